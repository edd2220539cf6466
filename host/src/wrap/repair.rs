//! Inverted faces are turned back.
//!
//! Attraction alone folds a mesh where the surface is curved within an edge, or where neighbours find different sheets.
//! Around the folds, vertices are moved one by one along the surface to wherever the corners of their faces are best, by a
//! pattern search that only ever accepts what is better; so a fold never grows, and what is sound stays sound. Where the
//! surface is bent within a face that may not do, and vertices may leave the surface a little.

use rayon::prelude::*;

use super::cluster::{self, Cluster};
use super::ease::{FARTHEST, SOUND, eased, less_folded};
use super::goal::Goal;
use super::level::{Level, Space};
use super::quality::{self, Inverted};
use crate::mesh::Point;

/// Corners below this are worked on: the sine of an angle that could as well be none.
const LEAST_CORNER: f64 = 0.02;
/// Corners below this cost, so that mending one does not strain the next.
const FAIR_CORNER: f64 = 0.5;
/// Attempts on the surface, each by the rings of faces around the folds that take part, and sweeps over them.
const ATTEMPTS: [(usize, usize); 3] = [(0, 10), (1, 20), (3, 40)];
/// Rings that are eased away from it for the folds that are left, one attempt after the other.
const EASED: [usize; 4] = [1, 2, 3, 5];
/// Attempts after that, on the surface or off it.
const LOOSE: [(usize, usize); 3] = [(1, 30), (3, 40), (5, 60)];
/// Directions that a vertex tries.
const DIRECTIONS: usize = 8;
/// How far a vertex may go from where it was, in lengths of its edges. Without a leash, vertices go on and on, since the
/// shapes of corners do not tell sizes.
const LEASH: f64 = 0.5;
/// Shortest step tried, in lengths of leashes.
const SHORTEST_STEP: f64 = 0.02;
/// How far from the surface a vertex that is held to it may go, in cells, if it is not farther already.
const NEAR: f64 = 0.1;

/// Turns faces back where possible; counts of inverted faces before and after.
///
/// Clusters of folds are mended in parallel, each by itself, so that the result does not depend on threads.
/// Cost: two passes over the mesh, and about 10 µs a sweep for each vertex around a fold.
pub(super) fn repair(level: &mut Level, space: &Space, goal: &Goal) -> [Inverted; 2] {
    let (mut bad, before) = quality::inverted(level, space, goal, LEAST_CORNER);
    if bad.is_empty() {
        return [before; 2];
    }
    for (rings, sweeps) in ATTEMPTS {
        let tried = mend(level, &bad, rings, |cluster| Patient::new(cluster, space, goal).mended(sweeps));
        bad = quality::bad_of(level, space, goal, &tried, LEAST_CORNER);
    }
    bad = quality::bad_of(level, space, goal, &bad, SOUND);
    for rings in EASED {
        let tried = mend(level, &bad, rings, |cluster| eased(cluster, space, goal));
        bad = quality::bad_of(level, space, goal, &tried, SOUND);
    }
    for (rings, sweeps) in LOOSE {
        let loose = |cluster| Patient::loose(cluster, space, goal).mended(sweeps);
        let tried = mend(level, &bad, rings, |cluster| less_folded(cluster, space, goal, loose));
        bad = quality::bad_of(level, space, goal, &tried, SOUND);
    }
    [before, quality::inverted(level, space, goal, SOUND).1]
}

/// Mends the clusters around bad faces, all at once; their faces.
fn mend(
    level: &mut Level,
    bad: &[u32],
    rings: usize,
    mended: impl Fn(Cluster) -> Cluster + Sync + Send,
) -> Vec<u32> {
    if bad.is_empty() {
        return Vec::new();
    }
    let clusters: Vec<Cluster> = cluster::around(level, bad, rings).into_par_iter().map(mended).collect();
    for cluster in &clusters {
        for (&vertex, &place) in cluster.vertices[..cluster.movable].iter().zip(&cluster.positions) {
            level.positions[vertex as usize] = place;
        }
    }
    clusters.into_iter().flat_map(|cluster| cluster.numbers).collect()
}

/// A cluster under repair.
struct Patient<'a> {
    cluster: Cluster,
    space: &'a Space<'a>,
    goal: &'a Goal<'a>,
    /// Which way is out at each vertex.
    outwards: Vec<Point>,
    /// Where each vertex that may move was, and how far it may go.
    leashes: Vec<(Point, f64)>,
    /// Next step of each vertex that may move, as a length.
    steps: Vec<f64>,
    /// Whether vertices may leave the surface.
    loose: bool,
}

impl<'a> Patient<'a> {
    fn new(cluster: Cluster, space: &'a Space<'a>, goal: &'a Goal<'a>) -> Self {
        let leash = |vertex| (cluster.positions[vertex], LEASH * cluster.edge_length(vertex));
        let leashes: Vec<_> = (0..cluster.movable).map(leash).collect();
        let places = cluster.positions.iter().zip(&cluster.normals);
        let outwards = places.map(|(&place, &normal)| goal.outwards(place, normal, space)).collect();
        let steps = leashes.iter().map(|&(_, length)| length).collect();
        Self { cluster, space, goal, outwards, leashes, steps, loose: false }
    }

