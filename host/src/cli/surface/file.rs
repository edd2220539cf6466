//! Files of surfaces, meshes and fields, for all steps.

use std::fmt::Display;
use std::fs;
use std::io::Write;
use std::path::Path;

use wavelift_host::field::ScalarField;
use wavelift_host::mesh::{self, MeshFormat, PolygonMesh, Surface, TriangleMesh};
use wavelift_host::subdivision::SubdivisionSurface;
use wavelift_host::surface_codec::{self, EncodeError, Encoded, Limits, Precision, Settings};
use wavelift_host::surface_wavelet::Basis;
use wavelift_host::volume::{self, Fault, in_words};

use crate::cli::exit::Failure;
use crate::cli::input::{RawArgs, open_source, refuse_overwriting};
use crate::cli::output::write_atomically;

/// Bits of a coordinate of a surface that is kept without loss, beside its sign.
const EXACT_BITS: i32 = 24;

/// Whether a file is taken for a mesh: by its name.
pub(super) fn is_mesh(path: &Path) -> bool {
    MeshFormat::of_name(path).is_some()
}

/// Whether a file is taken for a surface with levels: by its name.
pub(super) fn is_surface(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("wsurf"))
}

/// Refuses to write over the files of a mesh or a surface.
fn refuse_over(path: &Path, outputs: &[&Path]) -> Result<(), Failure> {
    let files = mesh::files(path);
    outputs.iter().try_for_each(|output| refuse_overwriting(&files, output))
}

/// Reads a field from a volume, unless one of the files to be written would replace a part of that.
pub(super) fn read_field(path: &Path, raw: &RawArgs, outputs: &[&Path]) -> Result<ScalarField, Failure> {
    let source = open_source(path, raw.layout(None)?.as_ref())?;
    outputs.iter().try_for_each(|output| refuse_overwriting(&source.files(), output))?;
    let volume = volume::read_all(path, source)?;
    let field = ScalarField::from_volume(&volume).map_err(|error| bad(path, error))?;
    let [x, y, z] = field.grid().extent;
    if [x, y, z].contains(&1) {
        let what = format_args!("is {x}x{y}x{z}: a surface takes two samples or more along x, y and z");
        return Err(bad(path, what));
    }
    Ok(field)
}

/// Reads triangles, unless a file to be written would replace them.
pub(super) fn read_mesh(path: &Path, outputs: &[&Path]) -> Result<TriangleMesh, Failure> {
    refuse_over(path, outputs)?;
    mesh::read(path).map_err(|error| Failure::new(error.kind(), error))
}

/// Reads polygons, unless a file to be written would replace them.
pub(super) fn read_polygons(path: &Path, outputs: &[&Path]) -> Result<PolygonMesh, Failure> {
    refuse_over(path, outputs)?;
    mesh::read_polygons(path).map_err(|error| Failure::new(error.kind(), error))
}

/// Writes a mesh in the format that its name asks for.
pub(super) fn write_mesh(surface: &impl Surface, path: &Path) -> Result<(), Failure> {
    mesh::write(surface, path).map_err(|error| Failure::new(error.kind(), error))
}

/// Refuses a name that is no mesh's before any work is done.
pub(super) fn refuse_other_than_mesh(path: &Path) -> Result<(), Failure> {
    if is_mesh(path) {
        return Ok(());
    }
    Err(Failure::at(
        path,
        Fault::Usage,
        "is no name of a mesh: end it with .ply, .obj, .stl, .off, .gltf or .glb",
    ))
}

/// Refuses the name of a mesh for a surface before any work is done: what is written is no mesh.
pub(super) fn refuse_mesh(path: &Path) -> Result<(), Failure> {
    if !is_mesh(path) {
        return Ok(());
    }
    Err(Failure::at(
        path,
        Fault::Usage,
        "is the name of a mesh, and a surface is to be written: end it with .wsurf, and make meshes of it with decode",
    ))
}

/// Takes a length above 0.
pub(super) fn length(text: &str) -> Result<f64, &'static str> {
    let length = text.parse().ok().filter(|length: &f64| length.is_finite() && *length > 0.0);
    length.ok_or("a number above 0")
}

