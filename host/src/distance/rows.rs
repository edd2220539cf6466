//! The closest point of every node, in rows that vector instructions can work on.

use rayon::prelude::*;
use wide::f32x8;

use super::lanes::{LANES, Points, dot, minus};
use super::surface::NONE;

/// Where the closest point is while there is none: farther away than any other.
const NOWHERE: f32 = 1e18;

/// Rows of nodes. In each row, the points of all its nodes stand axis by axis, then, as bits, the triangles on which they lie.
///
/// The first axis of points is the one that rows run along. Before the first node and after the last there is room that
/// neighbours may look at: nodes beyond the grid, which are computed with but lead nowhere.
#[derive(Debug)]
pub(super) struct Rows {
    /// Rows of each plane: memory of planes that are turned is used again at once.
    planes: Vec<Vec<f32>>,
    /// Rows of a plane.
    each: usize,
    /// Nodes of a row.
    nodes: usize,
}

/// One row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row<'a>(pub(super) &'a [f32]);

/// Numbers of a row for each of the four numbers of a node.
fn stride(nodes: usize) -> usize {
    nodes.next_multiple_of(LANES) + LANES
}

impl Rows {
    /// Planes of `each` rows of nodes without closest points.
    pub(super) fn new(planes: usize, each: usize, nodes: usize) -> Self {
        let planes = (0..planes).into_par_iter().map(|_| plane(each, nodes)).collect();
        Self { planes, each, nodes }
    }

    /// Row by number, plane by plane.
    pub(super) fn row(&self, row: usize) -> Row<'_> {
        let width = width(self.nodes);
        Row(&self.planes[row / self.each][row % self.each * width..][..width])
    }

    /// All planes, `count` at a time.
    pub(super) fn chunks_mut(&mut self, count: usize) -> rayon::slice::ChunksMut<'_, Vec<f32>> {
        self.planes.par_chunks_mut(count)
    }

    /// All rows.
    pub(super) fn all_mut(&mut self) -> impl Iterator<Item = &mut [f32]> {
        let width = width(self.nodes);
        self.planes.iter_mut().flat_map(move |plane| plane.chunks_exact_mut(width))
    }

    /// Nodes that have a closest point.
    pub(super) fn taken(&self) -> usize {
        let taken = |row: &[f32]| Row(row).triangles(self.nodes).filter(|&triangle| triangle != NONE).count();
        let rows = |plane: &Vec<f32>| plane.chunks_exact(width(self.nodes)).map(taken).sum::<usize>();
        self.planes.par_iter().map(rows).sum()
    }

    /// The same nodes with rows along the second axis.
    pub(super) fn turned(self) -> Self {
        let (each, nodes) = (self.nodes, self.each);
        let planes = self.planes.into_par_iter().map(|plane| turned(&plane, each, nodes)).collect();
        Self { planes, each, nodes }
    }
}

/// Numbers of a row.
pub(super) fn width(nodes: usize) -> usize {
    4 * stride(nodes)
}

/// Rows of nodes without closest points.
fn plane(rows: usize, nodes: usize) -> Vec<f32> {
    let mut plane = vec![NOWHERE; rows * width(nodes)];
    for row in plane.chunks_exact_mut(width(nodes)) {
        row[3 * stride(nodes)..].fill(f32::from_bits(NONE));
    }
    plane
}

/// A plane of `nodes` rows of `rows` nodes as one of `rows` rows.
fn turned(before: &[f32], rows: usize, nodes: usize) -> Vec<f32> {
    let (from, to) = (width(rows), width(nodes));
    let mut turned = plane(rows, nodes);
    for (part, source) in [1, 0, 2, 3].into_iter().enumerate() {
        let (part, source) = (part * stride(nodes) + 1, source * stride(rows) + 1);
        for first in (0..rows).step_by(2 * LANES) {
            for node in 0..nodes {
                let numbers = &before[node * from + source + first..][..(2 * LANES).min(rows - first)];
                for (place, &number) in (first..).zip(numbers) {
                    turned[place * to + part + node] = number;
                }
            }
        }
    }
    turned
}

/// Eight numbers of many.
#[inline(always)]
pub(super) fn load(numbers: &[f32], first: usize) -> f32x8 {
    f32x8::new(*numbers[first..].first_chunk().expect("rows end with room for a vector"))
}

/// Eight numbers of many, and one on either side.
#[inline(always)]
pub(super) fn window_of(numbers: &[f32], first: usize) -> &[f32; LANES + 2] {
    numbers[first..].first_chunk().expect("rows end with room for a vector")
}

impl<'a> Row<'a> {
    /// The numbers of the nodes from `first` - 1 to `first` + 8.
    #[inline(always)]
    pub(super) fn window(self, first: usize) -> [&'a [f32; LANES + 2]; 4] {
        let stride = self.0.len() / 4;
        let part = |part: usize| window_of(self.0, part * stride + first);
        [part(0), part(1), part(2), part(3)]
    }

    /// How far the points of all nodes are from them, squared.
    pub(super) fn squares(self, step: f32, others: [f32; 2], squares: &mut Vec<f32>) {
        squares.clear();
        for first in (0..self.0.len() / 4 - LANES).step_by(LANES) {
            let squared = squared(&nodes(first, step, others), &points(self.window(first), 1));
            squares.extend_from_slice(squared.as_array());
        }
    }

    /// How far each point is beside the line through given coordinates along the row, squared.
    pub(super) fn beside(self, others: [f32; 2], squares: &mut Vec<f32>) {
        let stride = self.0.len() / 4;
        let (second, third) = (&self.0[stride..2 * stride], &self.0[2 * stride..3 * stride]);
        squares.clear();
        squares.extend(second.iter().zip(third).map(|(second, third)| {
            let (second, third) = (second - others[0], third - others[1]);
            second * second + third * third
        }));
    }

    /// The triangle of each node.
    pub(super) fn triangles(self, nodes: usize) -> impl Iterator<Item = u32> + use<'a> {
        self.0[3 * (self.0.len() / 4) + 1..][..nodes].iter().map(|number| number.to_bits())
    }
}

/// Points of the eight nodes of a window that begin `shift` - 1 after its middle ones.
#[inline(always)]
pub(super) fn points(window: [&[f32; LANES + 2]; 4], shift: usize) -> Points {
    [load(window[0], shift), load(window[1], shift), load(window[2], shift)]
}

/// Stores the points and triangles of the nodes from `first` on.
#[inline(always)]
pub(super) fn store(row: &mut [f32], first: usize, points: &Points, triangles: f32x8) {
    let stride = row.len() / 4;
    for (part, lanes) in [points[0], points[1], points[2], triangles].into_iter().enumerate() {
        row[part * stride + first + 1..][..LANES].copy_from_slice(lanes.as_array());
    }
}

/// Gives one node a closest point.
#[inline]
pub(super) fn set(row: &mut [f32], node: usize, point: [f32; 3], triangle: u32) {
    let stride = row.len() / 4;
    for axis in 0..3 {
        row[axis * stride + node + 1] = point[axis];
    }
    row[3 * stride + node + 1] = f32::from_bits(triangle);
}

/// Where eight nodes lie, from node `first` on, `step` apart along a row.
#[inline(always)]
pub(super) fn nodes(first: usize, step: f32, others: [f32; 2]) -> Points {
    let lane = f32x8::new([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    [(lane + first as f32) * step, f32x8::splat(others[0]), f32x8::splat(others[1])]
}

/// Squared distances.
#[inline(always)]
pub(super) fn squared(a: &Points, b: &Points) -> f32x8 {
    let offset = minus(a, b);
    dot(&offset, &offset)
}
