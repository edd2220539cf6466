//! Residuals in whole steps.

use core::ops::RangeInclusive;

/// The precision of samples: their range, and how far a decoded one may be off.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Precision {
    pub(crate) range: RangeInclusive<i32>,
    pub(crate) slack: u32,
    /// By how much steps shrink from one level to the next coarser: a row of [`SHRINKING`].
    pub(crate) shrinking: u8,
}

/// What steps are of their full length, in 1/65536, at levels 0, 1, …; beyond the last level listed as at it.
pub(crate) const SHRINKING: [[u32; 4]; 3] =
    [[65_536, 65_536, 65_536, 65_536], [65_536, 52_429, 41_943, 32_768], [65_536, 43_691, 29_127, 16_384]];

/// The largest slack there is: the step still fits.
pub(crate) const LARGEST_SLACK: u32 = (1 << 30) - 1;

/// Rounds residuals to multiples of an odd step.
#[derive(Clone, Debug)]
pub(super) struct Quantizer {
    step: u32,
    /// 2^32 / step, rounded down.
    reciprocal: u64,
    low: i64,
    high: i64,
}

impl Quantizer {
    pub(super) fn new(precision: &Precision, level: u8) -> Self {
        let full = precision.slack.min(LARGEST_SLACK).wrapping_mul(2).wrapping_add(1);
        let shares = SHRINKING.get(usize::from(precision.shrinking)).unwrap_or(&[65_536; 4]);
        let share = shares.get(usize::from(level)).or(shares.last()).copied().unwrap_or(65_536);
        let shrunk = u64::from(full).wrapping_mul(share.into()) >> 16;
        let step = u32::try_from(shrunk.saturating_sub(1) | 1).unwrap_or(1);
        let reciprocal = (1_u64 << 32).checked_div(step.into()).unwrap_or(0);
        Self {
            step,
            reciprocal,
            low: (*precision.range.start()).into(),
            high: (*precision.range.end()).into(),
        }
    }

    pub(super) const fn step(&self) -> u32 {
        self.step
    }

    /// The number of steps nearest to `sample` - `predicted`.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn index(&self, sample: i32, predicted: i32) -> i32 {
        if self.step == 1 {
            return sample.wrapping_sub(predicted);
        }
        let residual = i64::from(sample).wrapping_sub(predicted.into());
        let dividend = residual.unsigned_abs().wrapping_add(u64::from(self.step >> 1));
        let step = u64::from(self.step);
        // At most one too low.
        let quotient = dividend.wrapping_mul(self.reciprocal) >> 32;
        let short = dividend.wrapping_sub(quotient.wrapping_mul(step)) >= step;
        let [a, b, c, d, ..] = quotient.wrapping_add(u64::from(short)).to_le_bytes();
        let steps = i32::from_le_bytes([a, b, c, d]);
        if residual < 0 { steps.wrapping_neg() } else { steps }
    }

    /// The sample that is `index` steps from `predicted`, in the range of the samples.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn sample(&self, predicted: i32, index: i32) -> i32 {
        if self.step == 1 {
            return predicted.wrapping_add(index);
        }
        let offset = i64::from(index).wrapping_mul(self.step.into());
        let [a, b, c, d, ..] =
            i64::from(predicted).wrapping_add(offset).max(self.low).min(self.high).to_le_bytes();
        i32::from_le_bytes([a, b, c, d])
    }
}
