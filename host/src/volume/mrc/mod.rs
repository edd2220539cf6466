//! MRC and CCP4 maps: a header of 1024 bytes, an extended one, samples; all of it in gzip, if the name ends so.
//!
//! Source: *MRC2014* (A. Cheng et al., Journal of Structural Biology 192, 2015; CCP-EM). Axes are listed fastest first.
//! Lengths are in ångström.

mod error;
mod header;
mod meaning;

use std::path::Path;

pub use error::MrcError;
use flate2::bufread::MultiGzDecoder;
use header::{HeaderFault, MrcHeader, field};

use super::format::{Format, has_extension};
use super::half::Widened;
use super::input::Input;
use super::stored::{Encoding, GZIP, Place, Stored, StoredSink};
use super::{Created, FileFormat, Header, ReadError, Source, WriteError, WriteOptions};
use crate::atomic::AtomicFile;

/// The format of the Medical Research Council's programs, and of what came of them.
pub(super) struct Mrc;

impl Format for Mrc {
    fn format(&self) -> FileFormat {
        FileFormat::Mrc
    }

    fn has_name(&self, path: &Path) -> bool {
        let extensions = ["mrc", "mrcs", "map", "ccp4", "mrc.gz", "mrcs.gz", "map.gz", "ccp4.gz"];
        has_extension(path, &extensions)
    }

    fn begins(&self, first: &[u8]) -> bool {
        first.get(field::MAP..field::MAP + 4) == Some(b"MAP ".as_slice())
    }

    fn compresses(&self, path: &Path) -> bool {
        has_extension(path, &["gz"])
    }

    fn open_input(&self, mut input: Input) -> Result<Box<dyn Source>, ReadError> {
        let path = input.path().to_owned();
        let encoding = if input.starts_with(GZIP)? { Encoding::Gzip } else { Encoding::Raw };
        let (file, mut input) = match encoding {
            Encoding::Raw => (MrcHeader::read(&mut input), input),
            _ => {
                let mut decoder = MultiGzDecoder::new(input);
                (MrcHeader::read(&mut decoder), decoder.into_inner())
            }
        };
        let file = file.map_err(|fault| named(fault, &path, encoding))?;
        let (header, is_half) = meaning::read(&file).map_err(|cause| format_error(&path, cause))?;
        input.seek(0)?;
        let skip = file.bytes.len() as u64;
        let place = Place { encoding, byte_order: file.order, skip, is_open_ended: false };
        let stored = Box::new(Stored::new(input, header, place)?);
        Ok(if is_half { Box::new(Widened::new(stored)) } else { stored })
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        let order = options.byte_order.unwrap_or(header.metadata.source.byte_order);
        let (file, losses) = meaning::written(header, order).map_err(|what| WriteError::CannotHold {
            path: path.to_owned(),
            format: FileFormat::Mrc,
            what,
        })?;
        let encoding = if has_extension(path, &["gz"]) { Encoding::Gzip } else { Encoding::Raw };
        let out =
            AtomicFile::create(path).map_err(|cause| WriteError::Io { path: path.to_owned(), cause })?;
        let mut sink = StoredSink::new(out, path, header, encoding, order);
        sink.write_head(&file.bytes)?;
        Ok(Created { sink: Box::new(sink), losses })
    }
}

fn format_error(path: &Path, cause: MrcError) -> ReadError {
    ReadError::Format { path: path.to_owned(), format: FileFormat::Mrc, cause: Box::new(cause) }
}

fn named(fault: HeaderFault, path: &Path, encoding: Encoding) -> ReadError {
    match fault {
        HeaderFault::Mrc(cause) => format_error(path, cause),
        HeaderFault::Io(cause) if encoding == Encoding::Gzip && cause.raw_os_error().is_none() => {
            ReadError::Gzip { path: path.to_owned(), cause }
        }
        HeaderFault::Io(cause) => ReadError::Io { path: path.to_owned(), cause },
    }
}

#[cfg(test)]
mod tests;
