//! The values coded last in a subband, in scratch.

use core::cell::Cell;

use super::context::Around;
use crate::memory::move_within;
use crate::transform::Plan;

/// Columns and rows of zeros kept around the values.
const MARGIN: usize = 2;

/// Rows that a subband of one plane keeps: two above, the current one, one below.
const FLAT_ROWS: usize = 4;

/// Rows that a subband of one row a plane keeps: the current one, and zeros for all around it.
const LINE_ROWS: usize = 2;

/// `i32`s of scratch that coding takes for the largest subband of `plan`: a history and a row of hints.
pub(crate) const fn history_len(plan: &Plan) -> usize {
    let largest = plan.extent().coarsened(if plan.levels() > 0 { 1 } else { 0 }).sides();
    let [x, _, _] = largest;
    values_len(largest).saturating_add(x)
}

const fn stride(x: usize) -> usize {
    x.saturating_add(2 * MARGIN)
}

const fn values_len([x, y, z]: [usize; 3]) -> usize {
    let rows = match Kept::of([x, y, z]) {
        Kept::Row => LINE_ROWS,
        Kept::FourRows => FLAT_ROWS,
        Kept::Plane => y.saturating_add(MARGIN + 1),
    };
    stride(x).saturating_mul(rows)
}

/// What a history keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kept {
    Row,
    FourRows,
    Plane,
}

impl Kept {
    /// What a subband of `sides` needs.
    const fn of(sides: [usize; 3]) -> Self {
        match sides {
            [_, 1, _] => Self::Row,
            [_, _, 1] => Self::FourRows,
            _ => Self::Plane,
        }
    }
}

/// One plane of values within a margin of zeros.
///
/// Up to the current coefficient they are those of the current plane, from there on still those of the plane before.
/// A subband of one plane keeps four rows only, and moves them up after each; one of single rows keeps the last.
#[derive(Debug)]
pub(super) struct History<'a> {
    values: &'a mut [i32],
    stride: usize,
    kept: Kept,
}

impl<'a> History<'a> {
    /// An empty history for a subband of `sides`, and a row of hints, both out of `scratch`.
    pub(super) fn new(sides: [usize; 3], scratch: &'a mut [i32]) -> Option<(Self, &'a mut [i32])> {
        let [x, _, _] = sides;
        let (values, hints) = scratch.split_at_mut_checked(values_len(sides))?;
        values.fill(0);
        Some((Self { values, stride: stride(x), kept: Kept::of(sides) }, hints.get_mut(..x)?))
    }

    /// The rows around row `y` of the current plane.
    pub(super) fn rows(&mut self, y: usize) -> Option<Rows<'_>> {
        let above = if self.kept == Kept::Plane { y.wrapping_mul(self.stride) } else { 0 };
        let (north_north, rest) = self.values.get_mut(above..)?.split_at_mut_checked(self.stride)?;
        if self.kept == Kept::Row {
            let zeros = &*north_north;
            let here = Cell::from_mut(rest).as_slice_of_cells();
            return Some(Rows { north_north: zeros, north: zeros, here, south: zeros });
        }
        let (north, rest) = rest.split_at_mut_checked(self.stride)?;
        let (here, rest) = rest.split_at_mut_checked(self.stride)?;
        let south = rest.get(..self.stride)?;
        Some(Rows { north_north, north, here: Cell::from_mut(here).as_slice_of_cells(), south })
    }

    /// Makes room for the next row.
    pub(super) fn end_row(&mut self) {
        if self.kept != Kept::FourRows {
            return;
        }
        move_within(self.values, self.stride..self.values.len(), 0);
        let below = self.stride.wrapping_mul(MARGIN);
        self.values.get_mut(below..).unwrap_or(&mut []).fill(0);
    }
}

/// The rows of a [`History`] around the current one, margins included.
#[derive(Debug)]
pub(super) struct Rows<'a> {
    north_north: &'a [i32],
    north: &'a [i32],
    here: &'a [Cell<i32>],
    south: &'a [i32],
}

impl Rows<'_> {
    /// For each coefficient of the row in turn: what is around it, and the place of its own value.
    pub(super) fn places(&self) -> impl Iterator<Item = (Around, &Cell<i32>)> {
        let columns = self.north_north.iter().skip(MARGIN).zip(self.south.iter().skip(MARGIN));
        let windows = self.north.array_windows::<5>().zip(self.here.array_windows::<5>());
        windows.zip(columns).map(
            |((&[_, north_west, north, north_east, _], here), (&north_north, &south))| {
                let [west_west, west, place, east, _] = here;
                let around = Around {
                    west: west.get(),
                    north,
                    up: place.get(),
                    north_west,
                    north_east,
                    up_east: east.get(),
                    up_south: south,
                    west_west: west_west.get(),
                    north_north,
                };
                (around, place)
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Extent, Wavelet};

    #[test]
    fn a_brick_keeps_the_plane_before() {
        let plan = Plan::new(Wavelet::Haar, Extent::brick(2, 2, 2).unwrap(), 0).unwrap();
        let mut scratch = [0; 64];
        let (mut history, _) = History::new([2, 2, 2], &mut scratch[..history_len(&plan)]).unwrap();
        let mut next = 1;
        for y in [0, 1, 0] {
            for (_, place) in history.rows(y).unwrap().places() {
                place.set(next);
                next += 1;
            }
            history.end_row();
        }
        // Plane 0 holds 1 2 / 3 4; row 0 of plane 1 holds 5 6.
        let rows = history.rows(1).unwrap();
        let (first, _) = rows.places().next().unwrap();
        assert_eq!([first.north, first.north_east, first.up, first.up_east, first.up_south], [5, 6, 3, 4, 0]);
        let (last, _) = rows.places().nth(1).unwrap();
        assert_eq!([last.west, last.north_west, last.north, last.up], [3, 5, 6, 4]);
    }

    #[test]
    fn single_rows_keep_the_last() {
        let mut scratch = [0; 16];
        let (mut history, _) = History::new([2, 1, 2], &mut scratch).unwrap();
        history.rows(0).unwrap().places().zip([5, 6]).for_each(|((_, place), value)| place.set(value));
        history.end_row();
        let rows = history.rows(0).unwrap();
        let (first, place) = rows.places().next().unwrap();
        assert_eq!([first.up, first.up_east, first.north, first.up_south, first.west], [5, 6, 0, 0, 0]);
        place.set(7);
        assert_eq!(rows.places().nth(1).map(|(second, _)| [second.west, second.up]), Some([7, 6]));
    }

    #[test]
    fn a_slice_keeps_two_rows() {
        let mut scratch = [0; 64];
        let (mut history, _) = History::new([3, 9, 1], &mut scratch).unwrap();
        for (row, value) in [(1, 1), (2, 2), (3, 3)] {
            history.rows(row).unwrap().places().for_each(|(_, place)| place.set(value));
            history.end_row();
        }
        let rows = history.rows(3).unwrap();
        let (middle, _) = rows.places().nth(1).unwrap();
        assert_eq!([middle.north, middle.north_north, middle.north_west], [3, 2, 3]);
        assert_eq!([middle.up, middle.up_east, middle.up_south, middle.west], [0; 4]);
    }
}
