//! Classes by more ranks than the nearest, in steps that suit the brick.

use super::bits::{BitReader, BitWriter};
use super::class::RANKS;
use super::neighbours::split_at_row;
use crate::coder::low_half;
use crate::memory::copy;

/// Classes there are.
pub(super) const CLASSES: usize = 14;

/// The least energies of the classes but the first, where ranks are small: each 1.7 times the one before.
const LEAST: [i16; CLASSES - 1] = [2, 3, 5, 9, 15, 26, 44, 74, 126, 215, 365, 621, 1056];

/// Bits of a scale in the codestream.
const SCALE_BITS: u32 = 5;

/// The largest scale: that of the largest ranks.
const LARGEST_SCALE: u32 = super::wide::MOST_SPAN_BITS;

/// How far the columns are away that count, at most.
const REACH: usize = 2;

/// Places whose classes are found together.
const LANES: usize = 16;

/// How much larger the energies of a brick are than those of one with small ranks.
pub(super) struct Steps {
    scale: u32,
}

impl Steps {
    /// Those that suit ranks.
    pub(super) fn of(ranks: &[i32]) -> Self {
        let sum = ranks.iter().fold(0, |sum: u64, rank| sum.wrapping_add(rank.unsigned_abs().into()));
        let mean = u64::try_from(ranks.len()).ok().and_then(|count| sum.checked_div(count));
        Self { scale: mean.and_then(u64::checked_ilog2).unwrap_or(0).min(LARGEST_SCALE) }
    }

    /// Writes the scale.
    pub(super) fn write(&self, bits: &mut BitWriter<'_>) -> Option<()> {
        bits.put(self.scale, SCALE_BITS)
    }

    /// Reads what [`Steps::write`] wrote; `None` for a scale that no encoder writes.
    pub(super) fn read(bits: &mut BitReader<'_>) -> Option<Self> {
        let scale = bits.take(SCALE_BITS);
        (scale <= LARGEST_SCALE).then_some(Self { scale })
    }

    /// Sets the class of each place of row y of plane z, in the beginning of `scratch`; the ranks of `values` may have
    /// classes above them. Returns the classes and the row.
    pub(super) fn classes<'a, 'b>(
        &self,
        values: &'a mut [i32],
        sides: [usize; 3],
        place: [usize; 2],
        scratch: &'b mut [i32],
    ) -> Option<(&'b mut [i32], &'a mut [i32])> {
        let (before, own) = split_at_row(values, sides, place)?;
        let [width, height, _] = sides;
        let row = |down: isize, deep: isize| {
            let [y, z] = nearest(place, [down, deep], height);
            let start = z.wrapping_mul(height).wrapping_add(y).wrapping_mul(width);
            before.get(start..start.wrapping_add(width))
        };
        let mut sums = Sums::new(width, scratch)?;
        match place {
            [0, 0] => sums.set(own.iter(), |_| [0; _]),
            [_, 0] => sums.of_plane([row(-1, 0)?, row(-2, 0)?, row(-3, 0)?]),
            _ => sums.of_brick(
                [row(-1, 0)?, row(0, -1)?, row(1, -1)?],
                [row(-2, 0)?, row(-1, -1)?, row(2, -1)?, row(0, -2)?],
            ),
        }
        sums.gather();
        self.classify(sums.here);
        Some((sums.here, own))
    }

    /// Makes classes of energies.
    fn classify(&self, energies: &mut [i32]) {
        let (blocks, rest) = energies.as_chunks_mut::<LANES>();
        blocks.iter_mut().for_each(|energies| self.classify_block(energies));
        let mut last = [0; LANES];
        copy(rest, &mut last);
        self.classify_block(&mut last);
        copy(&last, rest);
    }

    #[inline(always)]
    fn classify_block(&self, energies: &mut [i32; LANES]) {
        let reduced = energies.map(|energy| low_half(((energy & RANKS) >> self.scale).min(i16::MAX.into())));
        let mut classes = [0_i16; LANES];
        for least in LEAST {
            for (class, energy) in classes.iter_mut().zip(reduced) {
                *class = class.wrapping_add(i16::from(energy >= least));
            }
        }
        *energies = classes.map(i32::from);
    }
}

/// The place of the row so far down and deep from row y of plane z. Beyond the border stands the nearest; for the first row
/// of a plane, that of the plane before stands for those of the plane itself.
fn nearest([y, z]: [usize; 2], [down, deep]: [isize; 2], height: usize) -> [usize; 2] {
    let deep = if deep == 0 && y == 0 { -1 } else { deep };
    [y.saturating_add_signed(down).min(height.wrapping_sub(1)), z.saturating_add_signed(deep)]
}

/// Weighted sums of the ranks of each column: for itself, for those next to it, and for those next but one.
struct Sums<'a> {
    here: &'a mut [i32],
    /// With one more at either end.
    next: &'a mut [i32],
    /// With two more at either end.
    next_but_one: &'a mut [i32],
}

impl<'a> Sums<'a> {
    fn new(width: usize, scratch: &'a mut [i32]) -> Option<Self> {
        let (here, rest) = scratch.split_at_mut_checked(width)?;
        let (next, rest) = rest.split_at_mut_checked(width.wrapping_add(2))?;
        Some(Self { here, next, next_but_one: rest.get_mut(..width.wrapping_add(2 * REACH))? })
    }

    /// What each column adds to the energies of the first plane, of which the three rows before are known.
    #[inline(always)]
    fn of_plane(&mut self, [n, nn, nnn]: [&[i32]; 3]) {
        self.set(n.iter().zip(nn).zip(nnn), |((&n, &nn), &nnn)| {
            [sum([11, 6, 5], [n, nn, nnn]), sum([8, 4], [n, nn]), sum([6], [n])]
        });
    }

