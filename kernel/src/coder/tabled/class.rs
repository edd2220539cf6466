//! How large a residual is expected to be: the class of the ranks around it.

use super::neighbours::{Around, Kind, add_row};

/// Classes there are.
pub(super) const CLASSES: usize = 14;

/// The least energies of the classes but the first.
const LEAST: [i32; CLASSES - 1] = [1, 3, 5, 8, 12, 18, 28, 44, 80, 160, 400, 1200, 5000];

/// The class of each place of a row.
pub(super) fn classes(around: &Around<'_>, classes: &mut [i32]) {
    classes.fill(0);
    match around.kind {
        Kind::First => return,
        Kind::Plane => add_row(classes, around.north, [1, 2, 1]),
        Kind::Brick => {
            add_row(classes, around.north, [1, 2, 1]);
            add_row(classes, around.up, [1, 2, 1]);
            add_row(classes, around.up_south, [0, 1, 0]);
            classes.iter_mut().for_each(|energy| *energy >>= 1);
        }
    }
    for class in classes {
        let energy = *class;
        *class = LEAST.iter().fold(0, |count: i32, &least| count.wrapping_add(i32::from(energy >= least)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
