//! Signed distance to a surface, at the nodes of a grid: negative inside, positive outside, in the units of the grid.
//!
//! Sources: Vis2000 §4.2, Dataflow §3, Distance §4. In these texts nodes near the surface get closest points, from the
//! gradient of the field or from triangles, and a queue hands the points on to nodes farther away. Here:
//!
//! 1. *Seeds*: the nodes of all cells that a triangle of the surface meets get their closest point on it. An isosurface is
//!    contoured first, so that there is one way for isosurfaces and meshes, and one surface that the distance is exact for.
//! 2. *Propagation* (see `propagate.rs`): first in, first out, to the 26 neighbours, in blocks that send messages across
//!    their faces, as in the texts. It goes on in rounds, in which only what was known before the round is handed on, so
//!    that the result depends neither on blocks nor on threads.
//! 3. *Slide*: a point that is closest to a neighbour is not closest to the node: handed-on points alone leave an error of
//!    up to half a cell's edge squared over twice the distance. So each node walks from the triangle of its point to
//!    neighbouring triangles as long as that brings it closer, and takes its distance from there.
//! 4. *Signs* come from the field. For a mesh they come from the nearest feature of the surface, by normals weighted by
//!    angles (Baerentzen, Aanaes 2005), which is right for every closed oriented mesh, where the rules of Distance §4.3
//!    leave vertices to a majority of neighbours.
//!
//! A mesh with a boundary has no inside: near it the sign says on which side of the surface the nearest point is seen from,
//! and changes across some surface that continues the mesh from its boundary, where distances are not small. Faces wound
//! inwards give the opposite sign.

mod block;
mod propagate;
mod refine;
mod seed;
mod sign;
mod slide;
mod surface;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use crate::field::{Grid, ScalarField};
use crate::isosurface::{ContourError, contour};
use crate::mesh::{Point, TriangleMesh};
use block::Layout;
use propagate::Propagation;
use refine::Refined;
use seed::Seeding;
use sign::{Normals, Signs};
use slide::Neighbours;
use surface::Surface;

/// How far beyond a triangle of a mesh, in cells, cells are taken to be met by it: so that nodes on the plane of a triangle
/// have neighbours on both sides which know where they are.
const TOUCH: f64 = 1e-6;

/// What may be chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Greatest distance that matters, in units of the grid: nodes farther away have this distance, and take little time.
    pub limit: f64,
    /// Nodes along each side of a block, 4 to 128. It changes the speed only.
    pub block: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { limit: f64::INFINITY, block: 32 }
    }
}

/// A distance field, and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Distance {
    /// Signed distances.
    pub field: ScalarField,
    /// How it came about.
    pub report: Report,
}

/// What was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Nodes of the grid.
    pub nodes: usize,
    /// Triangles of the surface.
    pub triangles: usize,
    /// Nodes of cells that the surface meets.
    pub seeds: usize,
    /// How often a node was given a closest point and handed it on: 1.2 to 1.8 times the nodes in the texts.
    pub updates: u64,
    /// Rounds of propagation: the greatest number of steps from a node to its seed.
    pub rounds: usize,
}

