//! Files of meshes in the formats that others use.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::ply::PlyKind;
use super::{MeshFault, MeshFileError, PolygonMesh, Surface, TriangleMesh, gltf, obj, off, ply, stl};
use crate::atomic::AtomicFile;

/// A format of mesh files. PLY, OBJ and OFF keep polygons as they are, the others hold their triangles; STL (binary) and
/// glTF round positions to `f32`, the others keep every bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// PLY with little-endian elements.
    Ply,
    /// PLY with elements as text.
    PlyText,
    /// Wavefront OBJ.
    Obj,
    /// Binary STL.
    Stl,
    /// STL as text.
    StlText,
    /// OFF of Geomview, as text.
    Off,
    /// glTF with its arrays in base64.
    Gltf,
    /// glTF in one binary file.
    Glb,
}

impl MeshFormat {
    /// All formats.
    pub const ALL: [Self; 8] =
        [Self::Ply, Self::PlyText, Self::Obj, Self::Stl, Self::StlText, Self::Off, Self::Gltf, Self::Glb];

    /// The format that a name stands for: the binary one if there are two.
    pub fn of_name(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        Some(match extension.as_str() {
            "ply" => Self::Ply,
            "obj" => Self::Obj,
            "stl" => Self::Stl,
            "off" => Self::Off,
            "gltf" => Self::Gltf,
            "glb" => Self::Glb,
            _ => return None,
        })
    }

    /// The format of bytes, told by their beginning, or by `path` where that does not tell: OBJ has no beginning.
    fn of_bytes(bytes: &[u8], path: &Path) -> Option<Self> {
        let begins = |magic| bytes.starts_with(magic);
        Some(match () {
            () if begins(ply::MAGIC) => Self::Ply,
            () if begins(gltf::MAGIC) => Self::Glb,
            () if stl::is_binary(bytes) => Self::Stl,
            () if bytes.trim_ascii_start().starts_with(b"{") => Self::Gltf,
            () if off::is_off(bytes) => Self::Off,
            () if stl::is_text(bytes) => Self::StlText,
            () => return Self::of_name(path),
        })
    }
}

/// Reads a file of polygons, in the format that its bytes or else its name tell.
///
/// Vertices at the same place become one in STL and glTF files, which repeat them; elsewhere they stay apart. Positions
/// are finite, and faces have three corners or more that name vertices. Nothing else is checked.
///
/// # Errors
/// Any fault of the file is told with the line, byte, vertex or face of it.
///
/// Cost: memory in proportion to the length of the file.
pub fn read_polygons(path: &Path) -> Result<PolygonMesh, MeshFileError> {
    let bytes = read_file(path).map_err(|cause| MeshFileError::Read { path: path.to_owned(), cause })?;
    parse(&bytes, path).map_err(|cause| MeshFileError::Data { path: path.to_owned(), cause })
}

/// Reads a file as [`read_polygons`] and cuts the polygons into triangles, as
/// [`Triangulation`](super::Triangulation) does.
///
/// # Errors
/// As [`read_polygons`].
pub fn read(path: &Path) -> Result<TriangleMesh, MeshFileError> {
    read_polygons(path).map(|mesh| mesh.triangulated())
}

/// The files that a mesh is read from: its own, and those of the buffers of glTF.
pub fn files(path: &Path) -> Vec<PathBuf> {
    let is_gltf = matches!(MeshFormat::of_name(path), Some(MeshFormat::Gltf | MeshFormat::Glb));
    let bytes = if is_gltf { read_file(path).unwrap_or_default() } else { Vec::new() };
    let buffers = gltf::files(&bytes, path.parent().unwrap_or(Path::new(".")));
    std::iter::once(path.to_owned()).chain(buffers).collect()
}

fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    let metadata = File::open(path)?.metadata()?;
    if metadata.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !metadata.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file"));
    }
    fs::read(path)
}

/// Reads from memory; `path` helps where the bytes do not tell their format, and tells where further files lie.
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<PolygonMesh, MeshFault> {
    match MeshFormat::of_bytes(bytes, path).ok_or(MeshFault::UnknownFormat)? {
        MeshFormat::Ply | MeshFormat::PlyText => ply::read(bytes),
        MeshFormat::Obj => obj::read(bytes),
        MeshFormat::Stl | MeshFormat::StlText => stl::read(bytes),
        MeshFormat::Off => off::read(bytes),
        MeshFormat::Gltf | MeshFormat::Glb => gltf::read(bytes, path.parent().unwrap_or(Path::new("."))),
    }
}

/// Writes a mesh in the format that the name tells, the binary one if there are two. The file appears whole or not at
/// all.
///
/// # Errors
/// [`MeshFileError::Name`], and those of [`write_as`].
pub fn write(surface: &impl Surface, path: &Path) -> Result<(), MeshFileError> {
    let format = MeshFormat::of_name(path).ok_or_else(|| MeshFileError::Name { path: path.to_owned() })?;
    write_as(surface, format, path)
}

/// Writes a mesh in a given format.
///
/// # Errors
/// [`MeshFileError::Data`] if a position is not finite, or not as `f32` where the format rounds to that;
/// [`MeshFileError::Write`] as the system says.
pub fn write_as(surface: &impl Surface, format: MeshFormat, path: &Path) -> Result<(), MeshFileError> {
    if let Some(vertex) = first_unwritable(surface, format) {
        let cause = MeshFault::NotFinite { vertex };
        return Err(MeshFileError::Data { path: path.to_owned(), cause });
    }
    let written = AtomicFile::create(path).and_then(|mut file| {
        write_to(surface, format, &mut file)?;
        file.commit()
    });
    written.map_err(|cause| MeshFileError::Write { path: path.to_owned(), cause })
}

fn first_unwritable(surface: &impl Surface, format: MeshFormat) -> Option<usize> {
    let rounds = matches!(format, MeshFormat::Stl | MeshFormat::Gltf | MeshFormat::Glb);
    let mut points = surface.points().iter();
    points.position(|point| !if rounds { point.as_vec3().is_finite() } else { point.is_finite() })
}

pub(super) fn write_to(surface: &impl Surface, format: MeshFormat, out: &mut impl Write) -> io::Result<()> {
    match format {
        MeshFormat::Ply => ply::write(surface, PlyKind::Little, out),
        MeshFormat::PlyText => ply::write(surface, PlyKind::Text, out),
        MeshFormat::Obj => obj::write(surface, out),
        MeshFormat::Stl => stl::write_binary(surface, out),
        MeshFormat::StlText => stl::write_text(surface, out),
        MeshFormat::Off => off::write(surface, out),
        MeshFormat::Gltf => gltf::write_text(surface, out),
        MeshFormat::Glb => gltf::write_binary(surface, out),
    }
}

#[cfg(test)]
mod tests;
