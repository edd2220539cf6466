//! A decoder.

#![no_std]
#![no_main]

use image as _;
use wavelift_kernel::{Codec, DecodeError, Header};

/// As [`Codec::decode`].
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn decode(
    codec: &mut Codec,
    bytes: &[u8],
    samples: &mut [i32],
    scratch: &mut [i32],
) -> Result<Header, DecodeError> {
    codec.decode(bytes, samples, scratch)
}
