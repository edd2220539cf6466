//! Faults of headers of MRC.

use crate::volume::ExtentError;

/// What keeps a file of MRC from being read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MrcError {
    /// The file ends before its header does.
    #[error("the file ends within its header")]
    Truncated,
    /// An axis of no samples, or of fewer than none.
    #[error("its header says {found} samples along x, y and z: each has to be 1 at least")]
    Counts {
        /// What it says.
        found: String,
    },
    /// Samples of a type that is not read.
    #[error("samples of mode {mode} are not read, only 0, 1, 2, 3, 4, 6 and 12")]
    Mode {
        /// The mode.
        mode: i32,
    },
    /// An extended header of an impossible length.
    #[error("the length of its extended header is not possible, or more than 64 MiB")]
    Extension,
    /// More samples than can be counted.
    #[error("its header: {0}")]
    Extent(ExtentError),
}
