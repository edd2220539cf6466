//! Shrink-wrapping: a base mesh becomes a subdivision surface that lies on an isosurface.
//!
//! Source: Vis2000 §4.2, Dataflow §3, Diss §4.1.5. At each level the mesh is refined by the rules of Catmull and Clark, then
//! a few times relaxed and attracted to the zeros of a signed distance field.
//!
//! Better than the texts: vertices that find no surface along their normals go down the gradient of the distance where that
//! agrees with the normal; and faces that are turned over are turned back at each level, before finer ones inherit them.

mod attract;
mod border;
mod check;
mod cluster;
mod crest;
mod ease;
mod error;
mod fit;
mod goal;
mod level;
mod lines;
mod patient;
mod quality;
mod refine;
mod relax;
mod repair;
mod report;
mod rings;
mod settle;
#[cfg(test)]
mod tests;

pub use crest::Draw;
pub use error::WrapError;
pub use goal::{Target, ways};
pub use lines::Lines;
pub use quality::Inverted;
pub use report::{Cause, Failure, LevelReport, Misfit, SMALL, UNFIT, WrapReport};
pub use settle::Settling;

use crate::field::ScalarField;
use crate::mesh::PolygonMesh;
use crate::subdivision::SubdivisionSurface;

/// How a surface is wrapped.
#[derive(Clone, Copy, Debug)]
pub struct WrapOptions<'a> {
    /// Most levels: how often every face of the base mesh is split.
    pub levels: u32,
    /// No further level once the RMS distance of the faces' centres from the surface is at most this, in cells' edges; 0 for
    /// all levels.
    pub tolerance: f64,
    /// Rounds of relaxation and attraction at each level. One is best where the surface is rough: with each round, vertices
    /// slide farther along it, and more faces fold.
    pub rounds: u32,
    /// How far relaxation moves a vertex towards its neighbours, in 0 to 1.
    pub relaxation: f64,
    /// Whether relaxation keeps vertices on a quadratic height map, so that curved places do not shrink. As attraction
    /// follows each relaxation, it makes little difference, but for surfaces that attraction does not reach.
    pub keep_height: bool,
    /// How far attraction looks for the surface, in lengths of the vertex' edges.
    pub reach: f64,
    /// Most vertices that the finest mesh may have: as many as decoders accept.
    pub vertex_limit: u64,
    /// What the finest vertices are moved to in the end.
    pub target: Target<'a>,
    /// What the sharp edges of the base mesh are attracted to, and those boundaries of it that are not on the border of the
    /// field. Without lines they are attracted to the surface alone, and such boundaries only relaxed.
    pub lines: Option<&'a Lines>,
}

impl Default for WrapOptions<'_> {
    fn default() -> Self {
        Self {
            levels: 3,
            tolerance: 0.0,
            rounds: 1,
            relaxation: 0.2,
            keep_height: false,
            reach: 1.0,
            vertex_limit: 1 << 26,
            target: Target::Distance,
            lines: None,
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
/// The base mesh is a manifold, with boundary or without, near these zeros. Its boundary vertices on the border of the field
/// stay there; no vertex leaves the box of the field. The result does not depend on the number of threads.
///
/// # Errors
/// [`WrapError`].
///
/// Cost: about 10 µs a vertex of the finest mesh on one core, several times that where much is folded, and 250 bytes.
pub fn wrap(base: &PolygonMesh, distance: &ScalarField, options: &WrapOptions) -> Result<Wrapped, WrapError> {
    check::field(distance)?;
    if let Target::Isosurface(field, _) = options.target {
        check::same_grid(distance, field)?;
    }
    check::options(base, options)?;
    let space = level::Space::new(distance);
    check::base(base, &space)?;
    let (positions, report) = fit::Fit::new(space, options).all(base)?;
    let levels = report.levels.len() as u32 - 1;
    let surface =
        SubdivisionSurface { base: base.faces().clone(), features: base.features.clone(), levels, positions };
    Ok(Wrapped { surface, report })
}
