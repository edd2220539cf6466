//! STL files: triangles one by one, without shared vertices. Corners at exactly the same place become one vertex.
//!
//! Source: *StereoLithography Interface Specification*, 3D Systems, 1988. Normals are not read and are written as the
//! corners have them; the two bytes of attributes are passed over.

use std::io::{self, Write};

use super::builder::Builder;
use super::text::Lines;
use super::{MeshFault, Point, PolygonMesh, Surface, Triangulation};

/// Bytes before the triangles of a binary file: a free text and their count.
const HEADER: usize = 84;

/// Bytes of a triangle: a normal and three corners of `f32`, and two of attributes.
const TRIANGLE: usize = 50;

/// Whether a file has the length that the count in its header asks for.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|count| (bytes.len() - HEADER) as u64 == u64::from(count) * TRIANGLE as u64)
}

/// Whether a file begins as a text of this format does.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"solid")
}

pub(super) fn read(bytes: &[u8]) -> Result<PolygonMesh, MeshFault> {
    if is_text(bytes) && !is_binary(bytes) { read_text(bytes) } else { read_binary(bytes) }
}

fn count(bytes: &[u8]) -> Option<u32> {
    let field = bytes.get(HEADER - 4..HEADER)?;
    field.try_into().ok().map(u32::from_le_bytes)
}

fn read_binary(bytes: &[u8]) -> Result<PolygonMesh, MeshFault> {
    let promised = count(bytes).ok_or(MeshFault::Truncated { within: "header", byte: bytes.len() })?;
    let (triangles, rest) = bytes[HEADER..].as_chunks::<TRIANGLE>();
    if triangles.len() < promised as usize {
        return Err(MeshFault::Truncated { within: "triangles", byte: bytes.len() });
    }
    if triangles.len() > promised as usize || !rest.is_empty() {
        let what = format!("the header promises {promised} triangles, the file has bytes beyond them");
        return Err(MeshFault::header(what));
    }
    let mut mesh = Builder::welding();
    for triangle in triangles {
        let mut corners = [0; 3];
        for (corner, bytes) in corners.iter_mut().zip(triangle[12..48].as_chunks::<12>().0) {
            let position = [0, 4, 8].map(|at| {
                f64::from(f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]))
            });
            *corner = mesh.vertex(position)?;
        }
        mesh.face(&corners)?;
    }
    mesh.finish()
}

fn read_text(bytes: &[u8]) -> Result<PolygonMesh, MeshFault> {
    let mut mesh = Builder::welding();
    let mut corners = Vec::new();
    let mut ended = true;
    for line in Lines::new(bytes) {
        let mut words = line.words();
        match words.next().map(<[u8]>::to_ascii_lowercase).as_deref() {
            Some(b"vertex") => corners.push(mesh.vertex(line.point(words)?)?),
            Some(b"endloop") if corners.len() == 3 => {
                mesh.face(&corners)?;
                corners.clear();
            }
            Some(b"solid") => ended = false,
            Some(b"endsolid") => ended = true,
            None | Some(b"facet" | b"outer" | b"endfacet") => {}
            _ => return Err(line.fault("facet, outer loop, three times vertex, endloop or endfacet")),
        }
    }
    if !corners.is_empty() || !ended {
        return Err(MeshFault::Truncated { within: "triangles", byte: bytes.len() });
    }
    mesh.finish()
}

/// Writes a binary file of triangles; positions are rounded to `f32`.
pub(super) fn write_binary(surface: &impl Surface, out: &mut impl Write) -> io::Result<()> {
    let triangles = Triangulation::new(surface).triangles;
    let mut header = [b' '; HEADER];
    header[..17].copy_from_slice(b"triangles of mesh");
    header[HEADER - 4..].copy_from_slice(&(triangles.len() as u32).to_le_bytes());
    out.write_all(&header)?;
    for triangle in triangles {
        let corners = triangle.map(|corner| surface.points()[corner as usize]);
        let floats = [normal(corners)].into_iter().chain(corners).flat_map(|point| point.to_array());
        floats.map(|value| (value as f32).to_le_bytes()).try_for_each(|bytes| out.write_all(&bytes))?;
        out.write_all(&[0; 2])?;
    }
    Ok(())
}

/// Writes a text of triangles, with all digits that the positions need.
pub(super) fn write_text(surface: &impl Surface, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "solid mesh")?;
    for triangle in Triangulation::new(surface).triangles {
        let corners = triangle.map(|corner| surface.points()[corner as usize]);
        let normal = normal(corners).as_vec3();
        writeln!(out, "facet normal {} {} {}\nouter loop", normal.x, normal.y, normal.z)?;
        for corner in corners {
            writeln!(out, "vertex {} {} {}", corner.x, corner.y, corner.z)?;
        }
        writeln!(out, "endloop\nendfacet")?;
    }
    writeln!(out, "endsolid mesh")
}

fn normal([a, b, c]: [Point; 3]) -> Point {
    (b - a).cross(c - a).normalize_or_zero()
}
