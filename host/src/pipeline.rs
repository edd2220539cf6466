//! From a field or a mesh to a subdivision surface, in one go.
//!
//! contour → signed distance → base mesh → shrink-wrapped surface: Vis2000 §4, Dataflow §1–3. Each stage is a module of its
//! own; here they are put together with what is best for most surfaces.

use std::time::{Duration, Instant};

use crate::distance::{self, DistanceError};
use crate::field::{Grid, ScalarField};
use crate::isosurface::{ContourError, contour};
use crate::measure::Bvh;
use crate::mesh::{FeatureAngles, Features, PolygonMesh, TriangleMesh};
use crate::simplify::{self, Constraints, SimplifyError, base_mesh};
use crate::wrap::{self, Lines, WrapError, WrapOptions, Wrapped, wrap};

/// Distances are known so far from the surface, in cells: farther than any base mesh strays.
const BAND: f64 = 24.0;

/// Cells between a mesh and the border of its grid.
pub const MARGIN: usize = 4;

/// What a surface is made from.
#[derive(Clone, Debug)]
pub enum Source<'a> {
    /// Where a field has a value.
    Isosurface(&'a ScalarField, f32),
    /// A mesh of triangles; it is repaired first.
    Mesh(TriangleMesh),
}

/// How a surface is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildOptions {
    /// Vertices of the base mesh, as a share of those of the contour or the mesh.
    pub share: f64,
    /// How often the base mesh is split.
    pub levels: u32,
    /// Splits no further once the surface fits this well, in cells' edges.
    pub tolerance: f64,
    /// Cells along the longest axis of a mesh.
    pub cells: usize,
    /// Edges of a mesh are sharp where its faces turn by more than so many degrees; none are without.
    pub sharp: Option<f64>,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { share: 0.02, levels: 3, tolerance: 0.0, cells: 192, sharp: None }
    }
}

/// Parts of the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The contour of a field, or the repair of a mesh.
    Contour,
    /// Signed distance.
    Distance,
    /// The base mesh.
    Base,
    /// Shrink-wrapping.
    Wrap,
}

impl Stage {
    /// A word for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Contour => "contour",
            Self::Distance => "distance",
            Self::Base => "base mesh",
            Self::Wrap => "wrap",
        }
    }
}

/// A surface, and what it was made of on the way.
#[derive(Clone, Debug)]
pub struct Built {
    /// The contour of the field, or the repaired mesh.
    pub contour: TriangleMesh,
    /// Signed distance to it, within some cells.
    pub distance: ScalarField,
    /// The base mesh.
    pub base: PolygonMesh,
    /// The surface, and how well it fits.
    pub wrapped: Wrapped,
}

