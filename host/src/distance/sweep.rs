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
use super::rows::{Row, load, nodes, points, store, window_of};

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
        rows.map_init(Beside::default, |beside, (number, row)| {
            let near = [number.saturating_sub(1), number, (number + 1).min(last)];
            let mut others = [plane as f32 * apart[0], number as f32 * apart[1]];
            if second == 1 {
                others.reverse();
            }
            let from = [Row(theirs[near[0]]), Row(theirs[near[1]]), Row(theirs[near[2]])];
            beside.take(row, from, Place { step, others, reach })
        })
        .sum()
    }
}

/// Where a row lies.
#[derive(Clone, Copy)]
struct Place {
    step: f32,
    others: [f32; 2],
    reach: f32,
}

/// Squares that are computed for a whole row at once.
#[derive(Debug, Default)]
struct Beside {
    /// Distance of each node from its own point.
    own: Vec<f32>,
    /// How far the points of three rows are beside a fourth row: all nodes of that row that look at a point share this part
    /// of their distance from it.
    beside: [Vec<f32>; 3],
}

impl Beside {
    /// The nodes of a row look at those of three others. Returns how many took another point.
    ///
    /// In most sweeps most nodes take none, so that distances alone are looked at first.
    fn take(&mut self, row: &mut [f32], from: [Row<'_>; 3], place: Place) -> u64 {
        Row(row).squares(place.step, place.others, &mut self.own);
        for (beside, from) in self.beside.iter_mut().zip(from) {
            from.beside(place.others, beside);
        }
        let mut taken = 0;
        for first in (0..row.len() / 4 - LANES).step_by(LANES) {
            let nodes = nodes(first, place.step, place.others);
            let windows = [from[0].window(first), from[1].window(first), from[2].window(first)];
            let mut least = f32x8::splat(place.reach);
            let mut offers = [[least; 3]; 3];
            for (offers, (window, beside)) in offers.iter_mut().zip(windows.into_iter().zip(&self.beside)) {
                let beside: &[f32; LANES + 2] = window_of(beside, first);
                for (shift, offer) in offers.iter_mut().enumerate() {
                    let along = load(window[0], shift) - nodes[0];
                    *offer = along * along + load(beside, shift);
                    least = least.fast_min(*offer);
                }
            }
            let nearer = least.simd_lt(load(&self.own, first).fast_min(f32x8::splat(place.reach)));
            let which = nearer.to_bitmask();
            if which == 0 {
                continue;
            }
            taken += u64::from(which.count_ones());
            let own = Row(row).window(first);
            let (mut nearest, mut triangles) = (points(own, 1), load(own[3], 1));
            for (offers, window) in offers.into_iter().zip(windows).rev() {
                for (shift, offer) in offers.into_iter().enumerate().rev() {
                    let here = nearer & offer.simd_eq(least);
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
}
