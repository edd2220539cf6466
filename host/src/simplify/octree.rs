//! An octree of the signed distance: small cells where the surface has detail, and which of them are solid.
//!
//! Source: Dataflow §3. A cell is split where the distance deviates from the trilinear interpolant of the cell's corners by
//! more than a share of the cell's width on average, and where a neighbour is more than one level finer. The text splits
//! any such cell; here only cells with nodes on both sides of the surface are, for no others have a face of it.

use crate::field::ScalarField;

/// Which cells belong to the solid, by the distances of their nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Solid {
    /// Those with a node inside: the base mesh then contains the solid, as a foil shrunk over it would, and gaps and tunnels
    /// narrower than a cell are closed.
    #[default]
    Minimum,
    /// Those whose nodes are inside on average, as after a low-pass filter: the base mesh is nearer to the surface, and parts
    /// thinner than a cell are lost.
    Mean,
}

/// How an octree is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OctreeOptions {
    /// Which cells are solid.
    pub solid: Solid,
    /// Mean deviation from trilinear above which a cell is split, in widths of the cell.
    pub deviation: f64,
    /// Width of the smallest cells, in cells of the grid: this power of two.
    pub finest: u32,
    /// Width of the largest cells: this power of two, at most 16.
    pub coarsest: u32,
}

impl Default for OctreeOptions {
    fn default() -> Self {
        Self { solid: Solid::Minimum, deviation: 0.2, finest: 1, coarsest: 4 }
    }
}

/// Leaves of a forest of octrees over the cells of a grid.
pub(super) struct Octree {
    /// Cells along x, y and z.
    pub(super) cells: [usize; 3],
    /// For each cell of the grid, x fastest, the leaf that it lies in: its level, and [`SOLID`].
    leaves: Vec<u8>,
}

const SOLID: u8 = 0x80;

/// What the nodes of a cell say.
struct Nodes {
    least: f64,
    most: f64,
    mean: f64,
    /// Mean deviation from the interpolant of the corners.
    deviation: f64,
}

impl Octree {
    /// Makes the leaves, balanced and told solid from void.
    ///
    /// Cost: a pass over the nodes for each level, where the surface is; a byte a cell.
    pub(super) fn new(distance: &ScalarField, options: &OctreeOptions) -> Self {
        let cells = distance.grid().extent.map(|nodes| nodes.saturating_sub(1));
        let coarsest = options.coarsest.min(16).max(options.finest.min(16));
        let mut tree = Self { cells, leaves: vec![coarsest as u8; cells.iter().product()] };
        for cell in steps(cells, coarsest) {
            tree.split_where_rough(distance, options, cell, coarsest);
        }
        for level in 0..coarsest.saturating_sub(1) {
            tree.balance(level);
        }
        for level in 0..=coarsest {
            tree.mark_solid(distance, options.solid, level);
        }
        tree
    }

    fn mark_solid(&mut self, distance: &ScalarField, solid: Solid, level: u32) {
        for cell in steps(self.cells, level) {
            if self.level(cell) == level {
                let nodes = nodes(distance, cell, level);
                let value = match solid {
                    Solid::Minimum => nodes.least,
                    Solid::Mean => nodes.mean,
                };
                if value < 0.0 {
                    self.fill(cell, level, level as u8 | SOLID);
                }
            }
        }
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.cells[1] + y) * self.cells[0] + x
    }

    /// Level of the leaf that a cell lies in.
    pub(super) fn level(&self, cell: [usize; 3]) -> u32 {
        u32::from(self.leaves[self.index(cell)] & !SOLID)
    }

    /// Whether the leaf that a cell lies in is solid.
    pub(super) fn is_solid(&self, cell: [usize; 3]) -> bool {
        self.leaves[self.index(cell)] & SOLID != 0
    }

    fn fill(&mut self, first: [usize; 3], level: u32, leaf: u8) {
        let end: [usize; 3] = std::array::from_fn(|axis| self.cells[axis].min(first[axis] + (1 << level)));
        for z in first[2]..end[2] {
            for y in first[1]..end[1] {
                let [start, end] = [self.index([first[0], y, z]), self.index([end[0] - 1, y, z]) + 1];
                self.leaves[start..end].fill(leaf);
            }
        }
    }

    fn split_where_rough(
        &mut self,
        distance: &ScalarField,
        options: &OctreeOptions,
        cell: [usize; 3],
        level: u32,
    ) {
        let nodes = nodes(distance, cell, level);
        let width = distance.grid().cell_edge() * f64::from(1_u32 << level);
        let crossed = nodes.least < 0.0 && nodes.most >= 0.0;
        if level <= options.finest || !crossed || nodes.deviation <= options.deviation * width {
            return self.fill(cell, level, level as u8);
        }
        let half = 1 << (level - 1);
        for child in 0..8 {
            let child = std::array::from_fn(|axis| cell[axis] + half * (child >> axis & 1));
            if (0..3).all(|axis| child[axis] < self.cells[axis]) {
                self.split_where_rough(distance, options, child, level - 1);
            }
        }
    }

    /// Splits leaves more than one level coarser than a leaf of `level` beside them, across faces, edges or corners.
    fn balance(&mut self, level: u32) {
        let width = 1 << level;
        for cell in steps(self.cells, level) {
            if self.level(cell) != level {
                continue;
            }
            for direction in 0..27 {
                let steps = [direction % 3, direction / 3 % 3, direction / 9];
                let beside: [usize; 3] =
                    std::array::from_fn(|axis| (cell[axis] + width * steps[axis]).wrapping_sub(width));
                if (0..3).all(|axis| beside[axis] < self.cells[axis]) {
                    self.split_down_to(beside, level + 1);
                }
            }
        }
    }

    fn split_down_to(&mut self, cell: [usize; 3], level: u32) {
        while self.level(cell) > level {
            let own = self.level(cell);
            self.fill(cell.map(|at| at >> own << own), own, own as u8 - 1);
        }
    }
}

