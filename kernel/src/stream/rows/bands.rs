//! The rows of one level in the memory of an encoder, subband by subband.

use super::fronts::{Change, forward_rows};
use super::plan::RowPlan;
use crate::Wavelet;
use crate::coder::{Above, Row};
use crate::lifting::Direction;
use crate::packed::{Packed, ROUND};
use crate::transform::Plan;

/// Where the rows of one level are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    wavelet: Wavelet,
    start: usize,
    pub(super) width: usize,
    rows: usize,
}

impl Place {
    pub(super) const fn new(plan: &RowPlan, level: u8, start: usize) -> Self {
        let (width, rows) = (plan.width_at(level), forward_rows(plan.wavelet()));
        Self { wavelet: plan.wavelet(), start, width, rows }
    }

    /// Words that the level takes.
    pub(super) const fn len(&self) -> usize {
        let details = self.width.saturating_add(self.high());
        self.width.saturating_mul(self.rows).saturating_add(details)
    }

    /// Columns that are low along x.
    pub(super) const fn low(&self) -> usize {
        self.width.div_ceil(2)
    }

    /// Columns that are high along x.
    const fn high(&self) -> usize {
        self.width / 2
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

    /// Where the details of two rows begin.
    pub(super) fn of_rows(&self, c: i16, d: i16) -> Pieces {
        let (c, d) = (self.row(c), self.row(d));
        Pieces([c.saturating_add(self.low()), d, d.saturating_add(self.low())])
    }

    /// The row of an orientation, 1 to 3, to be coded.
    pub(super) fn band(&self, pieces: Pieces, orientation: u8) -> Row {
        let Pieces([first, second, third]) = pieces;
        let (low, high) = (self.low(), self.high());
        let none = (Packed::default(), 0);
        let (first_row, second_row) = ((Packed::words(first), high), (Packed::words(second), low));
        let (values, width, before, siblings) = match orientation {
            1 => (first, high, 0, [none; 2]),
            2 => (second, low, high, [first_row, none]),
            _ => (third, high, self.width, [first_row, second_row]),
        };
        let above = Above::Kept(self.above().saturating_add(before));
        Row { values: Packed::words(values), width, above, siblings, north: None, is_first: false }
    }

    /// Changes one row by one step.
    pub(super) fn change(&self, change: Change, memory: &mut [i32]) {
        let row = |row| Packed::words(self.row(row));
        // Words hold every number.
        let _ = lift(self.wavelet, Direction::Forward, (change, self.width), row, memory);
    }
}

/// Changes one row of a width by one step; `None` if a number takes more bits than there are for it.
pub(super) fn lift(
    wavelet: Wavelet,
    direction: Direction,
    (change, width): (Change, usize),
    place: impl Fn(i16) -> Packed,
    memory: &mut [i32],
) -> Option<()> {
    let Change { step, row, beside } = change;
    let target = place(row);
    let beside = beside.map(|row| row.map(&place));
    for x in (0..width).step_by(ROUND) {
        let columns = width.wrapping_sub(x).min(ROUND);
        let load = |row: Option<Packed>| {
            let mut values = [0; ROUND];
            if let Some(row) = row {
                row.skip(x).load(memory, values.get_mut(..columns).unwrap_or_default());
            }
            values
        };
        let (mut values, [left, here, right]) = (load(Some(target)), beside.map(load));
        wavelet.lift_row(step, direction, &mut values, [&left, &here, &right]);
        target.skip(x).store(memory, values.get(..columns).unwrap_or_default())?;
    }
    Some(())
}

/// Where the three rows of details of a pair begin, by orientation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pieces([usize; 3]);

/// Copies `len` elements.
pub(super) fn copy_within(memory: &mut [i32], from: usize, len: usize, to: usize) {
    crate::memory::move_within(memory, from..from.saturating_add(len), to);
}

/// Transforms one row along x; memory begins with the scratch for it.
pub(super) fn lift_row(plan: &RowPlan, scratch: usize, (start, width): (usize, usize), memory: &mut [i32]) {
    let Some((scratch, rest)) = memory.split_at_mut_checked(scratch) else { return };
    let start = start.saturating_sub(scratch.len());
    if let Some(row) = rest.get_mut(start..start.saturating_add(width)) {
        Plan::lift_row(plan.wavelet(), Direction::Forward, row, scratch);
    }
}
