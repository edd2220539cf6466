//! Components that wrapping does not fit, or the parts of them that it misses or folds, are placed by way of the collapses,
//! where that is better.
//!
//! Wrapping spreads vertices more evenly, which makes short files. So where all but a horn or the tip of an ear fits, only
//! what is around that is placed.

use super::care::grow;
use super::fit::{Aim, MISSED, Measured, NONE, RMS};
use crate::mesh::{Point, PolygonMesh, Sets};
use crate::simplify::History;
use crate::wrap::{Settling, Wrapped};

/// A component is placed if that leaves less than this of what distances are too large by, …
const WORTH: f64 = 0.7;
/// … and a part of it if less than this.
const WORTH_IN_PART: f64 = 0.9;
/// A part is what is farther than this from the target, in cells' edges, or folded, …
const FAR: f64 = 0.5;
/// … and so many rings of faces around it.
const RINGS: usize = 8;

/// A component of which more than this share would be placed is placed as a whole.
const LARGEST: f64 = 0.25;

/// The parts of a surface that do not fit.
pub(super) struct Misfits {
    /// The part that each vertex belongs to; [`NONE`] if it fits.
    parts: Vec<u32>,
    /// Bounds on root mean squares and on all distances, in cells' edges.
    limits: [f64; 2],
    /// How bad each part is.
    before: Vec<Badness>,
    /// What must be left of that for placing it to be worth it.
    worth: Vec<f64>,
}

/// What is wrong with a part.
#[derive(Clone, Copy, Debug)]
struct Badness {
    /// By how many times it is too far off.
    excess: f64,
    /// Faces that are turned over.
    folds: usize,
}

impl Misfits {
    /// Looks for them, by distances in units of so many cells' edges; none if all of the surface fits.
    pub(super) fn new(
        aim: &Aim,
        surface: &PolygonMesh,
        history: &History,
        measured: &Measured,
        unit: f64,
        folds: &[u32],
    ) -> Option<Self> {
        let limits = [RMS, MISSED].map(|limit| limit * unit);
        let ones = aim.components_of(surface, history);
        let count = aim.components.len();
        let mut excesses = Aim::excesses([&ones, &aim.components], count, measured, limits);
        for &face in folds {
            let one = ones[surface.faces().get(face as usize)[0] as usize] as usize;
            excesses[one] = f64::INFINITY;
        }
        if !ones.iter().any(|&one| excesses[one as usize] > 1.0) {
            return None;
        }
        let bad = around_bad(surface, measured, FAR * unit, folds);
        let rest = |(&one, &vertex): (&u32, &u32)| if bad[vertex as usize] { NONE } else { one };
        let vertices: Vec<u32> = (0..ones.len() as u32).collect();
        let rests = [(&ones, &vertices), (&aim.components, &measured.nearest)]
            .map(|(ones, vertices)| ones.iter().zip(vertices).map(rest).collect::<Vec<u32>>());
        let rests = Aim::excesses(rests.each_ref().map(Vec::as_slice), count, measured, limits);
        let mut sizes = vec![[0_usize; 2]; count];
        for (&one, &bad) in ones.iter().zip(&bad) {
            sizes[one as usize][usize::from(bad)] += 1;
        }
        let in_part = |one: u32| {
            let [good, bad] = sizes[one as usize];
            rests[one as usize] <= 1.0 && bad as f64 <= LARGEST * (good + bad) as f64
        };
        let is_misfit = |(&one, bad): (&u32, bool)| excesses[one as usize] > 1.0 && (bad || !in_part(one));
        let misfits: Vec<bool> = ones.iter().zip(bad).map(is_misfit).collect();
        let (parts, firsts) = connected(surface, &misfits);
        let worth = |&first: &u32| if in_part(ones[first as usize]) { WORTH_IN_PART } else { WORTH };
        let worth = firsts.iter().map(worth).collect();
        let mut found = Self { parts, limits, before: Vec::new(), worth };
        found.before = found.badness(surface, measured, folds);
        Some(found)
    }

    /// Puts those that become better where `places` say; the measures of what comes of it.
    pub(super) fn placed(
        &self,
        aim: &Aim,
        wrapped: &mut Wrapped,
        settling: &mut Settling,
        places: &[Point],
        measured: Measured,
    ) -> Measured {
        let mut surface = wrapped.surface.level(wrapped.surface.levels);
        let misfits: Vec<bool> = self.parts.iter().map(|&part| part != NONE).collect();
        let settled = settling.settled(&wrapped.surface.positions, places, &misfits);
        surface.positions.copy_from_slice(settled);
        let settled = aim.measure(&surface);
        let after = self.badness(&surface, &settled, &settling.folds());
        let is_better = |part: u32| {
            let (after, before) = (after[part as usize], self.before[part as usize]);
            after.is_better(before, self.worth[part as usize])
        };
        let better: Vec<bool> = self.parts.iter().map(|&part| part != NONE && is_better(part)).collect();
        if !better.contains(&true) {
            return measured;
        }
        settling.finish(wrapped, &better);
        if better == misfits {
            return settled;
        }
        surface.positions.copy_from_slice(&wrapped.surface.positions);
        aim.measure(&surface)
    }

