//! What can go wrong, by who is to blame: the plan, the lent memory, or the data.

use core::fmt;

use crate::Feature;

/// The caller asked for a transform that does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PlanError {
    /// An axis (0 = x, 1 = y, 2 = z) has no samples.
    ZeroExtent {
        /// The axis without samples.
        axis: u8,
    },
    /// The extent has 2^31 samples or more.
    ExtentTooLarge,
    /// The extent allows fewer levels.
    TooManyLevels {
        /// The most levels this extent allows.
        max: u8,
    },
    /// This build cannot: it was made without that part.
    NotBuilt(Feature),
}

impl PlanError {
    /// What is wrong with a header that asks for such a plan.
    pub(crate) fn in_header(self) -> DecodeError {
        match self {
            Self::ZeroExtent { .. } | Self::ExtentTooLarge => Malformed::Extent.into(),
            Self::TooManyLevels { .. } => Malformed::Levels.into(),
            Self::NotBuilt(part) => DecodeError::NotBuilt(part),
        }
    }
}

/// Which lent slice a [`LengthError`] speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Slice {
    /// Samples or coefficients.
    Samples,
    /// Working memory.
    Scratch,
    /// Scaling coefficients of a line.
    Low,
    /// Wavelet coefficients of a line.
    High,
    /// Bytes of a codestream.
    Bytes,
    /// Vertices of a mesh that a lift updates from all others: v in an s-lift, f in a w-lift.
    Corners,
    /// Vertices of a mesh in the middle of edges: e.
    Edges,
    /// Vertices of a mesh that a lift reads only: f in an s-lift, v in a w-lift.
    Centres,
}

/// A lent slice has the wrong length. Nothing was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LengthError {
    /// The slice that is wrong.
    pub slice: Slice,
    /// Elements needed: exactly for samples, at least for scratch.
    pub expected: usize,
    /// Elements lent.
    pub actual: usize,
}

/// Why [`Codec::encode`](crate::Codec::encode) gave up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum EncodeError {
    /// Lent memory has the wrong length; samples and output are untouched.
    Length(LengthError),
    /// A sample lies outside its declared type; samples and output are untouched.
    SampleOutOfRange {
        /// Position of the first such sample, x fastest.
        index: usize,
    },
    /// The output is too short; its contents are meaningless, and the samples are what they were.
    OutputFull,
    /// This build cannot: it was made without that part; samples and output are untouched.
    NotBuilt(Feature),
}

/// Why a codestream could not be decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum DecodeError {
    /// The bytes end before the codestream (or the part needed for the level asked for) does.
    Truncated,
    /// The bytes do not begin like a codestream.
    NotACodestream,
    /// The codestream was written in a version of the format that this decoder does not know.
    UnsupportedVersion {
        /// The version found.
        found: u8,
    },
    /// The bytes break a rule of the format.
    Malformed(Malformed),
    /// The codestream is for [`Lattice`](crate::Lattice) if it was given to [`Codec`](crate::Codec), and the other way
    /// round: the caller's fault, not the data's.
    OtherCodec,
    /// Bytes follow the codestream.
    TrailingBytes,
    /// Lent memory has the wrong length: the caller's fault, not the data's.
    Length(LengthError),
    /// The codestream holds fewer levels: the caller's fault, not the data's.
    LevelOutOfRange {
        /// The coarsest level it holds.
        max: u8,
    },
    /// The codestream is dense and no [`Dense`](crate::Dense) was lent: the caller's fault, not the data's.
    NeedsDense,
    /// This build cannot: it was made without that part. Other builds can, and nothing is wrong with the data so far.
    NotBuilt(Feature),
}

/// The rule of the format that a codestream breaks; see `docs/codestream.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Malformed {
    /// A field of the header holds a reserved value.
    Reserved,
    /// A number of the header is not written in its shortest form, or exceeds 32 bits.
    Number,
    /// An axis without samples, or 2^31 samples or more.
    Extent,
    /// More levels than the extent allows, or a wavelet without levels.
    Levels,
    /// The length of the stored samples is not that of the extent.
    StoredLength,
    /// A segment is longer than its coefficients need, ends in a zero byte, or lies above the coder's interval.
    Segment,
    /// A decoded sample lies outside the declared type.
    Sample,
    /// A slab is longer than its samples need, is not one codestream, is dense or a lattice, or is none of what the stream
    /// says it is made of.
    Slab,
}

/// Why a generalized lift of a line ([`lifting::generalized`](crate::lifting::generalized)) or of a mesh
/// ([`stencil`](crate::stencil)) was not done. Nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum LiftError {
    /// Lent memory has the wrong length.
    Length(LengthError),
    /// A result does not fit an `i32`.
    Overflow {
        /// Where.
        slice: Slice,
        /// Position of the first such result.
        index: usize,
    },
    /// An inverse met a value that the forward lift cannot have made.
    NotDivisible {
        /// Where.
        slice: Slice,
        /// Position of the first such value.
        index: usize,
    },
}

