//! Volumes and the files they come from and go to: raw samples, NRRD, NumPy.
//!
//! Which format holds what, and what is lost on the way into another, is in `docs/files.md`.

mod element;
mod error;
mod extent;
mod input;
mod metadata;
mod npy;
mod nrrd;
mod raw;
pub mod synthetic;

use std::fmt;
use std::io::Write;
use std::path::Path;

pub use element::{ByteOrder, ElementType, UnknownByteOrder, UnknownElementType};
pub use error::{Fault, Found, ReadError, WriteError};
pub use extent::{ExtentError, RankedExtent};
use input::Input;
pub use metadata::{FileFormat, HeaderLine, Metadata, Source};
pub use npy::NpyError;
pub use nrrd::NrrdError;
pub use raw::RawLayout;
use serde::{Deserialize, Serialize};

use crate::atomic::AtomicFile;

/// A whole data set in memory.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Volume {
    /// Samples along x, y and z, each at least 1; x varies fastest.
    pub extent: [u64; 3],
    /// Type of a sample.
    pub element: ElementType,
    /// Little-endian samples, x fastest: as many bytes as [`sample_bytes`] says.
    pub samples: Vec<u8>,
    /// What else the file said.
    pub metadata: Metadata,
}

impl Volume {
    /// Number of axes that a file of this volume has, 1 to 3: those of the source, and more if z or y need them.
    pub fn rank(&self) -> usize {
        let needed = self.extent.iter().rposition(|&axis| axis > 1).map_or(1, |axis| axis + 1);
        needed.max(self.metadata.rank.into()).min(3)
    }
}

/// Bytes of the samples of a volume, `None` if 64 bits do not count them.
pub fn sample_bytes(extent: [u64; 3], element: ElementType) -> Option<u64> {
    extent.into_iter().try_fold(element.bytes() as u64, u64::checked_mul)
}

/// How a volume is written. The default is the way it was read, without compression.
#[derive(Clone, Copy, Debug, Default)]
pub struct WriteOptions {
    /// Order of the bytes of a sample; `None` for that of the source.
    pub byte_order: Option<ByteOrder>,
    /// Whether samples are compressed with gzip, which only NRRD files can be.
    pub gzip: bool,
}

/// Something in the metadata that the written file does not hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loss {
    /// What is missing: the name of a field, `2 comments`, `17 key/value pairs`.
    pub what: String,
    /// Format that has no place for it.
    pub format: FileFormat,
}

impl Loss {
    fn of_line(line: &HeaderLine, format: FileFormat) -> Self {
        let what = match line {
            HeaderLine::Comment(text) => format!("comment {}", error::excerpt(text)),
            HeaderLine::Field { name, .. } => format!("field {}", error::excerpt(name)),
            HeaderLine::KeyValue { key, .. } => format!("key {}", error::excerpt(key)),
        };
        Self { what, format }
    }
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} has no place for it", self.what, self.format.name())
    }
}

/// Reads a volume.
///
/// With a layout the file is taken as raw, whatever its name. Without one the format is found by the extension
/// (`.nrrd`, `.nhdr`, `.npy`, in any case) or else by the first bytes.
///
/// # Errors
///
/// [`ReadError`], whose [`kind`](ReadError::kind) tells a wrong layout from a bad file and from a failing system.
/// Headers are not trusted: no more memory is taken for samples than bytes arrive.
///
/// Cost: one pass over the file; the samples are in memory once (twice at most while they come out of gzip or
/// a FIFO), and are reversed in place if they are big-endian.
pub fn read(path: &Path, layout: Option<&RawLayout>) -> Result<Volume, ReadError> {
    let mut input = Input::open(path)?;
    if let Some(layout) = layout {
        return raw::read(input, layout);
    }
    match FileFormat::of_path(path) {
        FileFormat::Nrrd => nrrd::read(input),
        FileFormat::Npy => npy::read(input),
        FileFormat::Raw if input.starts_with(nrrd::MAGIC)? => nrrd::read(input),
        FileFormat::Raw if input.starts_with(npy::MAGIC)? => npy::read(input),
        FileFormat::Raw => Err(ReadError::NoLayout { path: path.to_owned() }),
    }
}

/// Writes a volume in the format of the path's extension: `.nrrd`, `.nhdr` (samples beside it in `.raw` or
/// `.raw.gz`), `.npy`, and raw for any other. Returns what of the metadata that format does not hold.
///
/// The file appears whole or not at all, and an old one stays until then; see [`AtomicFile`].
///
/// # Errors
///
/// [`WriteError`]; nothing has changed at the path then.
///
/// Cost: one pass over the samples.
pub fn write(volume: &Volume, path: &Path, options: &WriteOptions) -> Result<Vec<Loss>, WriteError> {
    let expected = sample_bytes(volume.extent, volume.element).unwrap_or(u64::MAX);
    let found = volume.samples.len() as u64;
    if found != expected {
        return Err(WriteError::SampleBytes { path: path.to_owned(), expected, found });
    }
    let order = options.byte_order.unwrap_or(volume.metadata.source.byte_order);
    let format = FileFormat::of_path(path);
    if format == FileFormat::Nrrd {
        return nrrd::write(volume, path, order, options.gzip);
    }
    if options.gzip {
        return Err(WriteError::NoGzip { path: path.to_owned() });
    }
    let write = || {
        let mut file = AtomicFile::create(path)?;
        if format == FileFormat::Npy {
            file.write_all(&npy::header(volume, order))?;
        }
        element::write_samples(&mut file, &volume.samples, volume.element, order)?;
        file.commit()
    };
    write().map_err(|cause| WriteError::Io { path: path.to_owned(), cause })?;
    Ok(losses(&volume.metadata, format))
}

/// What a format that holds no lines loses: each field by name, comments and pairs by number.
fn losses(metadata: &Metadata, format: FileFormat) -> Vec<Loss> {
    let (mut comments, mut pairs) = (0, 0);
    let mut losses = Vec::new();
    for line in &metadata.lines {
        match line {
            HeaderLine::Comment(_) => comments += 1,
            HeaderLine::KeyValue { .. } => pairs += 1,
            HeaderLine::Field { .. } => losses.push(Loss::of_line(line, format)),
        }
    }
    for (count, one, many) in
        [(comments, "comment", "comments"), (pairs, "key/value pair", "key/value pairs")]
    {
        if count > 0 {
            losses.push(Loss { what: format!("{count} {}", if count == 1 { one } else { many }), format });
        }
    }
    losses
}

#[cfg(test)]
mod tests;
