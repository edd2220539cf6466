//! Samples per axis.

use core::fmt;

use crate::PlanError;

/// The number of samples along x, y and z of a line, a slice or a brick; x varies fastest in memory.
///
/// A line of `n` samples is `(n, 1, 1)`, a slice `(x, y, 1)`.
/// Every axis has at least one sample, and the product is at most 2^31 - 1 on every target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Extent {
    axes: [u32; 3],
}

impl Extent {
    /// An extent of `axes` = `[x, y, z]` samples.
    ///
    /// # Errors
    /// [`PlanError::ZeroExtent`] for an axis without samples, [`PlanError::ExtentTooLarge`] for 2^31 samples or more.
    pub const fn new(axes: [u32; 3]) -> Result<Self, PlanError> {
        let [x, y, z] = axes;
        if x == 0 {
            return Err(PlanError::ZeroExtent { axis: 0 });
        }
        if y == 0 {
            return Err(PlanError::ZeroExtent { axis: 1 });
        }
        if z == 0 {
            return Err(PlanError::ZeroExtent { axis: 2 });
        }
        let samples = match x.checked_mul(y) {
            Some(slice) => slice.checked_mul(z),
            None => None,
        };
        match samples {
            Some(samples) if samples <= i32::MAX.cast_unsigned() => Ok(Self { axes }),
            _ => Err(PlanError::ExtentTooLarge),
        }
    }

    /// A line of `x` samples.
    ///
    /// # Errors
    /// As [`Extent::new`].
    pub const fn line(x: u32) -> Result<Self, PlanError> {
        Self::new([x, 1, 1])
    }

    /// A slice of `x` by `y` samples.
    ///
    /// # Errors
    /// As [`Extent::new`].
    pub const fn slice(x: u32, y: u32) -> Result<Self, PlanError> {
        Self::new([x, y, 1])
    }

    /// A brick of `x` by `y` by `z` samples.
    ///
    /// # Errors
    /// As [`Extent::new`].
    pub const fn brick(x: u32, y: u32, z: u32) -> Result<Self, PlanError> {
        Self::new([x, y, z])
    }

    /// Samples along `[x, y, z]`.
    #[must_use]
    pub const fn axes(self) -> [u32; 3] {
        self.axes
    }

    /// Samples in all: the product of the axes.
    #[must_use]
    pub const fn samples(self) -> usize {
        let [x, y, z] = self.axes;
        to_usize(x.wrapping_mul(y).wrapping_mul(z))
    }

    /// The largest number of levels a transform of this extent has: one per halving until every axis is 1 long.
    #[must_use]
    pub const fn max_levels(self) -> u8 {
        let [x, y, z] = self.axes;
        let [x, y, z] = [levels_of(x), levels_of(y), levels_of(z)];
        let slice = if x > y { x } else { y };
        if slice > z { slice } else { z }
    }

    /// The extent of the low-pass part after `levels` levels: ceil(n / 2^levels) along each axis.
    #[must_use]
    pub const fn coarsened(self, levels: u8) -> Self {
        let [x, y, z] = self.axes;
        Self { axes: [coarsened(x, levels), coarsened(y, levels), coarsened(z, levels)] }
    }

    /// Samples along `[x, y, z]`, as lengths of slices.
    pub(crate) const fn sides(self) -> [usize; 3] {
        let [x, y, z] = self.axes;
        [to_usize(x), to_usize(y), to_usize(z)]
    }
}

impl fmt::Display for Extent {
    /// `64x64x93`: x, y, z.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.axes;
        write!(f, "{x}x{y}x{z}")
    }
}

/// Halvings (rounding up) that bring `n` samples down to one: ceil(log2 n).
#[expect(clippy::as_conversions, reason = "at most 32; From is not const")]
const fn levels_of(n: u32) -> u8 {
    u32::BITS.wrapping_sub(n.saturating_sub(1).leading_zeros()) as u8
}

const fn coarsened(n: u32, levels: u8) -> u32 {
    if levels >= 32 { 1 } else { (n.wrapping_sub(1) >> levels).wrapping_add(1) }
}

const _: () = assert!(usize::BITS >= u32::BITS, "slices are indexed with 32-bit lengths");

/// A 32-bit length as a slice length.
#[expect(clippy::as_conversions, reason = "lossless: usize has at least 32 bits, asserted above")]
pub(crate) const fn to_usize(n: u32) -> usize {
    n as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_end_when_every_axis_is_one_sample() {
        let max = |axes| Extent::new(axes).unwrap().max_levels();
        assert_eq!([max([1, 1, 1]), max([2, 1, 1]), max([3, 1, 1]), max([4, 5, 1])], [0, 1, 2, 3]);
        assert_eq!(max([64, 64, 64]), 6);
        assert_eq!(max([i32::MAX.cast_unsigned(), 1, 1]), 31);
    }

    #[test]
    fn coarsening_rounds_up() {
        let extent = Extent::brick(17, 5, 1).unwrap();
        assert_eq!(extent.coarsened(1).axes(), [9, 3, 1]);
        assert_eq!(extent.coarsened(5).axes(), [1, 1, 1]);
        assert_eq!(extent.coarsened(40).axes(), [1, 1, 1]);
    }

    #[test]
    fn impossible_extents_are_refused() {
        assert_eq!(Extent::new([3, 0, 1]), Err(PlanError::ZeroExtent { axis: 1 }));
        assert_eq!(Extent::new([1 << 16, 1 << 15, 1]), Err(PlanError::ExtentTooLarge));
        assert_eq!(Extent::new([u32::MAX; 3]), Err(PlanError::ExtentTooLarge));
    }
}
