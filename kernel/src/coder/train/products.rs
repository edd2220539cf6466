//! Sums of products of rows with one another.

use super::LANES;

/// The rows that others are multiplied with.
pub(super) struct Columns<'a>(&'a [[i16; LANES]]);

impl<'a> Columns<'a> {
    pub(super) const fn new(rows: &'a [[i16; LANES]]) -> Self {
        Self(rows)
    }

    /// Adds the sums of products of a row with the first of these to as many `sums`.
    #[cfg_attr(not(feature = "small"), inline(never))]
    pub(super) fn add_products(&self, row: &[i16; LANES], sums: &mut [i64]) {
        for (column, sum) in self.0.iter().zip(sums) {
            // If the row were known to be the same, its elements would be widened once for all others, and pairs not be
            // multiplied and added at once, which is quicker.
            let row = if cfg!(feature = "small") { row } else { core::hint::black_box(row) };
            *sum = sum.wrapping_add(dot(row, column).into());
        }
    }
}

/// The sum of products.
#[inline(always)]
fn dot(a: &[i16; LANES], b: &[i16; LANES]) -> i32 {
    a.iter().zip(b).fold(0, |sum: i32, (&a, &b)| sum.wrapping_add(i32::from(a).wrapping_mul(b.into())))
}
