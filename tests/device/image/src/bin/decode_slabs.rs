//! A decoder of slabs whose bytes arrive one after another.

#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use image as _;
use wavelift_kernel::stream::{SlabDecoder, SlabMemory, SlabPlan, Step};
use wavelift_kernel::{Codec, DecodeError, LengthError};

/// As [`SlabPlan::parse`].
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn parse(bytes: &[u8]) -> Result<(SlabPlan, usize), DecodeError> {
    SlabPlan::parse(bytes)
}

/// As [`SlabDecoder::new`], in place.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn begin<'a>(
    decoder: &mut MaybeUninit<SlabDecoder<'a>>,
    plan: &SlabPlan,
    codec: &'a mut Codec,
    memory: SlabMemory<'a>,
) -> Result<(), LengthError> {
    decoder.write(SlabDecoder::new(plan, codec, memory)?);
    Ok(())
}

/// As [`SlabDecoder::step`].
#[unsafe(no_mangle)]
#[unsafe(link_section = ".entry")]
pub fn step(decoder: &mut SlabDecoder<'_>, input: &[u8], output: &mut [i32]) -> Result<Step, DecodeError> {
    decoder.step(input, output)
}
