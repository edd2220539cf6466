//! An encoder of rows that arrive one after another.

#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use image as _;
use wavelift_kernel::LengthError;
use wavelift_kernel::stream::{RowCodec, RowEncoder, RowError, RowPlan, Step};

/// As [`RowEncoder::new`], in place.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn begin<'a>(
    encoder: &mut MaybeUninit<RowEncoder<'a>>,
    plan: &RowPlan,
    codec: &'a mut RowCodec,
    memory: &'a mut [i32],
) -> Result<(), LengthError> {
    encoder.write(RowEncoder::new(plan, codec, memory)?);
    Ok(())
}

/// As [`RowEncoder::step`].
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn step(encoder: &mut RowEncoder<'_>, input: &[i32], output: &mut [u8]) -> Result<Step, RowError> {
    encoder.step(input, output)
}

/// As [`RowEncoder::finish`].
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn finish(encoder: &mut RowEncoder<'_>) -> Result<(), RowError> {
    encoder.finish()
}
