//! Faults of MetaImage headers.

use crate::volume::ExtentError;

/// What keeps a MetaImage file from being read. Texts from the file are quoted and shortened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MetaImageError {
    /// The header does not end.
    #[error("no line `ElementDataFile = …` ends the header within {limit} bytes")]
    NoEnd {
        /// Bytes that were searched, at most.
        limit: u64,
    },
    /// A line that gives nothing a value.
    #[error("line {number} of the header, {text}, is no `Key = value`")]
    Line {
        /// Number of the line, the first being 1.
        number: usize,
        /// The line.
        text: String,
    },
    /// An object that is no image.
    #[error("the header is that of an object of type {found}, not of an image")]
    Object {
        /// The value of `ObjectType`.
        found: String,
    },
    /// A key that every header must have.
    #[error("the header has no `{key}`")]
    Missing {
        /// Name of the key.
        key: &'static str,
    },
    /// A value that is not what it should be.
    #[error("`{key}` of the header is {value}: {expected} is needed")]
    Value {
        /// Name of the key.
        key: &'static str,
        /// Its value.
        value: String,
        /// What should stand there.
        expected: &'static str,
    },
    /// Samples as text.
    #[error("the samples are text (`BinaryData = False`): save the image in binary form first")]
    Text,
    /// Files that do not hold the samples in equal parts.
    #[error("{files} files cannot hold the samples in equal parts")]
    Files {
        /// How many there are.
        files: usize,
    },
    /// Compressed samples that would have to be found from their end.
    #[error("`HeaderSize = -1` needs samples that are not compressed, in a file whose end is known")]
    SkipToEnd,
    /// Axes that make no extent.
    #[error("`DimSize` of the header: {0}")]
    Extent(ExtentError),
}
