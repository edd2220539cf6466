//! glTF files: JSON that describes nodes, meshes and arrays in buffers, with the buffers inside (`.glb`, or base64) or
//! beside it.
//!
//! Source: *glTF 2.0 Specification*, Khronos, 2021. Read are the triangles, strips and fans of all meshes of the nodes of
//! the default scene, at the places that the nodes give them. Files of this format repeat vertices along seams of normals
//! and textures, so vertices at exactly the same place become one.

mod accessor;
mod buffer;
mod document;
mod scene;
mod write;

use std::path::{Path, PathBuf};

use document::Document;

pub(super) use write::{write_binary, write_text};

use super::{MeshFault, PolygonMesh};

/// First bytes of every GLB file.
pub(super) const MAGIC: &[u8] = b"glTF";

/// Kinds of chunks of GLB files.
const JSON: u32 = 0x4E4F_534A;
const BINARY: u32 = 0x004E_4942;

/// Reads a text or binary file; `folder` is where buffers of their own files lie.
pub(super) fn read(bytes: &[u8], folder: &Path) -> Result<PolygonMesh, MeshFault> {
    let (document, binary) = parse(bytes)?;
    if let Some(extension) = document.extensions_required.first() {
        return Err(MeshFault::Unsupported { what: format!("the extension {extension:?}") });
    }
    let buffers = buffer::load(&document, binary, folder)?;
    scene::assemble(&document, &buffers, bytes.len())
}

/// The files of buffers that a text or binary file names; none if it cannot be read.
pub(super) fn files(bytes: &[u8], folder: &Path) -> Vec<PathBuf> {
    let buffers = parse(bytes).map(|(document, _)| document.buffers).unwrap_or_default();
    buffers.iter().filter_map(|buffer| buffer::path(buffer.uri.as_ref()?, folder)).collect()
}

/// What a file describes, and its binary chunk.
fn parse(bytes: &[u8]) -> Result<(Document, Option<&[u8]>), MeshFault> {
    let (json, binary) = if bytes.starts_with(MAGIC) { chunks(bytes)? } else { (bytes, None) };
    let document = serde_json::from_slice(json)
        .map_err(|cause| MeshFault::header(format!("the JSON is none of glTF: {cause}")))?;
    Ok((document, binary))
}

/// The JSON and the binary chunk of a GLB file.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), MeshFault> {
    let truncated = || MeshFault::Truncated { within: "chunks", byte: bytes.len() };
    let word = |at: usize| {
        let field = bytes.get(at..at + 4).and_then(|field| field.try_into().ok());
        field.map(u32::from_le_bytes).ok_or_else(truncated)
    };
    let version = word(4)?;
    if version != 2 {
        return Err(MeshFault::Unsupported { what: format!("version {version} of glTF") });
    }
    let chunk = |at: usize| {
        let length = word(at)? as usize;
        let data = bytes.get(at + 8..).and_then(|rest| rest.get(..length));
        Ok((word(at + 4)?, data.ok_or_else(truncated)?))
    };
    let (kind, json) = chunk(12)?;
    if kind != JSON {
        return Err(MeshFault::header("the first chunk is not the JSON"));
    }
    let next = 20 + json.len();
    let binary = if next < bytes.len() { Some(chunk(next)?) } else { None };
    Ok((json, binary.and_then(|(kind, data)| (kind == BINARY).then_some(data))))
}
