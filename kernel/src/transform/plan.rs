//! A transform that is known to be possible.

use super::lift::{Lifter, Part, scratch_len};
use crate::error::{at_least, exactly};
use crate::lifting::Direction;
#[cfg(feature = "stream")]
use crate::lifting::Halves;
use crate::memory::move_within;
use crate::{Extent, Feature, LengthError, PlanError, Slice, Wavelet};

/// `i32`s of scratch that [`Plan::lift_row`] takes for a row of `width`.
#[cfg(feature = "stream")]
pub(crate) const fn row_scratch_len(width: usize) -> usize {
    Halves::group_len(1, width)
}

/// A wavelet, an extent and a number of levels that the extent allows. Checked once, here: with a plan, only
/// lent memory of the wrong length can still fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plan {
    wavelet: Wavelet,
    extent: Extent,
    levels: u8,
}

impl Plan {
    /// Plans `levels` levels of `wavelet` over `extent`; 0 levels mean no transform.
    ///
    /// # Errors
    /// [`PlanError::TooManyLevels`] with the most that the extent allows, [`PlanError::NotBuilt`] if this build lacks the
    /// wavelet.
    pub const fn new(wavelet: Wavelet, extent: Extent, levels: u8) -> Result<Self, PlanError> {
        let max = extent.max_levels();
        if levels > max {
            return Err(PlanError::TooManyLevels { max });
        }
        if levels > 0 && !Feature::Wavelet(wavelet).is_built() {
            return Err(PlanError::NotBuilt(Feature::Wavelet(wavelet)));
        }
        // Without levels all wavelets are the same, and so are their plans.
        let wavelet = if levels == 0 { Wavelet::Haar } else { wavelet };
        Ok(Self { wavelet, extent, levels })
    }

    /// Levels that no wavelet makes, for [`Lattice`](crate::Lattice); `None` if the extent does not allow them.
    pub(crate) const fn without_wavelet(extent: Extent, levels: u8) -> Option<Self> {
        if levels > extent.max_levels() {
            return None;
        }
        Some(Self { wavelet: Wavelet::Haar, extent, levels })
    }

    /// The wavelet; with 0 levels always psi_H, whatever was asked for.
    #[must_use]
    pub const fn wavelet(&self) -> Wavelet {
        self.wavelet
    }

    /// Samples per axis.
    #[must_use]
    pub const fn extent(&self) -> Extent {
        self.extent
    }

    /// How often the low-pass part is transformed again.
    #[must_use]
    pub const fn levels(&self) -> u8 {
        self.levels
    }

    /// The plan of what is left after the `level` finest levels; `level` is at most [`Plan::levels`].
    #[must_use]
    pub const fn coarsened(&self, level: u8) -> Self {
        Self {
            wavelet: self.wavelet,
            extent: self.extent.coarsened(level),
            levels: self.levels.saturating_sub(level),
        }
    }

    /// `i32`s of scratch that the transform, the encoder and the decoder need for this plan.
    ///
    /// A transform takes one line along x, or up to 16 lines side by side along y and z; the coder takes the
    /// magnitudes of one plane (brick) or of four rows (slice, line) of the largest subband, and four rows of sums.
    #[must_use]
    pub const fn scratch_len(&self) -> usize {
        let coder = crate::coder::scratch_len(self);
        let transform = self.transform_scratch_len();
        if coder > transform { coder } else { transform }
    }

    /// Transforms `samples` (x fastest, `extent().samples()` of them) into coefficients in Mallat order.
    ///
    /// Lossless for every `i32`: sums wrap. Takes one pass over the data per level and axis.
    ///
    /// # Errors
    /// [`LengthError`] if `samples` is not exactly the extent or `scratch` is shorter than
    /// [`Plan::scratch_len`]; nothing is written then.
    pub fn forward(&self, samples: &mut [i32], scratch: &mut [i32]) -> Result<(), LengthError> {
        self.check(samples, scratch)?;
        for level in 0..self.levels {
            self.lift(level, Direction::Forward, samples, scratch);
        }
        Ok(())
    }

    /// Undoes [`Plan::forward`].
    ///
    /// # Errors
    /// As [`Plan::forward`].
    pub fn inverse(&self, samples: &mut [i32], scratch: &mut [i32]) -> Result<(), LengthError> {
        self.check(samples, scratch)?;
        for level in (0..self.levels).rev() {
            self.inverse_level(level, samples, scratch);
        }
        Ok(())
    }

    /// Transforms `samples` as [`Plan::forward`] and moves the low-pass part to their beginning: it is the first
    /// `extent().coarsened(levels()).samples()` of them, x fastest; the others have no meaning.
    ///
    /// # Errors
    /// As [`Plan::forward`].
    pub fn low_pass(&self, samples: &mut [i32], scratch: &mut [i32]) -> Result<(), LengthError> {
        self.forward(samples, scratch)?;
        for low_pass in self.subbands(0) {
            let width = low_pass.sides[0];
            for (to, [y, z]) in (0..).step_by(width.max(1)).zip(low_pass.rows()) {
                let from = low_pass.row(self, y, z);
                move_within(samples, from..from.wrapping_add(width), to);
            }
        }
        Ok(())
    }

    /// Undoes one level: the coarser ones are undone already.
    pub(crate) fn inverse_level(&self, level: u8, samples: &mut [i32], scratch: &mut [i32]) {
        self.lift(level, Direction::Inverse, samples, scratch);
    }

    /// Transforms one row along x, or back: the first level of a line. `scratch` is [`row_scratch_len`] long.
    #[cfg(feature = "stream")]
    pub(crate) fn lift_row(wavelet: Wavelet, direction: Direction, row: &mut [i32], scratch: &mut [i32]) {
        let sides = [row.len(), 1, 1];
        Lifter { wavelet, scratch }.lift(direction, Part { part: sides, sides }, row);
    }

    fn check(&self, samples: &[i32], scratch: &[i32]) -> Result<(), LengthError> {
        exactly(Slice::Samples, self.extent.samples(), samples.len())?;
        at_least(Slice::Scratch, self.scratch_len(), scratch.len())
    }

    fn lift(&self, level: u8, direction: Direction, samples: &mut [i32], scratch: &mut [i32]) {
        let part = Part { part: self.extent.coarsened(level).sides(), sides: self.extent.sides() };
        Lifter { wavelet: self.wavelet, scratch }.lift(direction, part, samples);
    }

    const fn transform_scratch_len(&self) -> usize {
        if self.levels == 0 { 0 } else { scratch_len(self.extent.sides()) }
    }
}
