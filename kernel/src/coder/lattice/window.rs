//! The rows around a row of new samples, with what is missing at the borders made up.

use super::pass::Pass;
use super::weights::{
    FAR_AFTER, FAR_BEFORE, Kernels, MEAN, NORTH, NORTH_NORTH, OWN, SLOTS, UP, UP_NORTH, UP_SOUTH, UP_UP,
    WEIGHT_BITS, centre,
};
use crate::memory::copy;

/// Columns to either side of a row.
pub(super) const MARGIN: usize = 2;

/// The length of a row of a window of new rows of `width`.
pub(super) const fn pitch(width: usize) -> usize {
    width.saturating_add(2 * MARGIN + 1)
}

/// Rows around a row of new samples, in scratch.
#[derive(Debug)]
pub(super) struct Window<'a> {
    pass: Pass,
    pub(super) width: usize,
    pitch: usize,
    rows: &'a mut [i32],
}

impl<'a> Window<'a> {
    /// A window for `pass` in scratch of [`SLOTS`] times [`pitch`].
    pub(super) fn new(pass: Pass, rows: &'a mut [i32]) -> Self {
        let [width, ..] = pass.new_sides();
        Self { pass, width, pitch: pitch(width), rows }
    }

    /// The row in `slot`, from `column` on.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn row(&self, slot: usize, column: isize) -> &[i32] {
        let start = slot.wrapping_mul(self.pitch).wrapping_add(MARGIN).wrapping_add_signed(column);
        self.rows.get(start..slot.wrapping_add(1).wrapping_mul(self.pitch)).unwrap_or(&[])
    }

    fn slot(&mut self, slot: usize) -> &mut [i32] {
        let start = slot.wrapping_mul(self.pitch);
        self.rows.get_mut(start..start.wrapping_add(self.pitch)).unwrap_or(&mut [])
    }

    /// Copies `row` to a slot and repeats its first and last sample in the margins.
    fn set(&mut self, slot: usize, row: &[i32]) {
        let (first, last) = (row.first().copied().unwrap_or(0), row.last().copied().unwrap_or(0));
        let to = self.slot(slot);
        let (left, to) = to.split_at_mut_checked(MARGIN).unwrap_or((&mut [], &mut []));
        left.fill(first);
        let (to, right) = to.split_at_mut_checked(row.len()).unwrap_or((&mut [], &mut []));
        copy(row, to);
        right.fill(last);
    }

    /// Sets a slot to `combine` of two others, margins included.
    fn combine(&mut self, slot: usize, [a, b]: [usize; 2], combine: impl Fn(i32, i32) -> i32) {
        let start = |slot: usize| slot.wrapping_mul(self.pitch);
        let (a, b, to) = (start(a), start(b), start(slot));
        for column in 0..self.pitch {
            let at = |start: usize| self.rows.get(start.wrapping_add(column)).copied().unwrap_or(0);
            let value = combine(at(a), at(b));
            self.rows.get_mut(to.wrapping_add(column)).into_iter().for_each(|to| *to = value);
        }
    }

    /// Fills the window around new row `place`; the rows of the pass only if they are `wanted`.
    pub(super) fn fill(&mut self, lattice: &[i32], place: [usize; 2], wanted: bool) {
        if self.pass.axis == 0 {
            self.fill_known_along_x(lattice, place);
        } else {
            self.fill_known(lattice, place);
        }
        if wanted {
            self.fill_new(lattice, place);
        }
    }

    /// The rows before and after in a pass along x: three by three, and two samples beyond either end.
    fn fill_known_along_x(&mut self, lattice: &[i32], place: [usize; 2]) {
        let pass = self.pass;
        let around =
            |y, z| pass.known_row(pass.near(place, y, z)).and_then(|row| lattice.get(row)).unwrap_or(&[]);
        for (y, first) in [-1, 0, 1].into_iter().zip((0_usize..).step_by(3)) {
            for (z, slot) in [-1, 0, 1].into_iter().zip(first..) {
                let row = around(y, z);
                self.set(slot, row);
                let known = row.len();
                let extended = self.slot(slot);
                let at =
                    |row: &[i32], column: usize| row.get(column.wrapping_add(MARGIN)).copied().unwrap_or(0);
                for column in [known, known.wrapping_add(1)] {
                    let [one, two] = [1, 2].map(|back| at(extended, column.wrapping_sub(back)));
                    let next = if known == 1 { one } else { one.wrapping_mul(2).wrapping_sub(two) };
                    extended.get_mut(column.wrapping_add(MARGIN)).into_iter().for_each(|to| *to = next);
                }
                let before = at(extended, 0).wrapping_mul(2).wrapping_sub(at(extended, 1));
                extended.get_mut(MARGIN - 1).into_iter().for_each(|to| *to = before);
            }
        }
        let [before, after] = [0, 1].map(|column| MARGIN.wrapping_add(column));
        let pitch = self.pitch;
        let (known, rest) =
            self.rows.split_at_mut_checked(MEAN.wrapping_mul(pitch)).unwrap_or((&mut [], &mut []));
        let known = known.get(centre(0).wrapping_mul(pitch)..).unwrap_or(&[]);
        let pairs = known.get(before..).unwrap_or(&[]).iter().zip(known.get(after..).unwrap_or(&[]));
        let width = self.width;
        let mean = rest.get_mut(MARGIN..).unwrap_or(&mut []);
        mean.iter_mut().zip(pairs).take(width).for_each(|(mean, (a, b))| *mean = a.wrapping_add(*b) >> 1);
        self.close_mean();
    }

    /// The rows before and after in a pass along y or z: three each, and one beyond either.
    fn fill_known(&mut self, lattice: &[i32], place: [usize; 2]) {
        let pass = self.pass;
        let row = |along: isize, aside: isize| {
            let [y, z] = if pass.axis == 1 { [along, aside] } else { [aside, along] };
            let [y, z] = pass.near_known(place, y, z);
            pass.known_row([y, z]).and_then(|row| lattice.get(row))
        };
        for (slot, aside) in (0..).zip(-1..=1) {
            self.set(slot, row(0, aside).unwrap_or(&[]));
            let after = slot.wrapping_add(3);
            if let Some(row) = row(1, aside) {
                self.set(after, row);
            } else if let Some(far) = row(-1, aside) {
                self.set(after, far);
                self.combine(after, [slot, after], |near, far| near.wrapping_mul(2).wrapping_sub(far));
            } else {
                self.set(after, row(0, aside).unwrap_or(&[]));
            }
        }
        let extended = |near: i32, far: i32| near.wrapping_mul(2).wrapping_sub(far);
        match row(-1, 0) {
            Some(row) => self.set(FAR_BEFORE, row),
            None => self.combine(FAR_BEFORE, [1, 4], extended),
        }
        match row(2, 0) {
            Some(row) => self.set(FAR_AFTER, row),
            None => self.combine(FAR_AFTER, [4, 1], extended),
        }
        self.combine(MEAN, [1, 4], |a, b| a.wrapping_add(b) >> 1);
        self.close_mean();
    }

    /// Repeats the first and last mean in its margins.
    fn close_mean(&mut self) {
        let width = self.width;
        let mean = self.slot(MEAN);
        let first = mean.get(MARGIN).copied().unwrap_or(0);
        let last = mean.get(MARGIN.wrapping_add(width).wrapping_sub(1)).copied().unwrap_or(0);
        mean.iter_mut().take(MARGIN).for_each(|mean| *mean = first);
        mean.iter_mut().skip(MARGIN.wrapping_add(width)).for_each(|mean| *mean = last);
    }

    /// The rows of the pass; for one that is missing, and beyond the ends of one, the mean.
    fn fill_new(&mut self, lattice: &[i32], [y, z]: [usize; 2]) {
        let (north, up, south) = (y.wrapping_sub(1), z.wrapping_sub(1), y.wrapping_add(1));
        let places = [
            (UP_NORTH, [north, up]),
            (UP, [y, up]),
            (UP_SOUTH, [south, up]),
            (NORTH, [north, z]),
            (NORTH_NORTH, [y.wrapping_sub(2), z]),
            (UP_UP, [y, z.wrapping_sub(2)]),
        ];
        for (slot, place) in places {
            let row = self.pass.new_row(place).and_then(|row| lattice.get(row)).unwrap_or(&[]);
            self.set_new(slot, row);
        }
    }

    /// Sets a slot to a row of the pass within the mean.
    fn set_new(&mut self, slot: usize, row: &[i32]) {
        let pitch = self.pitch;
        let start = slot.wrapping_sub(MEAN).wrapping_mul(pitch);
        let (mean, rest) = self
            .rows
            .get_mut(MEAN.wrapping_mul(pitch)..)
            .and_then(|rows| rows.split_at_mut_checked(pitch))
            .unwrap_or((&mut [], &mut []));
        let to = rest.get_mut(start.wrapping_sub(pitch)..start).unwrap_or(&mut []);
        copy(mean, to);
        copy(row, to.get_mut(MARGIN..).unwrap_or(&mut []));
    }

    /// Sets the row itself, which an encoder knows.
    pub(super) fn set_own(&mut self, row: &[i32]) {
        self.set_new(OWN, row);
    }

    /// Sums the weighted rows, in 1/4096, rounded: what the samples before in the row add is missing.
    pub(super) fn sum(&self, kernels: &Kernels, sums: &mut [i32]) {
        sums.fill(1 << (WEIGHT_BITS - 1));
        for (slot, kernel) in kernels.rows.iter().enumerate().take(SLOTS) {
            let row = self.row(slot, -1);
            match *kernel {
                [0, 0, 0, 0] => {}
                [0, b, 0, 0] => add(row.get(1..).unwrap_or(&[]), b, sums),
                [a, b, c, 0] => add_three(row, [a, b, c], sums),
                [a, b, c, d] => {
                    add_three(row, [a, b, c], sums);
                    add(row.get(3..).unwrap_or(&[]), d, sums);
                }
            }
        }
    }
}

fn add(row: &[i32], weight: i32, sums: &mut [i32]) {
    for (sum, value) in sums.iter_mut().zip(row) {
        *sum = sum.wrapping_add(value.wrapping_mul(weight));
    }
}

fn add_three(row: &[i32], [a, b, c]: [i32; 3], sums: &mut [i32]) {
    for (sum, [x, y, z]) in sums.iter_mut().zip(row.array_windows::<3>()) {
        let part = x.wrapping_mul(a).wrapping_add(y.wrapping_mul(b)).wrapping_add(z.wrapping_mul(c));
        *sum = sum.wrapping_add(part);
    }
}
