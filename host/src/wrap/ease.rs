//! Folds that cannot be undone on the surface are eased away from it.
//!
//! Where an isosurface is bent within a face, there may be no place on it for each vertex that leaves all faces sound. So the
//! mesh lets go of it around a fold: vertices move to the middles of their neighbours, which makes a patch as smooth as its
//! rim, until its faces are sound, and then back towards the surface as far as they stay so.

use super::cluster::Cluster;
use super::goal::Goal;
use super::level::Space;
use super::quality;
use crate::mesh::Point;

/// Corners above this are sound.
pub(super) const SOUND: f64 = 1e-3;
/// Looks at the faces, at most, …
const LOOKS: usize = 60;
/// … with so many sweeps before each.
const SWEEPS: usize = 3;
/// How far each sweep moves a vertex towards the middle of its neighbours.
const RELAXATION: f64 = 0.5;
/// How far from the surface a vertex may go, in cells; what is farther already stays.
pub(super) const FARTHEST: f64 = 0.5;
/// Parts of the way back to the surface that are tried.
const BACK: [f64; 3] = [1.0, 0.5, 0.25];
/// Sweeps back.
const RETURNS: usize = 3;

/// Eases the folds of a cluster; it is left as it was if that helps none.
pub(super) fn eased(cluster: Cluster, space: &Space, goal: &Goal) -> Cluster {
    less_folded(cluster, space, goal, |cluster| Patch::new(cluster, space, goal).relaxed())
}

/// Changes a cluster if that leaves fewer folds, and brings it back to the surface as far as it stays so.
pub(super) fn less_folded(
    cluster: Cluster,
    space: &Space,
    goal: &Goal,
    change: impl FnOnce(Cluster) -> Cluster,
) -> Cluster {
    let before = Patch::new(cluster, space, goal);
    let (folded, positions) = (before.folded(), before.cluster.positions.clone());
    let mut after = Patch::new(change(before.cluster), space, goal);
    if after.folded() < folded {
        (0..RETURNS).for_each(|_| after.go_back());
        after.cluster
    } else {
        Cluster { positions, ..after.cluster }
    }
}

struct Patch<'a> {
    cluster: Cluster,
    space: &'a Space<'a>,
    goal: &'a Goal<'a>,
    /// Which way is out at each vertex.
    outwards: Vec<Point>,
}

impl<'a> Patch<'a> {
    fn new(cluster: Cluster, space: &'a Space<'a>, goal: &'a Goal<'a>) -> Self {
        let mut patch = Self { cluster, space, goal, outwards: Vec::new() };
        patch.look();
        patch
    }

    /// Relaxes the vertices near the surface, off it, to where the fewest folds are left.
    fn relaxed(mut self) -> Cluster {
        let near = |vertex: usize| self.space.distance_in_cells(self.cluster.positions[vertex]) <= FARTHEST;
        let free: Vec<bool> =
            (0..self.cluster.movable).map(|vertex| near(vertex) && self.is_free(vertex)).collect();
        let (mut least, mut best) = (self.folded(), self.cluster.positions.clone());
        for _ in 0..LOOKS {
            (0..SWEEPS).for_each(|_| self.sweep(&free));
            self.look();
            let folded = self.folded();
            if folded < least {
                (least, best) = (folded, self.cluster.positions.clone());
            }
            if folded == 0 {
                break;
            }
        }
        Cluster { positions: best, ..self.cluster }
    }

    fn outwards_at(&self, vertex: usize) -> Point {
        self.goal.outwards(self.cluster.positions[vertex], self.cluster.normals[vertex], self.space)
    }

    /// Looks which way is out everywhere.
    fn look(&mut self) {
        self.outwards = (0..self.cluster.positions.len()).map(|vertex| self.outwards_at(vertex)).collect();
    }

    fn is_folded(&self, face: &[u32]) -> bool {
        let outwards = face.iter().map(|&corner| self.outwards[corner as usize]).sum();
        quality::least_corner(face, &self.cluster.positions, outwards) <= SOUND
    }