/// Why index lists are not an [`Adjacency`](crate::stencil::Adjacency).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum AdjacencyError {
    /// The offsets do not begin with 0, decrease, or do not end with the number of indices.
    Offset {
        /// Position of the first offset that is wrong; 0 if there are none.
        position: usize,
    },
    /// An index names no neighbour.
    Index {
        /// Position of the first such index.
        position: usize,
    },
}

impl From<LengthError> for LiftError {
    fn from(error: LengthError) -> Self {
        Self::Length(error)
    }
}

impl From<LengthError> for EncodeError {
    fn from(error: LengthError) -> Self {
        Self::Length(error)
    }
}

impl From<LengthError> for DecodeError {
    fn from(error: LengthError) -> Self {
        Self::Length(error)
    }
}

impl From<Malformed> for DecodeError {
    fn from(malformed: Malformed) -> Self {
        Self::Malformed(malformed)
    }
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ZeroExtent { axis } => write!(f, "axis {axis} has no samples"),
            Self::ExtentTooLarge => f.write_str("the extent has 2^31 samples or more"),
            Self::TooManyLevels { max } => write!(f, "the extent allows at most {max} levels"),
            Self::NotBuilt(part) => not_built(*part, f),
        }
    }
}

impl fmt::Display for Slice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Samples => "samples",
            Self::Scratch => "scratch",
            Self::Low => "scaling coefficients",
            Self::High => "wavelet coefficients",
            Self::Bytes => "bytes",
            Self::Corners => "corners",
            Self::Edges => "edges",
            Self::Centres => "centres",
        })
    }
}

impl fmt::Display for LengthError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} elements needed, {} lent", self.slice, self.expected, self.actual)
    }
}

impl fmt::Display for LiftError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(error) => error.fmt(f),
            Self::Overflow { slice, index } => write!(f, "{slice}: result {index} does not fit 32 bits"),
            Self::NotDivisible { slice, index } => write!(f, "{slice}: value {index} is not a lifted one"),
        }
    }
}

impl fmt::Display for AdjacencyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Offset { position } => write!(f, "offset {position} of the neighbour lists is wrong"),
            Self::Index { position } => {
                write!(f, "index {position} of the neighbour lists names no neighbour")
            }
        }
    }
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(error) => error.fmt(f),
            Self::SampleOutOfRange { index } => write!(f, "sample {index} is outside the declared type"),
            Self::OutputFull => f.write_str("the output is too short"),
            Self::NotBuilt(part) => not_built(*part, f),
        }
    }
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated => f.write_str("the codestream is truncated"),
            Self::NotACodestream => f.write_str("not a wavelift codestream"),
            Self::UnsupportedVersion { found } => write!(f, "unsupported codestream version {found}"),
            Self::Malformed(malformed) => malformed.fmt(f),
            Self::OtherCodec => f.write_str("the codestream is for the other codec"),
            Self::TrailingBytes => f.write_str("bytes follow the codestream"),
            Self::Length(error) => error.fmt(f),
            Self::LevelOutOfRange { max } => write!(f, "the coarsest level of the codestream is {max}"),
            Self::NeedsDense => f.write_str("a dense codestream, to be decoded with the memory for it"),
            Self::NotBuilt(part) => not_built(*part, f),
        }
    }
}

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Reserved => "malformed codestream: reserved value",
            Self::Number => "malformed codestream: number not in shortest form",
            Self::Extent => "malformed codestream: impossible extent",
            Self::Levels => "malformed codestream: impossible levels",
            Self::StoredLength => "malformed codestream: stored samples of the wrong length",
            Self::Segment => "malformed codestream: segment not as an encoder ends it",
            Self::Sample => "malformed codestream: sample outside its type",
            Self::Slab => "malformed stream: slab not as the header says",
        })
    }
}

fn not_built(part: Feature, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, "built without the feature {part}")
}

impl core::error::Error for PlanError {}
impl core::error::Error for LengthError {}
impl core::error::Error for LiftError {}
impl core::error::Error for AdjacencyError {}
impl core::error::Error for EncodeError {}
impl core::error::Error for DecodeError {}
impl core::error::Error for Malformed {}

/// `Ok` if `actual` is exactly `expected` elements.
pub(crate) const fn exactly(slice: Slice, expected: usize, actual: usize) -> Result<(), LengthError> {
    if actual == expected { Ok(()) } else { Err(LengthError { slice, expected, actual }) }
}

/// `Ok` if `actual` is at least `expected` elements.
pub(crate) const fn at_least(slice: Slice, expected: usize, actual: usize) -> Result<(), LengthError> {
    if actual >= expected { Ok(()) } else { Err(LengthError { slice, expected, actual }) }
}
