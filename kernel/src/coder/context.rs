//! What the chances of a residual depend on: how large the residuals around it are, and where between two integers
//! the prediction fell.

use crate::extent::to_usize;

/// Energies below 2 to this power are told apart exactly or by the half octave, and their residuals coded to the unit;
/// above, residuals are coded in steps.
const SMALL_OCTAVES: u32 = 5;

/// Classes of small energies: 0 to 3, then two an octave.
pub(super) const SMALL_CLASSES: usize = 10;

/// Classes of large energies, two an octave.
pub(super) const LARGE_CLASSES: usize = 50;

/// Where a prediction fell: close to an integer, off it, or halfway between two.
pub(super) const FRACTIONS: usize = 3;

/// Residuals are remembered up to this magnitude, so that no sum of them overflows.
const LARGEST: u32 = 1 << 25;

/// The magnitude of `residual`, as it is remembered.
#[inline(always)]
pub(super) fn magnitude(residual: i32) -> i32 {
    residual.unsigned_abs().min(LARGEST).cast_signed()
}

/// A prediction in units of 1/256: the nearest integer, and how far from it the prediction was, -128 to 127.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Expected {
    pub(super) value: i32,
    pub(super) offset: i32,
}

impl Expected {
    /// Exactly `value`.
    #[inline(always)]
    pub(super) const fn exactly(value: i32) -> Self {
        Self { value, offset: 0 }
    }

    /// `scaled` / 256.
    #[inline(always)]
    pub(super) fn of_scaled(scaled: i32) -> Self {
        let rounded = scaled.wrapping_add(128);
        Self { value: rounded >> 8, offset: (rounded & 0xFF).wrapping_sub(128) }
    }

    /// `scaled` / 256, its low 32 bits.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn of_wide_scaled(scaled: i64) -> Self {
        let [fraction, a, b, c, d, ..] = scaled.wrapping_add(128).to_le_bytes();
        Self { value: i32::from_le_bytes([a, b, c, d]), offset: i32::from(fraction).wrapping_sub(128) }
    }

    /// How far from an integer the prediction fell: below [`FRACTIONS`].
    #[inline(always)]
    pub(super) fn fraction(self) -> usize {
        let distance = self.offset.wrapping_abs();
        usize::from(distance >= 32).wrapping_add(usize::from(distance >= 80))
    }
}

/// The class of an energy, and the bits of the steps in which its residuals are coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    Small(usize),
    Large { class: usize, step_bits: u32 },
}

impl Class {
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn of(energy: i32) -> Self {
        let energy = energy.cast_unsigned();
        if energy < 4 {
            return Self::Small(to_usize(energy));
        }
        let octave = energy.checked_ilog2().unwrap_or(0);
        let upper_half = (energy >> octave.wrapping_sub(1)) & 1;
        let class = octave.wrapping_mul(2).wrapping_add(upper_half);
        if octave < SMALL_OCTAVES {
            Self::Small(to_usize(class))
        } else {
            let class = to_usize(class.wrapping_sub(2 * SMALL_OCTAVES)).min(LARGE_CLASSES - 1);
            Self::Large { class, step_bits: octave.wrapping_sub(SMALL_OCTAVES) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_classes_an_octave() {
        let small = [0, 1, 3, 4, 5, 6, 7, 8, 11, 12, 31].map(Class::of);
        assert_eq!(small, [0, 1, 3, 4, 4, 5, 5, 6, 6, 7, 9].map(Class::Small));
        assert_eq!(Class::of(32), Class::Large { class: 0, step_bits: 0 });
        assert_eq!(Class::of(127), Class::Large { class: 3, step_bits: 1 });
        assert_eq!(Class::of(i32::MAX), Class::Large { class: LARGE_CLASSES - 1, step_bits: 25 });
    }

    #[test]
    fn the_cap_lets_nothing_overflow() {
        let most = magnitude(i32::MIN);
        assert_eq!(most, 1 << 25);
        assert!(i64::from(most) * 32 < i64::from(i32::MAX));
    }

    #[test]
    fn fractions_are_symmetric() {
        let fraction = |offset| Expected { value: 0, offset }.fraction();
        assert_eq!([0, 31, -31, 32, -79, 80, 127, -128].map(fraction), [0, 0, 0, 1, 1, 2, 2, 2]);
    }
}
