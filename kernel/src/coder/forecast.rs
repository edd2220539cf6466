//! Prediction of coefficients by weighted sums of their neighbours.

use super::context::Expected;
use super::taps::{Known, REACH, Taps, WEIGHTS, WEST};

/// Weights are in units of 1/256.
pub(super) const FRACTION_BITS: u32 = 8;

/// The largest magnitude of a weight: 8.
pub(super) const LARGEST_WEIGHT: i16 = 8 << FRACTION_BITS;

/// The largest sum of magnitudes of the weights of a subband: 128.
pub(super) const LARGEST_SUM: i32 = 128 << FRACTION_BITS;

/// Bits of the lower halves of wide coefficients.
const HALF_BITS: u32 = 16;

/// The weights of a subband, in the order of [`Taps`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Weights(pub(super) [i16; WEIGHTS]);

/// The memory of the coder for one row, in scratch.
#[derive(Debug)]
pub(super) struct RowMemory<'a> {
    /// A row with [`REACH`] more columns at either end.
    pub(super) padded: &'a mut [i32],
    /// Weighted sums of what is known before the row.
    pub(super) sums: &'a mut [i32],
    /// The same of the upper halves of the coefficients, where they have more than 16 bits; else empty.
    pub(super) upper_sums: &'a mut [i32],
}

impl<'a> RowMemory<'a> {
    /// `i32`s of scratch for rows of `width`.
    pub(super) const fn len(width: usize) -> usize {
        width.saturating_mul(3).saturating_add(2 * REACH)
    }

    /// Memory for rows of `width`; `wide` if coefficients have more than 16 bits.
    pub(super) fn new(width: usize, wide: bool, scratch: &'a mut [i32]) -> Option<Self> {
        let (padded, rest) = scratch.split_at_mut_checked(width.wrapping_add(2 * REACH))?;
        let (sums, rest) = rest.split_at_mut_checked(width)?;
        let upper_sums = rest.get_mut(..if wide { width } else { 0 })?;
        Some(Self { padded, sums, upper_sums })
    }

    /// Sums of nothing.
    pub(super) fn clear(&mut self) {
        self.sums.fill(0);
        self.upper_sums.fill(0);
    }

    /// Adds the weighted windows of a row to the sums.
    fn add(&mut self, row: &Known<'_>, weights: &[i16]) {
        let width = self.sums.len();
        if self.upper_sums.is_empty() {
            pad(row.coefficients, width, self.padded, |coefficient| coefficient);
        } else {
            pad(row.coefficients, width, self.padded, |coefficient| coefficient >> HALF_BITS);
            add(self.upper_sums, self.padded, row.reach(), weights);
            pad(row.coefficients, width, self.padded, |coefficient| coefficient & LOWER_HALF);
        }
        add(self.sums, self.padded, row.reach(), weights);
    }

    /// Subtracts a row times `weight` from the sums.
    fn subtract(&mut self, row: &[i32], weight: i32) {
        let lower = if self.upper_sums.is_empty() { -1 } else { LOWER_HALF };
        for (sum, &coefficient) in self.sums.iter_mut().zip(row) {
            *sum = sum.wrapping_sub((coefficient & lower).wrapping_mul(weight));
        }
        for (sum, &coefficient) in self.upper_sums.iter_mut().zip(row) {
            *sum = sum.wrapping_sub((coefficient >> HALF_BITS).wrapping_mul(weight));
        }
    }
}

/// The lower half of a wide coefficient.
const LOWER_HALF: i32 = 0xFFFF;

/// Copies `row` to `padded`, `width` wide, with its first and last coefficient repeated on either side.
pub(super) fn pad(row: &[i32], width: usize, padded: &mut [i32], part: impl Fn(i32) -> i32) {
    let (Some(&first), Some(&last)) = (row.first(), row.last()) else { return padded.fill(0) };
    let Some((before, rest)) = padded.split_first_chunk_mut::<REACH>() else { return };
    *before = [part(first); REACH];
    let inside = row.len().min(width).min(rest.len());
    let (within, after) = rest.split_at_mut_checked(inside).unwrap_or_default();
    for (place, &coefficient) in within.iter_mut().zip(row) {
        *place = part(coefficient);
    }
    after.fill(part(last));
}

