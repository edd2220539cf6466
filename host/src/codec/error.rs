//! What can go wrong with a container, and whose fault it is.

use std::io;

use super::Brick;
use crate::volume::Fault;

/// Why a volume could not be compressed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompressError {
    /// A brick side is 0, or the brick too large.
    #[error("bricks of {}x{}x{} samples are not possible: give --brick sides of at least 1 with at most 2^27 samples", .0[0], .0[1], .0[2])]
    BrickSides([u32; 3]),
    /// More levels than a brick allows.
    #[error("bricks of {}x{}x{} samples allow at most {max} levels", sides[0], sides[1], sides[2])]
    TooManyLevels {
        /// Sides of the bricks.
        sides: [u32; 3],
        /// The most levels they allow.
        max: u8,
    },
    /// Levels were asked for without a transform, or a transform without levels.
    #[error("--wavelet {wavelet} and --levels {levels} contradict each other")]
    Contradiction {
        /// The wavelet asked for.
        wavelet: &'static str,
        /// The levels asked for.
        levels: u8,
    },
    /// The samples are not those of the extent.
    #[error("the volume has {actual} bytes of samples where its extent and type make {expected}")]
    SampleBytes {
        /// Bytes by extent and type.
        expected: u64,
        /// Bytes there are.
        actual: u64,
    },
    /// A brick decodes to other samples than it may: a fault of the codec.
    #[error("a brick decodes to samples beyond the error bound: please report this")]
    Unfaithful,
    /// Writing failed.
    #[error("cannot write: {0}")]
    Io(#[from] io::Error),
}

impl CompressError {
    /// Whose fault it is.
    pub const fn kind(&self) -> Fault {
        match self {
            Self::Io(_) => Fault::Io,
            Self::Unfaithful => Fault::Data,
            _ => Fault::Usage,
        }
    }
}

/// Why a container could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ContainerError {
    /// The first bytes are not those of a container.
    #[error("not a wavelift file")]
    NotAContainer,
    /// A version this program does not know.
    #[error("a wavelift file of version {found}, which this program cannot read: a newer wavelift can")]
    UnsupportedVersion {
        /// The version found.
        found: u16,
    },
    /// The last bytes are not those of a container.
    #[error("truncated, or not written to its end: the file does not end like a wavelift file")]
    Truncated,
    /// Something outside the bricks contradicts its checksum or itself.
    #[error("damaged: {0}")]
    Damaged(&'static str),
    /// A brick contradicts its checksum or cannot be decoded.
    #[error("damaged: brick {index} (samples {}): {cause}", region_of(brick))]
    Brick {
        /// Its number.
        index: u64,
        /// Where it lies.
        brick: Brick,
        /// What is wrong with it.
        cause: String,
    },
    /// A level that the file does not offer.
    #[error("level {asked} is not in this file: {why}")]
    NoSuchLevel {
        /// The level asked for.
        asked: u8,
        /// What it offers, and why.
        why: String,
    },
    /// A region outside the volume.
    #[error("region {region} is not inside the volume of {}x{}x{} samples", extent[0], extent[1], extent[2])]
    NoSuchRegion {
        /// The region asked for.
        region: super::Region,
        /// Extent of the volume.
        extent: [u64; 3],
    },
    /// A region between the samples of a level.
    #[error("region {region} holds no sample of level {level}, which has one in {} along each axis", 1_u64 << level)]
    NoSampleInRegion {
        /// The region asked for.
        region: super::Region,
        /// The level asked for.
        level: u8,
    },
    /// The samples do not fit into memory.
    #[error("{bytes} bytes of samples do not fit into memory: read a --region or a --level of the volume")]
    OutOfMemory {
        /// Bytes that were asked for.
        bytes: u64,
    },
    /// Reading failed.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
}

impl ContainerError {
    /// Whose fault it is.
    pub const fn kind(&self) -> Fault {
        match self {
            Self::NoSuchLevel { .. } | Self::NoSuchRegion { .. } | Self::NoSampleInRegion { .. } => {
                Fault::Usage
            }
            Self::Io(_) | Self::OutOfMemory { .. } => Fault::Io,
            _ => Fault::Data,
        }
    }
}

fn region_of(brick: &Brick) -> super::Region {
    super::Region {
        from: brick.origin,
        to: super::grid::per_axis(|axis| brick.origin[axis] + u64::from(brick.sides[axis])),
    }
}
