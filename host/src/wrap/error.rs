//! Why a surface cannot be wrapped.

/// What is wrong with the base mesh, the field or the options.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum WrapError {
    /// The base mesh has no face.
    #[error(
        "the base mesh has no face, so that there is nothing to wrap: look for an isovalue that the field takes"
    )]
    Empty,
    /// A vertex of the base mesh is NaN or infinite.
    #[error("vertex {vertex} of the base mesh is not finite")]
    VertexNotFinite {
        /// The first such vertex.
        vertex: usize,
    },
    /// A face of the base mesh meets a vertex twice.
    #[error("face {face} of the base mesh meets a vertex twice: remove such faces first")]
    RepeatedCorner {
        /// The first such face.
        face: usize,
    },
    /// A vertex of the base mesh has no face.
    #[error("vertex {vertex} of the base mesh belongs to no face: remove such vertices first")]
    LooseVertex {
        /// The first such vertex.
        vertex: usize,
    },
    /// The faces around a vertex are not one fan.
    #[error(
        "the faces around vertex {vertex} of the base mesh are not one fan of equal orientation: \
         make the mesh manifold first"
    )]
    NotManifold {
        /// The first such vertex.
        vertex: usize,
    },
    /// A vertex of the base mesh lies beyond the border of the field.
    #[error(
        "vertex {vertex} of the base mesh lies {distance} beyond the border of the field: \
         base mesh and field do not belong together"
    )]
    OutsideField {
        /// The first such vertex.
        vertex: usize,
        /// How far, in units of the field.
        distance: f64,
    },
    /// A field is a single node wide.
    #[error(
        "the field has {nodes} node along axis {axis} (x is 0); two are needed to have a value in between"
    )]
    FieldTooThin {
        /// The axis.
        axis: usize,
        /// Nodes along it.
        nodes: usize,
    },
    /// A distance is NaN or infinite.
    #[error("distance {index} (x fastest) is not finite")]
    FieldNotFinite {
        /// The first such node.
        index: usize,
    },
    /// All distances have one sign.
    #[error(
        "the distance field has no zero, so that there is no surface to wrap: all of it lies on one side, or the \
         surface is smaller than a cell"
    )]
    NoZero,
    /// The field of the isosurface has another grid than the distance field.
    #[error(
        "the field of the isosurface and the distance field have different grids: make the one from the other"
    )]
    OtherGrid,
    /// The finest mesh would be too large.
    #[error("{levels} levels give {vertices} vertices, more than the limit of {limit}: take fewer levels")]
    TooManyVertices {
        /// Levels asked for.
        levels: u32,
        /// Vertices of the finest mesh.
        vertices: u64,
        /// Most vertices allowed.
        limit: u64,
    },
    /// An option is not in its range.
    #[error("option {name} is {value}, but should be {range}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// What it is.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
}
