//! The rows of one pair in memory, subband by subband.

use super::fronts::Change;
use super::plan::{Role, RowPlan};
use crate::Wavelet;
use crate::coder::Row;
use crate::extent::to_usize;
use crate::lifting::Direction;
use crate::memory::copy;
use crate::transform::Plan;

/// Columns that a lifting step changes at a time.
const COLUMNS: usize = 32;

/// Where the rows of one level are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    wavelet: Wavelet,
    start: usize,
    pub(super) width: usize,
    rows: usize,
    held: usize,
}

impl Place {
    pub(super) fn new(plan: &RowPlan, role: Role, level: u8) -> Self {
        Self {
            wavelet: plan.wavelet(),
            start: plan.level_start(role, level),
            width: plan.width_at(level),
            rows: plan.rows(role),
            held: plan.held(role, level),
        }
    }

    /// Columns that are low along x.
    pub(super) const fn low(&self) -> usize {
        self.width.div_ceil(2)
    }

    /// Columns that are high along x.
    const fn high(&self) -> usize {
        self.width / 2
    }

    /// Details of a pair of rows.
    const fn details(&self) -> usize {
        self.width.saturating_add(self.high())
    }

    /// Where a row begins.
    pub(super) fn row(&self, row: i16) -> usize {
        let slot = usize::from(row.unsigned_abs()).checked_rem(self.rows).unwrap_or(0);
        self.start.saturating_add(slot.saturating_mul(self.width))
    }

    /// Where what is kept of the rows above begins: of orientation 1, of 2, of 3.
    const fn above(&self) -> usize {
        self.start.saturating_add(self.rows.saturating_mul(self.width))
    }

    /// The place of the pair that waits after the one in `place`.
    pub(super) fn next_waiting(&self, place: u32) -> u32 {
        let next = place.wrapping_add(1);
        if to_usize(next) < self.held { next } else { 0 }
    }

    /// Where the details of the pair begin that waits in `place`; places beyond the last begin again.
    pub(super) fn waiting(&self, place: u32) -> Pieces {
        let slot = to_usize(place).checked_rem(self.held).unwrap_or(0).saturating_add(1);
        let start = self.above().saturating_add(slot.saturating_mul(self.details()));
        let second = start.saturating_add(self.high());
        Pieces([start, second, second.saturating_add(self.low())])
    }

    /// Where the details of two rows begin.
    pub(super) fn of_rows(&self, c: i16, d: i16) -> Pieces {
        let (c, d) = (self.row(c), self.row(d));
        Pieces([c.saturating_add(self.low()), d, d.saturating_add(self.low())])
    }

    /// The row of an orientation, 1 to 3, to be coded.
    pub(super) const fn band(&self, pieces: Pieces, orientation: u8) -> Row {
        let Pieces([first, second, third]) = pieces;
        let (low, high, above) = (self.low(), self.high(), self.above());
        let none = (0, 0);
        let (values, width, before, siblings) = match orientation {
            1 => (first, high, 0, [none; 2]),
            2 => (second, low, high, [(first, high), none]),
            _ => (third, high, self.width, [(first, high), (second, low)]),
        };
        let above = above.saturating_add(before);
        Row { values, width, above, siblings, north: None, is_first: false }
    }

    /// Puts a pair together from its low-pass part, at `low_pass`, and details that waited.
    pub(super) fn assemble(
        &self,
        low_pass: usize,
        pieces: Pieces,
        (c, d): (i16, Option<i16>),
        memory: &mut [i32],
    ) {
        let Pieces([first, second, _]) = pieces;
        let c = self.row(c);
        copy_within(memory, low_pass, self.low(), c);
        copy_within(memory, first, self.high(), c.saturating_add(self.low()));
        if let Some(d) = d {
            copy_within(memory, second, self.width, self.row(d));
        }
    }

    /// Changes one row by one step.
    pub(super) fn change(&self, direction: Direction, change: Change, memory: &mut [i32]) {
        let Change { step, row, beside } = change;
        let target = self.row(row);
        let beside = beside.map(|row| row.map(|row| self.row(row)));
        for x in (0..self.width).step_by(COLUMNS) {
            let columns = self.width.wrapping_sub(x).min(COLUMNS);
            let read = beside.map(|row| {
                let mut values = [0; COLUMNS];
                if let Some(start) = row.map(|row| row.wrapping_add(x)) {
                    copy(memory.get(start..start.wrapping_add(columns)).unwrap_or_default(), &mut values);
                }
                values
            });
            let start = target.wrapping_add(x);
            let row = memory.get_mut(start..start.wrapping_add(columns)).unwrap_or_default();
            let [left, here, right] = &read;
            self.wavelet.lift_row(step, direction, row, [left, here, right]);
        }
    }
}

/// Where the three rows of details of a pair begin, by orientation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pieces([usize; 3]);

/// Copies `len` elements.
pub(super) fn copy_within(memory: &mut [i32], from: usize, len: usize, to: usize) {
    crate::memory::move_within(memory, from..from.saturating_add(len), to);
}

/// Transforms one row along x, or back; memory begins with the scratch for it.
pub(super) fn lift_row(
    plan: &RowPlan,
    direction: Direction,
    scratch: usize,
    (start, width): (usize, usize),
    memory: &mut [i32],
) {
    let Some((scratch, rest)) = memory.split_at_mut_checked(scratch) else { return };
    let start = start.saturating_sub(scratch.len());
    if let Some(row) = rest.get_mut(start..start.saturating_add(width)) {
        Plan::lift_row(plan.wavelet(), direction, row, scratch);
    }
}
