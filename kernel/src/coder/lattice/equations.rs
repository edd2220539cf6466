//! Weighted least squares by the normal equations, in integers.

use super::weights::{FIRST_NEW, TAPS, WEIGHT_BITS, Weights};

/// Differences of a point, one per tap, and what is to be predicted.
pub(super) const VALUES: usize = TAPS + 1;

/// Entries of a triangular matrix.
const ENTRIES: usize = VALUES * (VALUES + 1) / 2;

/// Bits that a value of a point has at most, sign left out.
const VALUE_BITS: u32 = 20;

/// The largest residual, likewise.
const LARGEST_RESIDUAL: i64 = 1 << VALUE_BITS;

/// Fraction bits of the weight of a point.
pub(super) const FRACTION_BITS: u32 = 12;

/// Bits that a weighted value is brought down by: the sum of 2^12 products has at most 63 bits.
const PRODUCT_BITS: u32 = 4;

/// Bits of the diagonal when the equations are solved.
const DIAGONAL_BITS: i32 = 46;

/// Fraction bits of factors and of the solution.
const SOLUTION_BITS: u32 = 40;

/// The largest correction of a weight.
const LARGEST_CORRECTION: i128 = 30_000;

/// The lower triangle of a symmetric matrix, row by row; its last row is the right side.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Equations {
    entries: [i64; ENTRIES],
    /// The sum of the weights of the points.
    weight: i64,
    /// Powers of two by which the rows were multiplied.
    scales: [i32; VALUES],
}

impl Equations {
    #[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
    pub(super) const NEW: Self = Self { entries: [0; ENTRIES], weight: 0, scales: [0; VALUES] };

    pub(super) fn clear(&mut self) {
        self.entries.fill(0);
        self.weight = 0;
    }

    /// Adds a point: its differences, the residual to be predicted, and how much it counts.
    pub(super) fn add(&mut self, differences: &[i32], residual: i64, weight: i64) {
        let all = differences.iter().fold(0, |all, difference| all | difference.unsigned_abs());
        let shift = u32::BITS.wrapping_sub(all.leading_zeros()).saturating_sub(VALUE_BITS);
        let mut values = [0_i32; VALUES];
        for (value, &difference) in values.iter_mut().zip(differences.iter().take(TAPS)) {
            *value = difference >> shift;
        }
        let residual = (residual >> shift).clamp(-LARGEST_RESIDUAL, LARGEST_RESIDUAL);
        values.iter_mut().skip(TAPS).for_each(|value| *value = i32::try_from(residual).unwrap_or(0));
        self.weight = self.weight.wrapping_add(weight);
        let mut entries = self.entries.as_mut_slice();
        for (number, &value) in values.iter().enumerate() {
            let weighted = i32::try_from(i64::from(value).wrapping_mul(weight) >> PRODUCT_BITS).unwrap_or(0);
            let Some((row, rest)) = entries.split_at_mut_checked(number.wrapping_add(1)) else { return };
            for (entry, &other) in row.iter_mut().zip(&values) {
                *entry = entry.wrapping_add(i64::from(weighted).wrapping_mul(other.into()));
            }
            entries = rest;
        }
    }

    /// Corrects `weights` by the solution, which is kept small: by 10^-6 of each equation, and by some of `step`.
    pub(super) fn solve(&mut self, step: u32, weights: &mut Weights) {
        self.regularize(step);
        self.equilibrate();
        for pivot in 0..TAPS {
            for row in pivot.wrapping_add(1)..VALUES {
                self.eliminate(pivot, row);
            }
        }
        let mut solution = [0_i64; TAPS];
        for row in (0..TAPS).rev() {
            let known = solution.iter().enumerate().skip(row.wrapping_add(1));
            let sum =
                known.fold(0_i64, |sum, (column, &x)| sum.wrapping_add(product(x, self.at(column, row))));
            let x = quotient(self.at(TAPS, row).wrapping_sub(sum), self.at(row, row));
            solution.iter_mut().skip(row).take(1).for_each(|slot| *slot = x);
        }
        let right_scale = self.scales.last().copied().unwrap_or(0);
        for ((weight, x), scale) in weights.0.iter_mut().zip(solution).zip(self.scales) {
            let by = scale.wrapping_sub(right_scale).clamp(-60, 60);
            let fine = i128::from(x).wrapping_shl(by.max(0).cast_unsigned()) >> by.min(0).unsigned_abs();
            let half = 1_i128 << (SOLUTION_BITS - WEIGHT_BITS - 1);
            let correction = fine.wrapping_add(half) >> (SOLUTION_BITS - WEIGHT_BITS);
            let correction = i32::try_from(correction.clamp(-LARGEST_CORRECTION, LARGEST_CORRECTION));
            *weight = weight.wrapping_add(correction.unwrap_or(0));
        }
    }

