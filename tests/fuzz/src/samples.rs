//! Samples out of arbitrary bytes.

use arbitrary::{Result, Unstructured};
use wavelift_kernel::SampleType;

/// `count` samples of a type: the bytes that are left, over and over, as they are or added up.
pub fn fill(data: &mut Unstructured<'_>, sample_type: SampleType, count: usize) -> Result<Vec<i32>> {
    let is_running: bool = data.arbitrary()?;
    let bytes = data.bytes(data.len())?;
    let at = |position: usize| bytes.get(position % bytes.len().max(1)).copied().unwrap_or(0);
    let width = if is_running { 1 } else { sample_type.bytes() };
    let mut sum = 0_i32;
    let samples = (0..count).map(|index| {
        let word: [u8; 4] = std::array::from_fn(|k| if k < width { at(index * width + k) } else { 0 });
        let value = i32::from_le_bytes(word);
        if !is_running {
            return value;
        }
        sum = sum.wrapping_add(value - 128);
        sum
    });
    Ok(samples.map(|value| as_type(sample_type, value)).collect())
}

/// The low bits of a value, in the range of a type.
fn as_type(sample_type: SampleType, value: i32) -> i32 {
    match sample_type {
        SampleType::U8 => value & 0xFF,
        SampleType::I8 => value << 24 >> 24,
        SampleType::U16 => value & 0xFFFF,
        SampleType::I16 => value << 16 >> 16,
        SampleType::U32 | SampleType::I32 => value,
    }
}
