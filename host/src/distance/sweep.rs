//! Closest points go from plane to plane.
//!
//! Sources: Dataflow §3, Distance §4.1 (closest points are handed on to 26 neighbours). There nodes wait in a queue. Here
//! planes of nodes look at the plane before them, from either end of each axis: a node looks at the nine nodes that are
//! nearest in that plane, and takes the nearest of their points and its own. Each of the 26 neighbours is looked at from
//! one side or another, and a way from a node straight to its closest point leads through neighbours of one sweep, the one
//! along the axis on which it is longest. There is no queue to keep, all nodes of a plane are independent, and eight are
//! computed at a time.

use rayon::prelude::*;

use wide::f32x8;

use super::lanes::{LANES, ones};
use super::rows::{Eight, Ruler};

/// Planes of rows, and where they lie.
pub(super) struct Planes<'a> {
    /// The rows of each plane.
    pub(super) rows: Vec<Vec<&'a mut [Eight]>>,
    /// The axes along rows, from row to row, and from plane to plane.
    pub(super) axes: [usize; 3],
    pub(super) ruler: Ruler,
    /// Points farther away than this, squared, are not taken.
    pub(super) reach: f32,
    /// Nearest, squared, that a point may be without being exact: nodes that have nearer ones keep them.
    pub(super) near: f32,
}

impl<'a> Planes<'a> {
    /// Puts rows into planes: row n belongs to plane n mod `count`, if `cyclic`, else `count` planes follow each other.
    pub(super) fn arrange(
        rows: impl Iterator<Item = &'a mut [Eight]>,
        count: usize,
        cyclic: bool,
    ) -> Vec<Vec<&'a mut [Eight]>> {
        let rows: Vec<_> = rows.collect();
        let each = rows.len() / count;
        let mut planes: Vec<Vec<_>> = (0..count).map(|_| Vec::with_capacity(each)).collect();
        for (number, row) in rows.into_iter().enumerate() {
            planes[if cyclic { number % count } else { number / each }].push(row);
        }
        planes
    }

    /// Sweeps there and back. Returns how many nodes took another point.
    pub(super) fn sweep(&mut self) -> u64 {
        let last = self.rows.len() - 1;
        let there: u64 = (1..=last).map(|plane| self.take(plane, plane - 1)).sum();
        let back: u64 = (0..last).rev().map(|plane| self.take(plane, plane + 1)).sum();
        there + back
    }

    /// The nodes of a plane look at those of another.
    fn take(&mut self, plane: usize, from: usize) -> u64 {
        let [mine, theirs] = self.rows.get_disjoint_mut([plane, from]).expect("two planes of many");
        let last = theirs.len() - 1;
        let batch = theirs.len().div_ceil(rayon::current_num_threads());
        let rows = mine.par_iter_mut().enumerate().with_min_len(batch);
        let (ruler, axes, limits) = (self.ruler, self.axes, [self.near, self.reach].map(f32x8::splat));
        rows.map_init(
            || Look { ruler, axes, limits, lines: Default::default() },
            |look, (number, row)| {
                let near = [number.saturating_sub(1), number, (number + 1).min(last)];
                let from = [&*theirs[near[0]], &*theirs[near[1]], &*theirs[near[2]]];
                for (near, from) in near.into_iter().zip(from) {
                    look.read(near, from);
                }
                look.take(row, [number, plane], near, from)
            },
        )
        .sum()
    }
}

/// Eight nodes and the points of their neighbours before, beside and after them in another row.
#[derive(Clone, Copy, Debug, Default)]
struct Three {
    /// Squared distances along the row.
    along: [f32x8; 3],
    /// Places along the other axes.
    second: [f32x8; 3],
    third: [f32x8; 3],
}

/// A row of points that nodes of another row look at.
#[derive(Debug, Default)]
struct Line {
    /// Which row of its plane, counted from 1.
    number: usize,
    threes: Vec<Three>,
}

/// A look from row to row.
#[derive(Debug)]
struct Look {
    ruler: Ruler,
    axes: [usize; 3],
    /// Squared distances between which nodes look for points.
    limits: [f32x8; 2],
    /// The rows last read.
    lines: [Line; 3],
}

/// Which neighbour has the least of nine offers: four times the row, and the place in it.
const WHICH: [[f32x8; 3]; 3] = [
    [f32x8::splat(0.0), f32x8::splat(1.0), f32x8::splat(2.0)],
    [f32x8::splat(4.0), f32x8::splat(5.0), f32x8::splat(6.0)],
    [f32x8::splat(8.0), f32x8::splat(9.0), f32x8::splat(10.0)],
];

