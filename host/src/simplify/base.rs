//! The base mesh of a surface: edges collapsed, then removed.

use super::{Constraints, History, SimplifyError, Target, collapse_edges, remove_edges};
use crate::mesh::{PolygonMesh, TriangleMesh};

/// A base mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseMesh {
    /// Polygons of three to five sides.
    pub mesh: PolygonMesh,
    /// The largest error that an edge collapse was taken for, in units of the positions.
    pub error: f64,
    /// How the triangles were collapsed that its polygons are made of, if that was to be recorded.
    pub history: Option<History>,
}

/// Makes the base mesh of a manifold, with the topology, the boundary and the features of the triangles.
///
/// # Errors
/// Those of [`collapse_edges`].
///
/// Cost: that of [`collapse_edges`]; edge removal is small beside it.
pub fn base_mesh(
    mesh: &TriangleMesh,
    constraints: &Constraints,
    target: Target,
) -> Result<BaseMesh, SimplifyError> {
    let collapsed = collapse_edges(mesh, constraints, target)?;
    let mut triangles = PolygonMesh::from(collapsed.mesh);
    triangles.features = collapsed.features;
    let mesh = remove_edges(&triangles);
    Ok(BaseMesh { mesh, error: collapsed.error, history: collapsed.history })
}
