//! An encoder of slices that arrive one after another, which trains nothing.

#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use image as _;
use wavelift_kernel::stream::{RowError, SlabEncoder, SlabMemory, SlabPlan, Step};
use wavelift_kernel::{Codec, Effort, EncodeError};

/// As [`SlabEncoder::new`], in place.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn begin<'a>(
    encoder: &mut MaybeUninit<SlabEncoder<'a>>,
    plan: &SlabPlan,
    codec: &'a mut Codec,
    memory: SlabMemory<'a>,
) -> Result<(), EncodeError> {
    let effort = if cfg!(feature = "light") { Effort::Light } else { Effort::Fast };
    encoder.write(SlabEncoder::new(plan, codec, effort, memory)?);
    Ok(())
}

/// As [`SlabEncoder::step`].
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn step(encoder: &mut SlabEncoder<'_>, input: &[i32], output: &mut [u8]) -> Result<Step, RowError> {
    encoder.step(input, output)
}

/// As [`SlabEncoder::finish`].
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn finish(encoder: &mut SlabEncoder<'_>) -> Result<(), RowError> {
    encoder.finish()
}
