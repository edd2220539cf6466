//! Blocks of nodes, each with a border of nodes that belong to its neighbours.

use super::DistanceError;
use crate::field::Grid;

/// How a grid is cut into blocks. All blocks have as many nodes; those beyond the grid stay unused.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) extent: [usize; 3],
    /// Nodes of a block along each axis, without its border.
    pub(super) side: [usize; 3],
    /// Binary logarithms of the steps in the arrays of a block along y and z, so that coordinates come from a place
    /// without divisions.
    shifts: [u32; 2],
    /// Blocks along each axis.
    pub(super) blocks: [usize; 3],
    /// Distance between nodes.
    pub(super) spacing: [f32; 3],
}

/// No closest point.
pub(super) const NONE: u32 = (1 << 30) - 1;
/// Set in the word of a node's site while the node waits for the end of the round.
pub(super) const WAITS: u32 = 1 << 31;
/// Set in the word of a node's site if the surface meets one of its cells.
pub(super) const SEED: u32 = 1 << 30;
/// The rest of that word: the number of the site.
pub(super) const SITE: u32 = SEED - 1;

/// Nodes, and what is known about them.
#[derive(Debug)]
pub(super) struct Block {
    /// Place among the blocks.
    pub(super) place: [usize; 3],
    /// Squared distance to the closest point, for every node and border node; below zero beyond the grid.
    pub(super) squared: Vec<f32>,
    /// Number of the closest point, and two marks.
    pub(super) sites: Vec<u32>,
}

impl Layout {
    /// Cuts a grid into blocks of about `side` nodes along each axis.
    pub(super) fn new(grid: &Grid, side: usize) -> Result<Self, DistanceError> {
        if grid.is_empty() {
            return Err(DistanceError::Grid("no nodes"));
        }
        if grid.spacing.to_array().iter().any(|&step| !(step > 0.0 && (step as f32).is_normal())) {
            return Err(DistanceError::Grid("a spacing that is not a positive number of moderate size"));
        }
        let blocks = grid.extent.map(|nodes| nodes.div_ceil(side.clamp(4, 128)));
        let side = std::array::from_fn(|axis| grid.extent[axis].div_ceil(blocks[axis]));
        let spacing = grid.spacing.to_array().map(|step| step as f32);
        let [x, y, _]: [u32; 3] = side.map(|nodes: usize| (nodes + 2).next_power_of_two().trailing_zeros());
        Ok(Self { extent: grid.extent, side, shifts: [x, x + y], blocks, spacing })
    }

    /// Number of blocks.
    pub(super) fn len(&self) -> usize {
        self.blocks.iter().product()
    }

    /// Place of a block, by its number.
    pub(super) fn place(&self, number: usize) -> [usize; 3] {
        let [x, y, _] = self.blocks;
        [number % x, number / x % y, number / (x * y)]
    }

    /// Number of the block at a place.
    pub(super) fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.blocks[1] + y) * self.blocks[0] + x
    }

    /// Length of the arrays of a block.
    fn all(&self) -> usize {
        (self.side[2] + 2) << self.shifts[1]
    }

    /// Steps in the arrays of a block along each axis.
    pub(super) fn strides(&self) -> [usize; 3] {
        [1, 1 << self.shifts[0], 1 << self.shifts[1]]
    }

    /// Place of a node in the arrays of a block, by its coordinates there: 0 is the border, 1 the first node.
    #[inline]
    pub(super) fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        z << self.shifts[1] | y << self.shifts[0] | x
    }

    /// Coordinates in a block, by place in its arrays.
    #[inline]
    pub(super) fn coordinates(&self, index: usize) -> [usize; 3] {
        let [y, z] = self.shifts;
        [index & ((1 << y) - 1), index >> y & ((1 << (z - y)) - 1), index >> z]
    }

    /// A block whose nodes are `squared` away from nothing.
    pub(super) fn block(&self, number: usize, squared: f32) -> Block {
        let place = self.place(number);
        // The coordinates in the block that lie in the grid, along each axis: the first, and one beyond the last.
        let within: [[usize; 2]; 3] = std::array::from_fn(|axis| {
            let before = place[axis] * self.side[axis];
            [usize::from(before == 0), (self.extent[axis] + 1 - before).min(self.side[axis] + 2)]
        });
        let mut values = vec![-1.0; self.all()];
        for z in within[2][0]..within[2][1] {
            for y in within[1][0]..within[1][1] {
                let row = self.index([0, y, z]);
                values[row + within[0][0]..row + within[0][1]].fill(squared);
            }
        }
        Block { place, squared: values, sites: vec![NONE; self.all()] }
    }

    /// The nodes of a block: the first, and one beyond the last.
    pub(super) fn nodes(&self, place: [usize; 3]) -> [[usize; 3]; 2] {
        let first: [usize; 3] = std::array::from_fn(|axis| place[axis] * self.side[axis]);
        [first, std::array::from_fn(|axis| (first[axis] + self.side[axis]).min(self.extent[axis]))]
    }

    /// Coordinate of a node along an axis, by its coordinate in a block at `place` along it.
    pub(super) fn coordinate(&self, axis: usize, place: usize, at: usize) -> f32 {
        ((place * self.side[axis] + at) as f32 - 1.0) * self.spacing[axis]
    }
}
