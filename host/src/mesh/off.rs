//! OFF files: `OFF`, three counts, then a vertex or face a line.
//!
//! Source: *Geomview manual*, "OFF files". The prefixes ST, C and N are taken, and what they add is passed over;
//! 4OFF, nOFF and binary files are refused.

use std::io::{self, Write};

use super::builder::Builder;
use super::text::{Line, Lines, number};
use super::{MeshFault, PolygonMesh, Surface};

/// Whether a file begins as an OFF file does.
pub(super) fn is_off(bytes: &[u8]) -> bool {
    Lines::new(&bytes[..bytes.len().min(1024)])
        .map(Line::without_comment)
        .find(|line| !line.text.is_empty())
        .and_then(|line| line.words().next())
        .is_some_and(|word| word.len() <= 8 && word.ends_with(b"OFF"))
}

pub(super) fn read(bytes: &[u8]) -> Result<PolygonMesh, MeshFault> {
    let mut lines = Lines::new(bytes);
    let [vertices, faces] = read_counts(&mut lines)?;
    let mut mesh = Builder::default();
    mesh.expect_vertices(vertices, bytes.len());
    for _ in 0..vertices {
        let line = filled(&mut lines, "vertices")?;
        mesh.vertex(line.point(line.words())?)?;
    }
    let mut corners = Vec::new();
    for _ in 0..faces {
        let line = filled(&mut lines, "faces")?;
        let mut words = line.words();
        let sides: usize = words.next().and_then(number).ok_or_else(|| line.fault("a number of corners"))?;
        corners.clear();
        for word in words.by_ref().take(sides) {
            let index = number(word).ok_or_else(|| line.fault("the number of a vertex"))?;
            corners.push(mesh.index(index)?);
        }
        if corners.len() < sides {
            return Err(line.fault("as many vertices as the first number says"));
        }
        mesh.face(&corners)?;
    }
    mesh.finish()
}

/// The next line that is not empty.
fn filled<'a>(lines: &mut Lines<'a>, within: &'static str) -> Result<Line<'a>, MeshFault> {
    loop {
        let line = lines.needed(within)?.without_comment();
        if !line.text.is_empty() {
            return Ok(line);
        }
    }
}

/// Vertices and faces. The counts may stand in the line of the first word.
fn read_counts(lines: &mut Lines) -> Result<[u64; 2], MeshFault> {
    const COUNTS: &str = "numbers of vertices, faces and edges";
    let first = filled(lines, "header")?;
    let mut words = first.words();
    let kind = words.next().unwrap_or_default();
    if !matches!(kind, b"OFF" | b"COFF" | b"NOFF" | b"CNOFF" | b"STOFF" | b"STCOFF" | b"STNOFF" | b"STCNOFF")
    {
        return Err(first.fault("OFF, with ST, C or N before it at most"));
    }
    let mut line = first;
    if words.clone().next().is_none() {
        line = filled(lines, "header")?;
        words = line.words();
    }
    let mut count = || words.next().and_then(number).ok_or_else(|| line.fault(COUNTS));
    Ok([count()?, count()?])
}

pub(super) fn write(surface: &impl Surface, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "OFF\n{} {} 0", surface.points().len(), surface.polygons().len())?;
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
