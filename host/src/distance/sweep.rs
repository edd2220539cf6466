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
use super::rows::{Row, load, nodes, points, squared, store};

/// Planes of rows, and where they lie.
pub(super) struct Planes<'a> {
    /// The rows of each plane.
    pub(super) rows: Vec<Vec<&'a mut [f32]>>,
    /// Distance between the nodes of a row.
    pub(super) step: f32,
    /// Distance between planes, and between the rows of a plane.
    pub(super) apart: [f32; 2],
    /// Which of these is the second axis of points: 0 if that is the one from plane to plane.
    pub(super) second: usize,
    /// Points farther away than this, squared, are not taken.
    pub(super) reach: f32,
}

impl<'a> Planes<'a> {
    /// Puts rows into planes: row n belongs to plane n mod `count`, if `cyclic`, else `count` planes follow each other.
    pub(super) fn arrange(
        rows: impl Iterator<Item = &'a mut [f32]>,
        count: usize,
        cyclic: bool,
    ) -> Vec<Vec<&'a mut [f32]>> {
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
        let (apart, second, reach, step) = (self.apart, self.second, self.reach, self.step);
        rows.map(|(number, row)| {
            let near = [number.saturating_sub(1), number, (number + 1).min(last)];
            let mut others = [plane as f32 * apart[0], number as f32 * apart[1]];
            if second == 1 {
                others.reverse();
            }
            take(row, near.map(|near| Row(theirs[near])), Place { step, others, reach })
        })
        .sum()
    }
}

/// Numbers of the nine nodes that a node looks at, and of itself.
const PLACES: [[f32x8; 3]; 3] = [
    [f32x8::splat(0.0), f32x8::splat(1.0), f32x8::splat(2.0)],
    [f32x8::splat(3.0), f32x8::splat(4.0), f32x8::splat(5.0)],
    [f32x8::splat(6.0), f32x8::splat(7.0), f32x8::splat(8.0)],
];
const OWN: f32x8 = f32x8::splat(9.0);

/// Where a row lies.
#[derive(Clone, Copy)]
struct Place {
    step: f32,
    others: [f32; 2],
    reach: f32,
}

/// The nodes of a row look at those of three others. Returns how many took another point.
///
/// In most sweeps most nodes take none, so that distances alone are looked at first.
fn take(row: &mut [f32], from: [Row<'_>; 3], place: Place) -> u64 {
    let mut taken = 0;
    for first in (0..row.len() / 4 - LANES).step_by(LANES) {
        let nodes = nodes(first, place.step, place.others);
        let own = Row(row).window(first);
        let before = squared(&nodes, &points(own, 1)).fast_min(f32x8::splat(place.reach));
        let windows = [from[0].window(first), from[1].window(first), from[2].window(first)];
        let (mut least, mut which) = (before, OWN);
        for (window, places) in windows.into_iter().zip(PLACES) {
            for (shift, place) in places.into_iter().enumerate() {
                let offered = squared(&nodes, &points(window, shift));
                let nearer = offered.simd_lt(least);
                least = nearer.select(offered, least);
                which = nearer.select(place, which);
            }
        }
        let nearer = which.simd_ne(OWN).to_bitmask();
        if nearer == 0 {
            continue;
        }
        taken += u64::from(nearer.count_ones());
        let (mut nearest, mut triangles) = (points(own, 1), load(own[3], 1));
        for (window, places) in windows.into_iter().zip(PLACES) {
            for (shift, place) in places.into_iter().enumerate() {
                let here = which.simd_eq(place);
                let theirs = points(window, shift);
                for axis in 0..3 {
                    nearest[axis] = here.select(theirs[axis], nearest[axis]);
                }
                triangles = here.select(load(window[3], shift), triangles);
            }
        }
        store(row, first, &nearest, triangles);
    }
    taken
}
