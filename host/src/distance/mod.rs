//! Signed distance to a surface, at the nodes of a grid: negative inside, positive outside, in the units of the grid.
//!
//! Sources: Vis2000 §4.2, Dataflow §3, Distance §4. In these texts nodes near the surface get closest points, from the
//! gradient of the field or from triangles, and a queue hands the points on to nodes farther away. Here:
//!
//! 1. *Seeds*: the nodes of all cells that a triangle of the surface meets get their closest point on it. An isosurface is
//!    contoured first, so that there is one way for isosurfaces and meshes, and one surface that the distance is exact for.
//! 2. *Propagation* (see `sweep.rs`): closest points are handed on to the 26 neighbours, as in the texts, but by planes of
//!    nodes that look at the plane before them, from both ends of each axis, instead of a queue, and without blocks and
//!    their messages. A node takes a point about as often as in the texts, and vector instructions work on eight at a time.
//!    The order of planes is given, and the nodes of a plane are independent, so that the result depends on no thread.
//! 3. *Walk*: a point that is closest to a neighbour is not closest to the node: handed-on points alone leave an error of
//!    up to half a cell's edge squared over twice the distance. So each node walks from the triangle of its point to
//!    neighbouring triangles as long as that brings it closer, and takes its distance from there. As points only show where
//!    to start, 16 bits along each axis are enough for them.
//! 4. *Signs* come from the field. For a mesh they come from the nearest feature of the surface, by normals weighted by
//!    angles (Baerentzen, Aanaes 2005), which is right for every closed oriented mesh, where the rules of Distance §4.3
//!    leave vertices to a majority of neighbours.
//!
//! A mesh with a boundary has no inside: near it the sign says on which side of the surface the nearest point is seen from,
//! and changes across some surface that continues the mesh from its boundary, where distances are not small. Faces wound
//! inwards give the opposite sign.

mod lanes;
mod rows;
mod seed;
mod sign;
mod surface;
mod sweep;
#[cfg(test)]
mod tests;
mod walk;

use rayon::prelude::*;

use crate::field::{Grid, ScalarField};
use crate::isosurface::{ContourError, contour};
use crate::mesh::{Point, TriangleMesh};
use rows::{Rows, Ruler};
use seed::Seeding;
use sign::{Normals, Signs};
use surface::{Facet, Surface};
use sweep::Planes;
use walk::{Walk, mean_side};

/// How far beyond a triangle of a mesh, in cells, cells are taken to be met by it: so that nodes on the plane of a triangle
/// have neighbours on both sides which know where they are.
const TOUCH: f64 = 1e-6;

/// Planes whose rows walk beside each other.
const BESIDE: usize = 32;

/// What may be chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Greatest distance that matters, in units of the grid: nodes farther away have this distance, and take little time.
    pub limit: f64,
    /// Planes of nodes that are seeded at a time. It changes the speed only.
    pub slab: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { limit: f64::INFINITY, slab: 8 }
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
    /// How often a node was given a closest point, in seeding or by a sweep: about twice the nodes. In the texts, where each
    /// point that a node is given is handed on, that is 1.2 to 1.8 times the nodes.
    pub updates: u64,
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
/// Cost: about 50 ns a node and 200 ns a triangle on one core, contour included. Memory: about 15 bytes a node, and 100 a
/// triangle, with the contour.
pub fn of_isosurface(
    field: &ScalarField,
    isovalue: f32,
    options: &Options,
) -> Result<Distance, DistanceError> {
    let mesh = contour(field, isovalue)?;
    let work = Work::new(&mesh, field.grid(), options, 0.0)?;
    let (spread, facets) = work.spread()?;
    Ok(work.finish(&spread, &facets, &Signs::Field { values: field.values(), isovalue }))
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
/// Cost: about 50 ns a node and 200 ns a triangle on one core. Memory: about 15 bytes a node, and 100 a triangle.
pub fn of_mesh(mesh: &TriangleMesh, grid: &Grid, options: &Options) -> Result<Distance, DistanceError> {
    let work = Work::new(mesh, grid, options, TOUCH)?;
    let (spread, facets) = work.spread()?;
    Ok(work.finish(&spread, &facets, &Signs::Mesh(Normals::new(&work.surface, &facets))))
}

/// What all steps look at.
struct Work<'a> {
    surface: Surface<'a>,
    grid: &'a Grid,
    options: &'a Options,
    margin: f64,
}

/// Closest points, handed on.
struct Spread {
    rows: Rows,
    seeds: usize,
    updates: u64,
}

