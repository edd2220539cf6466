//! How many bits coefficients take, where all samples are of their type.

use crate::{SampleType, Wavelet};

/// Levels, from the finest on, whose coefficients are known to take fewer bits than a word.
const LEVELS: u8 = 3;

/// Bits that every coefficient of a level takes, and every number that a lifting step along y makes on the way to it, at
/// most, if all samples are of the type.
///
/// With samples as far as h from the middle of the type, a number that depends on them by factors whose magnitudes add
/// up to s is at most h s from what it would be of the middle, and what was rounded on the way. s is the product of the
/// sums along x and along y, and those are the largest over all lengths and places.
pub(super) const fn bits(wavelet: Wavelet, sample_type: SampleType, level: u8) -> u32 {
    if level >= LEVELS {
        return u32::BITS;
    }
    let [finest, coarser] = match wavelet {
        Wavelet::Haar | Wavelet::Linear => [2, 3],
        Wavelet::Quadratic | Wavelet::Duchaineau | Wavelet::Cubic => [4, 5],
        Wavelet::Quintic => [7, 7],
    };
    let bits = sample_type.bits().wrapping_add(if level == 0 { finest } else { coarser });
    if bits > u32::BITS { u32::BITS } else { bits }
}

#[cfg(test)]
#[expect(clippy::float_arithmetic, reason = "no coding, only bounds")]
mod tests;
