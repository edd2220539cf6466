//! What can go wrong with a file of a volume, and whose fault it is.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::format::unknown;
use super::npy::NpyError;
use super::nrrd::NrrdError;
use super::{ExtentError, FileFormat, SlicesError};

/// Whose fault an error is; the program's exit code follows from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// What the user asked for: missing or contradictory arguments.
    Usage,
    /// What is in the file.
    Data,
    /// The system: a file that cannot be opened, a full disk.
    Io,
}

/// Bytes that were found where a number of bytes was expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// So many.
    Exactly(u64),
    /// More than these; reading stopped there.
    MoreThan(u64),
    /// No more than these, however well they are compressed; nothing was read.
    AtMost(u64),
}

impl Found {
    /// What is wrong with a file where `expected` bytes should be.
    const fn verdict(self, expected: u64) -> &'static str {
        match self {
            Self::Exactly(bytes) if bytes > expected => LONGER,
            Self::MoreThan(_) => LONGER,
            Self::Exactly(_) | Self::AtMost(_) => "it is damaged or cut short",
        }
    }
}

const LONGER: &str = "what follows them would be lost, so the header is wrong or something was appended";

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exactly(bytes) => write!(f, "{bytes}"),
            Self::MoreThan(bytes) => write!(f, "more than {bytes}"),
            Self::AtMost(bytes) => write!(f, "at most {bytes}"),
        }
    }
}

/// Why a volume could not be read. The text is complete: file, fault, and what to do where that is known.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The system refused.
    #[error("{}: cannot read: {}", path.display(), in_words(cause))]
    Io {
        /// File in question: the data file where header and data are detached.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// A file without a byte.
    #[error("{}: the file is empty", path.display())]
    Empty {
        /// File in question.
        path: PathBuf,
    },
    /// A raw file without a layout.
    #[error("{}: {}", path.display(), unknown(path))]
    NoLayout {
        /// File in question.
        path: PathBuf,
    },
    /// A layout that no file can have.
    #[error("{}: {cause}", path.display())]
    Layout {
        /// File in question.
        path: PathBuf,
        /// What is wrong with the layout.
        cause: ExtentError,
    },
    /// A raw file of another length than its layout.
    #[error(
        "{}: {layout} is {expected} bytes, the file has {found}: check extent and type{hint}",
        path.display()
    )]
    LayoutMismatch {
        /// File in question.
        path: PathBuf,
        /// Extent, type and what else is given, `64x64x93 of u16`.
        layout: String,
        /// Bytes of that layout.
        expected: u64,
        /// Bytes of the file.
        found: Found,
        /// A guess at what is wrong, or nothing.
        hint: &'static str,
    },
    /// More or fewer samples than the header of the file says.
    #[error(
        "{}: the header promises {expected} bytes of samples, the file has {found}: {}",
        path.display(), found.verdict(*expected)
    )]
    SampleBytes {
        /// File in question: the data file where header and data are detached.
        path: PathBuf,
        /// Bytes according to extent and type.
        expected: u64,
        /// Bytes that are there, after decompression.
        found: Found,
    },
    /// Compressed samples that cannot be decompressed.
    #[error("{}: the gzip data are damaged: {cause}", path.display())]
    Gzip {
        /// File in question.
        path: PathBuf,
        /// What the decompressor said.
        cause: io::Error,
    },
    /// More samples than this machine can hold.
    #[error("{}: {bytes} bytes of samples do not fit into memory", path.display())]
    TooLarge {
        /// File in question.
        path: PathBuf,
        /// Bytes according to extent and type.
        bytes: u64,
    },
    /// The file was written to while it was read.
    #[error("{}: has changed while it was read: try again when nobody writes to it", path.display())]
    Changed {
        /// File in question.
        path: PathBuf,
    },
    /// More samples were asked for than there are: a fault of the caller.
    #[error("{}: the samples end before those that are asked for", path.display())]
    BeyondEnd {
        /// File in question.
        path: PathBuf,
    },
    /// Several time steps or components where one volume of single values is needed.
    #[error(
        "{}: has {steps} time steps of samples with {components} components, where one volume of single values \
         is needed",
        path.display()
    )]
    NotScalar {
        /// File in question.
        path: PathBuf,
        /// Values of a sample.
        components: u32,
        /// Time steps.
        steps: u64,
    },
    /// A file that is not what its format wants, or beyond what is read of it.
    #[error("{}: no {} file that can be read: {cause}", path.display(), format.name())]
    Format {
        /// File in question.
        path: PathBuf,
        /// What it was taken for.
        format: FileFormat,
        /// What is wrong with it, and what to do.
        cause: Box<dyn std::error::Error + Send + Sync>,
    },
    /// Files that make no stack of slices.
    #[error("{}: {cause}", path.display())]
    Slices {
        /// The folder or pattern.
        path: PathBuf,
        /// What is wrong with them.
        cause: SlicesError,
    },
    /// A header that is no NRRD header of a volume.
    #[error("{}: {cause}", path.display())]
    Nrrd {
        /// File in question.
        path: PathBuf,
        /// What is wrong with it.
        cause: NrrdError,
    },
    /// A header that is no NumPy header of a volume.
    #[error("{}: {cause}", path.display())]
    Npy {
        /// File in question.
        path: PathBuf,
        /// What is wrong with it.
        cause: NpyError,
    },
}

