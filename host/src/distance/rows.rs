//! The closest point of every node, in rows that vector instructions can work on.

use rayon::prelude::*;
use wide::{ShuffleExt, f32x8, i32x8, u16x8, u32x8};

use super::lanes::{LANES, Points, dot, minus};
use super::surface::NONE;

/// Where the closest point is while there is none: farther away than any other.
const NOWHERE: u16 = u16::MAX;

/// How points are measured on their way, in 16 bits along each axis.
///
/// That is precise enough to find the nearest triangle, from which distances are taken, and there is less memory to go
/// through. Numbers grow from a little before the grid, to end at half of the range, so that no point of a node is as far
/// away as [`NOWHERE`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Ruler {
    /// Distance between nodes, in marks of the ruler.
    pub(super) step: [f32; 3],
    /// Where the first node lies.
    pub(super) start: f32,
    /// Marks in a cell's edge.
    pub(super) marks: f32,
}

/// Eight nodes of a row: their points, axis by axis, and the triangles on which they lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eight {
    pub(super) points: [[u16; LANES]; 3],
    pub(super) triangles: [u32; LANES],
}

/// Rows of nodes. A row may end with nodes beyond the grid, which are computed with but lead nowhere.
#[derive(Debug)]
pub(super) struct Rows {
    /// Rows of each plane: memory of planes that are turned is used again at once.
    planes: Vec<Vec<Eight>>,
    /// Rows of a plane.
    each: usize,
    /// Nodes of a row.
    nodes: usize,
}

impl Ruler {
    /// A ruler for a grid whose nodes are some distances apart; all points are at most `beyond` out of it.
    pub(super) fn new(extent: [usize; 3], spacing: [f32; 3], beyond: f32) -> Self {
        let length = |axis: usize| (extent[axis] - 1) as f32 * spacing[axis];
        let longest = length(0).max(length(1)).max(length(2));
        let marks = f32::from(NOWHERE) / (2.0 * (longest + 2.0 * beyond));
        Self { step: spacing.map(|step| step * marks), start: beyond * marks, marks }
    }

    /// The mark next to a place.
    pub(super) fn read(&self, place: f32) -> u16 {
        (place * self.marks + (self.start + 0.5)) as u16
    }

    /// Where a node lies along an axis.
    pub(super) fn node(&self, axis: usize, node: usize) -> f32 {
        node as f32 * self.step[axis] + self.start
    }

    /// Where eight nodes lie along an axis.
    #[inline(always)]
    pub(super) fn nodes(&self, axis: usize, first: usize) -> f32x8 {
        (EIGHT + first as f32) * self.step[axis] + self.start
    }
}

