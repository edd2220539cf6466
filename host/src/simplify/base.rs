//! The base mesh of a surface: edges collapsed, then removed.

use super::{Constraints, SimplifyError, Target, collapse_edges, remove_edges};
use crate::mesh::{PolygonMesh, TriangleMesh};

/// Makes the base mesh of a manifold: polygons of three to five sides, with the topology, the boundary and the features of
/// the triangles.
///
/// # Errors
/// Those of [`collapse_edges`].
///
/// Cost: that of [`collapse_edges`]; edge removal is small beside it.
pub fn base_mesh(
    mesh: &TriangleMesh,
    constraints: &Constraints,
    target: Target,
) -> Result<PolygonMesh, SimplifyError> {
    let collapsed = collapse_edges(mesh, constraints, target)?;
    let mut triangles = PolygonMesh::from(collapsed.mesh);
    triangles.features = collapsed.features;
    Ok(remove_edges(&triangles))
}