    /// How many faces are folded.
    fn folded(&self) -> usize {
        self.cluster.faces.iter().filter(|face| self.is_folded(face)).count()
    }

    /// How many of a vertex' faces are folded.
    fn folded_at(&self, vertex: usize) -> usize {
        let faces = self.cluster.faces_of[vertex].iter().map(|&face| self.cluster.faces.get(face as usize));
        faces.filter(|face| self.is_folded(face)).count()
    }

    /// Whether a vertex may leave the surface: creases stay where they are, but along the border.
    fn is_free(&self, vertex: usize) -> bool {
        match self.cluster.neighbours[vertex].len() {
            0 => false,
            ends => ends > 2 || self.cluster.sides[vertex].count() > 0,
        }
    }

    /// Moves all vertices that are free at once towards the middles of their neighbours.
    fn sweep(&mut self, free: &[bool]) {
        let positions = &self.cluster.positions;
        let moved = |(vertex, &free): (usize, &bool)| {
            let (place, ends) = (positions[vertex], &self.cluster.neighbours[vertex]);
            if !free {
                return place;
            }
            let mean = ends.iter().map(|&end| positions[end as usize]).sum::<Point>() / ends.len() as f64;
            let next = self.space.border.hold(self.cluster.sides[vertex], place.lerp(mean, RELAXATION));
            if self.space.distance_in_cells(next) > FARTHEST { place } else { next }
        };
        let next: Vec<Point> = free.iter().enumerate().map(moved).collect();
        self.cluster.positions[..next.len()].copy_from_slice(&next);
    }

    /// Moves vertices back to the surface, one by one, as far as that folds nothing.
    fn go_back(&mut self) {
        for vertex in 0..self.cluster.movable {
            if !self.is_free(vertex) {
                continue;
            }
            let (place, outwards) = (self.cluster.positions[vertex], self.outwards[vertex]);
            let (sides, folded) = (self.cluster.sides[vertex], self.folded_at(vertex));
            let reach = 2.0 * FARTHEST * self.space.cell;
            let goal = self.goal.approach(place, sides, reach, self.space);
            let is_good = BACK.iter().any(|&part| {
                self.cluster.positions[vertex] = self.space.border.hold(sides, place.lerp(goal, part));
                self.outwards[vertex] = self.outwards_at(vertex);
                self.folded_at(vertex) <= folded
            });
            if !is_good {
                (self.cluster.positions[vertex], self.outwards[vertex]) = (place, outwards);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Grid, ScalarField};
    use crate::wrap::goal::Target;
    use crate::wrap::level::Level;
    use crate::wrap::{WrapOptions, cluster, tests::cubes, wrap};

    #[test]
    fn folds_are_eased_and_the_patch_goes_back_to_the_surface() {
        let middle = Point::splat(16.0);
        let field = ScalarField::from_function(Grid::unit([33; 3]), |point| point.distance(middle) - 11.0);
        let surface = wrap(&cubes(&field, 8), &field, &WrapOptions::default()).unwrap().surface;
        let (space, goal) = (Space::new(&field), Goal::new(Target::Distance));
        let mut level = Level::base(&surface.level(3), &space.border).unwrap();
        let folded = |level: &Level| quality::inverted(level, &space, &goal, SOUND).0;
        assert!(folded(&level).is_empty());
        // A vertex changes places with one across a face.
        let face = level.faces.get(level.faces.len() / 2).to_vec();
        level.positions.swap(face[0] as usize, face[2] as usize);
        let bad = folded(&level);
        assert!(bad.len() > 2, "{bad:?}");
        for cluster in cluster::around(&level, &bad, 1) {
            let eased = eased(cluster, &space, &goal);
            for (&vertex, &place) in eased.vertices[..eased.movable].iter().zip(&eased.positions) {
                level.positions[vertex as usize] = place;
            }
        }
        assert!(folded(&level).is_empty());
        let off = level.positions.iter().map(|&place| space.distance_in_cells(place));
        assert!(off.fold(0.0, f64::max) < 0.01);
    }
}
