//! Base meshes: coarse polygons with the shape of a surface.
//!
//! Source: Vis2000 §4.1, Diss §4.1.5, Dataflow §3.

mod base;
mod collapse;
mod corners;
mod deviation;
mod edge_removal;
mod history;
mod layout;
mod leaf_faces;
mod legality;
mod octree;
mod parts;
mod priority;
mod separate;
mod spots;
mod star;
mod surface;

#[cfg(test)]
mod tests;

pub use base::{BaseMesh, base_mesh};
pub use collapse::{Collapsed, collapse_edges};
pub use edge_removal::remove_edges;
pub use history::History;
pub use leaf_faces::octree_mesh;
pub use octree::{OctreeOptions, Solid};

use crate::field::Grid;
use crate::mesh::Features;

/// What a simpler mesh must keep, beside topology.
#[derive(Clone, Debug, Default)]
pub struct Constraints {
    /// Sharp edges and vertices.
    pub features: Features,
    /// The grid in whose border planes the boundary lies: it stays in them, and turns from one to another where it did.
    pub border: Option<Grid>,
    /// How many vertices, at most, one may stand for that is made of each vertex and others. Empty where any number may.
    pub most: Vec<u32>,
    /// Whether collapses are recorded, so that places on what is left can be led back: about 250 bytes each.
    pub recorded: bool,
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// No collapse once there are as few vertices as this.
    pub vertices: usize,
    /// No collapse of a larger error than this, in units of the positions.
    pub error: f64,
}

/// Why a mesh cannot be simplified.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SimplifyError {
    /// More than 2^32 corners or vertices, or 2^16 edges at a vertex.
    #[error(
        "the mesh has more corners than 32 bits count, or more edges at a vertex than 16 bits count: split it first"
    )]
    TooLarge,
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} has vertex {vertex}, which does not exist")]
    NoSuchVertex {
        /// The triangle.
        triangle: usize,
        /// The vertex.
        vertex: u32,
    },
    /// A triangle has the same vertex twice.
    #[error("triangle {triangle} has the same vertex twice: remove it first")]
    DegenerateTriangle {
        /// The triangle.
        triangle: usize,
    },
    /// An edge has three triangles or more.
    #[error("the edge between vertices {} and {} has more than two triangles, so that the mesh is no manifold", edge[0], edge[1])]
    CrowdedEdge {
        /// Its ends.
        edge: [u32; 2],
    },
    /// The triangles on both sides of an edge face different ways.
    #[error("the triangles at the edge between vertices {} and {} face different ways: orient the mesh first", edge[0], edge[1])]
    Orientation {
        /// Its ends.
        edge: [u32; 2],
    },
    /// Sheets of the surface touch in a vertex.
    #[error(
        "sheets of the surface meet in vertex {vertex} only, so that the mesh is no manifold: double the vertex first"
    )]
    PinchedVertex {
        /// The vertex.
        vertex: u32,
    },
    /// A sharp edge is not an edge of the mesh.
    #[error("the mesh has no edge between vertices {} and {}, which is said to be sharp", edge[0], edge[1])]
    NoSuchEdge {
        /// Its ends.
        edge: [u32; 2],
    },
    /// A sharp vertex is not a vertex of the mesh.
    #[error("the mesh has no vertex {vertex}, which is said to be sharp")]
    NoSuchSharpVertex {
        /// The vertex.
        vertex: u32,
    },
}
