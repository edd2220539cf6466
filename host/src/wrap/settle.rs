//! A surface, or a part of one, whose vertices are known to be where they belong: what is left is to even them out.
//!
//! Places that are led back through a simplification cover the whole surface, without folds, whatever its shape, but kinks
//! and strains of each collapse are left in them. So vertices are relaxed and moved back to the surface a few times, as in
//! wrapping, but never farther than their edges are long, as they are on the right sheet already.

use std::time::Instant;

use rayon::prelude::*;

use super::crest::{Draw, draw};
use super::goal::Goal;
use super::level::{Level, Space};
use super::quality;
use super::relax::relaxed;
use super::repair::{repair, untangle};
use super::rings::Kind;
use super::{WrapError, WrapOptions, Wrapped};
use crate::field::ScalarField;
use crate::mesh::{Point, PolygonMesh};

/// Rounds of relaxation.
const ROUNDS: usize = 4;
/// How far each moves a vertex towards its neighbours.
const RELAXATION: f64 = 0.5;
/// How far a vertex may move in a round, in lengths of its edges, …
const FARTHEST: f64 = 0.5;
/// … and besides in distances from the surface: that leads back to it, at some angle.
const SLANTED: f64 = 1.5;
/// How near to the surface a vertex must come, in cells, to move.
const THERE: f64 = 0.02;

/// A wrapped surface parts of which are put elsewhere.
#[derive(Debug)]
pub struct Settling<'a> {
    space: Space<'a>,
    goal: Goal<'a>,
    /// The finest mesh.
    level: Level,
}

impl<'a> Settling<'a> {
    /// Gets a surface over `base` with so many levels ready.
    ///
    /// # Errors
    /// [`WrapError`], as [`super::wrap`].
    ///
    /// Cost: that of the splits, about 1 µs a vertex.
    pub fn new(
        base: &PolygonMesh,
        levels: u32,
        distance: &'a ScalarField,
        options: &WrapOptions<'a>,
    ) -> Result<Self, WrapError> {
        let space = Space::new(distance);
        let mut level = Level::base(base, &space.border)?;
        for _ in 0..levels {
            level = level.refined(&space.border)?;
        }
        Ok(Self { space, goal: Goal::new(options.target), level })
    }

    /// The faces of what was settled that have a corner that is turned over.
    pub fn folds(&self) -> Vec<u32> {
        quality::inverted(&self.level, &self.space, &self.goal, 0.0).0
    }

    /// Puts those vertices that are `placed` where `places` say, which are points of the surface in the numbering of its
    /// finest mesh, and evens them out; the others are at `positions`.
    ///
    /// Cost: about 5 µs a placed vertex on one core, and two passes over all vertices.
    pub fn settled(&mut self, positions: &[Point], places: &[Point], placed: &[bool]) -> &[Point] {
        let Self { space, goal, level } = self;
        let held = |vertex: usize| match placed[vertex] {
            true => space.border.hold(level.sides[vertex], places[vertex]),
            false => positions[vertex],
        };
        level.positions = (0..places.len()).map(held).collect();
        for _ in 0..ROUNDS {
            let moved = |vertex: usize| match placed[vertex] {
                true => moved(level, space, goal, vertex),
                false => level.positions[vertex],
            };
            level.positions = (0..places.len()).into_par_iter().map(moved).collect();
        }
        repair(level, space, goal, usize::MAX);
        for (vertex, place) in level.positions.iter_mut().enumerate().filter(|(vertex, _)| !placed[*vertex]) {
            *place = positions[vertex];
        }
        &level.positions
    }

    /// Draws vertices of a surface to points of the target that it passes at a distance, as far as that strains no face; how
    /// many moved.
    ///
    /// Cost: about 10 µs a drawn vertex on one core, and two passes over all vertices.
    pub fn drawn(&mut self, wrapped: &mut Wrapped, draws: &[Draw]) -> usize {
        let begun = Instant::now();
        self.level.positions.clone_from(&wrapped.surface.positions);
        let moved = draw(&mut self.level, &self.space, &self.goal, draws);
        wrapped.surface.positions.copy_from_slice(&self.level.positions);
        wrapped.report.finish(&self.level, &self.space, &self.goal);
        wrapped.report.correction_seconds += begun.elapsed().as_secs_f64();
        moved
    }

    /// Turns back what faces of a surface are turned over.
    ///
    /// Cost: about 1 ms a fold on one core, and a few passes over all vertices.
    pub fn untangled(&mut self, wrapped: &mut Wrapped) {
        let begun = Instant::now();
        self.level.positions.clone_from(&wrapped.surface.positions);
        untangle(&mut self.level, &self.space, &self.goal);
        wrapped.surface.positions.copy_from_slice(&self.level.positions);
        wrapped.report.finish(&self.level, &self.space, &self.goal);
        wrapped.report.correction_seconds += begun.elapsed().as_secs_f64();
    }

    /// Leaves what was settled in a surface: those vertices that are `kept`, the others being as they were there.
    pub fn finish(&mut self, wrapped: &mut Wrapped, kept: &[bool]) {
        let begun = Instant::now();
        let settled = wrapped.surface.positions.iter_mut().zip(&self.level.positions);
        for ((place, settled), _) in settled.zip(kept).filter(|(_, kept)| **kept) {
            *place = *settled;
        }
        self.level.positions.clone_from(&wrapped.surface.positions);
        wrapped.report.finish(&self.level, &self.space, &self.goal);
        wrapped.report.correction_seconds += begun.elapsed().as_secs_f64();
    }
}

/// Where a vertex goes in a round: nearer to the middle of its neighbours, on the surface; where it is if there is none.
fn moved(level: &Level, space: &Space, goal: &Goal, vertex: usize) -> Point {
    let (place, sides) = (level.positions[vertex], level.sides[vertex]);
    let free = match level.rings.kind(vertex) {
        Kind::Smooth => true,
        Kind::Crease(_) => sides.count() > 0,
        Kind::Fixed => false,
    };
    if !free {
        return place;
    }
    let off = goal.distance_in_cells(place, space) * space.cell;
    let leash = FARTHEST * level.rings.edge_length(vertex, &level.positions) + SLANTED * off;
    let normal = level.rings.normal(vertex, &level.positions);
    let step = relaxed(&level.rings, vertex, &level.positions, RELAXATION, false) - place;
    // Along the surface only, so that the tips of what is thin stay where they are.
    let towards = place + step.reject_from(normal);
    let next = goal.approach(space.border.hold(sides, towards), sides, leash, space);
    let is_there = next.distance(place) <= leash && goal.distance_in_cells(next, space) <= THERE;
    let turned = |place| level.rings.turned(vertex, &level.positions, place, normal);
    if is_there && turned(next) <= turned(place) { next } else { place }
}