    /// How bad each part of a surface is.
    fn badness(&self, surface: &PolygonMesh, measured: &Measured, folds: &[u32]) -> Vec<Badness> {
        let of_target: Vec<u32> =
            measured.nearest.iter().map(|&vertex| self.parts[vertex as usize]).collect();
        let excesses = Aim::excesses([&self.parts, &of_target], self.worth.len(), measured, self.limits);
        let mut all: Vec<Badness> = excesses.into_iter().map(|excess| Badness { excess, folds: 0 }).collect();
        for &face in folds {
            let part =
                surface.faces().get(face as usize).iter().map(|&corner| self.parts[corner as usize]).min();
            if let Some(bad) = part.and_then(|part| all.get_mut(part as usize)) {
                bad.folds += 1;
            }
        }
        all
    }
}

impl Badness {
    /// Whether this is better than what was before: nearer, by so much that it is worth it, or with fewer folds and no farther
    /// off. Folds that are left are undone in the end.
    fn is_better(self, before: Self, worth: f64) -> bool {
        let is_nearer = self.excess < worth * before.excess;
        is_nearer || (self.folds < before.folds && self.excess <= before.excess)
    }
}

/// Which vertices of a surface are farther than `limit` from the target, or next to what of that is so far from it, or
/// corners of a folded face, or some rings of faces around those.
fn around_bad(surface: &PolygonMesh, measured: &Measured, limit: f64, folds: &[u32]) -> Vec<bool> {
    let of_vertices = measured.of_surface.iter().take(surface.positions.len());
    let mut marked: Vec<bool> = of_vertices.map(|&distance| distance > limit).collect();
    for (&vertex, &distance) in measured.nearest.iter().zip(&measured.of_target) {
        marked[vertex as usize] |= distance > limit;
    }
    for &face in folds {
        surface.faces().get(face as usize).iter().for_each(|&corner| marked[corner as usize] = true);
    }
    (0..RINGS).for_each(|_| grow(surface.faces().iter(), &mut marked));
    marked
}

/// Numbers the parts that marked vertices make up, which hang together by faces; and the first vertex of each.
fn connected(surface: &PolygonMesh, marked: &[bool]) -> (Vec<u32>, Vec<u32>) {
    let mut sets = Sets::new(marked.len());
    for face in surface.faces().iter() {
        let mut corners = face.iter().copied().filter(|&corner| marked[corner as usize]);
        if let Some(first) = corners.next() {
            corners.for_each(|corner| sets.join(first, corner));
        }
    }
    let (mut parts, mut firsts) = (vec![NONE; marked.len()], Vec::new());
    for vertex in (0..marked.len() as u32).filter(|&vertex| marked[vertex as usize]) {
        let root = sets.root(vertex) as usize;
        if parts[root] == NONE {
            parts[root] = firsts.len() as u32;
            firsts.push(vertex);
        }
        parts[vertex as usize] = parts[root];
    }
    (parts, firsts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Faces;

    #[test]
    fn parts_hang_together_by_faces_and_are_named_by_their_first_vertices() {
        // A strip of quads, of which two vertices at one end and three at the other are marked.
        let quads = (0..5).map(|at| [at, at + 1, at + 7, at + 6]);
        let faces: Faces = quads.collect::<Vec<_>>().iter().map(<[u32; 4]>::as_slice).collect();
        let strip = PolygonMesh::new(vec![Point::ZERO; 12], faces);
        let marked = [0, 6, 4, 5, 11];
        let marked: Vec<bool> = (0..12).map(|vertex| marked.contains(&vertex)).collect();
        let (parts, firsts) = connected(&strip, &marked);
        assert_eq!(firsts, [0, 4]);
        assert_eq!([parts[0], parts[6], parts[4], parts[5], parts[11]], [0, 0, 1, 1, 1]);
        assert_eq!(parts.iter().filter(|&&part| part == NONE).count(), 7);
    }

    #[test]
    fn folds_are_not_mended_at_the_price_of_distance() {
        let bad = |excess, folds| Badness { excess, folds };
        assert!(bad(1.5, 0).is_better(bad(2.0, 0), WORTH_IN_PART));
        assert!(!bad(1.5, 0).is_better(bad(2.0, 0), WORTH));
        assert!(bad(2.0, 3).is_better(bad(2.0, 4), WORTH));
        assert!(!bad(2.1, 3).is_better(bad(2.0, 4), WORTH));
    }
}
