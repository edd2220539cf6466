//! A decoder of rows whose bytes arrive one after another.

#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use image as _;
use wavelift_kernel::stream::{RowCodec, RowDecoder, RowPlan, Step};
use wavelift_kernel::{DecodeError, LengthError};

/// As [`RowPlan::parse`].
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn parse(bytes: &[u8]) -> Result<(RowPlan, usize), DecodeError> {
    RowPlan::parse(bytes)
}

/// As [`RowDecoder::new`], in place.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn begin<'a>(
    decoder: &mut MaybeUninit<RowDecoder<'a>>,
    plan: &RowPlan,
    codec: &'a mut RowCodec,
    memory: &'a mut [i32],
) -> Result<(), LengthError> {
    decoder.write(RowDecoder::new(plan, codec, memory)?);
    Ok(())
}

/// As [`RowDecoder::step`].
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn step(decoder: &mut RowDecoder<'_>, input: &[u8], output: &mut [i32]) -> Result<Step, DecodeError> {
    decoder.step(input, output)
}
