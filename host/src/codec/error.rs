//! What can go wrong with a container, and whose fault it is.

use std::io;
use std::path::PathBuf;

use super::brick::Unencodable;
use super::{Brick, Place, Region};
use crate::progress::Stopped;
use crate::volume::{ElementType, Fault, ReadError, WriteError, in_words};

/// Why a volume could not be compressed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompressError {
    /// A brick side is 0, or the brick too large.
    #[error("bricks of {}x{}x{} samples are not possible: give sides of at least 1 with at most 2^27 samples", .0[0], .0[1], .0[2])]
    BrickSides([u32; 3]),
    /// A data set without values, or with more than can be counted.
    #[error(
        "a volume of {}x{}x{} samples of {components} components has no values, or too many: each count is at least 1",
        extent[0], extent[1], extent[2]
    )]
    Extent {
        /// Samples along x, y and z.
        extent: [u64; 3],
        /// Values of a sample.
        components: u32,
    },
    /// More levels than a brick allows.
    #[error("bricks of {}x{}x{} samples allow at most {max} levels", sides[0], sides[1], sides[2])]
    TooManyLevels {
        /// Sides of the bricks.
        sides: [u32; 3],
        /// The most levels they allow.
        max: u8,
    },
    /// Levels were asked for without a transform, or a transform without levels.
    #[error("wavelet {wavelet} and {levels} levels contradict each other")]
    Contradiction {
        /// The wavelet asked for.
        wavelet: &'static str,
        /// The levels asked for.
        levels: u8,
    },
    /// The samples are not those of the extent.
    #[error("there are {actual} bytes of values where extent, components and type make {expected}")]
    SampleBytes {
        /// Bytes by extent, components and type.
        expected: u64,
        /// Bytes there are.
        actual: u64,
    },
    /// Names of another number than there are components.
    #[error("{names} names for samples of {components} components")]
    Names {
        /// Names given.
        names: usize,
        /// Values of a sample.
        components: u32,
    },
    /// A time step of another kind than those that are there.
    #[error("cannot follow the time steps of {file}: they hold {there}, the input {given}")]
    OtherSteps {
        /// The file that they are in, as far as it has a name.
        file: String,
        /// Extent, type and components there, `64x64x93 of u16`.
        there: String,
        /// The same of the input.
        given: String,
    },
    /// The container that time steps are to follow cannot be read.
    #[error(transparent)]
    Container(#[from] ContainerError),
    /// A brick decodes to other samples than it may: a fault of the codec.
    #[error("a brick decodes to samples beyond the error bound: please report this")]
    Unfaithful,
    /// The values were not the same when they were read again.
    #[error("the input has changed while it was read: compress it again when nobody writes to it")]
    Changed,
    /// The values could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The values could not be kept in a temporary file.
    #[error("cannot use a temporary file in {}: {}", std::env::temp_dir().display(), in_words(.0))]
    Spool(io::Error),
    /// It was stopped.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// Writing failed.
    #[error("cannot write: {}", in_words(.0))]
    Io(#[from] io::Error),
    /// The compressed file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Values of another type than was said.
    #[error("the values are {given}, not {expected} as was said")]
    WrongType {
        /// Type of the header.
        expected: ElementType,
        /// Type of the values.
        given: ElementType,
    },
    /// The last time step lacks values, or there is none.
    #[error(
        "the last time step has {found} bytes of values where extent, components and type make {expected}"
    )]
    UnfinishedStep {
        /// Bytes of a time step.
        expected: u64,
        /// Bytes of the last.
        found: u64,
    },
    /// A region that is not inside the volume, or holds nothing.
    #[error("region {region} is not inside the volume of {}x{}x{} samples", extent[0], extent[1], extent[2])]
    OutsideVolume {
        /// The region.
        region: Region,
        /// Extent of the volume.
        extent: [u64; 3],
    },
    /// A region with samples that were written already.
    #[error("region {region} meets another that was written in this time step already")]
    WrittenBefore {
        /// The region.
        region: Region,
    },
    /// Values in order and values of regions in one time step.
    #[error("values in order and values of regions cannot be written to the same time step")]
    MixedOrder,
    /// Something went wrong before.
    #[error("nothing can be written after an error")]
    AfterError,
}

impl CompressError {
    /// Whose fault it is.
    pub fn kind(&self) -> Fault {
        match self {
            Self::Io(_) | Self::Spool(_) | Self::Stopped(_) => Fault::Io,
            Self::Write(error) => error.kind(),
            Self::Unfaithful | Self::Changed => Fault::Data,
            Self::Read(error) => error.kind(),
            Self::Container(error) => error.kind(),
            _ => Fault::Usage,
        }
    }
}