/// Why there is no surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The isovalue is not taken, or the mesh has no triangle.
    #[error(
        "there is no surface: no cell has values on both sides of the isovalue, or the mesh has no triangle"
    )]
    Empty,
    /// The share of vertices is none.
    #[error("{share} of the vertices is no share: give more than 0 and at most 1")]
    Share {
        /// What was asked for.
        share: f64,
    },
    /// No contour.
    #[error(transparent)]
    Contour(#[from] ContourError),
    /// No distance.
    #[error(transparent)]
    Distance(#[from] DistanceError),
    /// No base mesh.
    #[error("no base mesh: {0}")]
    Simplify(#[from] SimplifyError),
    /// No surface around the base mesh.
    #[error(transparent)]
    Wrap(#[from] WrapError),
}

/// How many vertices a base mesh is to have.
///
/// # Errors
/// [`BuildError::Share`] unless 0 < `share` <= 1.
pub fn target(mesh: &TriangleMesh, share: f64) -> Result<simplify::Target, BuildError> {
    if !(share > 0.0 && share <= 1.0) {
        return Err(BuildError::Share { share });
    }
    Ok(simplify::Target { vertices: (mesh.positions.len() as f64 * share) as usize, error: f64::INFINITY })
}

/// Builds a surface, and tells how long each stage took.
///
/// # Errors
/// [`BuildError`], by the stage that could not go on.
///
/// Cost: that of the stages; see there.
pub fn build(
    source: Source<'_>,
    options: &BuildOptions,
    observe: &mut dyn FnMut(Stage, Duration),
) -> Result<Built, BuildError> {
    let mut timed = Timed { start: Instant::now(), observe };
    let mut constraints = Constraints::default();
    let (contour, field) = match source {
        Source::Isosurface(field, isovalue) => {
            constraints.border = Some(*field.grid());
            (contour(field, isovalue)?, Some((field, isovalue)))
        }
        Source::Mesh(mut mesh) => {
            mesh.repair();
            if let Some(edge) = options.sharp {
                constraints.features =
                    Features::by_angle(&mesh, FeatureAngles { edge, ..FeatureAngles::default() });
            }
            (mesh, None)
        }
    };
    if contour.triangles.is_empty() {
        return Err(BuildError::Empty);
    }
    timed.done(Stage::Contour);
    let distance = match field {
        Some((field, isovalue)) => distance::of_isosurface(field, isovalue, &band(field.grid()))?,
        None => {
            let grid = distance::grid_around(&contour, options.cells, MARGIN)?;
            distance::of_mesh(&contour, &grid, &band(&grid))?
        }
    };
    timed.done(Stage::Distance);
    let base = base_mesh(&contour, &constraints, target(&contour, options.share)?)?;
    timed.done(Stage::Base);
    let wrapped = wrap_onto(&contour, &constraints.features, field, &base, &distance.field, options)?;
    timed.done(Stage::Wrap);
    Ok(Built { contour, distance: distance.field, base, wrapped })
}

fn wrap_onto(
    contour: &TriangleMesh,
    features: &Features,
    field: Option<(&ScalarField, f32)>,
    base: &PolygonMesh,
    distance: &ScalarField,
    options: &BuildOptions,
) -> Result<Wrapped, WrapError> {
    let wrap_options =
        WrapOptions { levels: options.levels, tolerance: options.tolerance, ..WrapOptions::default() };
    if let Some((field, isovalue)) = field {
        let target = wrap::Target::Isosurface(field, isovalue.into());
        return wrap(base, distance, &WrapOptions { target, ..wrap_options });
    }
    let (tree, lines) = (Bvh::new(contour), Lines::of_mesh(contour, features));
    let target = wrap::Target::Triangles(&tree);
    wrap(base, distance, &WrapOptions { target, lines: Some(&lines), ..wrap_options })
}

fn band(grid: &Grid) -> distance::Options {
    distance::Options { limit: BAND * grid.spacing.max_element(), ..distance::Options::default() }
}

struct Timed<'a> {
    start: Instant,
    observe: &'a mut dyn FnMut(Stage, Duration),
}

impl Timed<'_> {
    fn done(&mut self, stage: Stage) {
        (self.observe)(stage, self.start.elapsed());
        self.start = Instant::now();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::SurfaceDistance;
    use crate::mesh::{Point, Report};

    fn torus(point: Point) -> f64 {
        let around = (point.x.hypot(point.y) - 10.0).hypot(point.z);
        4.0 - around
    }

    #[test]
    fn a_torus_is_built_from_its_field_and_from_its_mesh() {
        let grid = Grid { extent: [36, 36, 16], origin: Point::new(-17.5, -17.5, -7.5), spacing: Point::ONE };
        let field = ScalarField::from_function(grid, torus);
        let options = BuildOptions { share: 0.05, levels: 2, cells: 40, ..BuildOptions::default() };
        let mut stages = Vec::new();
        let first =
            build(Source::Isosurface(&field, 0.0), &options, &mut |stage, _| stages.push(stage)).unwrap();
        assert_eq!(stages, [Stage::Contour, Stage::Distance, Stage::Base, Stage::Wrap]);
        let second = build(Source::Mesh(first.contour.clone()), &options, &mut |_, _| ()).unwrap();
        for built in [first, second] {
            let finest = built.wrapped.surface.level(2);
            let report = Report::of(&finest);
            assert_eq!((report.genus(), report.components.len(), report.is_closed()), (Some(1), 1, true));
            assert!(report.volume() > 0.0);
            let distance = SurfaceDistance::between(&built.contour, &finest.triangulated(), 20_000).unwrap();
            assert!(distance.rms(1.0) < 0.05, "{}", distance.rms(1.0));
        }
    }

    #[test]
    fn what_is_no_surface_is_told() {
        let field = ScalarField::from_function(Grid::unit([4; 3]), |point| point.x);
        let error = |source, options| build(source, &options, &mut |_, _| ()).unwrap_err();
        assert_eq!(error(Source::Isosurface(&field, 9.0), BuildOptions::default()), BuildError::Empty);
        assert_eq!(error(Source::Mesh(TriangleMesh::default()), BuildOptions::default()), BuildError::Empty);
        let none = BuildOptions { share: 0.0, ..BuildOptions::default() };
        assert_eq!(error(Source::Isosurface(&field, 1.5), none), BuildError::Share { share: 0.0 });
    }
}
