//! Training of the predictor's weights: weighted least squares by its normal equations, in integers.

use super::rows::each_sample;
use super::weights::{Differences, FRACTION_BITS, LARGEST_WEIGHT, WEIGHTS, Weights};
use crate::transform::{Plan, Subband};

/// Samples that are trained on, about: of larger low-pass parts only every so many rows, of longer rows the first.
const SAMPLES: usize = 1 << 14;

/// Bits that samples are brought down to, all by the same shift, so that no sum of products overflows.
const SAMPLE_BITS: u32 = 15;

/// Bits of the weight of a sample in the equations.
const SAMPLE_WEIGHT_BITS: u32 = 14;

/// Bits that the entries are brought down to before the equations are solved.
const ENTRY_BITS: u32 = 30;

/// What is added to the diagonal, as a fraction: 2^-13.
const RIDGE_BITS: u32 = 13;

/// Differences per sample.
const TAPS: i64 = 19;
const _: () = assert!(WEIGHTS == 19);

/// Fraction bits of the factors and of the solution.
const FACTOR_BITS: u32 = 18;

/// The normal equations of the weights: entry (r, c), c <= r, of their symmetric matrix, and the right-hand sides.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Equations {
    matrix: [[i64; WEIGHTS]; WEIGHTS],
    right: [i64; WEIGHTS],
}

impl Equations {
    #[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
    pub(crate) const NEW: Self = Self { matrix: [[0; WEIGHTS]; WEIGHTS], right: [0; WEIGHTS] };

    /// Makes `self` equal to [`Equations::NEW`].
    pub(crate) fn reset(&mut self) {
        self.matrix.as_flattened_mut().fill(0);
        self.right.fill(0);
    }

    /// The weights that suit the low-pass part of `coefficients`.
    pub(super) fn train(&mut self, plan: &Plan, low_pass: Subband, coefficients: &[i32]) -> Weights {
        let mut weights = Weights::ZERO;
        self.gather(plan, low_pass, coefficients, true);
        self.solve(&mut weights.first);
        self.gather(plan, low_pass, coefficients, false);
        self.solve(&mut weights.rest);
        self.reset();
        weights
    }

    /// Sets up the equations of the first plane, or of all others.
    fn gather(&mut self, plan: &Plan, low_pass: Subband, coefficients: &[i32], first_plane: bool) {
        self.reset();
        let [width, height, depth] = low_pass.sides;
        let planes = if first_plane { 1 } else { depth.saturating_sub(1) };
        // An odd step meets rows at every height. The top rows of planes know too little to learn from, unless there
        // is no other.
        let every = width.wrapping_mul(height).wrapping_mul(planes).div_ceil(SAMPLES) | 1;
        let learned_from = |&[y, z]: &[usize; 2]| (y > 0 || height == 1) && (z == 0) == first_plane;
        let rows = low_pass.rows().filter(learned_from).step_by(every);
        let shift = excess_bits(coefficients);
        each_sample(plan, low_pass, coefficients, rows, SAMPLES, |before, x, wests, value| {
            self.add(&Differences::new(before, x, wests), value, shift);
        });
    }

    /// Adds one sample, which counts inversely to the mean size of its differences, so that a few edges do not
    /// outweigh everything else.
    fn add(&mut self, differences: &Differences, value: i32, shift: u32) {
        let target = i64::from(value.wrapping_sub(differences.reference) >> shift);
        let differences = differences.values.map(|difference| i64::from(difference >> shift));
        let size =
            differences.iter().fold(0, |sum: i64, difference| sum.wrapping_add(difference.wrapping_abs()));
        let weight = (TAPS << SAMPLE_WEIGHT_BITS).checked_div(size.wrapping_add(TAPS)).unwrap_or(0);
        for ((row, right), (count, &difference)) in
            self.matrix.iter_mut().zip(&mut self.right).zip((1..).zip(&differences))
        {
            let weighted = difference.wrapping_mul(weight);
            for (entry, &other) in row.iter_mut().zip(&differences).take(count) {
                *entry = entry.wrapping_add(weighted.wrapping_mul(other));
            }
            *right = right.wrapping_add(weighted.wrapping_mul(target));
        }
    }

