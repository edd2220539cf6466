//! Faults of NIfTI headers.

use crate::volume::ExtentError;

/// What keeps a NIfTI file from being read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NiftiError {
    /// The header's length is that of no version.
    #[error("the first four bytes say {found}, not 348 or 540, in either order of bytes")]
    Size {
        /// What they say, little-endian.
        found: i32,
    },
    /// A name that belongs to no version.
    #[error("the header's magic is {found}, which is that of no NIfTI version")]
    Magic {
        /// What stands there.
        found: String,
    },
    /// The file ends before its header does.
    #[error("the file ends within its header")]
    Truncated,
    /// Axes that make no data set.
    #[error("field `dim` is {found}: one to seven axes of at least one sample are needed")]
    Dim {
        /// The field, at most eight numbers.
        found: String,
    },
    /// Samples of a type that is not read.
    #[error(
        "samples of type {code} ({name}) are not read: convert them to integers or floats of at most 64 bits"
    )]
    Type {
        /// The field `datatype`.
        code: i16,
        /// What it means.
        name: &'static str,
    },
    /// Samples that begin where no file has them.
    #[error("field `vox_offset` is {found}, where no samples can begin")]
    Offset {
        /// The field.
        found: String,
    },
    /// Extensions of more bytes than are taken into memory.
    #[error("the extensions of the header take {bytes} bytes; at most {limit} are read")]
    Extensions {
        /// Bytes according to the header.
        bytes: u64,
        /// Most bytes.
        limit: u64,
    },
    /// Axes that make no extent.
    #[error("field `dim`: {0}")]
    Extent(ExtentError),
}