/// Adds the weighted windows of a padded row to `sums`.
pub(super) fn add(sums: &mut [i32], padded: &[i32], reach: usize, weights: &[i16]) {
    let row = padded.get(REACH.wrapping_sub(reach)..).unwrap_or(&[]);
    if cfg!(feature = "small") {
        for (&weight, from) in weights.iter().zip(0..) {
            for (sum, coefficient) in sums.iter_mut().zip(row.get(from..).unwrap_or(&[])) {
                *sum = sum.wrapping_add(coefficient.wrapping_mul(weight.into()));
            }
        }
        return;
    }
    match *weights {
        [a] => add_windows(sums, row, [a]),
        [a, b, c] => add_windows(sums, row, [a, b, c]),
        [a, b, c, d, e] => add_windows(sums, row, [a, b, c, d, e]),
        [a, b, c, d, e, f, g] => add_windows(sums, row, [a, b, c, d, e, f, g]),
        _ => {}
    }
}

#[cfg_attr(not(feature = "small"), inline(always))]
fn add_windows<const N: usize>(sums: &mut [i32], row: &[i32], weights: [i16; N]) {
    let weights = weights.map(i32::from);
    for (sum, window) in sums.iter_mut().zip(row.array_windows::<N>()) {
        let products =
            window.iter().zip(weights).map(|(coefficient, weight)| coefficient.wrapping_mul(weight));
        *sum = products.fold(*sum, i32::wrapping_add);
    }
}

/// The part of the prediction of a row that its own last coefficients add.
#[derive(Clone, Copy, Debug)]
pub(super) struct West {
    /// Of the last coefficient, the one before and the one before that.
    weights: [i32; WEST],
    last: [i32; WEST],
}

/// What predicts the coefficients of a row, one after another.
pub(super) trait Forecast {
    /// The value expected at `x`.
    fn expected(&self, x: usize) -> Expected;

    /// Tells of the coefficient that was there.
    fn push(&mut self, coefficient: i32);
}

/// 0 everywhere.
#[derive(Debug)]
pub(super) struct Zero;

impl Forecast for Zero {
    #[inline(always)]
    fn expected(&self, _: usize) -> Expected {
        Expected::exactly(0)
    }

    #[inline(always)]
    fn push(&mut self, _: i32) {}
}

/// The sums before a row, and what its own coefficients add.
#[derive(Debug)]
pub(super) struct Weighted<'a> {
    pub(super) west: West,
    pub(super) sums: &'a [i32],
    pub(super) upper_sums: &'a [i32],
}

impl Forecast for Weighted<'_> {
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn expected(&self, x: usize) -> Expected {
        let sum = self.sums.get(x).copied().unwrap_or(0);
        match self.upper_sums.get(x) {
            None => self.west.expected(sum),
            Some(&upper_sum) => self.west.expected_wide(sum, upper_sum),
        }
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn push(&mut self, coefficient: i32) {
        self.west.push(coefficient);
    }
}

impl West {
    pub(super) const ZERO: Self = Self { weights: [0; WEST], last: [0; WEST] };

    /// The prediction that the sums before a coefficient amount to.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn expected(&self, sum: i32) -> Expected {
        let products = self.weights.iter().zip(self.last).map(|(weight, last)| weight.wrapping_mul(last));
        Expected::of_scaled(products.fold(sum, i32::wrapping_add))
    }

    /// The same where coefficients have more than 16 bits.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn expected_wide(&self, sum: i32, upper_sum: i32) -> Expected {
        let sum = (i64::from(upper_sum) << HALF_BITS).wrapping_add(sum.into());
        let products = self.weights.iter().zip(self.last);
        let products = products.map(|(&weight, last)| i64::from(weight).wrapping_mul(last.into()));
        Expected::of_wide_scaled(products.fold(sum, i64::wrapping_add))
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    const fn push(&mut self, coefficient: i32) {
        let [a, b, _] = self.last;
        self.last = [coefficient, a, b];
    }
}

impl Weights {
    pub(super) const ZERO: Self = Self([0; WEIGHTS]);