    /// Solves the leading equations for as many weights: elimination, then substitution, in fixed point.
    fn solve(&mut self, weights: &mut [i16]) {
        self.condition();
        let n = weights.len();
        for pivot in 0..n {
            for row in pivot.wrapping_add(1)..n {
                self.eliminate(pivot, row);
            }
        }
        let mut solution = [0_i64; WEIGHTS];
        for row in (0..n).rev() {
            let known = solution.iter().enumerate().take(n).skip(row.wrapping_add(1));
            let sum = known
                .fold(0, |sum: i64, (column, &x)| sum.wrapping_add(x.wrapping_mul(self.at(column, row))));
            let right = self.right.get(row).copied().unwrap_or(0) << FACTOR_BITS;
            let x = right.wrapping_sub(sum).checked_div(self.at(row, row)).unwrap_or(0);
            solution.iter_mut().skip(row).take(1).for_each(|slot| *slot = x);
        }
        for (weight, x) in weights.iter_mut().zip(solution) {
            let rounded =
                x.wrapping_add(1 << (FACTOR_BITS - FRACTION_BITS - 1)) >> (FACTOR_BITS - FRACTION_BITS);
            let largest = i64::from(LARGEST_WEIGHT);
            *weight = i16::try_from(rounded.clamp(largest.wrapping_neg(), largest)).unwrap_or(0);
        }
    }

    /// Adds a little to the diagonal, so that the equations have one solution, and brings all entries down to
    /// [`ENTRY_BITS`].
    fn condition(&mut self) {
        let mut largest = self.right.iter().fold(0, |largest: i64, right| right.wrapping_abs().max(largest));
        for (i, row) in self.matrix.iter_mut().enumerate() {
            for entry in row.iter_mut().skip(i).take(1) {
                *entry = entry.wrapping_add(*entry >> RIDGE_BITS).wrapping_add(1 << SAMPLE_WEIGHT_BITS);
                largest = (*entry).max(largest);
            }
        }
        let bits = i64::BITS.wrapping_sub(largest.leading_zeros());
        let shift = bits.saturating_sub(ENTRY_BITS);
        let entries = self.matrix.as_flattened_mut().iter_mut().chain(&mut self.right);
        entries.for_each(|entry| *entry >>= shift);
    }

    /// Takes the multiple of equation `pivot` from equation `row` that frees it of unknown `pivot`.
    fn eliminate(&mut self, pivot: usize, row: usize) {
        let divisor = self.at(pivot, pivot);
        let factor = (self.at(row, pivot) << FACTOR_BITS).checked_div(divisor).unwrap_or(0);
        for column in pivot.wrapping_add(1)..=row {
            let part = factor.wrapping_mul(self.at(column, pivot)) >> FACTOR_BITS;
            if let Some(entry) = self.matrix.get_mut(row).and_then(|entries| entries.get_mut(column)) {
                *entry = entry.wrapping_sub(part);
            }
        }
        let part = factor.wrapping_mul(self.right.get(pivot).copied().unwrap_or(0)) >> FACTOR_BITS;
        if let Some(right) = self.right.get_mut(row) {
            *right = right.wrapping_sub(part);
        }
    }

    /// Entry (`row`, `column`), `column` <= `row`.
    fn at(&self, row: usize, column: usize) -> i64 {
        self.matrix.get(row).and_then(|entries| entries.get(column)).copied().unwrap_or(0)
    }
}

/// Bits by which the largest of the samples exceeds [`SAMPLE_BITS`].
fn excess_bits(samples: &[i32]) -> u32 {
    let all = samples.iter().fold(0, |all, sample| all | sample.unsigned_abs());
    u32::BITS.wrapping_sub(all.leading_zeros()).saturating_sub(SAMPLE_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Extent, Wavelet};

    #[test]
    fn a_linear_rule_is_found() {
        // Every sample is the mean of west and north, and noise.
        let plan = Plan::new(Wavelet::Haar, Extent::slice(32, 31).unwrap(), 0).unwrap();
        let mut samples: heapless::Vec<i32, 992> = heapless::Vec::new();
        let mut seed = 1_u32;
        for i in 0..992 {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = (seed >> 20).cast_signed() - 2048;
            let mean =
                if i % 32 == 0 || i < 32 { 0 } else { (samples[i - 1] + samples[i - 32]).div_euclid(2) };
            samples.push(mean + noise).unwrap();
        }
        let low_pass = plan.subbands(0).next().unwrap();
        let mut equations = Equations::NEW;
        let weights = equations.train(&plan, low_pass, &samples);
        // N is the third of the window of five that follows WW: its weight is near 128 / 256, the others' near 0.
        for (i, weight) in weights.first.into_iter().enumerate() {
            let expected = if i == 3 { 128 } else { 0 };
            assert!((i32::from(weight) - expected).abs() < 40, "{:?}", weights.first);
        }
        assert_eq!(weights.rest, [0; WEIGHTS]);
    }

    #[test]
    fn extremes_do_not_panic() {
        let plan = Plan::new(Wavelet::Haar, Extent::brick(4, 4, 4).unwrap(), 0).unwrap();
        let samples: [i32; 64] = core::array::from_fn(|i| if i % 3 == 0 { i32::MIN } else { i32::MAX });
        let low_pass = plan.subbands(0).next().unwrap();
        let mut equations = Equations::NEW;
        equations.train(&plan, low_pass, &samples);
        assert_eq!(equations, Equations::NEW);
    }
}
