//! The trained predictor: a weighted sum of the samples before, its weights in the codestream.

use super::rows::{RowsBefore, window};

/// Weights of samples in the same plane.
pub(crate) const IN_PLANE: usize = 1 + 5 + 3;

/// Weights in all.
pub(crate) const WEIGHTS: usize = IN_PLANE + 3 + 3 + 3 + 1;

/// Weights are in units of 1/256.
pub(super) const FRACTION_BITS: u32 = 8;

/// The largest magnitude of a weight: 8.
pub(crate) const LARGEST_WEIGHT: i16 = 8 << FRACTION_BITS;

/// The weights of a codestream, in the order of [`Differences`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Weights {
    /// For the first plane, which has none before it.
    pub(crate) first: [i16; IN_PLANE],
    /// For all other planes.
    pub(crate) rest: [i16; WEIGHTS],
}

impl Weights {
    /// Weights that predict the reference itself.
    pub(crate) const ZERO: Self = Self { first: [0; IN_PLANE], rest: [0; WEIGHTS] };

    /// The value expected after the samples that `differences` tells of.
    #[inline(always)]
    pub(super) fn predict(&self, differences: &Differences) -> i32 {
        let weights = if differences.first_plane { &self.first[..] } else { &self.rest };
        let products = weights.iter().zip(&differences.values);
        let sum = products.map(|(&weight, &value)| i64::from(weight).wrapping_mul(value.into()));
        let sum = sum.fold(1 << (FRACTION_BITS - 1), i64::wrapping_add) >> FRACTION_BITS;
        differences.reference.wrapping_add(wrapped(sum))
    }
}

/// The low 32 bits.
#[inline(always)]
const fn wrapped(sum: i64) -> i32 {
    let [a, b, c, d, ..] = sum.to_le_bytes();
    i32::from_le_bytes([a, b, c, d])
}

/// Samples before one that is predicted, as differences from the nearest of them, the reference: WW; N with two
/// neighbours on either side; NN, U, UN and US with one; UU. Those that do not exist are no different from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Differences {
    pub(super) reference: i32,
    pub(super) values: [i32; WEIGHTS],
    pub(super) first_plane: bool,
}

impl Differences {
    /// Those before the sample at `x` of a row, of which the last two samples are known, if there are two.
    #[inline(always)]
    pub(super) fn new(before: &RowsBefore<'_>, x: usize, [west_west, west]: [Option<i32>; 2]) -> Self {
        let first = |row: &[i32]| row.first().copied();
        let reference = west.or_else(|| first(before.north)).or_else(|| first(before.up)).unwrap_or(0);
        let [a] = [west_west.unwrap_or(reference).wrapping_sub(reference)];
        let [b, c, d, e, f] = around(before.north, x, reference);
        let [g, h, i] = around(before.north_north, x, reference);
        let [j, k, l] = around(before.up, x, reference);
        let [m, n, o] = around(before.near_up_north, x, reference);
        let [p, q, r] = around(before.near_up_south, x, reference);
        let [s] = around(before.up_up, x, reference);
        let values = [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s];
        Self { reference, values, first_plane: before.up.is_empty() }
    }
}

/// The window of `row` around `x`, less the reference.
#[inline(always)]
fn around<const N: usize>(row: &[i32], x: usize, reference: i32) -> [i32; N] {
    if row.is_empty() { [0; N] } else { window(row, x).map(|sample: i32| sample.wrapping_sub(reference)) }
}
