//! What is known before a coefficient of the low-pass part: the rows above it, in its plane and in those before.

use crate::transform::{Plan, Subband};

/// The rows of the low-pass part that are known before one of its rows. Empty where there is none.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowsBefore<'a> {
    pub(super) north: &'a [i32],
    pub(super) up: &'a [i32],
    pub(super) up_north: &'a [i32],
    /// From here on, a row beyond the border is the nearest there is.
    pub(super) north_north: &'a [i32],
    pub(super) up_up: &'a [i32],
    pub(super) near_up_north: &'a [i32],
    pub(super) near_up_south: &'a [i32],
}

impl<'a> RowsBefore<'a> {
    /// Those of row `y` of plane `z`, among the coefficients of `plan` that lie `before` it.
    pub(super) fn new(plan: &Plan, low_pass: Subband, [y, z]: [usize; 2], before: &'a [i32]) -> Self {
        let [width, height, _] = low_pass.sides;
        let row = |y: Option<usize>, z: Option<usize>| {
            let start = low_pass.row(plan, y?, z?);
            before.get(start..start.wrapping_add(width))
        };
        let (above, last) = (y.checked_sub(1), height.saturating_sub(1));
        let (plane, plane_before) = (z.checked_sub(1), z.checked_sub(1).map(|z| z.saturating_sub(1)));
        let or_none = |row: Option<&'a [i32]>| row.unwrap_or(&[]);
        Self {
            north: or_none(row(above, Some(z))),
            up: or_none(row(Some(y), plane)),
            up_north: or_none(row(above, plane)),
            north_north: or_none(row(above.map(|y| y.saturating_sub(1)), Some(z))),
            up_up: or_none(row(Some(y), plane_before)),
            near_up_north: or_none(row(Some(y.saturating_sub(1)), plane)),
            near_up_south: or_none(row(Some(y.saturating_add(1).min(last)), plane)),
        }
    }
}

/// For encoders, who know all samples: calls `look` with the first `longest` samples of some `rows` of the low-pass
/// part, and with what a decoder knows before each: the rows before, x, and the last two samples of the row.
#[inline(always)]
pub(super) fn each_sample(
    plan: &Plan,
    low_pass: Subband,
    coefficients: &[i32],
    rows: impl Iterator<Item = [usize; 2]>,
    longest: usize,
    mut look: impl FnMut(&RowsBefore<'_>, usize, [Option<i32>; 2], i32),
) {
    let [width, _, _] = low_pass.sides;
    for [y, z] in rows {
        let Some((before, row)) = coefficients.split_at_checked(low_pass.row(plan, y, z)) else { return };
        let before = RowsBefore::new(plan, low_pass, [y, z], before);
        let [mut west_west, mut west] = [None; 2];
        for (x, &value) in row.iter().take(width.min(longest)).enumerate() {
            look(&before, x, [west_west, west], value);
            [west_west, west] = [west, Some(value)];
        }
    }
}

/// The `N` (odd) samples of `row` around `x`; beyond its ends stands its first or last. Zeros for an empty row.
#[inline(always)]
pub(super) fn window<const N: usize>(row: &[i32], x: usize) -> [i32; N] {
    let left = x.wrapping_sub(N / 2);
    match row.get(left..).and_then(|row| row.first_chunk()) {
        Some(&window) => window,
        None => clamped_window(row, left),
    }
}

#[cold]
fn clamped_window<const N: usize>(row: &[i32], left: usize) -> [i32; N] {
    let last = row.len().saturating_sub(1);
    core::array::from_fn(|i| {
        let x = left.wrapping_add(i).cast_signed().max(0).cast_unsigned();
        row.get(x.min(last)).copied().unwrap_or(0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Extent, Wavelet};

    #[test]
    fn windows_end_with_the_row() {
        let row = [1, 2, 3, 4];
        assert_eq!(
            [window::<5>(&row, 0), window(&row, 1), window(&row, 3)],
            [[1, 1, 1, 2, 3], [1, 1, 2, 3, 4], [2, 3, 4, 4, 4]]
        );
        assert_eq!((window::<1>(&row, 2), window::<3>(&[7], 0), window::<3>(&[], 5)), ([3], [7; 3], [0; 3]));
    }

    #[test]
    fn rows_beyond_the_border_are_the_nearest() {
        let plan = Plan::new(Wavelet::Haar, Extent::brick(1, 3, 3).unwrap(), 0).unwrap();
        let samples = [0, 1, 2, 3, 4, 5, 6, 7, 8];
        let low_pass = plan.subbands(0).next().unwrap();
        let before = |y, z| RowsBefore::new(&plan, low_pass, [y, z], &samples);
        let corner = before(0, 0);
        let rows = [corner.north, corner.north_north, corner.up, corner.up_up, corner.near_up_south];
        assert!(rows.iter().all(|row| row.is_empty()));
        let second = before(1, 1);
        assert_eq!(
            (second.north, second.north_north, second.up, second.up_up),
            (&[3][..], &[3][..], &[1][..], &[1][..])
        );
        assert_eq!(
            (second.up_north, second.near_up_north, second.near_up_south),
            (&[0][..], &[0][..], &[2][..])
        );
        let last = before(2, 2);
        assert_eq!((last.north_north, last.up_up, last.near_up_south), (&[6][..], &[2][..], &[5][..]));
        let top = before(0, 1);
        assert_eq!((top.up_north, top.near_up_north), (&[][..], &[0][..]));
    }
}
