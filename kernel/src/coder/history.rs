//! The magnitudes of the residuals coded last in a subband, in scratch.

use super::context::magnitude;
use crate::memory::move_within;

/// Columns and rows of zeros kept around the values.
const MARGIN: usize = 2;

/// Rows that a subband of one plane keeps: two above, the current one, one below.
const FLAT_ROWS: usize = 4;

/// `i32`s of scratch for a subband of `sides`.
pub(super) const fn history_len([x, y, z]: [usize; 3]) -> usize {
    let rows = if z == 1 { FLAT_ROWS } else { y.saturating_add(MARGIN + 1) };
    stride(x).saturating_mul(rows)
}

const fn stride(x: usize) -> usize {
    x.saturating_add(2 * MARGIN)
}

/// One plane of magnitudes within a margin of zeros.
///
/// Up to the current coefficient they are those of the current plane, from there on still those of the plane before.
/// A subband of one plane keeps four rows only, and moves them up after each.
#[derive(Debug)]
pub(super) struct History<'a> {
    values: &'a mut [i32],
    stride: usize,
    one_plane: bool,
}

impl<'a> History<'a> {
    /// An empty history for a subband of `sides`, and the rest of `scratch`.
    pub(super) fn new(sides: [usize; 3], scratch: &'a mut [i32]) -> Option<(Self, &'a mut [i32])> {
        let [x, _, z] = sides;
        let (values, rest) = scratch.split_at_mut_checked(history_len(sides))?;
        values.fill(0);
        Some((Self { values, stride: stride(x), one_plane: z == 1 }, rest))
    }

    /// The first of the rows of which `y` is the third.
    fn above(&self, y: usize) -> usize {
        if self.one_plane { 0 } else { y.wrapping_mul(self.stride) }
    }

    /// Adds to `energies` what is known around each coefficient of row `y` but to its west:
    /// 4 (N + U) + 2 (NW + NE + UE + US) + NN, of magnitudes, up being the plane before.
    pub(super) fn add_energies(&self, y: usize, energies: &mut [i32]) -> Option<()> {
        let (north_north, rest) = self.values.get(self.above(y)..)?.split_at_checked(self.stride)?;
        let (north, rest) = rest.split_at_checked(self.stride)?;
        let (up, rest) = rest.split_at_checked(self.stride)?;
        let up_south = rest.get(..self.stride)?;
        let columns = north_north.get(MARGIN..)?.iter().zip(up_south.get(MARGIN..)?);
        let windows = north.array_windows::<5>().zip(up.array_windows::<5>());
        for ((energy, (north, up)), (&north_north, &up_south)) in
            energies.iter_mut().zip(windows).zip(columns)
        {
            let [_, north_west, north, north_east, _] = *north;
            let [_, _, up, up_east, _] = *up;
            let near = north.wrapping_add(up).wrapping_mul(4);
            let next = north_west.wrapping_add(north_east).wrapping_add(up_east).wrapping_add(up_south);
            let sum = near.wrapping_add(next.wrapping_mul(2)).wrapping_add(north_north);
            *energy = energy.wrapping_add(sum);
        }
        Some(())
    }

    /// The places of the magnitudes of row `y`.
    pub(super) fn row(&mut self, y: usize) -> Option<&mut [i32]> {
        let start = self.above(y).wrapping_add(self.stride.wrapping_mul(2)).wrapping_add(MARGIN);
        let end = start.wrapping_add(self.stride).wrapping_sub(2 * MARGIN);
        self.values.get_mut(start..end)
    }

    /// Makes room for the next row.
    pub(super) fn end_row(&mut self) {
        if self.one_plane {
            move_within(self.values, self.stride..self.values.len(), 0);
            let below = self.stride.wrapping_mul(2);
            self.values.get_mut(below..).unwrap_or(&mut []).fill(0);
        }
    }
}

/// The magnitudes of the last two residuals of the row.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Last {
    west: i32,
    west_west: i32,
}

impl Last {
    /// What they add to the energy around the next coefficient: 4 W + WW.
    #[inline(always)]
    pub(super) const fn energy(self) -> i32 {
        self.west.wrapping_mul(4).wrapping_add(self.west_west)
    }

    /// Remembers a residual, and returns its magnitude.
    #[inline(always)]
    pub(super) fn push(&mut self, residual: i32) -> i32 {
        *self = Self { west: magnitude(residual), west_west: self.west };
        self.west
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fill(history: &mut History<'_>, y: usize, values: &[i32]) {
        history.row(y).unwrap().copy_from_slice(values);
        history.end_row();
    }

    #[test]
    fn a_brick_keeps_the_plane_before() {
        let mut scratch = [9; 64];
        let (mut history, _) = History::new([2, 2, 2], &mut scratch).unwrap();
        fill(&mut history, 0, &[1, 10]);
        fill(&mut history, 1, &[100, 1000]);
        fill(&mut history, 0, &[3, 5]);
        let mut energies = [0, 1];
        history.add_energies(1, &mut energies).unwrap();
        // N = 3, U = 100, NE = 5, UE = 1000; then N = 5, U = 1000, NW = 3.
        assert_eq!(energies, [4 * 103 + 2 * 1005, 1 + 4 * 1005 + 2 * 3]);
    }

    #[test]
    fn a_slice_keeps_two_rows() {
        let mut scratch = [9; 64];
        let (mut history, _) = History::new([3, 9, 1], &mut scratch).unwrap();
        for (y, value) in [(1, 1), (2, 10), (3, 100)] {
            fill(&mut history, y, &[value; 3]);
        }
        let mut energies = [0; 3];
        history.add_energies(4, &mut energies).unwrap();
        assert_eq!(energies, [4 * 100 + 2 * 100 + 10, 4 * 100 + 4 * 100 + 10, 4 * 100 + 2 * 100 + 10]);
    }

    #[test]
    fn energy_to_the_west() {
        let mut last = Last::default();
        assert_eq!((last.push(-3), last.energy(), last.push(5), last.energy()), (3, 12, 5, 23));
    }
}
