//! The neighbours that predict a sample, and their weights.

use super::super::Coder;
use super::super::distribution::Distribution;
use crate::extent::to_usize;

/// Neighbours of a sample.
pub(super) const TAPS: usize = 35;

/// The first tap among samples of the same pass.
pub(super) const FIRST_NEW: usize = 20;

/// Fraction bits of a weight.
pub(super) const WEIGHT_BITS: u32 = 12;

/// The least logarithm of what is coded of a weight.
const LEAST_BITS: u32 = 6;

/// Rows of a window: known ones, those of the pass, the row itself.
pub(super) const SLOTS: usize = 17;

/// The row between the known rows before and after: their mean.
pub(super) const MEAN: usize = 9;

/// The row of the samples to be predicted.
pub(super) const OWN: usize = 16;

/// Rows of the pass: first those of the plane before.
pub(super) const UP_NORTH: usize = 10;
pub(super) const UP: usize = 11;
pub(super) const UP_SOUTH: usize = 12;
pub(super) const NORTH: usize = 13;
pub(super) const NORTH_NORTH: usize = 14;
pub(super) const UP_UP: usize = 15;

/// The known rows beyond those before and after, for a pass along y or z.
pub(super) const FAR_BEFORE: usize = 6;
pub(super) const FAR_AFTER: usize = 7;

/// Where the known sample before is: its row.
pub(super) const fn centre(axis: usize) -> usize {
    if axis == 0 { 4 } else { 1 }
}

/// A neighbour: the row of the window and the column, counted from that of the sample.
pub(super) type Tap = (usize, isize);

/// The neighbours of a sample of a pass along `axis`.
pub(super) fn taps(axis: usize) -> [Tap; TAPS] {
    let mut taps = [(OWN, -1); TAPS];
    let mut slots = taps.iter_mut();
    let mut push = |tap| {
        if let Some(slot) = slots.next() {
            *slot = tap;
        }
    };
    // 3 x 3 known samples before, then after; the first other axis of the pass is the slower.
    for side in [0_usize, 1] {
        for first in [0_usize, 1, 2] {
            for (second, column) in (0_usize..3).zip(-1..) {
                let before = side.wrapping_mul(3);
                push(match axis {
                    0 => (first.wrapping_mul(3).wrapping_add(second), if side == 0 { 0 } else { 1 }),
                    1 => (before.wrapping_add(first), column),
                    _ => (before.wrapping_add(second), [-1, 0, 1].get(first).copied().unwrap_or(0)),
                });
            }
        }
    }
    let centre = centre(axis);
    push(if axis == 0 { (centre, -1) } else { (FAR_BEFORE, 0) });
    push(if axis == 0 { (centre, 2) } else { (FAR_AFTER, 0) });
    for row in [UP_NORTH, UP, UP_SOUTH, NORTH] {
        for column in -1..=1 {
            push((row, column));
        }
    }
    push((OWN, -1));
    let far = [(OWN, -2), (NORTH_NORTH, 0), (UP_UP, 0)];
    for step in [1_usize, 2] {
        let other = axis.wrapping_add(step).checked_rem(3).unwrap_or(0);
        push(far.get(other).copied().unwrap_or((OWN, -2)));
    }
    taps
}

/// Weights of the taps, in 1/4096; what is missing to 1 goes to the known samples before and after, half each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Weights(pub(super) [i32; TAPS]);

impl Weights {
    /// The cubic through four known samples: (-1, 9, 9, -1) / 16.
    pub(super) const CUBIC: Self = {
        let near = 9 << (WEIGHT_BITS - 4);
        let far = -(1 << (WEIGHT_BITS - 4));
        Self([
            0, 0, 0, 0, near, 0, 0, 0, 0, 0, 0, 0, 0, near, 0, 0, 0, 0, far, far, 0, 0, 0, 0, 0, 0, 0, 0, 0,
            0, 0, 0, 0, 0, 0,
        ])
    };

    /// Codes the weights as differences to [`Weights::CUBIC`].
    pub(super) fn code<C: Coder>(&mut self, coder: &mut C, lengths: &mut Distribution) {
        for (weight, default) in self.0.iter_mut().zip(Self::CUBIC.0) {
            let difference = weight.wrapping_sub(default);
            let folded = (difference << 1 ^ difference >> 31).cast_unsigned().wrapping_add(1 << LEAST_BITS);
            let length = folded.checked_ilog2().unwrap_or(LEAST_BITS);
            let symbol = coder.symbol(to_usize(length.wrapping_sub(LEAST_BITS)), lengths);
            let length = u32::try_from(symbol).unwrap_or(0).wrapping_add(LEAST_BITS);
            let leading = 1_u32.wrapping_shl(length);
            let low = coder.raw(folded & leading.wrapping_sub(1), length);
            let folded = (leading | low).wrapping_sub(1 << LEAST_BITS);
            let difference = (folded >> 1).cast_signed() ^ (folded & 1).wrapping_neg().cast_signed();
            *weight = default.wrapping_add(difference);
        }
    }

    /// The weights as they apply to the rows of a window, and those of the two samples before in the row itself.
    pub(super) fn kernels(&self, axis: usize) -> Kernels {
        let mut kernels = Kernels { rows: [[0; 4]; SLOTS], west: 0, west_west: 0 };
        let missing =
            self.0.iter().fold(1_i32 << WEIGHT_BITS, |missing, weight| missing.wrapping_sub(*weight));
        let half = missing >> 1;
        let taps = taps(axis);
        for (number, (&(slot, column), &weight)) in taps.iter().zip(&self.0).enumerate() {
            // The sum is that of the differences to the known sample before.
            let weight = match number {
                4 => weight.wrapping_add(half).wrapping_sub(1 << WEIGHT_BITS),
                13 => weight.wrapping_add(missing.wrapping_sub(half)),
                _ => weight,
            };
            let target = match (slot, column) {
                (OWN, -1) => Some(&mut kernels.west),
                (OWN, _) => Some(&mut kernels.west_west),
                _ => {
                    let column = usize::try_from(column.wrapping_add(1)).unwrap_or(0);
                    kernels.rows.get_mut(slot).and_then(|row| row.get_mut(column))
                }
            };
            target.into_iter().for_each(|target| *target = target.wrapping_add(weight));
        }
        kernels
    }
}

/// Weights by row of the window, for columns -1 to 2 from that of the sample.
#[derive(Clone, Debug)]
pub(super) struct Kernels {
    pub(super) rows: [[i32; 4]; SLOTS],
    pub(super) west: i32,
    pub(super) west_west: i32,
}