/// Encodes a surface that came from `path`.
pub(super) fn encode(
    path: &Path,
    surface: &SubdivisionSurface,
    settings: &Settings,
) -> Result<Encoded, Failure> {
    surface_codec::encode(surface, settings).map_err(|error| match error {
        EncodeError::Precision { .. } | EncodeError::Range { .. } | EncodeError::Levels { .. } => {
            Failure::at(path, Fault::Usage, error)
        }
        _ => bad(path, error),
    })
}

/// Reads the file of a surface, or its first `most` bytes, unless a file to be written would replace it.
pub(super) fn read_bytes(path: &Path, most: Option<usize>, outputs: &[&Path]) -> Result<Vec<u8>, Failure> {
    refuse_over(path, outputs)?;
    let mut bytes = fs::read(path)
        .map_err(|cause| Failure::at(path, Fault::Io, format_args!("cannot read: {}", in_words(&cause))))?;
    bytes.truncate(most.unwrap_or(usize::MAX));
    Ok(bytes)
}

/// Reads a surface with levels, unless a file to be written would replace it.
pub(super) fn read_surface(path: &Path, outputs: &[&Path]) -> Result<SubdivisionSurface, Failure> {
    surface_codec::decode(&read_bytes(path, None, outputs)?, Limits::default())
        .map_err(|error| bad(path, error))
}

/// Reads level `level` of a surface, the finest by default, or a mesh; and the number of the patch of each face. Not if
/// a file to be written would replace it.
pub(super) fn read_level(
    path: &Path,
    level: Option<u32>,
    outputs: &[&Path],
) -> Result<(PolygonMesh, Vec<u32>), Failure> {
    if !is_surface(path) {
        if level.is_some() {
            return Err(Failure::at(path, Fault::Usage, "is a mesh, which has no levels: leave --level out"));
        }
        let mesh = read_polygons(path, outputs)?;
        let patches = (0..mesh.faces().len() as u32).collect();
        return Ok((mesh, patches));
    }
    let surface = read_surface(path, outputs)?;
    let level = level.unwrap_or(surface.levels);
    refuse_level(path, &surface, level)?;
    Ok((surface.level(level), patches(&surface, level)))
}

/// Refuses a level that the surface does not have.
pub(super) fn refuse_level(path: &Path, surface: &SubdivisionSurface, level: u32) -> Result<(), Failure> {
    if level <= surface.levels {
        return Ok(());
    }
    let levels = surface.levels;
    Err(Failure::at(
        path,
        Fault::Usage,
        format_args!("has levels 0, the base mesh, to {levels}: there is no level {level}"),
    ))
}

/// The face of the base mesh that each face of a level comes from.
fn patches(surface: &SubdivisionSurface, level: u32) -> Vec<u32> {
    let faces = surface.base.iter().enumerate();
    let of_face = |(face, corners): (usize, &[u32])| {
        let count = if level == 0 { 1 } else { corners.len() << (2 * (level - 1)) };
        std::iter::repeat_n(face as u32, count)
    };
    faces.flat_map(of_face).collect()
}

/// Encodes a surface without loss to speak of: coordinates keep 24 bits.
pub(super) fn encode_exactly(path: &Path, surface: &SubdivisionSurface) -> Result<Encoded, Failure> {
    let largest = surface.positions.iter().map(|point| point.abs().max_element()).fold(0.0, f64::max);
    let unit = (largest.log2().ceil().max(-900.0) - f64::from(EXACT_BITS)).exp2();
    let settings = Settings { basis: Basis::Bilinear, ..Settings::new(Precision::Lossless { unit }) };
    surface_codec::encode(surface, &settings).map_err(|error| bad(path, error))
}

/// Writes the bytes of a file, whole or not at all.
pub(super) fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_atomically(path, |file| file.write_all(bytes).map_err(|cause| Failure::cannot_write(path, &cause)))
}

/// A failure because of what is in a file.
pub(super) fn bad(path: &Path, error: impl Display) -> Failure {
    Failure::at(path, Fault::Data, error)
}
