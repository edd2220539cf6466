//! From a field or a mesh to a subdivision surface, in one go.
//!
//! contour → signed distance → base mesh → shrink-wrapped surface: Vis2000 §4, Dataflow §1–3. Each stage is a module of its
//! own; here they are put together with what is best for most surfaces.

mod care;
mod fit;
mod making;
mod misfits;
mod round;

use std::time::{Duration, Instant};

pub use fit::{Fit, MISSED, Missed};
pub use round::{End, Round, Rounds};

use crate::distance::{self, DistanceError};
use crate::field::{Grid, ScalarField};
use crate::isosurface::{ContourError, contour};
use crate::mesh::{FeatureAngles, Features, PolygonMesh, Repairs, TriangleMesh};
use crate::simplify::{self, Constraints, SimplifyError};
use crate::wrap::{WrapError, Wrapped};
use making::{Fitted, Making};

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
    /// Vertices of the base mesh, as a share of those of the contour or the mesh, before it is made finer in places.
    pub share: f64,
    /// How far the base mesh may be off, in cells' edges, by the estimate of the collapses, which adds up what each of them
    /// might have done: where that is reached, the base mesh has more vertices. Infinite for `share` alone to count.
    pub error: f64,
    /// How often the base mesh is made finer, at most, in places where the surface does not fit. With none, vertices are not
    /// drawn to crests either.
    pub rounds: u32,
    /// How often the base mesh is split, …
    pub levels: u32,
    /// … or less often, if the finest mesh would have more than so many times the vertices of the contour, or of what `share`
    /// and `levels` alone come to. Infinite for `levels` alone to count.
    pub growth: f64,
    /// Splits no further once the surface fits this well, in cells' edges.
    pub tolerance: f64,
    /// Cells along the longest axis of a mesh.
    pub cells: usize,
    /// Edges of a mesh are sharp where its faces turn by more than so many degrees; none are without.
    pub sharp: Option<f64>,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            share: 0.02,
            error: 20.0,
            rounds: 3,
            levels: 3,
            growth: 4.0,
            tolerance: 0.0,
            cells: 192,
            sharp: None,
        }
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
    /// Shrink-wrapping, and measuring what it came to.
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
    /// What was changed of a mesh before anything else.
    pub repairs: Repairs,
    /// The contour of the field, or the repaired mesh.
    pub contour: TriangleMesh,
    /// Signed distance to it, within some cells.
    pub distance: ScalarField,
    /// The base mesh.
    pub base: PolygonMesh,
    /// The surface, and how each level of it came about.
    pub wrapped: Wrapped,
    /// How well it fits the contour or the mesh, both ways.
    pub fit: Fit,
    /// The surfaces that were made before one was good enough.
    pub rounds: Rounds,
}

/// Why there is no surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The isovalue is not taken.
    #[error("there is no surface at {isovalue}: the values lie between {low} and {high}")]
    NoSurface {
        /// What was asked for.
        isovalue: f32,
        /// The smallest value of the field.
        low: f32,
        /// The largest one.
        high: f32,
    },
    /// The mesh has no triangle.
    #[error("the mesh has no triangle with an area: there is no surface")]
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
    check_share(share)?;
    Ok(simplify::Target { vertices: (mesh.positions.len() as f64 * share) as usize, error: f64::INFINITY })
}