    /// The same of all others: by N, U and the row below U, and by NN, that above U, that two below, and UU.
    #[inline(always)]
    fn of_brick(&mut self, [n, u, us]: [&[i32]; 3], [nn, un, uss, uu]: [&[i32]; 4]) {
        let rows = n.iter().zip(u).zip(us).zip(nn).zip(un).zip(uss).zip(uu);
        self.set(rows, |((((((&n, &u), &us), &nn), &un), &uss), &uu)| {
            let (near, far) = (sum([1, 1], [n, u]), sum([1; 4], [nn, un, uss, uu]));
            [sum([7, 6, 3], [near, us, far]), sum([4, 3], [near, us]), near]
        });
    }

    #[inline(always)]
    fn set<T>(&mut self, rows: impl Iterator<Item = T>, of: impl Fn(T) -> [i32; 1 + REACH]) {
        let next = self.next.get_mut(1..).unwrap_or(&mut []);
        let next_but_one = self.next_but_one.get_mut(REACH..).unwrap_or(&mut []);
        set(self.here, next, next_but_one, rows, of);
    }

    /// Makes energies of what each column adds; beyond the ends of a row its first and its last column come again.
    fn gather(&mut self) {
        repeat_ends(self.next, 1);
        repeat_ends(self.next_but_one, REACH);
        let sides = self.next.array_windows().zip(self.next_but_one.array_windows());
        for (energy, (&[west, _, east], &[far_west, _, _, _, far_east])) in self.here.iter_mut().zip(sides) {
            *energy = sum([1; 5], [*energy, west, east, far_west, far_east]);
        }
    }
}

/// Sets the three sums of each column to what `of` makes of its rows.
// The compiler takes several columns at once only where it is told that these do not overlap, which arguments say.
#[cfg_attr(not(feature = "small"), inline(never))]
fn set<T>(
    here: &mut [i32],
    next: &mut [i32],
    next_but_one: &mut [i32],
    rows: impl Iterator<Item = T>,
    of: impl Fn(T) -> [i32; 1 + REACH],
) {
    for (((here, next), next_but_one), row) in here.iter_mut().zip(next).zip(next_but_one).zip(rows) {
        [*here, *next, *next_but_one] = of(row);
    }
}

/// The sum of values times their weights.
#[inline(always)]
fn sum<const N: usize>(weights: [i32; N], values: [i32; N]) -> i32 {
    let products = weights.into_iter().zip(values).map(|(weight, value)| weight.wrapping_mul(value));
    products.fold(0, i32::wrapping_add)
}

/// Copies the first and the last element between `margin` others on both sides over these.
fn repeat_ends(row: &mut [i32], margin: usize) {
    let last = row.len().saturating_sub(margin);
    let (Some(&first), Some(&end)) = (row.get(margin), row.get(last.wrapping_sub(1))) else { return };
    row.iter_mut().take(margin).for_each(|slot| *slot = first);
    row.iter_mut().skip(last).for_each(|slot| *slot = end);
}

#[cfg(test)]
mod tests {
    use super::*;

    extern crate std;
    use std::{vec, vec::Vec};

    /// The classes of a row of a brick of such ranks.
    fn classes(values: &[i32], sides: [usize; 3], place: [usize; 2], scale: u32) -> Vec<i32> {
        let mut scratch = vec![-1; 3 * sides[0] + 6];
        let mut values = values.to_vec();
        let (classes, _) = Steps { scale }.classes(&mut values, sides, place, &mut scratch).unwrap();
        classes.to_vec()
    }

    #[test]
    fn energies_by_hand() {
        // Nothing is known of the first row; of the second N alone, which stands
        // for those before too: 11 + 6 + 5, and 2 (8 + 4 + 6) of its neighbours.
        assert_eq!(classes(&[1; 9], [3, 3, 1], [0, 0], 0), [0; 3]);
        assert_eq!(classes(&[1; 9], [3, 3, 1], [1, 0], 0), [7; 3]);
        let in_middle: [i32; 18] = core::array::from_fn(|i| if i == 4 { 3 } else { 0 });
        // N is NN and the third too: 6 x 3, (8 + 4) x 3, (11 + 6 + 5) x 3.
        assert_eq!(classes(&in_middle, [9, 2, 1], [1, 0], 0), [0, 0, 5, 6, 7, 6, 5, 0, 0]);
        // And half of it.
        assert_eq!(classes(&in_middle, [9, 2, 1], [1, 0], 1), [0, 0, 4, 5, 6, 5, 4, 0, 0]);
        // As if there were classes above.
        let above = in_middle.map(|rank| rank | 5 << super::super::class::PLACE);
        assert_eq!(classes(&above, [9, 2, 1], [1, 0], 0), [0, 0, 5, 6, 7, 6, 5, 0, 0]);
    }

    #[test]
    fn weights_of_both_kinds_sum_up_to_58() {
        let mut scratch = [0; 16];
        let mut sums = Sums::new(3, &mut scratch).unwrap();
        sums.of_plane([&[1; 3]; 3]);
        sums.gather();
        assert_eq!(sums.here, [58; 3]);
        sums.of_brick([&[1; 3]; 3], [&[1; 3]; 4]);
        sums.gather();
        assert_eq!(sums.here, [58; 3]);
    }

    #[test]
    fn rows_beyond_the_border_are_the_nearest() {
        assert_eq!(nearest([0, 3], [-2, 0], 5), [0, 2]);
        assert_eq!(nearest([1, 3], [-2, 0], 5), [0, 3]);
        assert_eq!(nearest([4, 3], [2, -1], 5), [4, 2]);
        assert_eq!(nearest([4, 1], [0, -2], 5), [4, 0]);
    }
}
