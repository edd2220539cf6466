//! A decoder, and an encoder of any effort that is not dense.

#![no_std]
#![no_main]

use image as _;
use wavelift_kernel::{Codec, DecodeError, Effort, EncodeError, Header, Plan, SampleType, Training};

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

/// As [`Codec::encode`].
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn encode(
    (codec, training): (&mut Codec, Option<&mut Training>),
    (plan, sample_type): (&Plan, SampleType),
    samples: &mut [i32],
    scratch: &mut [i32],
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    let effort = training.map_or(Effort::Fast, Effort::Default);
    codec.encode(effort, plan, sample_type, samples, scratch, out)
}
