//! Faults of NRRD headers.

use crate::volume::ExtentError;

/// What keeps an NRRD file from being read as a volume. Texts from the file are quoted and shortened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NrrdError {
    /// The first line is none that this reader knows.
    #[error("no NRRD file: the first line is {found}, not NRRD0001 to NRRD0005")]
    Magic {
        /// The first line.
        found: String,
    },
    /// The header does not end.
    #[error("the header has no blank line at its end within {limit} bytes")]
    HeaderTooLong {
        /// Bytes that were searched.
        limit: u64,
    },
    /// The file ends within the header.
    #[error("the file ends before its samples: no blank line ends the header, and it has no `data file`")]
    NoSamples,
    /// A line of no known form.
    #[error("line {number} of the header, {text}, is no `field: value`, no `key:=value` and no `# comment`")]
    Line {
        /// Number of the line, the first being 1.
        number: usize,
        /// The line.
        text: String,
    },
    /// A field that every header must have, or that this type or encoding needs.
    #[error("the header has no field `{field}`")]
    Missing {
        /// Name of the field.
        field: &'static str,
    },
    /// A field that may stand once only.
    #[error("the header has the field `{field}` more than once")]
    Repeated {
        /// Name of the field.
        field: &'static str,
    },
    /// A field whose value is not what it should be.
    #[error("field `{field}` of the header is {value}: {expected} is needed")]
    Value {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: String,
        /// What should stand there.
        expected: &'static str,
    },
    /// Sizes that make no extent.
    #[error("field `sizes` of the header: {0}")]
    Extent(ExtentError),
    /// No axes, or too many.
    #[error("the array has {found} axes, an NRRD file has 1 to 16")]
    Dimension {
        /// The value of `dimension`.
        found: u32,
    },
    /// Samples without a meaning.
    #[error(
        "samples of type `block` are no numbers and cannot be compressed as such: convert the file first"
    )]
    BlockType,
    /// Samples that are stored in another way.
    #[error(
        "the encoding {found} is not read: save as `raw` or `gzip` first, such as with `unu save -f nrrd -e raw`"
    )]
    Encoding {
        /// The value of `encoding`.
        found: String,
    },
    /// Samples that are not what their encoding says.
    #[error("the samples, which are {encoding}, are damaged: {cause}")]
    Samples {
        /// The encoding.
        encoding: &'static str,
        /// What is wrong with them.
        cause: String,
    },
    /// Samples as text, or compressed with bzip2, in several files.
    #[error("samples as ascii, hex or bzip2 in several files are not read: save as `raw` or `gzip` first")]
    SeveralFiles,
    /// Files by numbers that are none, or too many.
    #[error(
        "field `data file` of the header: {found} with numbers from {first} to {last} by {step} names no files"
    )]
    Pattern {
        /// The pattern.
        found: String,
        /// First number.
        first: i64,
        /// Last number.
        last: i64,
        /// From one number to the next.
        step: i64,
    },
    /// Files that do not hold the samples in equal parts.
    #[error("{count} data files cannot hold the samples in equal parts")]
    Files {
        /// How many there are.
        count: usize,
    },
    /// Skipping backwards where it means nothing.
    #[error("`byte skip: -1` needs encoding raw and a regular file, whose end is known")]
    SkipToEnd,
}
