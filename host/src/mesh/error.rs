//! What can go wrong with a file of a mesh, and whose fault it is.

use std::io;
use std::path::PathBuf;

use crate::volume::{Fault, excerpt, in_words};

/// What is wrong with the bytes of a mesh. Texts from the file are quoted and shortened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFault {
    /// No format is recognized.
    #[error("neither the name nor the bytes are those of a PLY, OBJ, STL, OFF, glTF or GLB file")]
    UnknownFormat,
    /// A line that says something else than it should.
    #[error("line {number} is {text}: {expected} is needed there")]
    Line {
        /// Number of the line, the first being 1.
        number: usize,
        /// The line.
        text: String,
        /// What should stand there.
        expected: &'static str,
    },
    /// The bytes end too early.
    #[error("the file ends within its {within}, at byte {byte}: it is damaged or cut short")]
    Truncated {
        /// What the bytes to come belong to.
        within: &'static str,
        /// Where the file ends, or where the part begins that does not fit in.
        byte: usize,
    },
    /// A header that cannot be followed.
    #[error("{what}")]
    Header {
        /// What is wrong with it.
        what: String,
    },
    /// A face names a vertex that is not there.
    #[error("face {face} names vertex {index}, the file has {vertices} (counted from 0)")]
    Index {
        /// The face, the first being 0.
        face: usize,
        /// The vertex that it names.
        index: i64,
        /// Vertices of the file.
        vertices: usize,
    },
    /// A face of one or two corners, or none.
    #[error("face {face} has {sides} corners: a face has three or more")]
    Sides {
        /// The face, the first being 0.
        face: usize,
        /// Its corners.
        sides: usize,
    },
    /// A position that is no point.
    #[error("vertex {vertex} is NaN or infinite")]
    NotFinite {
        /// The vertex, the first being 0.
        vertex: usize,
    },
    /// Points, but no surface.
    #[error("the file has no faces, so that there is no surface ({vertices} vertices)")]
    NoFaces {
        /// Vertices of the file.
        vertices: usize,
    },
    /// More than indices of 32 bits can number.
    #[error("the mesh has 2^32 vertices or corners of faces, or more")]
    TooLarge,
    /// Something that glTF files may hold and this reader does not read.
    #[error("{what} is not read: export the mesh without it")]
    Unsupported {
        /// Its name.
        what: String,
    },
}

impl MeshFault {
    pub(super) fn line(number: usize, text: &[u8], expected: &'static str) -> Self {
        Self::Line { number, text: excerpt(&String::from_utf8_lossy(text)), expected }
    }

    pub(super) fn header(what: impl Into<String>) -> Self {
        Self::Header { what: what.into() }
    }
}

/// Why a mesh could not be read or written. The text is complete.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFileError {
    /// The system refused to give the bytes.
    #[error("{}: cannot read: {}", path.display(), in_words(cause))]
    Read {
        /// File in question.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// The system refused to take the bytes. Nothing has changed at the path then.
    #[error("{}: cannot write: {}", path.display(), in_words(cause))]
    Write {
        /// File in question.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// The bytes are no mesh, or the mesh is none that the format holds.
    #[error("{}: {cause}", path.display())]
    Data {
        /// File in question.
        path: PathBuf,
        /// What is wrong.
        cause: MeshFault,
    },
    /// A name that does not tell the format to write.
    #[error("{}: give a name that ends in .ply, .obj, .stl, .off, .gltf or .glb", path.display())]
    Name {
        /// File in question.
        path: PathBuf,
    },
}

impl MeshFileError {
    /// Whose fault it is.
    pub const fn kind(&self) -> Fault {
        match self {
            Self::Read { .. } | Self::Write { .. } => Fault::Io,
            Self::Data { .. } => Fault::Data,
            Self::Name { .. } => Fault::Usage,
        }
    }
}
