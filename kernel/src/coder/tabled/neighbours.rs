//! The rows around a row that are known when it is coded.

use super::narrow::{BothWeights, Weights};

/// Whether loops are written out for processors without vectors: in small builds, but not where code is sent.
pub(super) const LOOPS_UNROLLED: bool = cfg!(all(feature = "small", not(target_arch = "wasm32")));

/// What a row is predicted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The first row of all: nothing before it.
    First,
    /// A row of the first plane: the row before.
    Plane,
    /// A row of another plane: the row before and three of the plane before.
    Brick,
}

impl Kind {
    /// The weights of rows of this kind.
    pub(super) fn of(self, [plane, brick]: &mut BothWeights) -> &mut Weights {
        if self == Self::Brick { brick } else { plane }
    }
}

/// Known rows, each as long as the row itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around<'a> {
    pub(super) kind: Kind,
    /// The row before; in the first row of a plane, [`Around::up`].
    pub(super) north: &'a [i32],
    /// The same row of the plane before, and those before and after it, or else itself.
    pub(super) up: &'a [i32],
    pub(super) up_north: &'a [i32],
    pub(super) up_south: &'a [i32],
}

/// Row y of plane z, and all samples before it, of a brick of `sides`. `None` for no row of the brick.
pub(super) fn split_at_row(
    values: &mut [i32],
    [width, height, _]: [usize; 3],
    [y, z]: [usize; 2],
) -> Option<(&[i32], &mut [i32])> {
    let start = z.wrapping_mul(height).wrapping_add(y).wrapping_mul(width);
    let (before, row) = values.split_at_mut_checked(start)?;
    Some((before, row.get_mut(..width)?))
}

/// Row y of plane z, and those around it, of a brick of `sides`. `None` for no row of the brick.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn row_at(
    values: &mut [i32],
    sides: [usize; 3],
    [y, z]: [usize; 2],
) -> Option<(Around<'_>, &mut [i32])> {
    let [width, height, _] = sides;
    let plane = width.wrapping_mul(height);
    let (before, row) = split_at_row(values, sides, [y, z])?;
    let known = |back: usize| {
        let from = before.len().checked_sub(back)?;
        before.get(from..from.wrapping_add(width))
    };
    let around = if z > 0 {
        let up = known(plane)?;
        let (is_first, is_last) = (y == 0, y.wrapping_add(1) == height);
        Around {
            kind: Kind::Brick,
            north: if is_first { up } else { known(width)? },
            up,
            up_north: if is_first { up } else { known(plane.wrapping_add(width))? },
            up_south: if is_last { up } else { known(plane.wrapping_sub(width))? },
        }
    } else if y > 0 {
        Around { kind: Kind::Plane, north: known(width)?, up: &[], up_north: &[], up_south: &[] }
    } else {
        Around { kind: Kind::First, north: &[], up: &[], up_north: &[], up_south: &[] }
    };
    Some((around, row))
}

/// Adds to each of `sums` what `add` makes of the values of `row` around the same place; beyond its ends stands the first
/// or the last.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn add_row<const N: usize>(sums: &mut [i32], row: &[i32], add: impl Fn(i32, [i32; N]) -> i32) {
    let (width, reach) = (row.len(), N / 2);
    let inner = sums.get_mut(reach..).unwrap_or(&mut []);
    for (sum, &window) in inner.iter_mut().zip(row.array_windows()) {
        *sum = add(*sum, window);
    }
    let last = width.saturating_sub(1);
    for x in (0..reach.min(width)).chain(width.saturating_sub(reach).max(reach)..width) {
        let column = |tap: usize| x.wrapping_add(tap).saturating_sub(reach).min(last);
        let window = core::array::from_fn(|tap| row.get(column(tap)).copied().unwrap_or(0));
        if let Some(sum) = sums.get_mut(x) {
            *sum = add(*sum, window);
        }
    }
}

/// The same with three weights.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn add_three(sums: &mut [i32], row: &[i32], weights: [i32; 3]) {
    let add = three(weights);
    if !LOOPS_UNROLLED {
        return add_row(sums, row, add);
    }
    let Some((&first, rest)) = row.split_first() else { return };
    let (mut west, mut here) = (first, first);
    let (pairs, odd) = rest.as_chunks::<2>();
    for (sums, &[east, far_east]) in sums.as_chunks_mut::<2>().0.iter_mut().zip(pairs) {
        let [first, second] = *sums;
        *sums = [add(first, [west, here, east]), add(second, [here, east, far_east])];
        (west, here) = (east, far_east);
    }
    let mut left = sums.iter_mut().skip(pairs.len().wrapping_mul(2));
    for (&east, sum) in odd.iter().zip(&mut left) {
        *sum = add(*sum, [west, here, east]);
        (west, here) = (here, east);
    }
    if let Some(sum) = left.next() {
        *sum = add(*sum, [west, here, here]);
    }
}

/// Adds products of three values with `weights` to a sum.
#[inline(always)]
fn three([a, b, c]: [i32; 3]) -> impl Fn(i32, [i32; 3]) -> i32 {
    move |sum: i32, [p, q, r]| {
        let sum = sum.wrapping_add(a.wrapping_mul(p)).wrapping_add(b.wrapping_mul(q));
        sum.wrapping_add(c.wrapping_mul(r))
    }
}

/// The same of five.
#[inline(always)]
pub(super) fn five([a, b, c, d, e]: [i32; 5]) -> impl Fn(i32, [i32; 5]) -> i32 {
    let three = three([a, b, c]);
    move |sum, [p, q, r, s, t]| {
        three(sum, [p, q, r]).wrapping_add(d.wrapping_mul(s)).wrapping_add(e.wrapping_mul(t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_do_not_exist_are_replaced() {
        let mut values = [0, 1, 2, 3, 4, 5];
        let mut kinds = |place| {
            let (around, row) = row_at(&mut values, [1, 3, 2], place).unwrap();
            let of = |row: &[i32]| row.first().copied();
            (around.kind, [around.north, around.up, around.up_north, around.up_south].map(of), row[0])
        };
        assert_eq!(kinds([0, 0]), (Kind::First, [None; 4], 0));
        assert_eq!(kinds([2, 0]), (Kind::Plane, [Some(1), None, None, None], 2));
        assert_eq!(kinds([0, 1]), (Kind::Brick, [Some(0), Some(0), Some(0), Some(1)], 3));
        assert_eq!(kinds([1, 1]), (Kind::Brick, [Some(3), Some(1), Some(0), Some(2)], 4));
        assert_eq!(kinds([2, 1]), (Kind::Brick, [Some(4), Some(2), Some(1), Some(2)], 5));
    }

    #[test]
    fn ends_stand_for_what_is_beyond() {
        let mut sums = [10, 20, 30];
        add_three(&mut sums, &[1, 2, 4], [1, 0, 100]);
        assert_eq!(sums, [10 + 1 + 200, 20 + 1 + 400, 30 + 2 + 400]);
        let mut sum = [0];
        add_row(&mut sum, &[7], five([1; 5]));
        assert_eq!(sum, [35]);
    }
}
