//! Volumes and the files they come from and go to: raw samples, NRRD, NumPy.
//!
//! Which format holds what, and what is lost on the way into another, is in `docs/files.md`.

mod axis;
mod copy;
mod dicom;
mod element;
mod entries;
mod error;
mod extent;
mod format;
mod geometry;
mod guarded;
mod half;
#[cfg(feature = "hdf5")]
mod hdf5;
mod header;
mod input;
mod joined;
mod jpeg;
mod jpeg2000;
mod metadata;
mod metaimage;
mod mgh;
mod mrc;
mod nifti;
mod npy;
mod nrrd;
mod order;
mod overwritten;
mod packbits;
mod pieces;
mod planes;
mod png;
mod pnm;
mod raster;
mod raw;
mod rearranged;
pub(crate) mod sample;
mod slices;
mod spool;
mod stored;
mod stream;
pub mod synthetic;
mod tiff;
mod vtk;
mod watched;
#[cfg(feature = "zarr")]
mod zarr;

use std::path::Path;

pub use axis::Axis;
pub use copy::{CopyError, copy};
pub use dicom::DicomError;
pub(crate) use element::value_of_text;
pub use element::{ByteOrder, ElementType, UnknownByteOrder, UnknownElementType};
pub(crate) use error::excerpt;
pub use error::{Fault, Found, ReadError, WriteError, in_words};
pub use extent::{ExtentError, RankedExtent};
pub use format::FileFormat;
pub use geometry::{Geometry, Space};
#[cfg(feature = "hdf5")]
pub use hdf5::Hdf5Error;
pub use header::Header;
pub use metadata::{HeaderLine, Metadata, Origin};
pub use metaimage::MetaImageError;
pub use mgh::MghError;
pub use mrc::MrcError;
pub use nifti::NiftiError;
pub use npy::NpyError;
pub use nrrd::NrrdError;
pub use order::{AxisOrder, OrderError};
pub use overwritten::overwritten;
pub use png::PngError;
pub use pnm::PnmError;
pub use raw::RawLayout;
pub use sample::Sample;
use serde::{Deserialize, Serialize};
pub use slices::SlicesError;
pub use stream::{Created, InMemory, Sink, Source, create, open, open_known};
pub use tiff::TiffError;
pub use vtk::VtkError;
#[cfg(feature = "zarr")]
pub use zarr::ZarrError;

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
        self.metadata.rank_of(self.extent)
    }

    /// All but the samples.
    pub fn header(&self) -> Header {
        Header::scalar(self.extent, self.element, self.metadata.clone())
    }

    /// The rows of the box of `sides` samples from `origin` on, which lies within the volume: each `sides[0]` samples,
    /// little-endian, y before z.
    pub(crate) fn rows(&self, origin: [u64; 3], sides: [u32; 3]) -> impl Iterator<Item = &[u8]> {
        let [width, height, _] = self.extent.map(|axis| axis as usize);
        let ([x, y, z], [w, h, d]) = (origin.map(|axis| axis as usize), sides.map(|side| side as usize));
        let sample = self.element.bytes();
        (z..z + d).flat_map(move |z| {
            (y..y + h).map(move |y| &self.samples[((z * height + y) * width + x) * sample..][..w * sample])
        })
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
    /// Whether samples are compressed: with gzip in NRRD, with zlib in MetaImage. NIfTI's names say it themselves, by
    /// `.gz` at their end.
    pub gzip: bool,
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
pub fn read(path: impl AsRef<Path>, layout: Option<&RawLayout>) -> Result<Volume, ReadError> {
    read_all(path.as_ref(), open(&path, layout)?)
}

/// Reads a volume whose layout is known from elsewhere: as [`read`] without a layout, but where the file is raw, it
/// is taken to have that one.
///
/// # Errors
///
/// As [`read`], but for [`ReadError::NoLayout`].
///
/// Cost: as [`read`].
pub fn read_known(path: impl AsRef<Path>, layout: &RawLayout) -> Result<Volume, ReadError> {
    read_all(path.as_ref(), open_known(&path, layout)?)
}

/// Bytes that are read, and for which memory is taken, at a time.
const PIECE_BYTES: u64 = 1 << 22;

/// Reads all samples of a source, which is that of a file at `path` and one volume of single values, into memory.
///
/// # Errors
///
/// As [`read`], but for those of opening.
///
/// Cost: as [`read`].
pub fn read_all(path: &Path, mut source: Box<dyn Source>) -> Result<Volume, ReadError> {
    let Header { extent, components, steps, element, metadata } = source.header().clone();
    if !source.header().is_scalar() {
        return Err(ReadError::NotScalar { path: path.to_owned(), components, steps });
    }
    let bytes = source.header().bytes().unwrap_or(u64::MAX);
    let too_large = || ReadError::TooLarge { path: path.to_owned(), bytes };
    let mut samples = Vec::new();
    if source.is_random() {
        samples
            .try_reserve_exact(usize::try_from(bytes).map_err(|_| too_large())?)
            .map_err(|_| too_large())?;
    }
    while (samples.len() as u64) < bytes {
        let (start, piece) = (samples.len(), PIECE_BYTES.min(bytes - samples.len() as u64) as usize);
        samples.try_reserve(piece).map_err(|_| too_large())?;
        samples.resize(start + piece, 0);
        source.read(&mut samples[start..])?;
    }
    Ok(Volume { extent, element, samples, metadata })
}

/// Writes a volume in the format of the path's extension: `.nrrd`, `.nhdr` (samples beside it in `.raw` or
/// `.raw.gz`), `.npy`, and raw for any other. Returns what of the metadata that format has no place for: fields by
/// name, `2 comments`, `17 key/value pairs`; for NRRD the single lines that no header can hold.
///
/// The file appears whole or not at all, and an old one stays until then; see [`AtomicFile`](crate::atomic::AtomicFile).
///
/// # Errors
///
/// [`WriteError`]; nothing has changed at the path then.
///
/// Cost: one pass over the samples.
pub fn write(
    volume: &Volume,
    path: impl AsRef<Path>,
    options: &WriteOptions,
) -> Result<Vec<String>, WriteError> {
    let path = path.as_ref();
    let expected = sample_bytes(volume.extent, volume.element).unwrap_or(u64::MAX);
    let found = volume.samples.len() as u64;
    if found != expected {
        return Err(WriteError::SampleBytes { path: path.to_owned(), expected, found });
    }
    let Created { mut sink, losses } = create(path, &volume.header(), options)?;
    sink.write(&volume.samples)?;
    sink.finish()?;
    Ok(losses)
}

/// What a format that holds no lines loses: each field by name, comments and pairs by number.
fn losses(metadata: &Metadata) -> Vec<String> {
    let (mut comments, mut pairs) = (0, 0);
    let mut losses = Vec::new();
    for line in &metadata.lines {
        match line {
            HeaderLine::Comment(_) => comments += 1,
            HeaderLine::KeyValue { key, value } if is_rescaling(key, value) => {
                losses.push(format!("rescaling ({} {})", error::excerpt(key), error::excerpt(value)));
            }
            HeaderLine::KeyValue { .. } => pairs += 1,
            HeaderLine::Field { .. } => losses.push(name_of(line)),
        }
    }
    for (count, what) in [(comments, "comment"), (pairs, "key/value pair")] {
        match count {
            0 => {}
            1 => losses.push(format!("1 {what}")),
            _ => losses.push(format!("{count} {what}s")),
        }
    }
    losses
}

/// Whether a pair says that values stand for other numbers: by a slope, which is 1 if not (0 or none in NIfTI), or an
/// intercept, which is 0 if not.
fn is_rescaling(key: &str, value: &str) -> bool {
    let usual: &[f64] = match key {
        "nifti.scl_slope" | "dicom.0028,1053" | "hdf5.scale_factor" => &[0.0, 1.0],
        "nifti.scl_inter" | "dicom.0028,1052" | "hdf5.add_offset" => &[0.0],
        _ => return false,
    };
    let is_usual = |number: f64| number.is_nan() || usual.contains(&number);
    !value.split(';').all(|text| text.trim().parse().is_ok_and(is_usual))
}

/// A line of a header in a few words; texts from the file are shortened and cannot write to a terminal.
fn name_of(line: &HeaderLine) -> String {
    match line {
        HeaderLine::Comment(text) => format!("comment {}", error::excerpt(text)),
        HeaderLine::Field { name, .. } => name.chars().take(48).flat_map(char::escape_debug).collect(),
        HeaderLine::KeyValue { key, .. } => format!("key {}", error::excerpt(key)),
    }
}

#[cfg(test)]
mod tests;
