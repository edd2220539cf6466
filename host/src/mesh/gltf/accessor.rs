//! Arrays of positions and indices in buffers.

use std::borrow::Cow;

use super::document::{Accessor, Document};
use crate::mesh::MeshFault;

/// Types of components, by their numbers in the text.
const U8: u32 = 5121;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// Positions, three `f32` each.
pub(super) fn positions(
    document: &Document,
    buffers: &[Cow<[u8]>],
    accessor: usize,
) -> Result<Vec<[f64; 3]>, MeshFault> {
    let accessor = find(document, accessor)?;
    if (accessor.component_type, accessor.kind.as_str()) != (F32, "VEC3") || accessor.normalized {
        return Err(MeshFault::Unsupported { what: "a position that is not three floats".to_owned() });
    }
    let elements = elements(document, buffers, accessor, 12)?;
    let position = |bytes: &[u8]| {
        let mut floats = bytes.as_chunks().0.iter().map(|&bytes| f64::from(f32::from_le_bytes(bytes)));
        [0; 3].map(|_| floats.next().unwrap_or(f64::NAN))
    };
    Ok(elements.map(position).collect())
}

/// Indices of vertices.
pub(super) fn indices(
    document: &Document,
    buffers: &[Cow<[u8]>],
    accessor: usize,
) -> Result<Vec<u32>, MeshFault> {
    let accessor = find(document, accessor)?;
    let width = match (accessor.component_type, accessor.kind.as_str()) {
        (U8, "SCALAR") => 1,
        (U16, "SCALAR") => 2,
        (U32, "SCALAR") => 4,
        _ => return Err(MeshFault::header("indices that are not unsigned integers")),
    };
    let elements = elements(document, buffers, accessor, width)?;
    Ok(elements
        .map(|bytes| bytes.iter().rev().fold(0, |index, &byte| index << 8 | u32::from(byte)))
        .collect())
}

fn find(document: &Document, accessor: usize) -> Result<&Accessor, MeshFault> {
    let found = document.accessors.get(accessor);
    let found = found.ok_or_else(|| MeshFault::header(format!("there is no accessor {accessor}")))?;
    if found.sparse.is_some() || found.buffer_view.is_none() {
        return Err(MeshFault::Unsupported { what: "a sparse or compressed array".to_owned() });
    }
    Ok(found)
}

/// The bytes of each element, checked to lie in their view and buffer.
fn elements<'a>(
    document: &Document,
    buffers: &'a [Cow<[u8]>],
    accessor: &Accessor,
    width: usize,
) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, MeshFault> {
    let outside = || MeshFault::header("an array reaches beyond its buffer");
    let view = accessor.buffer_view.and_then(|view| document.buffer_views.get(view)).ok_or_else(outside)?;
    let bytes =
        buffers.get(view.buffer).and_then(|bytes| bytes.get(view.byte_offset..)).ok_or_else(outside)?;
    let bytes = bytes.get(..view.byte_length).ok_or_else(outside)?;
    let bytes = bytes.get(accessor.byte_offset..).ok_or_else(outside)?;
    let stride = view.byte_stride.unwrap_or(width);
    if stride < width {
        return Err(MeshFault::header("an array whose elements overlap"));
    }
    let before_last = accessor.count.checked_sub(1).and_then(|count| count.checked_mul(stride));
    let needed = before_last.and_then(|bytes| bytes.checked_add(width)).unwrap_or(0);
    if needed > bytes.len() || (needed == 0 && accessor.count > 0) {
        return Err(outside());
    }
    let bytes = &bytes[..needed];
    Ok((0..accessor.count).map(move |element| &bytes[element * stride..element * stride + width]))
}
