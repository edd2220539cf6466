//! Vertices around folds look for better places.

use super::cluster::Cluster;
use super::ease::FARTHEST;
use super::goal::Goal;
use super::level::Space;
use super::quality;
use crate::mesh::Point;

/// Corners below this are worked on: the sine of an angle that could as well be none.
pub(super) const LEAST_CORNER: f64 = 0.02;
/// Directions that a vertex tries.
const DIRECTIONS: usize = 8;
/// Shortest step tried, in lengths of leashes.
const SHORTEST_STEP: f64 = 0.02;
/// How far from the surface a vertex that is held to it may go, in cells, if it is not farther already.
const NEAR: f64 = 0.1;

/// How vertices look for better places.
#[derive(Clone, Copy, Debug)]
pub(super) struct Manner {
    /// Whether they may leave the surface.
    pub(super) loose: bool,
    /// Corners below this cost, so that mending one does not strain the next: the sine of an angle.
    pub(super) fair: f64,
    /// How far a vertex may go from where it was, in lengths of its edges. Without a leash, vertices go on and on, since the
    /// shapes of corners do not tell sizes.
    pub(super) leash: f64,
}

/// On the surface.
pub(super) const HELD: Manner = Manner { loose: false, fair: 0.5, leash: 0.5 };
/// On the surface or off it.
pub(super) const LET_GO: Manner = Manner { loose: true, ..HELD };

impl Manner {
    /// Sweeps over the vertices of a cluster that may move, at most so often, until its corners are sound.
    pub(super) fn mended(self, cluster: Cluster, space: &Space, goal: &Goal, sweeps: usize) -> Cluster {
        Patient::new(cluster, space, goal, self).mended(sweeps)
    }
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
    manner: Manner,
}

impl<'a> Patient<'a> {
    fn new(cluster: Cluster, space: &'a Space<'a>, goal: &'a Goal<'a>, manner: Manner) -> Self {
        let leash = |vertex| (cluster.positions[vertex], manner.leash * cluster.edge_length(vertex));
        let leashes: Vec<_> = (0..cluster.movable).map(leash).collect();
        let places = cluster.positions.iter().zip(&cluster.normals);
        let outwards = places.map(|(&place, &normal)| goal.outwards(place, normal, space)).collect();
        let steps = leashes.iter().map(|&(_, length)| length).collect();
        Self { cluster, space, goal, outwards, leashes, steps, manner }
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
        !self.manner.loose
            || (self.cluster.neighbours[vertex].len() == 2 && self.cluster.sides[vertex].count() == 0)
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
                quality::shortfall(face, &self.cluster.positions, self.outwards_of(face), self.manner.fair)
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
        if self.manner.loose && off > FARTHEST {
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
            if self.manner.loose {
                places.extend([place + step * normal, place - step * normal]);
            }
        }
        places
    }
}
