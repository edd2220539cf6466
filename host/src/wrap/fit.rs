//! The fit of a mesh to a surface, level by level.

use std::time::Instant;

use rayon::prelude::*;

use super::goal::Goal;
use super::level::{Level, Space};
use super::repair::{LARGEST, repair};
use super::report::{LevelReport, WrapReport, misfit};
use super::{Target, WrapError, WrapOptions};
use crate::mesh::{Point, PolygonMesh};

/// What a mesh is fitted to, and how.
pub(super) struct Fit<'a> {
    space: Space<'a>,
    options: &'a WrapOptions<'a>,
}

impl<'a> Fit<'a> {
    pub(super) fn new(space: Space<'a>, options: &'a WrapOptions<'a>) -> Self {
        Self { space, options }
    }

    /// Fits one level after the other; the finest vertices, and how they came about.
    pub(super) fn all(&self, base: &PolygonMesh) -> Result<(Vec<Point>, WrapReport), WrapError> {
        let mut level = Level::base(base, &self.space.border)?;
        let mut report = WrapReport::default();
        for number in 0..=self.options.levels {
            let begun = Instant::now();
            if number > 0 {
                level = level.refined(&self.space.border)?;
            }
            let mut found = self.level(&mut level);
            (found.level, found.seconds) = (number, begun.elapsed().as_secs_f64());
            report.levels.push(found);
            let tolerance = self.options.tolerance;
            if tolerance > 0.0 && found.at_faces.rms <= tolerance {
                break;
            }
        }
        let begun = Instant::now();
        self.correct(&mut level);
        report.correction_seconds = begun.elapsed().as_secs_f64();
        report.finish(&level, &self.space, &Goal::new(self.options.target));
        Ok((level.positions, report))
    }

    /// Fits one level.
    fn level(&self, level: &mut Level) -> LevelReport {
        let goal = Goal::new(Target::Distance);
        let mut missed = Vec::new();
        for _ in 0..self.options.rounds {
            level.relax(&self.space.border, self.options);
            missed = level.attract(&self.space, self.options);
            missed = level.lead(&self.space, &goal, &missed, self.options.reach);
        }
        let [inverted_before, inverted] = repair(level, &self.space, &goal, LARGEST);
        let centre = |face: usize| {
            let corners = level.faces.get(face);
            corners.iter().map(|&corner| level.positions[corner as usize]).sum::<Point>()
                / corners.len() as f64
        };
        LevelReport {
            level: 0,
            vertices: level.positions.len(),
            at_vertices: misfit(&self.space, level.positions.par_iter().copied()),
            at_faces: misfit(&self.space, (0..level.faces.len()).into_par_iter().map(centre)),
            unsnapped: missed.len(),
            inverted_before,
            inverted,
            seconds: 0.0,
        }
    }

    /// Moves the finest vertices to the target.
    fn correct(&self, level: &mut Level) {
        if matches!(self.options.target, Target::Distance) {
            return;
        }
        let goal = Goal::new(self.options.target);
        level.approach(&self.space, &goal, self.options.reach);
        repair(level, &self.space, &goal, LARGEST);
    }
}
