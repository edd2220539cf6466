//! How large a residual is expected to be: the class of the ranks around it.

use super::MOST_SPAN_BITS;
use super::neighbours::{Around, Kind, LOOPS_UNROLLED, add_row, add_three};
use crate::coder::energy;
use crate::extent::to_usize;

/// Classes there are.
pub(super) const CLASSES: usize = 14;

/// Where the class of a rank may stand above it: sums of nine ranks do not reach it.
pub(super) const PLACE: u32 = 24;

/// Ranks, and sums of them, without classes above.
pub(super) const RANKS: i32 = (1 << PLACE) - 1;

const _: () = assert!(9 << (MOST_SPAN_BITS + 1) <= RANKS);

/// The least energies of the classes but the first.
const LEAST: [i32; CLASSES - 1] = [1, 3, 5, 8, 12, 18, 28, 44, 80, 160, 400, 1200, 5000];

/// The classes of the first energies, which nearly all are: small builds look them up.
#[rustfmt::skip]
const FIRST: [u8; 80] = [
    0, 1, 1, 2, 2, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 5, 5, 6, 6,
    6, 6, 6, 6, 6, 6, 6, 6, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7,
    7, 7, 7, 7, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8,
    8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8,
];

/// The classes that they have, but the last.
const PASSED: u8 = 8;

/// The class of each place of a row, of ranks that may have classes above them.
pub(super) fn classes(around: &Around<'_>, classes: &mut [i32]) {
    if around.kind == Kind::Brick && LOOPS_UNROLLED {
        let rows = [around.north, around.up, around.up_south];
        return energy::around(rows, classes, |sum| class((sum & RANKS) >> 1));
    }
    classes.fill(0);
    match around.kind {
        Kind::First => return,
        Kind::Plane => add_three(classes, around.north, [1, 2, 1]),
        Kind::Brick => {
            add_three(classes, around.north, [1, 2, 1]);
            add_three(classes, around.up, [1, 2, 1]);
            add_row(classes, around.up_south, |sum, [rank]| sum.wrapping_add(rank));
            return classes.iter_mut().for_each(|sum| *sum = class((*sum & RANKS) >> 1));
        }
    }
    classes.iter_mut().for_each(|sum| *sum = class(*sum & RANKS));
}

/// The class of an energy.
#[inline(always)]
fn class(energy: i32) -> i32 {
    let count = |count: i32, &least: &i32| count.wrapping_add(i32::from(energy >= least));
    if !LOOPS_UNROLLED {
        return LEAST.iter().fold(0, count);
    }
    match FIRST.get(to_usize(energy.cast_unsigned())) {
        Some(&class) => class.into(),
        None => LEAST.iter().skip(PASSED.into()).fold(PASSED.into(), count),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_classes_are_looked_up() {
        for (energy, &class) in (0..).zip(&FIRST) {
            assert_eq!(usize::from(class), LEAST.iter().filter(|&&least| least <= energy).count());
        }
    }

    #[test]
    fn energies_by_hand() {
        let around = |kind, rows: [&'static [i32]; 3]| {
            let [north, up, up_south] = rows;
            Around { kind, north, up, up_north: &[], up_south }
        };
        let mut found = [9; 3];
        classes(&around(Kind::First, [&[]; 3]), &mut found);
        assert_eq!(found, [0; 3]);
        // 0 + 0 + 0, 0 + 0 + 1, 0 + 2 + 1.
        classes(&around(Kind::Plane, [&[0, 0, 1], &[], &[]]), &mut found);
        assert_eq!(found, [0, 1, 2]);
        // (5000 * 4 + 0 + 0) / 2 left of the end, (10000 + 5000 + 5000) / 2 at the end, none of 1 / 2.
        classes(&around(Kind::Brick, [&[0, 0, 5000], &[0; 3], &[1, 0, 0]]), &mut found);
        assert_eq!(found, [0, 12, 13]);
    }
}
