//! Inverted faces are turned back.
//!
//! Attraction alone folds a mesh where the surface is curved within an edge, or where neighbours find different sheets.
//! Around the folds, vertices are moved one by one along the surface to wherever the corners of their faces are best, by a
//! pattern search that only ever accepts what is better; so a fold never grows, and what is sound stays sound. Where the
//! surface is bent within a face that may not do, and vertices may leave the surface a little.

use rayon::prelude::*;

use super::cluster::{self, Cluster};
use super::ease::{SOUND, eased, less_folded};
use super::goal::Goal;
use super::level::{Level, Space};
use super::patient::{HELD, LEAST_CORNER, LET_GO, Manner};
use super::quality::{self, Inverted};

/// Attempts on the surface, each by the rings of faces around the folds that take part, and sweeps over them.
const ATTEMPTS: [(usize, usize); 3] = [(0, 10), (1, 20), (3, 40)];
/// Rings that are eased away from it for the folds that are left, one attempt after the other.
const EASED: [usize; 4] = [1, 2, 3, 5];
/// Attempts after that, on the surface or off it.
const LOOSE: [(usize, usize); 3] = [(1, 30), (3, 40), (5, 60)];
/// After wrapping, a cluster of more faces than this is no fold, but a part that has found the wrong sheet of the surface: it
/// may come to be placed another way.
pub(super) const LARGEST: usize = 500;
/// Attempts on what is left in the end.
const STUBBORN: [(usize, usize, Manner); 5] = [
    (1, 60, Manner { fair: 0.1, leash: 1.0, ..LET_GO }),
    (2, 60, Manner { fair: 0.1, leash: 1.0, ..LET_GO }),
    (3, 60, Manner { fair: 0.2, leash: 1.0, ..LET_GO }),
    (1, 60, Manner { fair: 0.05, leash: 2.0, ..LET_GO }),
    (2, 100, Manner { fair: 0.05, leash: 2.0, ..LET_GO }),
];

/// Turns faces back where possible; counts of inverted faces before and after.
///
/// Clusters of folds, of `most` faces at most, are mended in parallel, each by itself, so that the result does not depend
/// on threads.
/// Cost: two passes over the mesh, and about 10 µs a sweep for each vertex around a fold.
pub(super) fn repair(level: &mut Level, space: &Space, goal: &Goal, most: usize) -> [Inverted; 2] {
    let (bad, before) = quality::inverted(level, space, goal, LEAST_CORNER);
    if bad.is_empty() {
        return [before; 2];
    }
    Mending { level, space, goal, most }.all(bad);
    [before, quality::inverted(level, space, goal, SOUND).1]
}

/// Turns the faces back that [`repair`] has left, and those that became so since, however many hang together. Then vertices
/// go farther, off the surface too, and care for nothing but these faces.
///
/// Cost: two passes over the mesh, and about 1 ms a fold; more where many hang together.
pub(super) fn untangle(level: &mut Level, space: &Space, goal: &Goal) {
    let bad = quality::inverted(level, space, goal, SOUND).0;
    let mut mending = Mending { level, space, goal, most: usize::MAX };
    let left = mending.all(bad);
    STUBBORN.into_iter().fold(left, |bad, attempt| mending.loosened(&bad, attempt));
}

/// A mesh with folds.
struct Mending<'a> {
    level: &'a mut Level,
    space: &'a Space<'a>,
    goal: &'a Goal<'a>,
    /// Faces of the clusters that are worked on, at most.
    most: usize,
}

