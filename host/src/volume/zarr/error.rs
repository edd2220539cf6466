//! What can be wrong with a Zarr folder.

/// Why a Zarr folder cannot be read. Texts from files are quoted and shortened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ZarrError {
    /// No metadata of Zarr.
    #[error("it has neither zarr.json nor .zarray, .zgroup or .zattrs")]
    NoNode,
    /// A metadata file that is no proper JSON, or far too long.
    #[error("{file} cannot be understood: {cause}")]
    Json {
        /// Name of the file.
        file: String,
        /// What is wrong with it.
        cause: String,
    },
    /// A group in which no image or array is the obvious one.
    #[error("it is a group without a picture of its own: name one of the arrays in it, {arrays}")]
    Group {
        /// Names of arrays in it.
        arrays: String,
    },
    /// Something that has to be in the metadata and is not.
    #[error("its metadata have no proper {what}")]
    Metadata {
        /// What it is.
        what: &'static str,
    },
    /// Samples that are no integers or floats of 8 to 64 bits.
    #[error("its samples are of type {found}, not integers or floats of 8 to 64 bits")]
    Element {
        /// Type in the words of the metadata.
        found: String,
    },
    /// Axes that make no volume.
    #[error("its axes {axes} are not those of a volume: up to three of space, one of channels, one of time")]
    Axes {
        /// The axes.
        axes: String,
    },
    /// More samples than can be counted, or an axis without any.
    #[error(
        "its shape {shape} has an axis of zero samples, or more samples than 64 bits can count the bytes of"
    )]
    Extent {
        /// The shape.
        shape: String,
    },
    /// Chunks, rows or tables of chunks that are too large to be decoded.
    #[error("{what} has {bytes} bytes, more than the {limit} that are read at once")]
    TooLarge {
        /// What is too large.
        what: &'static str,
        /// Its bytes, `u64::MAX` if too many to count.
        bytes: u64,
        /// The most that is taken.
        limit: u64,
    },
    /// Metadata or chunks that zarrs does not read.
    #[error("{0}")]
    Zarrs(String),
}
