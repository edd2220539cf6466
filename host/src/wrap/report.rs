//! What a surface is like after wrapping.

use rayon::prelude::*;

use super::goal::Goal;
use super::level::{Level, Space};
use super::{Inverted, quality};
use crate::measure::Bounds;
use crate::mesh::Point;

/// A vertex farther than this from its target does not fit, in cells' edges.
pub const UNFIT: f64 = 0.1;
/// A component with a smaller diagonal than this, in cells' edges, is less than what the cells can tell.
pub const SMALL: f64 = 2.0;

/// Distances from the surface, in cells' edges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misfit {
    /// Root of the mean square.
    pub rms: f64,
    /// The largest.
    pub most: f64,
}

/// One level of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelReport {
    /// Number of the level; the base mesh is 0.
    pub level: u32,
    /// Number of vertices.
    pub vertices: usize,
    /// Distances of the vertices, by the distance field.
    pub at_vertices: Misfit,
    /// Distances of the centres of the faces, by the distance field.
    pub at_faces: Misfit,
    /// Vertices that found no surface within reach in the last round, neither along their normals nor on the shortest way.
    pub unsnapped: usize,
    /// Inverted faces after attraction.
    pub inverted_before: Inverted,
    /// Inverted faces after repair.
    pub inverted: Inverted,
    /// Time that the level took.
    pub seconds: f64,
}

/// All levels of a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WrapReport {
    /// The base mesh and each finer level. Where another target than the distance field was asked for, the last level is
    /// told before the correction.
    pub levels: Vec<LevelReport>,
    /// Inverted faces after the correction and the repair that follows it.
    pub inverted: Inverted,
    /// Which faces of the finest mesh have a corner that is turned over, in order.
    pub folds: Vec<u32>,
    /// Time that the correction took.
    pub correction_seconds: f64,
    /// Connected components of the surface.
    pub components: usize,
    /// Those of them that do not fit everywhere.
    pub failures: Vec<Failure>,
}

impl WrapReport {
    /// Takes down what the surface is like in the end.
    pub(super) fn finish(&mut self, level: &Level, space: &Space, goal: &Goal) {
        let (inverted, counts) = quality::inverted(level, space, goal, 0.0);
        self.inverted = counts;
        (self.components, self.failures) = failures(level, space, goal, &inverted);
        self.folds = inverted;
    }
}

/// A component that does not fit everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failure {
    /// Its first vertex in the base mesh.
    pub vertex: u32,
    /// Where that is.
    pub place: Point,
    /// Vertices of the finest mesh that it has.
    pub vertices: usize,
    /// Diagonal of the box around it, in cells' edges.
    pub diagonal: f64,
    /// Vertices farther than [`UNFIT`] from the target.
    pub unfit: usize,
    /// How far the farthest of them is from the target, in cells' edges.
    pub most: f64,
    /// Faces of which a corner is turned over.
    pub inverted: usize,
    /// Why.
    pub cause: Cause,
}

/// Why a component does not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// It is smaller than [`SMALL`].
    Small,
    /// No vertex of it has a surface nearby that faces the same way.
    NoSurface,
    /// Some vertices have none: the base mesh spans what is not connected, or stops short of it.
    OutOfReach,
    /// It fits, but some faces could not be turned back: the surface is bent too much within a face.
    Folded,
}

/// RMS and largest distance of points.
pub(super) fn misfit(space: &Space, points: impl IndexedParallelIterator<Item = Point>) -> Misfit {
    let count = points.len() as f64;
    let distances: Vec<f64> = points.map(|point| space.distance_in_cells(point)).collect();
    let squares: f64 = distances.iter().map(|distance| distance * distance).sum();
    Misfit { rms: (squares / count).sqrt(), most: distances.into_iter().fold(0.0, f64::max) }
}

/// What is gathered about one component.
#[derive(Clone, Copy)]
struct Tally {
    vertices: usize,
    bounds: Bounds,
    unfit: usize,
    most: f64,
    inverted: usize,
}

/// Number of components, and those that do not fit.
fn failures(level: &Level, space: &Space, goal: &Goal, inverted: &[u32]) -> (usize, Vec<Failure>) {
    let firsts = level.first_of_components();
    let none = Tally { vertices: 0, bounds: Bounds::NONE, unfit: 0, most: 0.0, inverted: 0 };
    let mut tallies = vec![none; firsts.len()];
    let misfit = |&place: &Point| Some(goal.distance_in_cells(place, space)).filter(|&off| off > UNFIT);
    let misfits: Vec<Option<f64>> = level.positions.par_iter().map(misfit).collect();
    for ((&component, &place), misfit) in level.components.iter().zip(&level.positions).zip(misfits) {
        let tally = &mut tallies[component as usize];
        tally.vertices += 1;
        tally.bounds = tally.bounds.joined(Bounds { low: place, high: place });
        tally.unfit += usize::from(misfit.is_some());
        tally.most = tally.most.max(misfit.unwrap_or(0.0));
    }
    for &face in inverted {
        let corner = level.faces.get(face as usize)[0];
        tallies[level.components[corner as usize] as usize].inverted += 1;
    }
    let failed = firsts.iter().zip(&tallies).filter(|(_, tally)| tally.unfit + tally.inverted > 0);
    let failures =
        failed.map(|(&vertex, tally)| tally.failure(vertex, level.positions[vertex as usize], space.cell));
    (firsts.len(), failures.collect())
}

impl Tally {
    fn failure(&self, vertex: u32, place: Point, cell: f64) -> Failure {
        let &Self { vertices, bounds, unfit, most, inverted } = self;
        let diagonal = bounds.diagonal() / cell;
        let cause = match (diagonal < SMALL, unfit) {
            (true, _) => Cause::Small,
            (false, 0) => Cause::Folded,
            (false, unfit) if unfit == vertices => Cause::NoSurface,
            (false, _) => Cause::OutOfReach,
        };
        Failure { vertex, place, vertices, diagonal, unfit, most, inverted, cause }
    }
}
