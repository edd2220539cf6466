//! Where the samples of a field lie.

use crate::mesh::Point;

/// A regular grid of nodes; node (i, j, k) lies at `origin + spacing * (i, j, k)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Nodes along x, y and z, each at least 1.
    pub extent: [usize; 3],
    /// Where the first node lies.
    pub origin: Point,
    /// Distance between nodes along x, y and z, each positive and finite.
    pub spacing: Point,
}

impl Grid {
    /// A grid with its origin at zero and nodes one apart.
    pub const fn unit(extent: [usize; 3]) -> Self {
        Self { extent, origin: Point::ZERO, spacing: Point::ONE }
    }

    /// Number of nodes.
    pub const fn len(&self) -> usize {
        self.extent[0] * self.extent[1] * self.extent[2]
    }

    /// Whether there is no node.
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Place of node (i, j, k) in an array with x fastest.
    pub const fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.extent[1] + j) * self.extent[0] + i
    }

    /// Where node (i, j, k) lies.
    pub fn position(&self, node: [usize; 3]) -> Point {
        self.origin + self.spacing * Point::from_array(node.map(|index| index as f64))
    }

    /// A point in units of nodes: the inverse of [`Grid::position`], with fractions between nodes.
    pub fn local(&self, point: Point) -> Point {
        (point - self.origin) / self.spacing
    }

    /// Length of a cell's edge: the geometric mean over the axes, the unit in which errors of surfaces are told.
    pub fn cell_edge(&self) -> f64 {
        self.spacing.element_product().cbrt()
    }

    /// Node (i, j, k), by its place in an array with x fastest: the inverse of [`Grid::index`].
    pub const fn node(&self, index: usize) -> [usize; 3] {
        let [width, height, _] = self.extent;
        [index % width, index / width % height, index / (width * height)]
    }

    /// Places of the nodes one step away along an axis, 3 to 6 of them.
    pub fn neighbours(&self, index: usize) -> impl Iterator<Item = usize> + use<> {
        let (node, extent) = (self.node(index), self.extent);
        let strides = [1, extent[0], extent[0] * extent[1]];
        (0..3).flat_map(move |axis| {
            let before = (node[axis] > 0).then(|| index - strides[axis]);
            let after = (node[axis] + 1 < extent[axis]).then(|| index + strides[axis]);
            before.into_iter().chain(after)
        })
    }
}