    fn regularize(&mut self, step: u32) {
        let square = i64::from(step).saturating_mul(step.into());
        let unit = (self.weight >> PRODUCT_BITS).saturating_mul(square).checked_div(50).unwrap_or(0);
        let unit = unit.saturating_add(1).min(1 << 58);
        for tap in 0..TAPS {
            let ridge = if tap < FIRST_NEW { unit } else { unit.wrapping_mul(3) };
            let entry = self.entries.get_mut(index(tap, tap));
            entry
                .into_iter()
                .for_each(|entry| *entry = entry.saturating_add(*entry >> 20).saturating_add(ridge));
        }
    }

    /// Multiplies rows and columns by powers of two so that every entry on the diagonal has [`DIAGONAL_BITS`] or one
    /// less.
    fn equilibrate(&mut self) {
        for (number, scale) in self.scales.iter_mut().enumerate() {
            let diagonal = self.entries.get(index(number, number)).copied().unwrap_or(0);
            let bits = u64::BITS.wrapping_sub(diagonal.unsigned_abs().leading_zeros());
            *scale = DIAGONAL_BITS.wrapping_sub(bits.cast_signed()) >> 1;
        }
        let rows = self.scales.iter().enumerate();
        let scales = rows
            .flat_map(|(row, a)| self.scales.iter().take(row.wrapping_add(1)).map(|b| a.wrapping_add(*b)));
        for (entry, by) in self.entries.iter_mut().zip(scales) {
            let by = by.clamp(-63, 63);
            *entry = entry.wrapping_shl(by.max(0).cast_unsigned()) >> by.min(0).unsigned_abs();
        }
    }

    /// Takes the multiple of equation `pivot` from equation `row` that frees it of unknown `pivot`.
    fn eliminate(&mut self, pivot: usize, row: usize) {
        let factor = quotient(self.at(row, pivot), self.at(pivot, pivot));
        if factor == 0 {
            return;
        }
        for column in pivot.wrapping_add(1)..=row {
            let part = product(factor, self.at(column, pivot));
            let entry = self.entries.get_mut(index(row, column));
            entry.into_iter().for_each(|entry| *entry = entry.wrapping_sub(part));
        }
    }

    /// Entry (`row`, `column`), `column` <= `row`.
    fn at(&self, row: usize, column: usize) -> i64 {
        self.entries.get(index(row, column)).copied().unwrap_or(0)
    }
}

/// Where entry (`row`, `column`), `column` <= `row`, is.
const fn index(row: usize, column: usize) -> usize {
    (row.wrapping_mul(row.wrapping_add(1)) / 2).wrapping_add(column)
}

/// `a` / `b` with [`SOLUTION_BITS`] of fraction, toward 0; 0 if that is no `i64`, or `b` is 0.
///
/// Bit by bit: a division of 128 bits is long code where processors have none.
fn quotient(a: i64, b: i64) -> i64 {
    let divisor = b.unsigned_abs();
    let (Some(whole), Some(mut rest)) =
        (a.unsigned_abs().checked_div(divisor), a.unsigned_abs().checked_rem(divisor))
    else {
        return 0;
    };
    if whole >> (u64::BITS - SOLUTION_BITS) != 0 {
        return 0;
    }
    let mut quotient = whole;
    for _ in 0..SOLUTION_BITS {
        // The rest is below the divisor, and so at most 2^63 - 1.
        (rest, quotient) = (rest << 1, quotient << 1);
        if rest >= divisor {
            (rest, quotient) = (rest.wrapping_sub(divisor), quotient | 1);
        }
    }
    let signed = if a.signum() == b.signum() {
        quotient.cast_signed()
    } else {
        0_u64.wrapping_sub(quotient).cast_signed()
    };
    // A quotient beyond 2^63 comes out with the other sign.
    if signed.signum() == a.signum().wrapping_mul(b.signum()) { signed } else { 0 }
}

/// `a` `b`, where `a` has [`SOLUTION_BITS`] of fraction.
fn product(a: i64, b: i64) -> i64 {
    i64::try_from(i128::from(a).wrapping_mul(b.into()) >> SOLUTION_BITS).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotients_are_those_of_128_bits() {
        let expected = |a: i64, b: i64| {
            let quotient = (i128::from(a) << SOLUTION_BITS).checked_div(b.into()).unwrap_or(0);
            i64::try_from(quotient).unwrap_or(0)
        };
        let ends = [0, 1, 3, i64::MAX >> 40, i64::MAX >> 17, i64::MAX / 3, i64::MAX - 1, i64::MAX, i64::MIN];
        let values = || ends.into_iter().chain((0..63).map(|bits| 0x5DEE_CE66_D1A4_B087 >> bits));
        let values = || values().flat_map(|value: i64| [value, value.wrapping_neg(), value.wrapping_add(1)]);
        for a in values() {
            for b in values() {
                assert_eq!(quotient(a, b), expected(a, b), "{a} / {b}");
            }
        }
    }
}
