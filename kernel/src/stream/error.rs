//! What can go wrong with rows that arrive.

use core::fmt;

/// Why an encoder of rows refuses what it is given. Nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RowError {
    /// A sample lies outside the declared type.
    SampleOutOfRange {
        /// Its position in the input.
        index: usize,
    },
    /// The last row, or slice, is not whole.
    UnfinishedRow {
        /// Samples that it lacks.
        missing: usize,
    },
}

impl fmt::Display for RowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SampleOutOfRange { index } => write!(f, "sample {index} is outside the declared type"),
            Self::UnfinishedRow { missing } => write!(f, "the last row lacks {missing} samples"),
        }
    }
}

impl core::error::Error for RowError {}
