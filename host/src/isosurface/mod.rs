//! Contours of scalar fields: triangulations with the topology of the trilinear interpolant.
//!
//! A node is inside if its value is greater than the isovalue; a value equal to it is outside. Each edge between an inside
//! and an outside node has one vertex, shared by the cells around it. Within a cell the surface is made in four steps:
//!
//! 1. Each face of the cell has one or two segments. Where inside and outside corners alternate, the asymptotic decider
//!    says which corners are joined across the face (Nielson, Hamann 1991): it looks at the face only, so that both cells
//!    agree, and there are no cracks.
//! 2. Segments join to loops.
//! 3. Two loops bound a tube if the trilinear interpolant joins their corners through the inside of the cell (the question
//!    is Chernyaev's, 1995; the answer here is exact, by a sweep of slices: see `decide.rs`). All other loops bound disks.
//! 4. Disks and tubes are triangulated without edges across faces of the cell, which would meet those of the neighbour.
//!    Where that is impossible, a disk has a vertex in the middle, and a tube three around its waist.
//!
//! So the result is always a manifold, whose boundary lies on the border of the volume, whatever the values are. The cases
//! are derived from the rules when they are first needed; no table is stored in the source.
//!
//! Rows of nodes are classified into bits first, and cells without surface are skipped 64 at a time; output is counted
//! before it is written, so that layers are written in parallel and no vertex is looked up (Schroeder, Maynard,
//! Geveci 2015: *Flying Edges*).

mod case;
mod cell;
mod decide;
mod inside;
mod march;
#[cfg(test)]
mod tests;

use crate::field::ScalarField;
use crate::mesh::TriangleMesh;

/// Why there is no contour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ContourError {
    /// Indices of vertices have 32 bits.
    #[error(
        "the contour has {vertices} vertices, and a mesh at most 2^32 - 1: cut the volume or smooth out its noise"
    )]
    TooManyVertices {
        /// How many it would have.
        vertices: u64,
    },
}

/// The surface where a field takes a value, in the units of the field's grid.
///
/// Triangles are counter-clockwise seen from where values are lower. Vertices keep a distance of 2^-10 of an edge from its
/// ends, so that no triangle is degenerate where values equal the isovalue. A grid with an axis of one node has no
/// contour. Next to values that are not finite the surface goes where it must to be closed, and its vertices are finite.
///
/// Layers are worked on by the threads of the current `rayon` pool; the result is the same for any number of them.
///
/// # Errors
/// [`ContourError::TooManyVertices`].
///
/// Cost: two passes over the cells with surface, one over the rest. Memory: the result, and a bit a node.
pub fn contour(field: &ScalarField, isovalue: f32) -> Result<TriangleMesh, ContourError> {
    march::march(field, isovalue)
}
