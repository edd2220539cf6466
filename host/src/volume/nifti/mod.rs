//! NIfTI files: a header of 348 or 540 bytes, extensions, and samples behind it or in a file of their own; any of them
//! in gzip.
//!
//! Source: `nifti1.h` and `nifti2.h` of the NIfTI Data Format Working Group. Axes are listed fastest first: x, y, z,
//! time, then components, which so lie as volumes one after another, but for colours and complex numbers, whose parts
//! lie together. Positions are those of a right-anterior-superior space. The crate `nifti` reads whole volumes only,
//! and knows no extensions on writing; so the header is read here.

mod error;
mod fields;
mod header;
mod meaning;
mod orientation;

use std::io::{Read, Write};
use std::path::{Path, PathBuf};

pub use error::NiftiError;
use flate2::Compression;
use flate2::bufread::MultiGzDecoder;
use flate2::write::GzEncoder;
use header::{HeaderFault, NiftiHeader};

use super::format::{Format, has_extension};
use super::input::Input;
use super::rearranged::{ordered, ordered_sink};
use super::stored::{Encoding, GZIP, Place, Stored, StoredSink};
use super::{Axis, Created, FileFormat, Header, ReadError, Source, WriteError, WriteOptions};
use crate::atomic::AtomicFile;

/// The Neuroimaging Informatics Technology Initiative's format.
pub(super) struct Nifti;

impl Format for Nifti {
    fn format(&self) -> FileFormat {
        FileFormat::Nifti
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(path, &["nii", "nii.gz", "hdr", "hdr.gz", "img", "img.gz"])
    }

    fn begins(&self, first: &[u8]) -> bool {
        let mut unpacked = Vec::new();
        if first.starts_with(GZIP) {
            // As much of it as comes out of so few bytes.
            let _cut_short = MultiGzDecoder::new(first).take(352).read_to_end(&mut unpacked);
        }
        let head = if unpacked.is_empty() { first } else { &unpacked };
        head.get(344..348) == Some(b"n+1\0".as_slice())
            || head.get(4..12) == Some(b"n+2\0\r\n\x1a\n".as_slice())
    }

    fn compresses(&self, path: &Path) -> bool {
        has_extension(path, &["gz"])
    }

    fn open(&self, path: &Path) -> Result<Box<dyn Source>, ReadError> {
        match has_extension(path, &["img", "img.gz"]) {
            true => self.open_input(Input::open(&partner(path, "hdr"))?),
            false => self.open_input(Input::open(path)?),
        }
    }

    fn open_input(&self, mut input: Input) -> Result<Box<dyn Source>, ReadError> {
        let path = input.path().to_owned();
        let is_packed = input.starts_with(GZIP)?;
        let (read, mut input) = if is_packed {
            let mut decoder = MultiGzDecoder::new(input);
            (NiftiHeader::read(&mut decoder), decoder.into_inner())
        } else {
            (NiftiHeader::read(&mut input), input)
        };
        let file = read.map_err(|fault| named(fault, &path, is_packed))?;
        let (header, axes) = meaning::read(&file).map_err(|cause| format_error(&path, cause))?;
        if !file.is_pair {
            input.seek(0)?;
            return stored(input, &file, header, &axes);
        }
        let data = partner(&path, "img");
        let input = match Input::open(&data) {
            Err(_) if !data.exists() && with_gz(&data).exists() => Input::open(&with_gz(&data))?,
            other => other?,
        };
        stored(input, &file, header, &axes)
    }

    fn writes(&self, path: &Path) -> Vec<PathBuf> {
        match has_extension(path, &["nii", "nii.gz"]) {
            true => vec![path.to_owned()],
            false => ["hdr", "img"].map(|extension| partner(path, extension)).into(),
        }
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        let order = options.byte_order.unwrap_or(header.metadata.source.byte_order);
        let is_pair = !has_extension(path, &["nii", "nii.gz"]);
        let (file, axes, mut losses) = meaning::written(header, order, is_pair).map_err(|what| {
            WriteError::CannotHold { path: path.to_owned(), format: FileFormat::Nifti, what }
        })?;
        let (bytes, lost) = file.to_bytes();
        losses.extend(lost.into_iter().map(meaning::loss_of));
        let encoding = if has_extension(path, &["gz"]) { Encoding::Gzip } else { Encoding::Raw };
        let create = |path: &Path| {
            AtomicFile::create(path).map_err(|cause| WriteError::Io { path: path.to_owned(), cause })
        };
        if !is_pair {
            let mut sink = StoredSink::new(create(path)?, path, header, encoding, order);
            sink.write_head(&bytes)?;
            return Ok(Created { sink: ordered_sink(sink, path, header, &axes)?, losses });
        }
        let (head, data) = (partner(path, "hdr"), partner(path, "img"));
        if data.exists() && !head.exists() {
            return Err(WriteError::DataFileExists { path: head, data });
        }
        let mut head_file = create(&head)?;
        let written = match encoding {
            Encoding::Raw => head_file.write_all(&bytes),
            _ => GzEncoder::new(&mut head_file, Compression::default()).write_all(&bytes),
        };
        written.map_err(|cause| WriteError::Io { path: head.clone(), cause })?;
        let sink =
            StoredSink::new(create(&data)?, &data, header, encoding, order).followed_by(head_file, &head);
        Ok(Created { sink: ordered_sink(sink, path, header, &axes)?, losses })
    }
}

/// Samples behind the header, or alone in a file.
fn stored(
    mut input: Input,
    file: &NiftiHeader,
    header: Header,
    axes: &[Axis],
) -> Result<Box<dyn Source>, ReadError> {
    let encoding = if input.starts_with(GZIP)? { Encoding::Gzip } else { Encoding::Raw };
    let place = Place { encoding, byte_order: file.order, skip: file.offset, is_open_ended: false };
    let path = input.path().to_owned();
    ordered(Stored::new(input, header, place)?, &path, axes)
}

fn format_error(path: &Path, cause: NiftiError) -> ReadError {
    ReadError::Format { path: path.to_owned(), format: FileFormat::Nifti, cause: Box::new(cause) }
}

fn named(fault: HeaderFault, path: &Path, is_packed: bool) -> ReadError {
    match fault {
        HeaderFault::Nifti(cause) => format_error(path, cause),
        HeaderFault::Io(cause) if is_packed && cause.raw_os_error().is_none() => {
            ReadError::Gzip { path: path.to_owned(), cause }
        }
        HeaderFault::Io(cause) => ReadError::Io { path: path.to_owned(), cause },
    }
}

/// The other file of a pair, with that extension, `.gz` behind it as in `path`.
fn partner(path: &Path, extension: &str) -> PathBuf {
    match has_extension(path, &["gz"]) {
        true => with_gz(&path.with_extension("").with_extension(extension)),
        false => path.with_extension(extension),
    }
}

fn with_gz(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".gz");
    name.into()
}

#[cfg(test)]
mod tests;
