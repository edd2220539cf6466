//! What can be wrong with a surface or its file.

/// Why a surface cannot be coded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EncodeError {
    /// The base mesh has no face.
    #[error("the base mesh has no face, so that there is no surface to code")]
    Empty,
    /// A vertex belongs to no face.
    #[error("vertex {vertex} of the base mesh belongs to no face: remove it first")]
    Isolated {
        /// Which.
        vertex: usize,
    },
    /// Two faces run along a side in the same direction.
    #[error(
        "side {from}-{to} of the base mesh is used twice in the same direction: orient its faces alike, split edges of more than two faces"
    )]
    Side {
        /// Where the side begins.
        from: u32,
        /// Where it ends.
        to: u32,
    },
    /// There are more or fewer points than vertices.
    #[error("the finest mesh has {expected} vertices, but there are {actual} points")]
    Points {
        /// Vertices of the finest mesh.
        expected: usize,
        /// Points given.
        actual: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("point {vertex} is not finite")]
    NotFinite {
        /// Which.
        vertex: usize,
    },
    /// The precision asked for is zero, negative, not finite, or so coarse that coordinates overflow.
    #[error("the precision {asked} is not a positive number of moderate size")]
    Precision {
        /// What was asked for.
        asked: f64,
    },
    /// Coefficients do not fit 31 bits in the steps asked for.
    #[error(
        "coordinates are too large for a precision of {step}: choose a coarser one, or move the surface nearer to the \
         origin"
    )]
    Range {
        /// The step that coordinates were to be coded in.
        step: f64,
    },
    /// There are more levels than a file can hold.
    #[error("{levels} levels are more than the 16 that a file can hold")]
    Levels {
        /// Levels of the surface.
        levels: u32,
    },
}

/// Why bytes are no surface.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// The bytes end before the base mesh does.
    #[error("the file ends within the base mesh: at least {needed} bytes are needed")]
    Truncated {
        /// How many bytes it takes to read further.
        needed: usize,
    },
    /// The bytes do not begin like a surface.
    #[error("this is no file of a surface")]
    Magic,
    /// The version is not one that is known.
    #[error("the file is of version {version}, and this program reads version {known}", known = super::header::VERSION)]
    Version {
        /// Which.
        version: u8,
    },
    /// A checksum does not match.
    #[error("the {part} is damaged: its checksum does not match")]
    Checksum {
        /// What is damaged.
        part: &'static str,
    },
    /// A field has no meaning.
    #[error("the file is damaged: {what}")]
    Malformed {
        /// What is wrong.
        what: &'static str,
    },
    /// The surface is larger than allowed.
    #[error(
        "the surface has {vertices} vertices, more than the {limit} allowed: raise the limit or decode fewer levels"
    )]
    TooLarge {
        /// Vertices of the finest mesh.
        vertices: u64,
        /// The limit.
        limit: u64,
    },
    /// A level is asked for that there is not.
    #[error("there are levels 0, the base mesh, to {levels}: there is no level {asked}")]
    Level {
        /// Which was asked for.
        asked: u32,
        /// The finest.
        levels: u32,
    },
    /// A region is asked for that there is not.
    #[error("there are {regions} regions, and region {asked} is asked for")]
    Region {
        /// Which was asked for.
        asked: usize,
        /// How many there are.
        regions: usize,
    },
}