fn check_share(share: f64) -> Result<(), BuildError> {
    if share > 0.0 && share <= 1.0 { Ok(()) } else { Err(BuildError::Share { share }) }
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
    check_share(options.share)?;
    let mut timed = Timed { start: Instant::now(), observe };
    let (mut constraints, mut repairs) = (Constraints::default(), Repairs::default());
    let (contour, field) = match source {
        Source::Isosurface(field, isovalue) => {
            constraints.border = Some(*field.grid());
            (contour(field, isovalue)?, Some((field, isovalue)))
        }
        Source::Mesh(mut mesh) => {
            repairs = mesh.repair();
            if let Some(edge) = options.sharp {
                constraints.features =
                    Features::by_angle(&mesh, FeatureAngles { edge, ..FeatureAngles::default() });
            }
            (mesh, None)
        }
    };
    if contour.triangles.is_empty() {
        return Err(field.map_or(BuildError::Empty, |(field, isovalue)| no_surface(field, isovalue)));
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
    let making = Making { contour: &contour, constraints, field, distance: &distance.field, options };
    let (Fitted { base, wrapped, fit }, rounds) = making.fitted(&mut |stage| timed.done(stage))?;
    Ok(Built { repairs, contour, distance: distance.field, base, wrapped, fit, rounds })
}

fn no_surface(field: &ScalarField, isovalue: f32) -> BuildError {
    let within = |[low, high]: [f32; 2], &value: &f32| [low.min(value), high.max(value)];
    let [low, high] = field.values().iter().fold([f32::INFINITY, f32::NEG_INFINITY], within);
    BuildError::NoSurface { isovalue, low, high }
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
            let finest = built.wrapped.surface.level(built.wrapped.surface.levels);
            let report = Report::of(&finest);
            assert_eq!((report.genus(), report.components.len(), report.is_closed()), (Some(1), 1, true));
            assert!(report.volume() > 0.0);
            let distance = SurfaceDistance::between(&built.contour, &finest.triangulated(), 20_000).unwrap();
            assert!(distance.rms(1.0) < 0.05, "{}", distance.rms(1.0));
        }
    }

    #[test]
    fn horns_and_small_balls_come_through() {
        // A ball with a thin horn, and balls of a few cells beside it.
        let grid = Grid { extent: [44; 3], origin: Point::ZERO, spacing: Point::ONE };
        let field = ScalarField::from_function(grid, |point| {
            let ball = 8.0 - point.distance(Point::new(12.0, 12.0, 12.0));
            let along = point.x.clamp(12.0, 38.0);
            let horn = 1.3 - point.distance(Point::new(along, 12.0, 12.0));
            let beads = [20.0, 26.0, 32.0].map(|y| 2.4 - point.distance(Point::new(30.0, y, 30.0)));
            beads.into_iter().fold(ball.max(horn), f64::max)
        });
        let options =
            BuildOptions { share: 0.005, error: f64::INFINITY, levels: 2, ..BuildOptions::default() };
        let build = |rounds| {
            let options = BuildOptions { rounds, ..options };
            build(Source::Isosurface(&field, 0.0), &options, &mut |_, _| ()).unwrap()
        };
        let (coarse, fine) = (build(0), build(3));
        assert!(coarse.fit.backward.rms > 0.1, "{:?}", coarse.fit);
        assert!(fine.fit.rms() < 0.05 && fine.fit.missed.is_empty(), "{:?}", fine.fit);
        let report = Report::of(&fine.wrapped.surface.level(2));
        assert_eq!((report.genus(), report.components.len(), report.is_closed()), (Some(0), 4, true));
        assert!(fine.wrapped.report.failures.is_empty(), "{:?}", fine.wrapped.report.failures);
    }

    #[test]
    fn rough_surfaces_fit_within_bounds() {
        // Waves as short as two cells, and noise.
        let grid = Grid { extent: [16; 3], origin: Point::ZERO, spacing: Point::ONE };
        let field = ScalarField::from_function(grid, |point| {
            let noise = (point.dot(Point::new(12.9898, 78.233, 37.719)).sin() * 43_758.545).fract();
            (point.x * 0.9).sin() + (point.y * 1.1).sin() + (point.z * 0.7).cos() + 0.7 * noise
        });
        let build = |options| build(Source::Isosurface(&field, 0.2), &options, &mut |_, _| ()).unwrap();
        let built = build(BuildOptions::default());
        let Rounds { made, end } = &built.rounds;
        assert!(built.fit.rms() < 0.06, "{made:?} {end:?}");
        let finest = made.iter().map(|round| round.vertices).max().unwrap();
        assert!(finest as f64 <= 5.12 * built.contour.positions.len() as f64, "{made:?}");
        assert!(made.iter().any(|round| round.levels < 3), "{made:?}");
        let [before, after] = [
            Report::of(&built.contour),
            Report::of(&built.wrapped.surface.level(built.wrapped.surface.levels)),
        ];
        assert_eq!(before.components.len(), after.components.len());
        assert_eq!((before.genus(), before.boundary_loops()), (after.genus(), after.boundary_loops()));
        // What is asked for is done, whatever it comes to.
        let asked = build(BuildOptions {
            rounds: 0,
            error: f64::INFINITY,
            growth: f64::INFINITY,
            ..BuildOptions::default()
        });
        assert_eq!((asked.wrapped.surface.levels, asked.rounds.end), (3, End::Asked));
    }

    #[test]
    fn what_is_no_surface_is_told() {
        let field = ScalarField::from_function(Grid::unit([4; 3]), |point| point.x);
        let error = |source, options| build(source, &options, &mut |_, _| ()).unwrap_err();
        let far = BuildError::NoSurface { isovalue: 9.0, low: 0.0, high: 3.0 };
        assert_eq!(error(Source::Isosurface(&field, 9.0), BuildOptions::default()), far);
        assert_eq!(error(Source::Mesh(TriangleMesh::default()), BuildOptions::default()), BuildError::Empty);
        let none = BuildOptions { share: 0.0, ..BuildOptions::default() };
        assert_eq!(error(Source::Isosurface(&field, 1.5), none), BuildError::Share { share: 0.0 });
    }
}