impl Mending<'_> {
    /// Mends what it can around bad faces; those that are left.
    fn all(&mut self, mut bad: Vec<u32>) -> Vec<u32> {
        let (space, goal) = (self.space, self.goal);
        for (rings, sweeps) in ATTEMPTS {
            let tried = self.mend(&bad, rings, |cluster| HELD.mended(cluster, space, goal, sweeps));
            bad = quality::bad_of(self.level, space, goal, &tried, LEAST_CORNER);
        }
        bad = quality::bad_of(self.level, space, goal, &bad, SOUND);
        for rings in EASED {
            let tried = self.mend(&bad, rings, |cluster| eased(cluster, space, goal));
            bad = quality::bad_of(self.level, space, goal, &tried, SOUND);
        }
        LOOSE.into_iter().fold(bad, |bad, (rings, sweeps)| self.loosened(&bad, (rings, sweeps, LET_GO)))
    }

    /// Mends the clusters around bad faces off the surface, where that leaves fewer folds; the faces that are bad still.
    fn loosened(&mut self, bad: &[u32], (rings, sweeps, manner): (usize, usize, Manner)) -> Vec<u32> {
        let (space, goal) = (self.space, self.goal);
        let mended = |cluster| manner.mended(cluster, space, goal, sweeps);
        let tried = self.mend(bad, rings, |cluster| less_folded(cluster, space, goal, mended));
        quality::bad_of(self.level, space, goal, &tried, SOUND)
    }

    /// Mends the clusters around bad faces, all at once; their faces.
    fn mend(
        &mut self,
        bad: &[u32],
        rings: usize,
        mended: impl Fn(Cluster) -> Cluster + Sync + Send,
    ) -> Vec<u32> {
        if bad.is_empty() {
            return Vec::new();
        }
        let bounded = |cluster: Cluster| match cluster.numbers.len() <= self.most {
            true => mended(cluster),
            false => cluster,
        };
        let clusters = cluster::around(self.level, bad, rings);
        let clusters: Vec<Cluster> = clusters.into_par_iter().map(bounded).collect();
        for cluster in &clusters {
            for (&vertex, &place) in cluster.vertices[..cluster.movable].iter().zip(&cluster.positions) {
                self.level.positions[vertex as usize] = place;
            }
        }
        clusters.into_iter().flat_map(|cluster| cluster.numbers).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Grid, ScalarField};
    use crate::mesh::{Faces, Point, PolygonMesh};
    use crate::wrap::goal::Target;
    use crate::wrap::{WrapOptions, tests::cubes, wrap};

    #[test]
    fn tangles_are_undone_and_the_rest_stays() {
        let middle = Point::splat(16.0);
        let field = ScalarField::from_function(Grid::unit([33; 3]), |point| point.distance(middle) - 11.0);
        let surface = wrap(&cubes(&field, 8), &field, &WrapOptions::default()).unwrap().surface;
        let space = Space::new(&field);
        let mut level = Level::base(&surface.level(3), &space.border).unwrap();
        // Every vertex in a cap changes places with the one opposite to it.
        let cap: Vec<usize> =
            (0..level.positions.len()).filter(|&vertex| level.positions[vertex].z > 26.0).collect();
        for &vertex in &cap {
            level.positions[vertex] =
                Point::new(32.0, 32.0, 0.0) + level.positions[vertex] * Point::new(-1.0, -1.0, 1.0);
        }
        let kept = level.positions.clone();
        let [before, after] = repair(&mut level, &space, &Goal::new(Target::Distance), usize::MAX);
        assert!(before.corners > 10, "{before:?}");
        assert!(after.corners < before.corners, "{after:?}");
        assert!(level.positions.iter().all(|place| (place.distance(middle) - 11.0).abs() < 0.15));
        let unmoved = kept.iter().zip(&level.positions).filter(|(old, new)| old == new).count();
        assert!(unmoved > kept.len() / 2);
    }

    #[test]
    fn vertices_on_edges_of_the_box_move_along_them() {
        // A plane across the box, with a vertex on an edge of it beyond the next one of the boundary.
        let field = ScalarField::from_function(Grid::unit([9; 3]), |point| point.z - 4.3);
        let corner = |x: u32, y: u32| x + 5 * y;
        let positions = (0..25).map(|at| Point::new(f64::from(at % 5) * 2.0, f64::from(at / 5) * 2.0, 4.3));
        let quads = (0..16)
            .map(|at| (at % 4, at / 4))
            .map(|(x, y)| [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)]);
        let faces: Faces = quads.collect::<Vec<_>>().iter().map(<[u32; 4]>::as_slice).collect();
        let mesh = PolygonMesh::new(positions.collect(), faces);
        let (space, goal) = (Space::new(&field), Goal::new(Target::Distance));
        let mut level = Level::base(&mesh, &space.border).unwrap();
        level.positions[0].z = 8.0;
        level.positions[1].z = 1.0;
        level.positions[5].z = 1.0;
        untangle(&mut level, &space, &goal);
        assert_eq!(quality::inverted(&level, &space, &goal, SOUND).1, Inverted::default());
        assert_eq!((level.positions[0].x, level.positions[0].y), (0.0, 0.0));
    }
}
