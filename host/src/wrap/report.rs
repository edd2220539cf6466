//! What a surface is like after wrapping.

use super::Inverted;

/// Distances from the surface, in cells' edges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misfit {
    /// Root of the mean square.
    pub rms: f64,
    /// The largest.
    pub most: f64,
}

/// One level of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelReport {
    /// Number of the level; the base mesh is 0.
    pub level: u32,
    /// Number of vertices.
    pub vertices: usize,
    /// Distances of the vertices.
    pub at_vertices: Misfit,
    /// Distances of the centres of the faces.
    pub at_faces: Misfit,
    /// Vertices that found no surface within reach in the last round.
    pub unsnapped: usize,
    /// Inverted faces after attraction.
    pub inverted_before: Inverted,
    /// Inverted faces after repair.
    pub inverted: Inverted,
    /// Time that the level took.
    pub seconds: f64,
}

/// All levels of a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WrapReport {
    /// The base mesh and each finer level.
    pub levels: Vec<LevelReport>,
}