impl From<Unencodable> for CompressError {
    fn from(cause: Unencodable) -> Self {
        match cause {
            Unencodable::Unfaithful => Self::Unfaithful,
            Unencodable::Unknown => Self::Changed,
        }
    }
}

/// Why a container could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ContainerError {
    /// A file could not be opened.
    #[error("{}: {cause}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// Why not: one of the others.
        cause: Box<ContainerError>,
    },
    /// The first bytes are not those of a container.
    #[error("not a wavelift file")]
    NotAContainer,
    /// A version this program does not know.
    #[error("a wavelift file of version {found}, which this program cannot read: {}", reader_of(*found))]
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
    /// What is said of the whole contradicts its checksum or itself.
    #[error("damaged: the {what}: {cause}")]
    Record {
        /// What it is: head, metadata, statistics.
        what: &'static str,
        /// What is wrong with it.
        cause: &'static str,
    },
    /// What is said of a time step contradicts its checksum or itself.
    #[error("damaged: time step {step}: {cause}")]
    Step {
        /// Its number.
        step: u64,
        /// What is wrong with it.
        cause: &'static str,
    },
    /// A brick contradicts its checksum or cannot be decoded.
    #[error("damaged: {} (samples {}): {cause}", name_of(place), Region::from(*brick))]
    Brick {
        /// Which one it is.
        place: Place,
        /// Where it lies.
        brick: Brick,
        /// What is wrong with it.
        cause: String,
    },
    /// A time step that the file does not have.
    #[error("there is no time step {asked}: the file has {steps}, the first is 0")]
    NoSuchStep {
        /// The step asked for.
        asked: u64,
        /// Number of time steps.
        steps: u64,
    },
    /// A component that samples do not have.
    #[error("there is no component {asked}: samples have {components}, the first is 0")]
    NoSuchComponent {
        /// The component asked for.
        asked: u32,
        /// Values of a sample.
        components: u32,
    },
    /// Several values where one volume of single ones was asked for.
    #[error(
        "{steps} time steps of samples with {components} components are no single volume: choose one of each"
    )]
    NotScalar {
        /// Time steps.
        steps: u64,
        /// Values of a sample.
        components: u32,
    },
    /// Memory of another length than what is to be read.
    #[error("{actual} bytes of memory for {expected} bytes of samples")]
    BufferLength {
        /// Bytes of the samples.
        expected: u64,
        /// Bytes that were lent.
        actual: u64,
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
        region: Region,
        /// Extent of the volume.
        extent: [u64; 3],
    },
    /// A region between the samples of a level.
    #[error("region {region} holds no sample of level {level}, which has one in {} along each axis", 1_u64 << level)]
    NoSampleInRegion {
        /// The region asked for.
        region: Region,
        /// The level asked for.
        level: u8,
    },
    /// The samples do not fit into memory.
    #[error("{bytes} bytes of samples do not fit into memory: read a region or a level of the volume")]
    OutOfMemory {
        /// Bytes that were asked for.
        bytes: u64,
    },
    /// Reading failed.
    #[error("cannot read: {}", in_words(.0))]
    Io(#[from] io::Error),
    /// The samples could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// It was stopped.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl ContainerError {
    /// Whether the file is one, but not as it was written: [`Container::salvage`](super::Container::salvage) may help.
    pub fn is_damage(&self) -> bool {
        matches!(
            self.cause(),
            Self::Truncated | Self::Damaged(_) | Self::Record { .. } | Self::Step { .. } | Self::Brick { .. }
        )
    }

    /// The same without the name of the file.
    pub fn cause(&self) -> &Self {
        match self {
            Self::Open { cause, .. } => cause,
            other => other,
        }
    }

    /// Whose fault it is.
    pub fn kind(&self) -> Fault {
        match self.cause() {
            Self::NoSuchLevel { .. }
            | Self::NoSuchRegion { .. }
            | Self::NoSampleInRegion { .. }
            | Self::NoSuchStep { .. }
            | Self::NoSuchComponent { .. }
            | Self::NotScalar { .. }
            | Self::BufferLength { .. } => Fault::Usage,
            Self::Io(_) | Self::OutOfMemory { .. } | Self::Stopped(_) => Fault::Io,
            Self::Write(error) => error.kind(),
            _ => Fault::Data,
        }
    }
}

/// Who can read a version that this program cannot.
const fn reader_of(version: u16) -> &'static str {
    if version < super::container::VERSION {
        "it was never released, compress the volume again"
    } else {
        "a newer wavelift can"
    }
}

/// A brick in words: step and component are named if they are not the first.
fn name_of(place: &Place) -> String {
    let Place { step, brick, component } = place;
    match (step, component) {
        (0, 0) => format!("brick {brick}"),
        (_, 0) => format!("brick {brick} of time step {step}"),
        _ => format!("brick {brick} of time step {step}, component {component}"),
    }
}
