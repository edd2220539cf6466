//! PLY files: a header of text lines that describes elements and their properties, then the elements as text or binary.
//!
//! Source: Turk, *The PLY Polygon File Format*, 1994. Of the vertices x, y and z are read, of the faces the list
//! `vertex_indices` (or `vertex_index`); other properties and elements are passed over.

mod header;
mod values;

use std::io::{self, Write};

use header::{Element, Encoding, Header, Property};
use values::{Scalar, Values};

use super::builder::Builder;
use super::{MeshFault, PolygonMesh, Surface};

/// First bytes of every PLY file.
pub(super) const MAGIC: &[u8] = b"ply";

pub(super) fn read(bytes: &[u8]) -> Result<PolygonMesh, MeshFault> {
    let header = Header::read(bytes)?;
    let mut values = Values::new(bytes, &header);
    let mut mesh = Builder::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut values, &mut mesh)?,
            "face" => read_faces(element, &mut values, &mut mesh)?,
            _ => skip(element, &mut values)?,
        }
    }
    mesh.finish()
}

fn read_vertices(element: &Element, values: &mut Values, mesh: &mut Builder) -> Result<(), MeshFault> {
    let place = |name| {
        let found = element.properties.iter().position(|property| property.is_scalar(name));
        found.ok_or_else(|| MeshFault::header(format!("the header has no property {name} of its vertices")))
    };
    let axes = [place("x")?, place("y")?, place("z")?];
    mesh.expect_vertices(element.count, values.left());
    let mut row = vec![0.0; element.properties.len()];
    for _ in 0..element.count {
        for (value, property) in row.iter_mut().zip(&element.properties) {
            match property.list {
                Some(count) => skip_list(count, property.scalar, values)?,
                None => *value = values.next(property.scalar, "vertices")?,
            }
        }
        mesh.vertex(axes.map(|axis| row[axis]))?;
    }
    Ok(())
}

fn read_faces(element: &Element, values: &mut Values, mesh: &mut Builder) -> Result<(), MeshFault> {
    let is_corners =
        |property: &Property| property.is_list("vertex_indices") || property.is_list("vertex_index");
    let Some(place) = element.properties.iter().position(is_corners) else {
        return Err(MeshFault::header("the header has no list vertex_indices of its faces"));
    };
    let mut corners = Vec::new();
    for _ in 0..element.count {
        for (property, is_corners) in element.properties.iter().zip((0..).map(|index| index == place)) {
            match property.list {
                Some(count) if is_corners => {
                    corners.clear();
                    for _ in 0..list_len(count, values)? {
                        let value = values.next(property.scalar, "faces")?;
                        // What is no index, such as 1.5, becomes one that no vertex has.
                        let index = if value.fract() == 0.0 { value as i64 } else { -1 };
                        corners.push(mesh.index(index)?);
                    }
                }
                Some(count) => skip_list(count, property.scalar, values)?,
                None => {
                    values.next(property.scalar, "faces")?;
                }
            }
        }
        mesh.face(&corners)?;
    }
    Ok(())
}

fn skip(element: &Element, values: &mut Values) -> Result<(), MeshFault> {
    // An element without properties has no bytes, however many of it there are.
    let count = if element.properties.is_empty() { 0 } else { element.count };
    for _ in 0..count {
        for property in &element.properties {
            match property.list {
                Some(count) => skip_list(count, property.scalar, values)?,
                None => {
                    values.next(property.scalar, "elements")?;
                }
            }
        }
    }
    Ok(())
}

fn list_len(count: Scalar, values: &mut Values) -> Result<u64, MeshFault> {
    let value = values.next(count, "lists")?;
    if value < 0.0 || value.fract() != 0.0 || !value.is_finite() {
        return Err(MeshFault::header(format!("a list of {value} entries, before byte {}", values.at())));
    }
    Ok(value as u64)
}

fn skip_list(count: Scalar, scalar: Scalar, values: &mut Values) -> Result<(), MeshFault> {
    for _ in 0..list_len(count, values)? {
        values.next(scalar, "lists")?;
    }
    Ok(())
}

/// How to write the elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlyKind {
    Text,
    Little,
}

/// Writes vertices of `float` where that is exact and else of `double`, and faces of as many sides as they have.
pub(super) fn write(surface: &impl Surface, kind: PlyKind, out: &mut impl Write) -> io::Result<()> {
    let coordinates = surface.points().iter().flat_map(|point| point.to_array());
    let short = coordinates.clone().all(|value| f64::from(value as f32) == value);
    let wide = surface.polygons().any(|face| face.len() > usize::from(u8::MAX));
    writeln!(out, "ply")?;
    let encoding = if kind == PlyKind::Text { Encoding::Text } else { Encoding::Little };
    writeln!(out, "format {} 1.0\nelement vertex {}", encoding.name(), surface.points().len())?;
    for axis in ["x", "y", "z"] {
        writeln!(out, "property {} {axis}", if short { "float" } else { "double" })?;
    }
    let count = if wide { "uint" } else { "uchar" };
    writeln!(
        out,
        "element face {}\nproperty list {count} uint vertex_indices\nend_header",
        surface.polygons().len()
    )?;
    if kind == PlyKind::Text {
        return write_text(surface, out);
    }
    for value in coordinates {
        if short {
            out.write_all(&(value as f32).to_le_bytes())?
        } else {
            out.write_all(&value.to_le_bytes())?
        }
    }
    for face in surface.polygons() {
        let sides = (face.len() as u32).to_le_bytes();
        out.write_all(if wide { &sides } else { &sides[..1] })?;
        face.iter().try_for_each(|corner| out.write_all(&corner.to_le_bytes()))?;
    }
    Ok(())
}

fn write_text(surface: &impl Surface, out: &mut impl Write) -> io::Result<()> {
    for point in surface.points() {
        writeln!(out, "{} {} {}", point.x, point.y, point.z)?;
    }
    for face in surface.polygons() {
        write!(out, "{}", face.len())?;
        face.iter().try_for_each(|corner| write!(out, " {corner}"))?;
        writeln!(out)?;
    }
    Ok(())
}