    /// With vertices that may leave the surface.
    fn loose(cluster: Cluster, space: &'a Space<'a>, goal: &'a Goal<'a>) -> Self {
        Self { loose: true, ..Self::new(cluster, space, goal) }
    }

    /// Sweeps over the vertices until all corners are sound or nothing moves.
    fn mended(mut self, sweeps: usize) -> Cluster {
        for _ in 0..sweeps {
            let mut moved = false;
            for vertex in 0..self.cluster.movable {
                moved |= self.improve(vertex);
            }
            if !moved || self.is_sound() {
                break;
            }
        }
        self.cluster
    }

    /// Whether a vertex is held to the surface: creases are in any case, but on the border.
    fn is_held(&self, vertex: usize) -> bool {
        !self.loose || (self.cluster.neighbours[vertex].len() == 2 && self.cluster.sides[vertex].count() == 0)
    }

    fn is_sound(&self) -> bool {
        let least = self.cluster.faces.iter().map(|face| self.least_corner(face));
        least.fold(1.0, f64::min) > LEAST_CORNER
    }

    fn least_corner(&self, face: &[u32]) -> f64 {
        quality::least_corner(face, &self.cluster.positions, self.outwards_of(face))
    }

    fn outwards_of(&self, face: &[u32]) -> Point {
        face.iter().map(|&corner| self.outwards[corner as usize]).sum()
    }

    /// What the corners of a vertex' faces lack.
    fn cost(&self, vertex: usize) -> f64 {
        let faces = self.cluster.faces_of[vertex].iter().map(|&face| self.cluster.faces.get(face as usize));
        faces
            .map(|face| {
                quality::shortfall(face, &self.cluster.positions, self.outwards_of(face), FAIR_CORNER)
            })
            .sum()
    }

    /// Moves a vertex to the best of some places around it; whether any is better than where it was, or a shorter step may
    /// find one.
    fn improve(&mut self, vertex: usize) -> bool {
        let ends = &self.cluster.neighbours[vertex];
        let (home, leash) = self.leashes[vertex];
        let step = self.steps[vertex].min(leash);
        let cost = self.cost(vertex);
        if ends.is_empty() || cost == 0.0 || step < SHORTEST_STEP * leash {
            return false;
        }
        let kept = (self.cluster.positions[vertex], self.outwards[vertex]);
        let (held, sides) = (self.is_held(vertex), self.cluster.sides[vertex]);
        let off = self.space.distance_in_cells(kept.0);
        if self.loose && off > FARTHEST {
            return false;
        }
        let near = if held { off.max(NEAR) } else { FARTHEST };
        let (mut best, mut least) = (kept, cost);
        for place in self.candidates(vertex, step) {
            let place = match held {
                true => self.goal.approach(place, sides, leash, self.space),
                false => self.space.border.hold(sides, place),
            };
            let outwards = self.goal.outwards(place, self.cluster.normals[vertex], self.space);
            let strays = home.distance(place) > leash || self.space.distance_in_cells(place) > near;
            if strays || (held && outwards.dot(kept.1) <= 0.0) {
                continue;
            }
            (self.cluster.positions[vertex], self.outwards[vertex]) = (place, outwards);
            let cost = self.cost(vertex);
            if cost < least {
                (best, least) = ((place, outwards), cost);
            }
        }
        (self.cluster.positions[vertex], self.outwards[vertex]) = best;
        self.steps[vertex] = if least < cost { 2.0 * step } else { step / 2.0 };
        true
    }

    /// Places to try: towards the mean of the neighbours and, in the tangent plane, all around.
    fn candidates(&self, vertex: usize, step: f64) -> Vec<Point> {
        let (positions, ends) = (&self.cluster.positions, &self.cluster.neighbours[vertex]);
        let place = positions[vertex];
        let mean = ends.iter().map(|&end| positions[end as usize]).sum::<Point>() / ends.len() as f64;
        let mut places = vec![mean, place.midpoint(mean)];
        if let [before, after] = ends[..] {
            let towards = |end: u32| place + (positions[end as usize] - place).clamp_length_max(step);
            places.extend([towards(before), towards(after)]);
        } else {
            let normal = self.outwards[vertex].try_normalize().unwrap_or(Point::Z);
            let (right, up) = normal.any_orthonormal_pair();
            let angles = (0..DIRECTIONS).map(|turn| turn as f64 * std::f64::consts::TAU / DIRECTIONS as f64);
            places.extend(angles.map(|angle| place + step * (angle.cos() * right + angle.sin() * up)));
            if self.loose {
                places.extend([place + step * normal, place - step * normal]);
            }
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Grid, ScalarField};
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
            (0..level.positions.len()).filter(|&vertex| level.positions[vertex].z > 25.5).collect();
        for &vertex in &cap {
            level.positions[vertex] =
                Point::new(32.0, 32.0, 0.0) + level.positions[vertex] * Point::new(-1.0, -1.0, 1.0);
        }
        let kept = level.positions.clone();
        let [before, after] = repair(&mut level, &space, &Goal::new(Target::Distance));
        assert!(before.corners > 10, "{before:?}");
        assert!(after.corners < before.corners, "{after:?}");
        assert!(level.positions.iter().all(|place| (place.distance(middle) - 11.0).abs() < 0.15));
        let unmoved = kept.iter().zip(&level.positions).filter(|(old, new)| old == new).count();
        assert!(unmoved > kept.len() / 2);
    }
}