/// First cells of the blocks of a level that cover so many cells, in order.
pub(super) fn steps(cells: [usize; 3], level: u32) -> impl Iterator<Item = [usize; 3]> {
    let [xs, ys, zs] = cells.map(|cells| (0..cells).step_by(1 << level));
    zs.flat_map(move |z| {
        let xs = xs.clone();
        ys.clone().flat_map(move |y| xs.clone().map(move |x| [x, y, z]))
    })
}

/// Looks at the nodes of a block of cells, its border included.
fn nodes(distance: &ScalarField, first: [usize; 3], level: u32) -> Nodes {
    let width = 1_usize << level;
    let last = distance.grid().extent.map(|nodes| nodes - 1);
    // Past the border the field goes on as it is there.
    let at =
        |node: [usize; 3]| f64::from(distance.at(std::array::from_fn(|axis| node[axis].min(last[axis]))));
    let corners: [f64; 8] = std::array::from_fn(|corner| {
        at(std::array::from_fn(|axis| first[axis] + width * (corner >> axis & 1)))
    });
    let mut nodes = Nodes { least: f64::INFINITY, most: f64::NEG_INFINITY, mean: 0.0, deviation: 0.0 };
    let inverse = 1.0 / width as f64;
    for k in 0..=width {
        for j in 0..=width {
            let [y, z] = [j as f64 * inverse, k as f64 * inverse];
            let mix = |low: f64, high: f64, share: f64| low + (high - low) * share;
            let row = [0, 1]
                .map(|x| mix(mix(corners[x], corners[x + 2], y), mix(corners[x + 4], corners[x + 6], y), z));
            for i in 0..=width {
                let value = at([first[0] + i, first[1] + j, first[2] + k]);
                nodes.least = nodes.least.min(value);
                nodes.most = nodes.most.max(value);
                nodes.mean += value;
                nodes.deviation += (value - mix(row[0], row[1], i as f64 * inverse)).abs();
            }
        }
    }
    let count = (width + 1).pow(3) as f64;
    Nodes { mean: nodes.mean / count, deviation: nodes.deviation / count, ..nodes }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Grid;
    use crate::mesh::Point;

    #[test]
    fn neighbours_are_at_most_one_level_apart() {
        let centre = Point::new(20.0, 17.0, 23.0);
        let field = ScalarField::from_function(Grid::unit([41, 37, 45]), |at| at.distance(centre) - 9.0);
        let options = OctreeOptions { finest: 0, deviation: 0.02, ..OctreeOptions::default() };
        let tree = Octree::new(&field, &options);
        let mut levels = [0; 5];
        for cell in steps(tree.cells, 0) {
            levels[tree.level(cell) as usize] += 1;
            for [x, y, z] in [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1], [1, 1, 1]] {
                let beside = [cell[0] + x, cell[1] + y, cell[2] + z];
                if (0..3).all(|axis| beside[axis] < tree.cells[axis]) {
                    assert!(tree.level(cell).abs_diff(tree.level(beside)) <= 1, "{cell:?}");
                }
            }
            if field.at(cell) < 0.0 {
                assert!(tree.is_solid(cell), "{cell:?}");
            }
        }
        assert!(levels.iter().filter(|&&cells| cells > 0).count() > 2, "{levels:?}");
    }

    #[test]
    fn a_plane_does_not_deviate() {
        let field = ScalarField::from_function(Grid::unit([9, 9, 9]), |at| at.x + 0.5 * at.y - 3.2);
        let nodes = nodes(&field, [0; 3], 3);
        assert!(nodes.deviation < 1e-6 && nodes.least < 0.0 && nodes.most > 0.0);
        assert!((nodes.mean - (4.0 + 2.0 - 3.2)).abs() < 1e-6);
    }
}
