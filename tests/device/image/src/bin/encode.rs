//! An encoder that trains nothing, or one of tables.

#![no_std]
#![no_main]

use image as _;
use wavelift_kernel::{Codec, Effort, EncodeError, Plan, SampleType};

/// As [`Codec::encode`].
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn encode(
    codec: &mut Codec,
    (plan, sample_type): (&Plan, SampleType),
    samples: &mut [i32],
    scratch: &mut [i32],
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    let effort = if cfg!(feature = "tables") {
        Effort::Tabled
    } else if cfg!(feature = "light") {
        Effort::Light
    } else {
        Effort::Fast
    };
    codec.encode(effort, plan, sample_type, samples, scratch, out)
}
