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

use super::lanes::LANES;
use super::rows::{Eight, Ruler, load};

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
                for near in number.saturating_sub(1)..=(number + 1).min(last) {
                    look.read(near, theirs[near]);
                }
                let lines = [number.saturating_sub(1), number, (number + 1).min(last)];
                look.take(row, lines, [number, plane])
            },
        )
        .sum()
    }
}

/// A row of points that nodes of another row look at, as numbers to compute with; one vector more on either side, for nodes
/// beyond the grid.
#[derive(Debug, Default)]
struct Line {
    /// Which row of its plane, counted from 1.
    number: usize,
    points: [Vec<f32>; 3],
    triangles: Vec<f32>,
    /// How far the points are beside the row of nodes, squared: all nodes that look at a point share this part of their
    /// distance from it.
    beside: Vec<f32>,
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

/// Numbers of eight nodes, and of one on either side.
#[inline(always)]
fn window(numbers: &[f32], at: usize) -> &[f32; LANES + 2] {
    numbers[(at + 1) * LANES - 1..][..LANES + 2].try_into().expect("lines have room on both sides")
}

impl Line {
    /// Reads a row.
    fn read(&mut self, number: usize, row: &[Eight]) {
        self.number = number + 1;
        for axis in 0..3 {
            let points = &mut self.points[axis];
            points.clear();
            for eight in [&Eight::NONE].into_iter().chain(row).chain([&Eight::NONE]) {
                points.extend_from_slice(eight.along(axis).as_array());
            }
        }
        self.triangles.clear();
        for eight in [&Eight::NONE].into_iter().chain(row).chain([&Eight::NONE]) {
            self.triangles.extend_from_slice(eight.bits().as_array());
        }
    }

    /// Sees how far points are beside a row of nodes that lies at some places along two axes.
    fn look_from(&mut self, axes: [usize; 2], places: [f32; 2]) {
        let [first, second] = axes.map(|axis| &self.points[axis][..]);
        self.beside.clear();
        self.beside.extend(first.iter().zip(second).map(|(first, second)| {
            let (first, second) = (first - places[0], second - places[1]);
            first * first + second * second
        }));
    }
}

impl Look {
    /// Reads a row of points, unless it was read before.
    fn read(&mut self, number: usize, row: &[Eight]) {
        let line = &mut self.lines[number % 3];
        if line.number != number + 1 {
            line.read(number, row);
        }
    }

    /// The nodes of a row look at the points of three others. Returns how many took another point.
    ///
    /// In most sweeps most nodes take none, so that distances alone are looked at first.
    fn take(&mut self, row: &mut [Eight], lines: [usize; 3], [number, plane]: [usize; 2]) -> u64 {
        let [along, second, third] = self.axes;
        let places = [self.ruler.node(second, number), self.ruler.node(third, plane)];
        for line in lines {
            self.lines[line % 3].look_from([second, third], places);
        }
        let lines = lines.map(|line| &self.lines[line % 3]);
        let [near, reach] = self.limits;
        let mut taken = 0;
        for (at, eight) in row.iter_mut().enumerate() {
            let nodes = self.ruler.nodes(along, at * LANES);
            let mut least = reach;
            let mut offers = [[reach; 3]; 3];
            for (offers, line) in offers.iter_mut().zip(lines) {
                let (points, beside) = (window(&line.points[along], at), window(&line.beside, at));
                for (shift, offer) in offers.iter_mut().enumerate() {
                    let offset = load(points, shift) - nodes;
                    *offer = offset * offset + load(beside, shift);
                    least = least.fast_min(*offer);
                }
            }
            let offsets = [eight.along(along) - nodes, eight.along(second) - places[0], eight.along(third) - places[1]];
            let own = offsets[0] * offsets[0] + (offsets[1] * offsets[1] + offsets[2] * offsets[2]);
            let nearer = least.simd_lt(own) & own.simd_gt(near) & least.simd_lt(reach);
            let which = nearer.to_bitmask();
            if which != 0 {
                taken += u64::from(which.count_ones());
                choose(eight, nearer, least, (offers, lines), at);
            }
        }
        taken
    }
}

/// Gives some of eight nodes those points whose offers were the least.
#[inline(always)]
fn choose(eight: &mut Eight, nearer: f32x8, least: f32x8, from: ([[f32x8; 3]; 3], [&Line; 3]), at: usize) {
    let (mut points, mut triangles) = (eight.all(), eight.bits());
    let (offers, lines) = from;
    for (offers, line) in offers.into_iter().zip(lines).rev() {
        let windows = [0, 1, 2].map(|axis: usize| window(&line.points[axis], at));
        let theirs = window(&line.triangles, at);
        for (shift, offer) in offers.into_iter().enumerate().rev() {
            let here = nearer & offer.simd_eq(least);
            for axis in 0..3 {
                points[axis] = here.select(load(windows[axis], shift), points[axis]);
            }
            triangles = here.select(load(theirs, shift), triangles);
        }
    }
    eight.set(&points, triangles);
}
