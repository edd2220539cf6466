//! The samples around one that is coded, and what was foretold of them.

use super::equations::TAPS;
use crate::memory::copy;

/// Samples that rows reach beyond either end: the nearest stands in.
pub(super) const REACH: usize = 3;

/// Samples of a row around one.
const WINDOW: usize = 2 * REACH + 1;

/// Rows known before the row at (y, z), as steps along y and z: north, twice and three times north, up, and
/// north, south and up of that.
const ROWS: [[isize; 2]; 7] = [[-1, 0], [-2, 0], [-3, 0], [0, -1], [-1, -1], [1, -1], [0, -2]];

/// Columns of errors and losses beside those of the samples, half on either side: they stay 0.
const BORDER: usize = 4;

/// Rows of them above and below those of the samples.
const EDGES: usize = 2;

/// What is known before a row: nothing but samples of it in the first, of the first plane, then of planes before.
pub(super) const LINE: u8 = 0;
/// As [`LINE`].
pub(super) const PLANE: u8 = 1;
/// As [`LINE`].
pub(super) const BRICK: u8 = 2;
/// Any of them.
pub(super) const ANY: u8 = 3;

/// What is known before row `y` of plane `z`.
pub(super) const fn known_at([y, z]: [usize; 2]) -> u8 {
    match (y, z) {
        (0, 0) => LINE,
        (_, 0) => PLANE,
        _ => BRICK,
    }
}

/// Differences that samples are predicted from.
pub(super) const fn taps(known: u8) -> usize {
    match known {
        LINE => 2,
        PLANE => 17,
        _ => 19,
    }
}

/// The rows around a row that is coded, and memory of a plane; in scratch.
#[derive(Debug)]
pub(super) struct Surroundings<'a> {
    rows: [&'a mut [i32]; ROWS.len()],
    /// How far predictions were off, in 1/16, by place; those not yet coded are of the plane before.
    errors: &'a mut [i32],
    /// What the two predictions lost, by place: of the fast one in the upper half, of the slow one in the lower.
    losses: &'a mut [i32],
    width: usize,
    height: usize,
}

/// Views of the surroundings of one row.
#[derive(Debug)]
pub(super) struct RowAround<'a> {
    pub(super) rows: [&'a [i32]; ROWS.len()],
    pub(super) errors: [&'a mut [i32]; 3],
    pub(super) losses: [&'a mut [i32]; 2],
}

impl<'a> Surroundings<'a> {
    /// `i32`s of scratch for rows of `width` in planes of `height`.
    pub(super) const fn scratch_len(width: usize, height: usize) -> usize {
        let rows = width.saturating_add(2 * REACH).saturating_mul(ROWS.len());
        let plane = width.saturating_add(BORDER).saturating_mul(height.saturating_add(EDGES));
        rows.saturating_add(plane.saturating_mul(2))
    }

    /// Lays out `scratch`; `None` if it is shorter than [`Surroundings::scratch_len`].
    pub(super) fn new(width: usize, height: usize, scratch: &'a mut [i32]) -> Option<Self> {
        let mut rest = scratch.get_mut(..Self::scratch_len(width, height))?;
        rest.fill(0);
        let mut rows: [&mut [i32]; ROWS.len()] = Default::default();
        for row in &mut rows {
            (*row, rest) = rest.split_at_mut_checked(width.wrapping_add(2 * REACH))?;
        }
        let (errors, losses) = rest.split_at_mut_checked(rest.len() / 2)?;
        Some(Self { rows, errors, losses, width, height })
    }

    /// Copies the rows known before row `y` of plane `z`, the nearest for those that are not there. Returns the first
    /// sample of the nearest row, or `middle` if none is known.
    pub(super) fn fill(&mut self, samples: &[i32], [y, z]: [usize; 2], middle: i32) -> Option<i32> {
        if known_at([y, z]) == LINE {
            return Some(middle);
        }
        let height = self.height;
        for (row, [along_y, along_z]) in self.rows.iter_mut().zip(ROWS) {
            let [y, z] = match along_z {
                0 if y == 0 => [0, z.wrapping_sub(1)],
                _ => [
                    y.saturating_add_signed(along_y).min(height.wrapping_sub(1)),
                    z.saturating_add_signed(along_z),
                ],
            };
            let start = z.wrapping_mul(height).wrapping_add(y).wrapping_mul(self.width);
            let known = samples.get(start..start.wrapping_add(self.width))?;
            let (&first, &last) = (known.first()?, known.last()?);
            let (west, rest) = row.split_at_mut_checked(REACH)?;
            west.fill(first);
            let (inside, east) = rest.split_at_mut_checked(self.width)?;
            copy(known, inside);
            east.fill(last);
        }
        let [north, .., up, _, _, _] = &self.rows;
        (if y > 0 { north } else { up }).first().copied()
    }

    /// What lies around row `y` of the plane.
    pub(super) fn around(&mut self, y: usize) -> Option<RowAround<'_>> {
        let stride = self.width.wrapping_add(BORDER);
        let start = stride.wrapping_mul(y);
        let mut errors = self.errors.get_mut(start..)?.chunks_exact_mut(stride.max(1));
        let mut losses = self.losses.get_mut(start..)?.chunks_exact_mut(stride.max(1));
        Some(RowAround {
            rows: self.rows.each_ref().map(|row| &**row),
            errors: [errors.next()?, errors.next()?, errors.next()?],
            losses: [losses.next()?, losses.next()?],
        })
    }
}

/// The samples of a row from `x` on.
#[cfg_attr(not(feature = "small"), inline(always))]
fn window(row: &[i32], x: usize) -> Option<&[i32; WINDOW]> {
    row.get(x..)?.first_chunk()
}

/// Samples around the one at `x`: the three to the west, the nearest last, and the rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbours {
    /// Differences from the west neighbour, the nearest first.
    pub(super) differences: [i32; TAPS],
    /// West, north, north-east, and up, or north-west where there is no plane before.
    pub(super) nearest: [i32; 4],
}

impl Neighbours {
    /// Those of the sample at `x` of a row with `rows` around and `wests` before it, the nearest last.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn of(known: u8, rows: &[&[i32]; 7], wests: [i32; 3], x: usize) -> Option<Self> {
        let [www, ww, w] = wests;
        let mut differences = [w; TAPS];
        let [n, nn, nnn, u, un, us, uu] = *rows;
        let n = window(n, x)?;
        let mut last = n[2];
        match known {
            LINE => copy(&[ww, www], &mut differences),
            PLANE => {
                let (nn, nnn) = (window(nn, x)?, window(nnn, x)?);
                let taps = [
                    n[3], n[2], n[4], ww, nn[3], nn[4], nn[2], n[5], n[1], www, n[0], n[6], nn[1], nn[5],
                    nnn[2], nnn[3], nnn[4],
                ];
                copy(&taps, &mut differences);
            }
            _ => {
                let (nn, u, un) = (window(nn, x)?, window(u, x)?, window(un, x)?);
                let (us, uu) = (window(us, x)?, window(uu, x)?);
                let taps = [
                    n[3], u[3], n[2], u[2], n[4], u[4], un[3], us[3], ww, nn[3], uu[3], un[2], un[4], us[4],
                    us[2], n[5], n[1], nn[2], nn[4],
                ];
                copy(&taps, &mut differences);
                last = u[3];
            }
        }
        for difference in &mut differences {
            *difference = difference.wrapping_sub(w);
        }
        Some(Self { differences, nearest: [w, n[3], n[4], last] })
    }
}