impl Look {
    /// Reads a row of points, unless it was read before.
    fn read(&mut self, number: usize, row: &[Eight]) {
        let line = &mut self.lines[number % 3];
        if line.number == number + 1 {
            return;
        }
        line.number = number + 1;
        line.threes.resize(row.len(), Three::default());
        let [along, second, third] = self.axes;
        let mut before = &Eight::NONE;
        for (at, (eight, three)) in row.iter().zip(&mut line.threes).enumerate() {
            let next = row.get(at + 1).unwrap_or(&Eight::NONE);
            let nodes = self.ruler.nodes(along, at * LANES);
            let offsets = eight.between(before, next, along);
            for (square, offset) in three.along.iter_mut().zip(offsets) {
                *square = (offset - nodes) * (offset - nodes);
            }
            three.second = eight.between(before, next, second);
            three.third = eight.between(before, next, third);
            before = eight;
        }
    }

    /// The nodes of a row look at the points of three others. Returns how many took another point.
    ///
    /// In most sweeps most nodes take none, so that distances alone are looked at first.
    fn take(
        &self,
        row: &mut [Eight],
        [number, plane]: [usize; 2],
        near: [usize; 3],
        from: [&[Eight]; 3],
    ) -> u64 {
        let [along, second, third] = self.axes;
        let others = Others {
            second: f32x8::splat(self.ruler.node(second, number)),
            third: f32x8::splat(self.ruler.node(third, plane)),
        };
        let lines = near.map(|near| &self.lines[near % 3].threes[..row.len()]);
        let [exact, reach] = self.limits;
        let mut taken = 0;
        for (at, eight) in row.iter_mut().enumerate() {
            let offset = eight.along(along) - self.ruler.nodes(along, at * LANES);
            let own = offset * offset + others.apart(eight.along(second), eight.along(third));
            let open = own.simd_gt(exact);
            if open.none() {
                continue;
            }
            let offers =
                [lines[0][at].offers(&others), lines[1][at].offers(&others), lines[2][at].offers(&others)];
            let [first, middle, last] = offers.map(|[a, b, c]| a.fast_min(b.fast_min(c)));
            let least = first.fast_min(middle.fast_min(last)).fast_min(reach);
            let nearer = (least.simd_lt(own) & open & least.simd_lt(reach)).to_bitmask();
            if nearer != 0 {
                taken += u64::from(nearer.count_ones());
                choose(eight, nearer, which(&offers, least), (at, from));
            }
        }
        taken
    }
}

/// Places of the nodes of a row along the axes other than its own.
#[derive(Clone, Copy)]
struct Others {
    second: f32x8,
    third: f32x8,
}

impl Others {
    /// Squared distances from points along these axes.
    #[inline(always)]
    fn apart(&self, second: f32x8, third: f32x8) -> f32x8 {
        let (second, third) = (second - self.second, third - self.third);
        second * second + third * third
    }
}

impl Three {
    /// Squared distances of the nodes of a row from the points.
    #[inline(always)]
    fn offers(&self, others: &Others) -> [f32x8; 3] {
        let offer = |n: usize| self.along[n] + others.apart(self.second[n], self.third[n]);
        [offer(0), offer(1), offer(2)]
    }
}

/// Which of nine offers is the least.
#[inline(always)]
fn which(offers: &[[f32x8; 3]; 3], least: f32x8) -> [i32; LANES] {
    let mut which = f32x8::ZERO;
    for (offer, number) in offers.as_flattened().iter().zip(WHICH.as_flattened()) {
        which = offer.simd_eq(least).select(*number, which);
    }
    which.fast_trunc_int().to_array()
}

/// Gives some of eight nodes the points of their neighbours in other rows.
#[inline(always)]
fn choose(eight: &mut Eight, some: u32, which: [i32; LANES], (at, from): (usize, [&[Eight]; 3])) {
    for lane in ones(some) {
        let (row, shift) = (which[lane] as usize / 4, which[lane] as usize % 4);
        let node = (at * LANES + lane + shift).wrapping_sub(1);
        // There are no points beyond the ends of rows.
        if let Some(theirs) = from[row].get(node / LANES) {
            for (points, theirs) in eight.points.iter_mut().zip(&theirs.points) {
                points[lane] = theirs[node % LANES];
            }
            eight.triangles[lane] = theirs.triangles[node % LANES];
        }
    }
}
