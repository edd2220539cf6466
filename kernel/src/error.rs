//! What can go wrong, by who is to blame: the plan, the lent memory, or the data.

use core::fmt;

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
}

/// Which lent slice a [`LengthError`] speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Slice {
    /// Samples or coefficients.
    Samples,
    /// Working memory.
    Scratch,
    /// Scaling coefficients of a line, or values of the vertices updated last.
    Low,
    /// Wavelet coefficients of a line.
    High,
    /// Control points of a mesh.
    Points,
    /// Index lists of a mesh.
    Neighbours,
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
    /// Bytes follow the codestream.
    TrailingBytes,
    /// Lent memory has the wrong length: the caller's fault, not the data's.
    Length(LengthError),
    /// The codestream holds fewer levels: the caller's fault, not the data's.
    LevelOutOfRange {
        /// The coarsest level it holds.
        max: u8,
    },
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
        }
    }
}

impl fmt::Display for LengthError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let slice = match self.slice {
            Slice::Samples => "samples",
            Slice::Scratch => "scratch",
            Slice::Low => "scaling coefficients",
            Slice::High => "wavelet coefficients",
            Slice::Points => "points",
            Slice::Neighbours => "neighbours",
        };
        write!(f, "{slice}: {} elements needed, {} lent", self.expected, self.actual)
    }
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(error) => error.fmt(f),
            Self::SampleOutOfRange { index } => write!(f, "sample {index} is outside the declared type"),
            Self::OutputFull => f.write_str("the output is too short"),
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
            Self::TrailingBytes => f.write_str("bytes follow the codestream"),
            Self::Length(error) => error.fmt(f),
            Self::LevelOutOfRange { max } => write!(f, "the coarsest level of the codestream is {max}"),
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
        })
    }
}

impl core::error::Error for PlanError {}
impl core::error::Error for LengthError {}
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
