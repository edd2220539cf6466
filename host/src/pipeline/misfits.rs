//! Components that wrapping does not fit, or the parts of them that it misses or folds, are placed by way of the collapses,
//! where that is better.
//!
//! Wrapping spreads vertices more evenly, which makes short files. So where all but a horn or the tip of an ear fits, only
//! what is around that is placed; and so it is where it is not worth it to place a component as a whole.

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
    /// Whether one of them is a whole component.
    pub(super) has_whole: bool,
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
    /// Looks for them, by distances in units of so many cells' edges; none if all of the surface fits. Components that are
    /// bad all over are one part each if `whole`, and else what is bad of them.
    pub(super) fn new(
        aim: &Aim,
        wrapped: &Wrapped,
        history: &History,
        measured: &Measured,
        unit: f64,
        whole: bool,
    ) -> Option<Self> {
        let (surface, folds) = (&wrapped.surface.level(wrapped.surface.levels), &wrapped.report.folds);
        let limits = [RMS, MISSED].map(|limit| limit * unit);
        let components = aim.components_of(surface, history);
        let mut excesses =
            Aim::excesses([&components, &aim.components], aim.component_count, measured, limits);
        for &face in folds {
            let corner = surface.faces().get(face as usize)[0];
            excesses[components[corner as usize] as usize] = f64::INFINITY;
        }
        let fits = |component: u32| excesses[component as usize] <= 1.0;
        if components.iter().all(|&component| fits(component)) {
            return None;
        }
        let bad = around_bad(surface, measured, FAR * unit, folds);
        let in_part = match whole {
            true => fit_but_for(&bad, aim, &components, measured, limits),
            false => vec![true; aim.component_count],
        };
        let is_misfit =
            |(&component, bad): (&u32, bool)| !fits(component) && (bad || !in_part[component as usize]);
        let misfits: Vec<bool> = components.iter().zip(bad).map(is_misfit).collect();
        let (parts, firsts) = connected(surface, &misfits);
        if firsts.is_empty() {
            return None;
        }
        let worth = |&first: &u32| match in_part[components[first as usize] as usize] {
            true => WORTH_IN_PART,
            false => WORTH,
        };
        let worth: Vec<f64> = firsts.iter().map(worth).collect();
        let has_whole = worth.contains(&WORTH);
        let mut found = Self { parts, limits, before: Vec::new(), worth, has_whole };
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

/// Which components fit but for what is bad, and that is not too large a part of them. `components` are those of the
/// vertices of the surface.
fn fit_but_for(
    bad: &[bool],
    aim: &Aim,
    components: &[u32],
    measured: &Measured,
    limits: [f64; 2],
) -> Vec<bool> {
    let good = |component: u32, vertex: usize| if bad[vertex] { NONE } else { component };
    let of_surface: Vec<u32> =
        components.iter().enumerate().map(|(vertex, &component)| good(component, vertex)).collect();
    let of_target = aim.components.iter().zip(&measured.nearest);
    let of_target: Vec<u32> =
        of_target.map(|(&component, &vertex)| good(component, vertex as usize)).collect();
    let excesses = Aim::excesses([&of_surface, &of_target], aim.component_count, measured, limits);
    let mut counts = vec![[0_usize; 2]; aim.component_count];
    for (&component, &bad) in components.iter().zip(bad) {
        let [all, some] = &mut counts[component as usize];
        (*all, *some) = (*all + 1, *some + usize::from(bad));
    }
    let is_small = |[all, some]: [usize; 2]| some as f64 <= LARGEST * all as f64;
    excesses.into_iter().zip(counts).map(|(excess, counts)| excess <= 1.0 && is_small(counts)).collect()
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
