//! Whether a base mesh, a field and options can be worked with.

use super::level::Space;
use super::{WrapError, WrapOptions};
use crate::field::ScalarField;
use crate::mesh::{Faces, PolygonMesh};

/// How far outside the field the base mesh may be, as a part of the field's longest side. Simplification keeps volumes,
/// and so pushes the corners of large faces beyond a curved surface, and over the border.
const MOST_OUTSIDE: f64 = 0.25;

/// Looks at the distance field.
pub(super) fn field(distance: &ScalarField) -> Result<(), WrapError> {
    let extent = distance.grid().extent;
    if let Some(axis) = extent.iter().position(|&nodes| nodes < 2) {
        return Err(WrapError::FieldTooThin { axis, nodes: extent[axis] });
    }
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for (index, &value) in distance.values().iter().enumerate() {
        if !value.is_finite() {
            return Err(WrapError::FieldNotFinite { index });
        }
        (low, high) = (low.min(value), high.max(value));
    }
    if low > 0.0 || high < 0.0 || low == high { Err(WrapError::NoZero) } else { Ok(()) }
}

/// Whether two fields have one grid.
pub(super) fn same_grid(distance: &ScalarField, field: &ScalarField) -> Result<(), WrapError> {
    if distance.grid() == field.grid() { Ok(()) } else { Err(WrapError::OtherGrid) }
}

/// Looks at the base mesh, but not at how its faces hang together.
pub(super) fn base(mesh: &PolygonMesh, space: &Space) -> Result<(), WrapError> {
    if mesh.faces().is_empty() {
        return Err(WrapError::Empty);
    }
    for (vertex, &place) in mesh.positions.iter().enumerate() {
        if !place.is_finite() {
            return Err(WrapError::VertexNotFinite { vertex });
        }
        let distance = space.border.excess(place);
        if distance > MOST_OUTSIDE * space.border.longest_side() {
            return Err(WrapError::OutsideField { vertex, distance });
        }
    }
    let mut corners = Vec::new();
    for (face, around) in mesh.faces().iter().enumerate() {
        corners.clear();
        corners.extend_from_slice(around);
        corners.sort_unstable();
        if corners.array_windows().any(|[one, other]| one == other) {
            return Err(WrapError::RepeatedCorner { face });
        }
    }
    Ok(())
}

/// Looks at the options, and at how large they make the finest mesh.
pub(super) fn options(mesh: &PolygonMesh, options: &WrapOptions) -> Result<(), WrapError> {
    let named = |name, value: f64, range, good: bool| match good {
        true => Ok(()),
        false => Err(WrapError::Option { name, value, range }),
    };
    let WrapOptions { relaxation, reach, tolerance, .. } = *options;
    named("relaxation", relaxation, "from 0 to 1", (0.0..=1.0).contains(&relaxation))?;
    named("reach", reach, "positive", reach > 0.0 && reach.is_finite())?;
    named("tolerance", tolerance, "0 or positive", tolerance >= 0.0)?;
    let vertices = finest_vertices(mesh.positions.len(), mesh.faces(), options.levels);
    if vertices > options.vertex_limit {
        return Err(WrapError::TooManyVertices {
            levels: options.levels,
            vertices,
            limit: options.vertex_limit,
        });
    }
    Ok(())
}

/// Vertices of the finest mesh, if no edge is on the boundary: those on it have more edges than half the sides.
fn finest_vertices(base: usize, faces: &Faces, levels: u32) -> u64 {
    let (mut vertices, mut faces, mut sides) =
        (base as u64, faces.len() as u64, faces.corners().len() as u64);
    for _ in 0..levels {
        vertices = vertices.saturating_add(sides.div_ceil(2)).saturating_add(faces);
        (faces, sides) = (sides, sides.saturating_mul(4));
    }
    vertices
}