/// Why there is no distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DistanceError {
    /// There is nothing to be distant from.
    #[error(
        "no cell of the grid meets the surface, so that there is no distance: choose another isovalue or grid"
    )]
    NoSurface,
    /// The isosurface is no mesh.
    #[error(transparent)]
    Contour(#[from] ContourError),
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names a vertex that the mesh does not have: repair the mesh first")]
    NoSuchVertex {
        /// Number of the first such triangle.
        triangle: usize,
    },
    /// A vertex is NaN or infinite.
    #[error("vertex {vertex} is not finite: repair the mesh first")]
    NotFinite {
        /// Number of the first such vertex.
        vertex: usize,
    },
    /// The grid cannot be worked on.
    #[error("the grid has {0}: choose another spacing")]
    Grid(&'static str),
}

/// Signed distance to an isosurface, at the nodes of its field: negative where values are greater than the isovalue.
///
/// The surface is that of [`contour`]: distances are exact for its triangles, up to what propagation misses.
///
/// Works on the threads of the current `rayon` pool; the result is the same for any number of them.
///
/// # Errors
/// [`DistanceError::NoSurface`] if no value is on the other side of the isovalue; [`DistanceError::Contour`];
/// [`DistanceError::Grid`].
///
/// Memory: about 12 bytes a node, 16 a seed, and the contour with 24 bytes a triangle more.
pub fn of_isosurface(
    field: &ScalarField,
    isovalue: f32,
    options: &Options,
) -> Result<Distance, DistanceError> {
    let mesh = contour(field, isovalue)?;
    let surface = Surface::new(&mesh, field.grid())?;
    let layout = Layout::new(field.grid(), options.block)?;
    let seeding = Seeding { surface: &surface, grid: field.grid(), layout: &layout, margin: 0.0 };
    let propagation = Propagation::run(&seeding, options.limit)?;
    let neighbours = Neighbours::new(&surface);
    let signs = Signs::Field { values: field.values(), isovalue };
    Ok(finish(&seeding, &propagation, &neighbours, &signs, options.limit))
}

/// Signed distance to a mesh, at the nodes of any grid: negative inside, if faces are counter-clockwise seen from outside.
///
/// The grid may end within the mesh; only cells of the grid that meet the surface count. Works on the threads of the
/// current `rayon` pool; the result is the same for any number of them.
///
/// # Errors
/// [`DistanceError::NoSurface`] if no cell meets a triangle; [`DistanceError::NoSuchVertex`]; [`DistanceError::NotFinite`];
/// [`DistanceError::Grid`].
///
/// Memory: about 16 bytes a node, 16 a seed, and 100 a triangle.
pub fn of_mesh(mesh: &TriangleMesh, grid: &Grid, options: &Options) -> Result<Distance, DistanceError> {
    let surface = Surface::new(mesh, grid)?;
    let layout = Layout::new(grid, options.block)?;
    let seeding = Seeding { surface: &surface, grid, layout: &layout, margin: TOUCH };
    let propagation = Propagation::run(&seeding, options.limit)?;
    let neighbours = Neighbours::new(&surface);
    let signs = Signs::Mesh(Normals::new(&surface, &neighbours));
    Ok(finish(&seeding, &propagation, &neighbours, &signs, options.limit))
}

/// Lets all nodes slide, and gives distances their signs.
fn finish(
    seeding: &Seeding,
    propagation: &Propagation,
    neighbours: &Neighbours,
    signs: &Signs,
    limit: f64,
) -> Distance {
    let words = propagation.words();
    let refined = Refined { seeding, neighbours, sites: &propagation.sites, words: &words };
    let mut values = vec![0.0_f32; words.len()];
    values.par_chunks_mut(seeding.grid.extent[0]).enumerate().with_min_len(16).for_each(|(row, values)| {
        let first = row * values.len();
        for (x, value) in values.iter_mut().enumerate() {
            *value = f32::NAN;
            if let Some(foot) = refined.foot(first + x) {
                let distance = foot.squared.sqrt().min(limit) as f32;
                let inside = signs.inside(first + x, &foot);
                *value = if inside { -distance } else { distance };
            }
        }
    });
    signs.fill(seeding.grid, &mut values, limit as f32);
    let report = Report {
        nodes: seeding.grid.len(),
        triangles: seeding.surface.triangles.len(),
        seeds: propagation.sites.len(),
        updates: propagation.updates,
        rounds: propagation.rounds,
    };
    Distance { field: ScalarField::new(*seeding.grid, values), report }
}

/// A grid around a mesh: `cells` cells along the longest side of its bounding box and as large along the others, and
/// `margin` cells more on every side.
///
/// # Errors
/// [`DistanceError::NoSurface`] if there is no triangle; [`DistanceError::NotFinite`]; [`DistanceError::Grid`] if the box
/// has no extent, or there would be 2^32 nodes or more.
pub fn grid_around(mesh: &TriangleMesh, cells: usize, margin: usize) -> Result<Grid, DistanceError> {
    if mesh.triangles.is_empty() {
        return Err(DistanceError::NoSurface);
    }
    if let Some(vertex) = mesh.positions.iter().position(|point| !point.is_finite()) {
        return Err(DistanceError::NotFinite { vertex });
    }
    let least = mesh.positions.iter().copied().reduce(Point::min).unwrap_or_default();
    let most = mesh.positions.iter().copied().reduce(Point::max).unwrap_or_default();
    let step = (most - least).max_element() / cells.max(1) as f64;
    if !(step.is_finite() && step > 0.0) {
        return Err(DistanceError::Grid("no size, as all vertices lie in one point"));
    }
    // A cell more than needed where rounding would leave a vertex on the border.
    let sides = ((most - least) / step - 1e-9).ceil().max(Point::ONE) + 2.0 * margin as f64;
    if (sides + 1.0).element_product() >= f64::from(u32::MAX) {
        return Err(DistanceError::Grid("2^32 nodes or more"));
    }
    let center = 0.5 * least + 0.5 * most;
    let extent = sides.to_array().map(|side| side as usize + 1);
    Ok(Grid { extent, origin: center - 0.5 * step * sides, spacing: Point::splat(step) })
}