impl<'a> Work<'a> {
    fn new(
        mesh: &'a TriangleMesh,
        grid: &'a Grid,
        options: &'a Options,
        margin: f64,
    ) -> Result<Self, DistanceError> {
        Ok(Self { surface: Surface::new(mesh, grid)?, grid, options, margin })
    }

    /// Distance between nodes.
    fn spacing(&self) -> [f32; 3] {
        self.surface.spacing.as_vec3().to_array()
    }

    /// Seeds nodes and hands points on; meanwhile, triangles find their neighbours.
    fn spread(&self) -> Result<(Spread, Vec<Facet>), DistanceError> {
        let points = || {
            let facets = self.surface.facets();
            (self.points(&facets), facets)
        };
        let ((spread, mut facets), across) = rayon::join(points, || self.surface.across());
        facets.par_iter_mut().zip(across).with_min_len(4096).for_each(|(facet, across)| facet.join(across));
        Ok((spread?, facets))
    }

    fn points(&self, facets: &[Facet]) -> Result<Spread, DistanceError> {
        let slab = self.options.slab.max(1);
        let Self { surface, grid, margin, .. } = self;
        let ruler = self.ruler();
        let mut rows = Seeding { surface, facets, grid, ruler, slab, margin: *margin }.run();
        let seeds = rows.taken();
        if seeds == 0 {
            return Err(DistanceError::NoSurface);
        }
        let [width, height, depth] = grid.extent;
        // Points may come from a little beyond the limit, as walks bring them nearer.
        let reach = (self.options.limit / grid.cell_edge() + surface.spacing.length()) as f32 * ruler.marks;
        let near = surface.spacing.min_element() as f32 * ruler.marks;
        let [reach, near] = [reach * reach, near * near];
        let mut updates = seeds as u64;
        let planes = Planes::arrange(rows.all_mut(), width, true);
        updates += Planes { rows: planes, axes: [1, 2, 0], ruler, reach, near }.sweep();
        let mut rows = rows.turned();
        let planes = Planes::arrange(rows.all_mut(), height, true);
        updates += Planes { rows: planes, axes: [0, 2, 1], ruler, reach, near }.sweep();
        let planes = Planes::arrange(rows.all_mut(), depth, false);
        updates += Planes { rows: planes, axes: [0, 1, 2], ruler, reach, near }.sweep();
        Ok(Spread { rows, seeds, updates })
    }

    /// Seeds have points at most the diagonal of a cell away.
    fn ruler(&self) -> Ruler {
        Ruler::new(self.grid.extent, self.spacing(), 1.01 * self.surface.spacing.length() as f32)
    }

    /// Lets all nodes walk, and gives distances their signs.
    fn finish(&self, spread: &Spread, facets: &[Facet], signs: &Signs) -> Distance {
        let [width, height, depth] = self.grid.extent;
        let (limit, edge) = (self.options.limit as f32, self.grid.cell_edge() as f32);
        let (ruler, side) = (self.ruler(), mean_side(facets));
        let mut values = vec![0.0_f32; self.grid.len()];
        let mut rows: Vec<_> = values.chunks_mut(width).enumerate().collect();
        // Rows of a few planes follow each other, as they are near the same triangles.
        rows.sort_by_key(|(number, _)| (number / height / BESIDE, number % height));
        let rows = rows.into_par_iter().with_min_len(BESIDE * 4);
        rows.for_each_init(
            || Walk::new(facets, side, self.spacing(), ruler),
            |walk, (number, values)| {
                let [y, z] = [number % height, number / height];
                let near = [
                    (y > 0).then(|| (spread.rows.row(number - 1), 1, -1.0)),
                    (y + 1 < height).then(|| (spread.rows.row(number + 1), 1, 1.0)),
                    (z > 0).then(|| (spread.rows.row(number - height), 2, -1.0)),
                    (z + 1 < depth).then(|| (spread.rows.row(number + height), 2, 1.0)),
                ];
                let near: Vec<_> = near.into_iter().flatten().collect();
                walk.run(spread.rows.row(number), [y, z], &near);
                for (value, squared) in values.iter_mut().zip(&walk.squared) {
                    *value = (squared.sqrt() * edge).min(limit);
                }
                signs.mark(&self.surface, [0, y, z], number * width, &walk.triangles, values);
            },
        );
        signs.fill(self.grid, &mut values, limit);
        let report = Report {
            nodes: self.grid.len(),
            triangles: self.surface.triangles.len(),
            seeds: spread.seeds,
            updates: spread.updates,
        };
        Distance { field: ScalarField::new(*self.grid, values), report }
    }
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
