//! Error codes: below 100 the data are at fault, from 100 on the caller.

use core::ffi::{CStr, c_char};

#[cfg(feature = "rows")]
use wavelift_kernel::stream::RowError;
use wavelift_kernel::{DecodeError, EncodeError, LengthError, Malformed, PlanError, Slice};

macro_rules! errors {
    ($($(#[$doc:meta])* $variant:ident = $code:literal, $name:literal;)*) => {
        /// What a call returns: `wavelift_error` in C, whose names begin with `WAVELIFT_`.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(i32)]
        pub enum WaveliftError {
            $($(#[$doc])* $variant = $code,)*
        }

        impl WaveliftError {
            /// Every code, with its name in C.
            pub const ALL: &[(i32, &CStr)] = &[$(($code, $name),)*];
        }
    };
}

errors! {
    /// The call did what it says.
    Ok = 0, c"WAVELIFT_OK";

    /// The bytes end before the codestream, or the part asked for, does.
    Truncated = 1, c"WAVELIFT_TRUNCATED";
    /// The bytes do not begin like a codestream.
    NotACodestream = 2, c"WAVELIFT_NOT_A_CODESTREAM";
    /// A version of the format that this library does not know.
    UnsupportedVersion = 3, c"WAVELIFT_UNSUPPORTED_VERSION";
    /// Bytes follow the codestream.
    TrailingBytes = 4, c"WAVELIFT_TRAILING_BYTES";
    /// A field of the header holds a reserved value.
    MalformedReserved = 10, c"WAVELIFT_MALFORMED_RESERVED";
    /// A number of the header is not in its shortest form.
    MalformedNumber = 11, c"WAVELIFT_MALFORMED_NUMBER";
    /// An axis without samples, or 2^31 samples or more.
    MalformedExtent = 12, c"WAVELIFT_MALFORMED_EXTENT";
    /// More levels than the extent allows, or a wavelet without levels.
    MalformedLevels = 13, c"WAVELIFT_MALFORMED_LEVELS";
    /// Stored samples of another length than the extent's.
    MalformedStoredLength = 14, c"WAVELIFT_MALFORMED_STORED_LENGTH";
    /// A segment that no encoder writes.
    MalformedSegment = 15, c"WAVELIFT_MALFORMED_SEGMENT";
    /// A decoded sample outside the declared type.
    MalformedSample = 16, c"WAVELIFT_MALFORMED_SAMPLE";
    /// A slab that is not as the header of its stream says, or is dense or near-lossless.
    MalformedSlab = 17, c"WAVELIFT_MALFORMED_SLAB";
    /// The data break a rule that has no code of its own in this version of the header.
    Malformed = 99, c"WAVELIFT_MALFORMED";

    /// A pointer is NULL that must not be.
    NullPointer = 100, c"WAVELIFT_NULL_POINTER";
    /// A pointer is not aligned as its type asks.
    Misaligned = 101, c"WAVELIFT_MISALIGNED";
    /// Two lent buffers overlap.
    Overlap = 102, c"WAVELIFT_OVERLAP";
    /// A buffer is longer than memory can be.
    TooLong = 103, c"WAVELIFT_TOO_LONG";
    /// No wavelet has this number, or 0 with levels.
    UnknownWavelet = 104, c"WAVELIFT_UNKNOWN_WAVELET";
    /// No sample type has this number.
    UnknownSampleType = 105, c"WAVELIFT_UNKNOWN_SAMPLE_TYPE";
    /// An axis has no samples.
    ZeroExtent = 106, c"WAVELIFT_ZERO_EXTENT";
    /// The extent has 2^31 samples or more.
    ExtentTooLarge = 107, c"WAVELIFT_EXTENT_TOO_LARGE";
    /// The extent allows fewer levels.
    TooManyLevels = 108, c"WAVELIFT_TOO_MANY_LEVELS";
    /// The samples lent are not as many as the call takes.
    SamplesLength = 109, c"WAVELIFT_SAMPLES_LENGTH";
    /// The scratch is too short.
    ScratchTooShort = 110, c"WAVELIFT_SCRATCH_TOO_SHORT";
    /// A sample is outside the declared type.
    SampleOutOfRange = 111, c"WAVELIFT_SAMPLE_OUT_OF_RANGE";
    /// The output is too short.
    OutputFull = 112, c"WAVELIFT_OUTPUT_FULL";
    /// The codestream holds fewer levels.
    LevelOutOfRange = 113, c"WAVELIFT_LEVEL_OUT_OF_RANGE";
    /// The codestream is for the other kind of codec: near-lossless or not.
    OtherCodec = 114, c"WAVELIFT_OTHER_CODEC";
    /// The codestream is dense.
    NeedsDense = 115, c"WAVELIFT_NEEDS_DENSE";
    /// Nothing was begun in this memory.
    NotBegun = 116, c"WAVELIFT_NOT_BEGUN";
    /// The last row lacks samples.
    UnfinishedRow = 117, c"WAVELIFT_UNFINISHED_ROW";
    /// The library was built without what this takes.
    NotBuilt = 118, c"WAVELIFT_NOT_BUILT";
    /// The bytes lent for a slab are too few.
    BytesTooShort = 119, c"WAVELIFT_BYTES_TOO_SHORT";
    /// The call breaks a rule that has no code of its own in this version of the header.
    Refused = 199, c"WAVELIFT_REFUSED";
}

/// The name of a code, as in the header; of any other number, "not an error of wavelift".
#[unsafe(no_mangle)]
pub extern "C" fn wavelift_error_name(error: i32) -> *const c_char {
    let named = WaveliftError::ALL.iter().find(|(code, _)| *code == error);
    named.map_or(c"not an error of wavelift", |(_, name)| name).as_ptr()
}

/// The code of a result.
pub(crate) fn code(result: Result<(), WaveliftError>) -> WaveliftError {
    result.err().unwrap_or(WaveliftError::Ok)
}

impl From<PlanError> for WaveliftError {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::ZeroExtent { .. } => Self::ZeroExtent,
            PlanError::ExtentTooLarge => Self::ExtentTooLarge,
            PlanError::TooManyLevels { .. } => Self::TooManyLevels,
            PlanError::NotBuilt(_) => Self::NotBuilt,
            _ => Self::Refused,
        }
    }
}

impl From<LengthError> for WaveliftError {
    fn from(error: LengthError) -> Self {
        match error.slice {
            Slice::Scratch => Self::ScratchTooShort,
            Slice::Bytes => Self::BytesTooShort,
            _ => Self::SamplesLength,
        }
    }
}

impl From<EncodeError> for WaveliftError {
    fn from(error: EncodeError) -> Self {
        match error {
            EncodeError::Length(error) => error.into(),
            EncodeError::SampleOutOfRange { .. } => Self::SampleOutOfRange,
            EncodeError::OutputFull => Self::OutputFull,
            EncodeError::NotBuilt(_) => Self::NotBuilt,
            _ => Self::Refused,
        }
    }
}

#[cfg(feature = "rows")]
impl From<RowError> for WaveliftError {
    fn from(error: RowError) -> Self {
        match error {
            RowError::SampleOutOfRange { .. } => Self::SampleOutOfRange,
            RowError::UnfinishedRow { .. } => Self::UnfinishedRow,
            _ => Self::Refused,
        }
    }
}

impl From<DecodeError> for WaveliftError {
    fn from(error: DecodeError) -> Self {
        match error {
            DecodeError::Truncated => Self::Truncated,
            DecodeError::NotACodestream => Self::NotACodestream,
            DecodeError::UnsupportedVersion { .. } => Self::UnsupportedVersion,
            DecodeError::Malformed(rule) => rule.into(),
            DecodeError::OtherCodec => Self::OtherCodec,
            DecodeError::TrailingBytes => Self::TrailingBytes,
            DecodeError::Length(error) => error.into(),
            DecodeError::LevelOutOfRange { .. } => Self::LevelOutOfRange,
            DecodeError::NeedsDense => Self::NeedsDense,
            DecodeError::NotBuilt(_) => Self::NotBuilt,
            _ => Self::Malformed,
        }
    }
}

impl From<Malformed> for WaveliftError {
    fn from(rule: Malformed) -> Self {
        match rule {
            Malformed::Reserved => Self::MalformedReserved,
            Malformed::Number => Self::MalformedNumber,
            Malformed::Extent => Self::MalformedExtent,
            Malformed::Levels => Self::MalformedLevels,
            Malformed::StoredLength => Self::MalformedStoredLength,
            Malformed::Segment => Self::MalformedSegment,
            Malformed::Sample => Self::MalformedSample,
            Malformed::Slab => Self::MalformedSlab,
            _ => Self::Malformed,
        }
    }
}