impl ReadError {
    /// Whose fault it is.
    pub const fn kind(&self) -> Fault {
        match self {
            Self::Io { .. } | Self::TooLarge { .. } => Fault::Io,
            Self::NoLayout { .. }
            | Self::Layout { .. }
            | Self::LayoutMismatch { .. }
            | Self::NotScalar { .. } => Fault::Usage,
            Self::Empty { .. }
            | Self::SampleBytes { .. }
            | Self::Gzip { .. }
            | Self::Changed { .. }
            | Self::BeyondEnd { .. }
            | Self::Format { .. }
            | Self::Slices { .. }
            | Self::Nrrd { .. }
            | Self::Npy { .. } => Fault::Data,
        }
    }
}

/// Why a volume could not be written. Nothing has changed at its path then.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The system refused.
    #[error("{}: cannot write: {}", path.display(), in_words(cause))]
    Io {
        /// File in question: the data file where header and data are detached.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// The volume's samples are not as many as its extent says.
    #[error("{}: the volume has {found} bytes of samples where its extent and type need {expected}", path.display())]
    SampleBytes {
        /// File in question.
        path: PathBuf,
        /// Bytes according to extent and type; `u64::MAX` if too many to count.
        expected: u64,
        /// Bytes of the samples.
        found: u64,
    },
    /// Compression was asked for in a format that has none.
    #[error(
        "{}: files of this name hold no compressed samples: leave gzip out, or write .nrrd, .nhdr, .mha, .mhd or .nii.gz",
        path.display()
    )]
    NoGzip {
        /// File in question.
        path: PathBuf,
    },
    /// The name of a file that only compressing makes.
    #[error(
        "{}: a file of this name would be taken for a compressed one: give another extension",
        path.display()
    )]
    Compressed {
        /// File in question.
        path: PathBuf,
    },
    /// The name of a format that is not written.
    #[error(
        "{}: {what} is not written: give the extension of a format that is, or .raw for the samples alone",
        path.display()
    )]
    Foreign {
        /// File in question.
        path: PathBuf,
        /// What such a file would be taken for.
        what: &'static str,
    },
    /// A data set that the format cannot hold.
    #[error("{}: {} files cannot hold {what}", path.display(), format.name())]
    CannotHold {
        /// File in question.
        path: PathBuf,
        /// Its format.
        format: FileFormat,
        /// What they cannot hold, and what can.
        what: String,
    },
    /// Slices would mix with those that are there.
    #[error(
        "{}: files of such names are there already ({count}, as {}): remove them or choose another name",
        path.display(),
        first.display()
    )]
    SlicesExist {
        /// The pattern.
        path: PathBuf,
        /// Files whose names fit it.
        count: usize,
        /// One of them.
        first: PathBuf,
    },
    /// A detached header would replace a data file that does not belong to it.
    #[error(
        "{}: its samples would replace {}, which is there already: move that file or choose another name",
        path.display(),
        data.display()
    )]
    DataFileExists {
        /// The header.
        path: PathBuf,
        /// The data file.
        data: PathBuf,
    },
}

impl WriteError {
    /// Whose fault it is.
    pub const fn kind(&self) -> Fault {
        match self {
            Self::Io { .. } => Fault::Io,
            Self::SampleBytes { .. } => Fault::Data,
            Self::NoGzip { .. }
            | Self::Compressed { .. }
            | Self::Foreign { .. }
            | Self::CannotHold { .. }
            | Self::SlicesExist { .. }
            | Self::DataFileExists { .. } => Fault::Usage,
        }
    }

    /// The same fault of what the user knows as `file`, where the file in question is a part of it.
    #[must_use]
    pub(super) fn at(self, file: &Path) -> Self {
        let path = file.to_owned();
        match self {
            Self::Io { cause, .. } => Self::Io { path, cause },
            Self::SampleBytes { expected, found, .. } => Self::SampleBytes { path, expected, found },
            Self::NoGzip { .. } => Self::NoGzip { path },
            Self::Compressed { .. } => Self::Compressed { path },
            Self::Foreign { what, .. } => Self::Foreign { path, what },
            Self::CannotHold { format, what, .. } => Self::CannotHold { path, format, what },
            other @ (Self::SlicesExist { .. } | Self::DataFileExists { .. }) => other,
        }
    }
}

/// What the system says of an error, for people: without its number, and without the name of a temporary file.
pub fn in_words(cause: &io::Error) -> String {
    match cause.kind() {
        io::ErrorKind::IsADirectory => "is a directory".to_owned(),
        _ => {
            let text = cause.to_string();
            text.split_once(" (os error ").map_or(text.as_str(), |(words, _)| words).to_owned()
        }
    }
}

/// At most 48 characters of `text` as a quoted literal, so that no file can write to a terminal.
pub(crate) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(48) {
        Some((end, _)) => format!("{:?}…", &text[..end]),
        None => format!("{text:?}"),
    }
}
