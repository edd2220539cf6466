//! OBJ files: lines of text, `v x y z` for a vertex and `f a b c …` for a face.
//!
//! Source: *Object Files (.obj)*, appendix B1 of the Advanced Visualizer manual, Wavefront. Only vertices and faces are
//! read; texture coordinates, normals, lines, points, groups and materials are passed over.

use std::io::{self, Write};

use super::builder::Builder;
use super::text::{Lines, number};
use super::{MeshFault, PolygonMesh, Surface};

pub(super) fn read(bytes: &[u8]) -> Result<PolygonMesh, MeshFault> {
    let mut mesh = Builder::default();
    let mut corners = Vec::new();
    let mut lines = Lines::new(bytes);
    while let Some(line) = lines.next() {
        let mut words = line.without_comment().words();
        match words.next() {
            Some(b"v") => {
                mesh.vertex(line.point(words)?)?;
            }
            Some(b"f") => {
                corners.clear();
                let mut line = line;
                while let Some(word) = words.next() {
                    if word == b"\\" {
                        line = lines.needed("face")?;
                        words = line.without_comment().words();
                        continue;
                    }
                    let vertex = word.split(|&byte| byte == b'/').next().and_then(number::<i64>);
                    let vertex = vertex.filter(|&vertex| vertex != 0);
                    let vertex = vertex.ok_or_else(|| line.fault("a face `f a b c` of vertices from 1"))?;
                    corners.push(mesh.index(from_zero(vertex, mesh.vertices()))?);
                }
                mesh.face(&corners)?;
            }
            _ => {}
        }
    }
    mesh.finish()
}

/// Vertices count from 1, or backwards from the last one at -1.
fn from_zero(vertex: i64, vertices: usize) -> i64 {
    if vertex > 0 { vertex - 1 } else { (vertices as i64).saturating_add(vertex) }
}

pub(super) fn write(surface: &impl Surface, out: &mut impl Write) -> io::Result<()> {
    for point in surface.points() {
        writeln!(out, "v {} {} {}", point.x, point.y, point.z)?;
    }
    for face in surface.polygons() {
        write!(out, "f")?;
        face.iter().try_for_each(|&corner| write!(out, " {}", u64::from(corner) + 1))?;
        writeln!(out)?;
    }
    Ok(())
}
