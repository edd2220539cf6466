//! Writing of one mesh of triangles as a glTF file.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use crate::mesh::{Surface, Triangulation};

/// Bytes of the header of a GLB file, and of that of a chunk.
const HEADER: usize = 12;
const CHUNK: usize = 8;

/// Writes a GLB file; positions are rounded to `f32`.
///
/// # Errors
/// As `out`, and if the file would have 2^32 bytes or more, which the format cannot say.
pub(in crate::mesh) fn write_binary(surface: &impl Surface, out: &mut impl Write) -> io::Result<()> {
    let (document, buffer) = contents(surface);
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = |bytes: usize| {
        let length = u32::try_from(bytes).map_err(|_| io::Error::from(io::ErrorKind::FileTooLarge));
        length.map(u32::to_le_bytes)
    };
    out.write_all(super::MAGIC)?;
    out.write_all(&2_u32.to_le_bytes())?;
    out.write_all(&length(HEADER + CHUNK + text.len() + CHUNK + buffer.len())?)?;
    for (kind, bytes) in [(super::JSON, &text), (super::BINARY, &buffer)] {
        out.write_all(&length(bytes.len())?)?;
        out.write_all(&kind.to_le_bytes())?;
        out.write_all(bytes)?;
    }
    Ok(())
}

/// Writes a text with the arrays in base64; positions are rounded to `f32`.
pub(in crate::mesh) fn write_text(surface: &impl Surface, out: &mut impl Write) -> io::Result<()> {
    let (mut document, buffer) = contents(surface);
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(buffer));
    document["buffers"][0]["uri"] = Value::String(uri);
    out.write_all(document.to_string().as_bytes())
}

/// The JSON, and the positions with the indices of triangles after them.
fn contents(surface: &impl Surface) -> (Value, Vec<u8>) {
    let points = surface.points();
    let triangles = Triangulation::new(surface).triangles;
    let positions = points.iter().flat_map(|point| point.as_vec3().to_array());
    let mut buffer: Vec<u8> = positions.flat_map(f32::to_le_bytes).collect();
    let indices_at = buffer.len();
    buffer.extend(triangles.iter().flatten().flat_map(|corner| corner.to_le_bytes()));
    let first = points.first().copied().unwrap_or_default().as_vec3();
    let low = points.iter().fold(first, |low, point| low.min(point.as_vec3()));
    let high = points.iter().fold(first, |high, point| high.max(point.as_vec3()));
    let document = json!({
        "asset": { "version": "2.0", "generator": "wavelift" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": points.len(), "type": "VEC3",
              "min": low.to_array(), "max": high.to_array() },
            { "bufferView": 1, "componentType": 5125, "count": 3 * triangles.len(), "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": indices_at, "target": 34962 },
            { "buffer": 0, "byteOffset": indices_at, "byteLength": buffer.len() - indices_at, "target": 34963 },
        ],
        "buffers": [{ "byteLength": buffer.len() }],
    });
    (document, buffer)
}
