//! What the samples of a row itself add to the sums over known rows: ranks of residuals, and samples again.

use super::Span;
use crate::coder::forecast::FRACTION_BITS;
use crate::coder::rank::{of_rank, rank};

/// Weights of the last `N` samples of the row, W first, in 1/2^[`FRACTION_BITS`].
#[derive(Clone, Copy, Debug)]
pub(super) struct OwnRow<const N: usize> {
    pub(super) weights: [i32; N],
    pub(super) span: Span,
}

impl<const N: usize> OwnRow<N> {
    /// Makes ranks of residuals of the samples of a row or a part of it, by the sums over known rows, which it uses up.
    /// `west` are the last samples before, and then the last of these.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn forward(&self, row: &mut [i32], sums: &mut [i32], west: &mut [i32; N]) {
        if cfg!(feature = "small") {
            for (slot, &sum) in row.iter_mut().zip(&*sums) {
                let residual = slot.wrapping_sub(self.predicted(self.add(sum, west)));
                slide(west, *slot);
                *slot = rank(residual);
            }
            return;
        }
        for (back, &weight) in (1..).zip(&self.weights) {
            let (first, others) = sums.split_at_mut_checked(back.min(row.len())).unwrap_or_default();
            for (sum, sample) in first.iter_mut().zip(west.iter().take(back).rev()) {
                *sum = sum.wrapping_add(weight.wrapping_mul(*sample));
            }
            for (sum, &sample) in others.iter_mut().zip(&*row) {
                *sum = sum.wrapping_add(weight.wrapping_mul(sample));
            }
        }
        let last = row.len().saturating_sub(N);
        row.iter().skip(last).for_each(|&sample| slide(west, sample));
        for (slot, &sum) in row.iter_mut().zip(&*sums) {
            *slot = rank(slot.wrapping_sub(self.predicted(sum)));
        }
    }

    /// Makes samples of the ranks of a row or a part of it, as [`OwnRow::forward`] made ranks of them.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn inverse(&self, row: &mut [i32], sums: &mut [i32], west: &mut [i32; N]) {
        if cfg!(feature = "small") {
            for (slot, &sum) in row.iter_mut().zip(&*sums) {
                let sample = self.predicted(self.add(sum, west)).wrapping_add(of_rank(*slot));
                slide(west, sample);
                *slot = sample;
            }
            return;
        }
        // Each sample waits for the one before. What does not is summed up first: samples count less the lowest, and the
        // residual is added to the sum.
        let Span { lowest, span } = self.span;
        let of_lowest = self.add(0, &[lowest; N]);
        for (slot, sum) in row.iter_mut().zip(&mut *sums) {
            *slot = of_rank(*slot);
            *sum = sum.wrapping_add(of_lowest).wrapping_add(*slot << FRACTION_BITS);
        }
        let mut before = west.map(|sample| sample.wrapping_sub(lowest));
        for (slot, &sum) in row.iter_mut().zip(&*sums) {
            let sum = self.add(sum, &before);
            let mut sample = sum >> FRACTION_BITS;
            if sample.wrapping_sub(*slot).cast_unsigned() > span.cast_unsigned() {
                sample = self.limited(sum, *slot);
            }
            slide(&mut before, sample);
            *slot = sample.wrapping_add(lowest);
        }
        *west = before.map(|sample| sample.wrapping_add(lowest));
    }

    /// The sample, less the lowest, of a prediction that is beyond the span: seldom, so that it is foreseen not to be.
    #[cold]
    fn limited(&self, sum: i32, residual: i32) -> i32 {
        let predicted = sum.wrapping_sub(residual << FRACTION_BITS) >> FRACTION_BITS;
        predicted.max(0).min(self.span.span).wrapping_add(residual)
    }

    /// Adds the products of the last samples, that of W last.
    #[inline(always)]
    fn add(&self, sum: i32, west: &[i32; N]) -> i32 {
        let products =
            self.weights.iter().zip(west).rev().map(|(weight, sample)| weight.wrapping_mul(*sample));
        products.fold(sum, i32::wrapping_add)
    }

    #[inline(always)]
    fn predicted(&self, sum: i32) -> i32 {
        let Span { lowest, span } = self.span;
        (sum >> FRACTION_BITS).max(0).min(span).wrapping_add(lowest)
    }
}

/// Makes `sample` the first of the last, W.
#[inline(always)]
fn slide<const N: usize>(west: &mut [i32; N], sample: i32) {
    west.iter_mut().fold(sample, |newer, slot| core::mem::replace(slot, newer));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_by_hand() {
        let own = OwnRow { weights: [128, 64], span: Span { lowest: -2, span: 20 } };
        // Half W and a quarter WW, and what known rows add: 8 / 2 + 8 / 4 + 0, 10 / 2 + 8 / 4 + 1, 6 / 2 + 10 / 4 + 2,
        // each less the lowest, which is added again.
        let known = [0, 1, 2].map(|known: i32| (known + 2) << FRACTION_BITS);
        let (mut row, mut sums) = ([10, 6, 18], known);
        own.forward(&mut row, &mut sums, &mut [8; 2]);
        assert_eq!(row, [10 - 6, 6 - 8, 18 - 7].map(rank));
        sums = known;
        own.inverse(&mut row, &mut sums, &mut [8; 2]);
        assert_eq!(row, [10, 6, 18]);
    }

    #[test]
    fn predictions_beyond_the_span_are_its_ends() {
        let own = OwnRow { weights: [256], span: Span { lowest: 5, span: 10 } };
        let known = [-100 << FRACTION_BITS, 100 << FRACTION_BITS];
        let (mut row, mut sums) = ([15, 5], known);
        own.forward(&mut row, &mut sums, &mut [0]);
        assert_eq!(row, [15 - 5, 5 - 15].map(rank));
        sums = known;
        own.inverse(&mut row, &mut sums, &mut [0]);
        assert_eq!(row, [15, 5]);
    }
}