/// The first eight numbers.
const EIGHT: f32x8 = f32x8::new([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);

/// The neighbours of eight nodes on the left, among the eight before and these, and on the right, among these and the next.
const LEFT: [u16; LANES] = [7, 8, 9, 10, 11, 12, 13, 14];
const RIGHT: [u16; LANES] = [1, 2, 3, 4, 5, 6, 7, 8];

/// Numbers to compute with.
#[inline(always)]
fn wide(numbers: u16x8) -> f32x8 {
    f32x8::from_i32x8(i32x8::from_u16x8(numbers))
}

impl Eight {
    /// Nodes without closest points.
    pub(super) const NONE: Self = Self { points: [[NOWHERE; LANES]; 3], triangles: [NONE; LANES] };

    /// The points along an axis.
    #[inline(always)]
    pub(super) fn along(&self, axis: usize) -> f32x8 {
        wide(u16x8::new(self.points[axis]))
    }

    /// The points of the left neighbours, of these nodes, and of the right neighbours along an axis, given the nodes before
    /// and after these.
    #[inline(always)]
    pub(super) fn between(&self, before: &Self, after: &Self, axis: usize) -> [f32x8; 3] {
        let at = |eight: &Self| u16x8::new(eight.points[axis]);
        let left = [at(before), at(self)].shuffle(LEFT.into());
        let right = [at(self), at(after)].shuffle(RIGHT.into());
        [wide(left), self.along(axis), wide(right)]
    }

    /// The points.
    #[inline(always)]
    pub(super) fn all(&self) -> Points {
        [self.along(0), self.along(1), self.along(2)]
    }

    /// These nodes' neighbours on the left, given the nodes before.
    #[inline(always)]
    pub(super) fn after(&self, before: &Self) -> Self {
        Self::joined(before, self, LEFT)
    }

    /// The right neighbours of the nodes before these, given those nodes.
    #[inline(always)]
    pub(super) fn before(&self, nodes: &Self) -> Self {
        Self::joined(nodes, self, RIGHT)
    }

    /// Eight of sixteen nodes.
    #[inline(always)]
    fn joined(these: &Self, those: &Self, which: [u16; LANES]) -> Self {
        let points = |axis: usize| {
            [u16x8::new(these.points[axis]), u16x8::new(those.points[axis])].shuffle(which.into()).to_array()
        };
        let triangles = [u32x8::new(these.triangles), u32x8::new(those.triangles)];
        Self {
            points: [points(0), points(1), points(2)],
            triangles: triangles.shuffle(u16x8::new(which).into()).to_array(),
        }
    }
}

impl Rows {
    /// Planes of `each` rows of nodes without closest points.
    pub(super) fn new(planes: usize, each: usize, nodes: usize) -> Self {
        let planes = (0..planes).into_par_iter().map(|_| vec![Eight::NONE; each * width(nodes)]).collect();
        Self { planes, each, nodes }
    }

    /// Row by number, plane by plane.
    pub(super) fn row(&self, row: usize) -> &[Eight] {
        let width = width(self.nodes);
        &self.planes[row / self.each][row % self.each * width..][..width]
    }

    /// All planes, `count` at a time.
    pub(super) fn chunks_mut(&mut self, count: usize) -> rayon::slice::ChunksMut<'_, Vec<Eight>> {
        self.planes.par_chunks_mut(count)
    }

    /// All rows.
    pub(super) fn all_mut(&mut self) -> impl Iterator<Item = &mut [Eight]> {
        let width = width(self.nodes);
        self.planes.iter_mut().flat_map(move |plane| plane.chunks_exact_mut(width))
    }

    /// Nodes that have a closest point.
    pub(super) fn taken(&self) -> usize {
        let taken = |eight: &Eight| eight.triangles.iter().filter(|&&triangle| triangle != NONE).count();
        self.planes.par_iter().map(|plane| plane.iter().map(taken).sum::<usize>()).sum()
    }

    /// The same nodes with rows along the second axis.
    pub(super) fn turned(self) -> Self {
        let (each, nodes) = (self.nodes, self.each);
        let planes = self.planes.into_par_iter().map(|plane| turned(&plane, each, nodes)).collect();
        Self { planes, each, nodes }
    }
}

/// Vectors of a row.
pub(super) fn width(nodes: usize) -> usize {
    nodes.div_ceil(LANES)
}

/// A plane of `nodes` rows of `rows` nodes as one of `rows` rows.
fn turned(before: &[Eight], rows: usize, nodes: usize) -> Vec<Eight> {
    let (from, to) = (width(rows), width(nodes));
    let mut turned = vec![Eight::NONE; rows * to];
    for first in (0..rows).step_by(LANES) {
        for (at, lane) in (0..nodes).map(|node| (node / LANES, node % LANES)) {
            let source = &before[(at * LANES + lane) * from + first / LANES];
            for place in first..rows.min(first + LANES) {
                let target = &mut turned[place * to + at];
                for axis in 0..3 {
                    target.points[axis][lane] = source.points[axis][place - first];
                }
                target.triangles[lane] = source.triangles[place - first];
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

/// Where eight nodes lie, from node `first` on, `step` apart along a row.
#[inline(always)]
pub(super) fn nodes(first: usize, step: f32, others: [f32; 2]) -> Points {
    [(EIGHT + first as f32) * step, f32x8::splat(others[0]), f32x8::splat(others[1])]
}

/// Squared distances.
#[inline(always)]
pub(super) fn squared(a: &Points, b: &Points) -> f32x8 {
    let offset = minus(a, b);
    dot(&offset, &offset)
}
