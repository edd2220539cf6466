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
    numbers: Vec<f32>,
    /// Nodes of a row.
    pub(super) nodes: usize,
}

/// One row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row<'a>(pub(super) &'a [f32]);

/// Numbers of a row for each of the four numbers of a node.
fn stride(nodes: usize) -> usize {
    nodes.next_multiple_of(LANES) + LANES
}

impl Rows {
    /// Rows of nodes without closest points.
    pub(super) fn new(rows: usize, nodes: usize) -> Self {
        let stride = stride(nodes);
        let mut numbers = vec![NOWHERE; rows * 4 * stride];
        numbers.par_chunks_mut(4 * stride).for_each(|row| row[3 * stride..].fill(f32::from_bits(NONE)));
        Self { numbers, nodes }
    }

    /// Numbers of a row.
    pub(super) fn width(&self) -> usize {
        4 * stride(self.nodes)
    }

    /// Row by number.
    pub(super) fn row(&self, row: usize) -> Row<'_> {
        Row(&self.numbers[row * self.width()..(row + 1) * self.width()])
    }

    /// All rows, `count` at a time.
    pub(super) fn chunks_mut(&mut self, count: usize) -> rayon::slice::ChunksMut<'_, f32> {
        let width = self.width();
        self.numbers.par_chunks_mut(count * width)
    }

    /// All rows.
    pub(super) fn all_mut(&mut self) -> impl Iterator<Item = &mut [f32]> {
        let width = self.width();
        self.numbers.chunks_exact_mut(width)
    }

    /// Nodes that have a closest point.
    pub(super) fn taken(&self) -> usize {
        let taken = |row: &[f32]| Row(row).triangles(self.nodes).filter(|&triangle| triangle != NONE).count();
        self.numbers.par_chunks(self.width()).map(taken).sum()
    }

    /// The same nodes with rows along the second axis, plane by plane of `self.nodes` rows.
    pub(super) fn turned(self, across: usize) -> Self {
        let (along, from) = (self.nodes, self.width());
        let mut turned = Self::new(self.numbers.len() / (from * across) * along, across);
        let to = turned.width();
        let planes = self.numbers.par_chunks(from * across);
        turned.numbers.par_chunks_mut(to * along).zip(planes).for_each(|(turned, plane)| {
            for (part, source) in [1, 0, 2, 3].into_iter().enumerate() {
                let (part, source) = (part * stride(across) + 1, source * stride(along) + 1);
                for first in (0..along).step_by(2 * LANES) {
                    for x in 0..across {
                        let nodes = &plane[x * from + source + first..][..(2 * LANES).min(along - first)];
                        for (place, &number) in (first..).zip(nodes) {
                            turned[place * to + part + x] = number;
                        }
                    }
                }
            }
        });
        turned
    }
}

/// Eight numbers of many.
#[inline(always)]
pub(super) fn load(numbers: &[f32], first: usize) -> f32x8 {
    f32x8::new(*numbers[first..].first_chunk().expect("rows end with room for a vector"))
}

impl<'a> Row<'a> {
    /// The numbers of the nodes from `first` - 1 to `first` + 8.
    #[inline(always)]
    pub(super) fn window(self, first: usize) -> [&'a [f32; LANES + 2]; 4] {
        let stride = self.0.len() / 4;
        let part = |part: usize| -> &'a [f32; LANES + 2] {
            self.0[part * stride + first..].first_chunk().expect("rows end with room for a vector")
        };
        [part(0), part(1), part(2), part(3)]
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