    /// Sums what is known before row `y` of plane `z` into `memory`, for [`West`] to complete.
    ///
    /// A prediction is W + sum of w (c - W) in the low-pass part, and sum of w c + sum of w (l - l0) elsewhere, where
    /// l0 is the low-pass coefficient at the same place.
    pub(super) fn sum_row(
        &self,
        taps: &Taps,
        coefficients: &[i32],
        place: [usize; 2],
        memory: &mut RowMemory<'_>,
    ) -> West {
        memory.clear();
        let known = taps.known(coefficients, place);
        let (mut total, mut total_low) = (0_i32, 0_i32);
        for row in &known {
            let weights = self.of_row(row);
            memory.add(row, weights);
            let sum = weights.iter().fold(0, |sum: i32, &weight| sum.wrapping_add(weight.into()));
            let total = if row.is_low() { &mut total_low } else { &mut total };
            *total = total.wrapping_add(sum);
        }
        if let Some(low) = known.iter().find(|row| row.is_low()) {
            memory.subtract(low.coefficients, total_low);
        }
        let [a, b, c, ..] = self.0.map(i32::from);
        if !taps.is_low_pass() {
            return West { weights: [a, b, c], last: [0; WEST] };
        }
        // The nearest row comes first: N, or U in the first row of a plane.
        let reference = known.first().and_then(|row| row.coefficients.first().copied()).unwrap_or(0);
        let others = total.wrapping_add(a).wrapping_add(b);
        West { weights: [(1_i32 << FRACTION_BITS).wrapping_sub(others), a, b], last: [reference; WEST] }
    }

    fn of_row(&self, row: &Known<'_>) -> &[i16] {
        let end = row.first_weight.wrapping_add(row.len());
        self.0.get(row.first_weight..end).unwrap_or(&[])
    }
}

#[cfg(test)]
mod tests {
    use super::super::taps::Planes;
    use super::*;
    use crate::{Extent, Plan, Wavelet};

    /// The predictions of the last row of a brick under weights 1, 2, 3, ….
    fn predictions(samples: &[i32; 27], wide: bool) -> [Expected; 3] {
        let plan = Plan::new(Wavelet::Haar, Extent::brick(3, 3, 3).unwrap(), 0).unwrap();
        let taps = Taps::new(&plan, plan.subbands(0).next().unwrap(), Planes::Others).unwrap();
        let mut weights = Weights::ZERO;
        weights.0.iter_mut().zip(1..).for_each(|(weight, n)| *weight = n);
        let mut scratch = [7; 64];
        let mut memory = RowMemory::new(3, wide, &mut scratch).unwrap();
        let west = weights.sum_row(&taps, samples, [2, 2], &mut memory);
        let mut row = Weighted { west, sums: memory.sums, upper_sums: memory.upper_sums };
        [0, 1, 2].map(|x| {
            let expected = row.expected(x);
            row.push(samples[24 + x]);
            expected
        })
    }

    #[test]
    fn a_plane_of_one_value_is_predicted_exactly() {
        assert_eq!(predictions(&[-7; 27], false), [Expected::exactly(-7); 3]);
        assert_eq!(predictions(&[i32::MAX; 27], true), [Expected::exactly(i32::MAX); 3]);
    }

    #[test]
    fn halves_sum_to_the_whole() {
        let mut next = 0;
        let samples = [0; 27].map(|_: i32| {
            next = (next + 1103) % 251;
            next - 125
        });
        assert_eq!(predictions(&samples, false), predictions(&samples, true));
        let large = samples.map(|sample| sample << 20);
        let exact = predictions(&samples, true);
        let scaled = predictions(&large, true);
        for (exact, scaled) in exact.into_iter().zip(scaled) {
            let in_256ths = (exact.value << 8) + exact.offset;
            assert_eq!(i64::from(scaled.value), i64::from(in_256ths) << 12);
        }
    }

    #[test]
    fn rows_are_padded_with_their_ends() {
        let mut padded = [9; 9];
        pad(&[1, 2, 3], 3, &mut padded, |value| value * 10);
        assert_eq!(padded, [10, 10, 10, 10, 20, 30, 30, 30, 30]);
        pad(&[4, 5], 3, &mut padded, |value| value);
        assert_eq!(padded, [4, 4, 4, 4, 5, 5, 5, 5, 5]);
        pad(&[], 3, &mut padded, |value| value);
        assert_eq!(padded, [0; 9]);
    }
}
