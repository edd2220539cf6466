//! What is read of a step at once: as much as memory allows, in the order of its bricks.

use super::Grid;

/// A box of whole bricks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Unit {
    pub(super) origin: [u64; 3],
    pub(super) sides: [u64; 3],
}

impl Unit {
    /// Its bricks, in their order.
    pub(super) fn bricks(&self, grid: &Grid) -> impl Iterator<Item = u64> + use<> {
        let end: [u64; 3] = std::array::from_fn(|axis| self.origin[axis] + self.sides[axis]);
        grid.bricks_in(self.origin, end)
    }
}

/// Bricks along x, y and z of a unit of at most `most` bytes, or of one brick: whole planes of bricks, or else whole
/// rows of them.
pub(super) fn counts(grid: &Grid, sample_bytes: u64, most: u64) -> [u64; 3] {
    let [across, down, _] = grid.counts();
    let brick: u128 = grid.sides.into_iter().map(u128::from).product::<u128>() * u128::from(sample_bytes);
    let fit = (u128::from(most) / brick) as u64;
    match fit / across {
        0 => [fit.clamp(1, across), 1, 1],
        rows => [across, rows.min(down), 1],
    }
}

/// The units of a grid, each of so many bricks.
pub(super) fn units(grid: Grid, counts: [u64; 3]) -> impl Iterator<Item = Unit> {
    let steps: [u64; 3] = std::array::from_fn(|axis| counts[axis] * u64::from(grid.sides[axis]));
    let starts =
        move |axis: usize| (0..grid.extent[axis].div_ceil(steps[axis])).map(move |n| n * steps[axis]);
    let origins = starts(2).flat_map(move |z| starts(1).flat_map(move |y| starts(0).map(move |x| [x, y, z])));
    origins.map(move |origin| {
        let sides = std::array::from_fn(|axis| steps[axis].min(grid.extent[axis] - origin[axis]));
        Unit { origin, sides }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_hold_every_brick_in_order() {
        let grid = Grid::new([40, 21, 9], [8, 8, 4]).unwrap();
        // A brick of two bytes a sample has 512 bytes.
        for (most, expected) in [
            (0, [1, 1, 1]),
            (512, [1, 1, 1]),
            (1535, [2, 1, 1]),
            (2560, [5, 1, 1]),
            (5120, [5, 2, 1]),
            (1 << 20, [5, 3, 1]),
        ] {
            let counts = counts(&grid, 2, most);
            assert_eq!(counts, expected, "{most}");
            let bricks: Vec<u64> = units(grid, counts).flat_map(|unit| unit.bricks(&grid)).collect();
            assert_eq!(bricks, (0..grid.bricks()).collect::<Vec<_>>(), "{most}");
            assert!(
                units(grid, counts).all(|unit| {
                    expected == [1; 3] || unit.sides.into_iter().product::<u64>() * 2 <= most
                })
            );
        }
    }
}
