//! Classes by more ranks than the nearest, in steps that suit the brick.

use super::bits::{BitReader, BitWriter};
use super::class::{CLASSES, RANKS};
use super::neighbours::split_at_row;
use crate::coder::low_half;
use crate::memory::copy;

/// The least energies of the classes but the first, where ranks are small: each about 1.7 times the one before.
const LEAST: [i16; CLASSES - 1] = [2, 3, 5, 9, 15, 26, 44, 74, 126, 215, 365, 621, 1056];

/// Bits of a scale in the codestream.
const SCALE_BITS: u32 = 5;

/// The largest scale: that of the largest ranks.
const LARGEST_SCALE: u32 = super::wide::MOST_SPAN_BITS;

/// How far the columns are away that count, at most.
const REACH: usize = 2;

/// Weights of ranks for their own column, for those next to it, and for those next but one.
type Weights = [i32; 1 + REACH];

/// A row around, that far down and deep, and what its ranks weigh.
struct Row([isize; 2], Weights);

/// N, NN and the one before that, in the first plane.
const PLANE: [Row; 3] = [Row([-1, 0], [11, 8, 6]), Row([-2, 0], [6, 4, 0]), Row([-3, 0], [5, 0, 0])];

/// N and U; the one below U; NN, the one above U, that two below, and UU; in all other planes.
const BRICK: [Row; 7] = [
    Row([-1, 0], NEAR),
    Row([0, -1], NEAR),
    Row([1, -1], BELOW),
    Row([-2, 0], FAR),
    Row([-1, -1], FAR),
    Row([2, -1], FAR),
    Row([0, -2], FAR),
];

const NEAR: Weights = [7, 4, 1];
const BELOW: Weights = [6, 3, 0];
const FAR: Weights = [3, 0, 0];

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
        let row = |away: [isize; 2]| {
            let [y, z] = nearest(place, away, height);
            let start = z.wrapping_mul(height).wrapping_add(y).wrapping_mul(width);
            before.get(start..start.wrapping_add(width)).unwrap_or(&[])
        };
        let mut sums = Sums::new(width, scratch)?;
        match place {
            [0, 0] => sums.clear(),
            _ if cfg!(feature = "small") => {
                sums.clear();
                let [_, z] = place;
                let rows = if z == 0 { PLANE.as_slice() } else { &BRICK };
                rows.iter().for_each(|Row(away, weights)| sums.add(row(*away), *weights));
            }
            [_, 0] => sums.of_plane(PLANE.map(|Row(away, _)| row(away))),
            _ => sums.of_brick(BRICK.map(|Row(away, _)| row(away))),
        }
        sums.gather();
        self.classify(sums.here);
        Some((sums.here, own))
    }

    /// Makes classes of energies.
    fn classify(&self, energies: &mut [i32]) {
        if cfg!(feature = "small") {
            for energy in energies {
                let reduced = (*energy & RANKS) >> self.scale;
                let count = |class: i32, least| class.wrapping_add(i32::from(reduced >= i32::from(least)));
                *energy = LEAST.into_iter().fold(0, count);
            }
            return;
        }
        let (blocks, rest) = energies.as_chunks_mut::<LANES>();
        blocks.iter_mut().for_each(|energies| self.classify_block(energies));
        let mut last = [0; LANES];
        copy(rest, &mut last);
        self.classify_block(&mut last);
        copy(&last, rest);
    }

    /// The same of many at once.
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

    fn clear(&mut self) {
        self.here.fill(0);
        self.next.fill(0);
        self.next_but_one.fill(0);
    }

    /// Sets what each column adds in the first plane.
    #[inline(always)]
    fn of_plane(&mut self, [n, nn, nnn]: [&[i32]; 3]) {
        let [Row(_, [n0, n1, n2]), Row(_, [nn0, nn1, _]), Row(_, [nnn0, ..])] = PLANE;
        self.set(n.iter().zip(nn).zip(nnn), |((&n, &nn), &nnn)| {
            [sum([n0, nn0, nnn0], [n, nn, nnn]), sum([n1, nn1], [n, nn]), sum([n2], [n])]
        });
    }

    /// The same in all others.
    #[inline(always)]
    fn of_brick(&mut self, [n, u, below, nn, un, uss, uu]: [&[i32]; 7]) {
        let ([near0, near1, near2], [below0, below1, _], [far0, ..]) = (NEAR, BELOW, FAR);
        let rows = n.iter().zip(u).zip(below).zip(nn).zip(un).zip(uss).zip(uu);
        self.set(rows, |((((((&n, &u), &below), &nn), &un), &uss), &uu)| {
            let (near, far) = (sum([1, 1], [n, u]), sum([1; 4], [nn, un, uss, uu]));
            let here = sum([near0, below0, far0], [near, below, far]);
            [here, sum([near1, below1], [near, below]), sum([near2], [near])]
        });
    }

    /// Adds what the ranks of a row add.
    fn add(&mut self, row: &[i32], weights: Weights) {
        let (next, far) = (self.next.get_mut(1..), self.next_but_one.get_mut(REACH..));
        let sums = [&mut *self.here, next.unwrap_or(&mut []), far.unwrap_or(&mut [])];
        for (sums, weight) in sums.into_iter().zip(weights) {
            for (sum, rank) in sums.iter_mut().zip(row) {
                *sum = sum.wrapping_add(weight.wrapping_mul(*rank));
            }
        }
    }

    #[inline(always)]
    fn set<T>(&mut self, rows: impl Iterator<Item = T>, of: impl Fn(T) -> Weights) {
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
    of: impl Fn(T) -> Weights,
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
        sums.of_brick([&[1; 3]; 7]);
        sums.gather();
        assert_eq!(sums.here, [58; 3]);
    }

    #[test]
    fn rows_one_by_one_add_the_same() {
        let row = |step: i32| core::array::from_fn::<i32, 20, _>(|x| i32::try_from(x).unwrap() * step % 17);
        let rows = [3, 5, 7, 11, 13, 16, 19].map(row);
        let rows @ [n, nn, nnn, ..] = rows.each_ref().map(|row| &row[..]);
        let (mut scratch, mut other) = ([0; 66], [0; 66]);
        let (mut at_once, mut one_by_one) =
            (Sums::new(20, &mut scratch).unwrap(), Sums::new(20, &mut other).unwrap());
        at_once.of_plane([n, nn, nnn]);
        rows.into_iter().zip(PLANE).for_each(|(row, Row(_, weights))| one_by_one.add(row, weights));
        assert_eq!((&at_once.here, &at_once.next), (&one_by_one.here, &one_by_one.next));
        at_once.of_brick(rows);
        one_by_one.clear();
        rows.into_iter().zip(BRICK).for_each(|(row, Row(_, weights))| one_by_one.add(row, weights));
        assert_eq!(at_once.here, one_by_one.here);
        assert_eq!(at_once.next[1..21], one_by_one.next[1..21]);
        assert_eq!(at_once.next_but_one[2..22], one_by_one.next_but_one[2..22]);
    }

    #[test]
    fn rows_beyond_the_border_are_the_nearest() {
        assert_eq!(nearest([0, 3], [-2, 0], 5), [0, 2]);
        assert_eq!(nearest([1, 3], [-2, 0], 5), [0, 3]);
        assert_eq!(nearest([4, 3], [2, -1], 5), [4, 2]);
        assert_eq!(nearest([4, 1], [0, -2], 5), [4, 0]);
    }
}
