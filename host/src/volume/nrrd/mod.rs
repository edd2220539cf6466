//! NRRD files ("nearly raw raster data"): a header of text lines, then samples or the name of their file.
//!
//! Source: *Definition of the NRRD file format*, the Teem project. Axes are listed fastest first there too, so the
//! first of `sizes` is x. Read and written are the encodings `raw` and `gzip`, attached and detached.

mod error;
mod header;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

pub use error::NrrdError;
use header::{ByteSkip, is_structure, line_text, type_name};

use super::format::{Format, has_extension};
use super::input::Input;
use super::stored::{Encoding, Place, Stored, StoredSink};
use super::{
    ByteOrder, Created, FileFormat, Header, HeaderLine, Metadata, Origin, ReadError, Source, WriteError,
    WriteOptions, name_of,
};
use crate::atomic::AtomicFile;

/// First bytes of every NRRD file.
pub(super) const MAGIC: &[u8] = b"NRRD";

/// The Teem project's format.
pub(super) struct Nrrd;

impl Format for Nrrd {
    fn format(&self) -> FileFormat {
        FileFormat::Nrrd
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(path, &["nrrd", "nhdr"])
    }

    fn magic(&self) -> Option<&'static [u8]> {
        Some(MAGIC)
    }

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        Ok(Box::new(open(input)?))
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        if !header.is_scalar() {
            let what = "several components or time steps".to_owned();
            return Err(WriteError::CannotHold { path: path.to_owned(), format: self.format(), what });
        }
        create(path, header, options)
    }
}

fn open(mut input: Input) -> Result<Stored, ReadError> {
    let header = header::Header::read(&mut input)?;
    let bytes = header.extent.samples() * header.element.bytes() as u64;
    let mut data = match &header.data_file {
        Some(name) => Input::open(&beside(input.path(), name))?,
        None => input,
    };
    if header.byte_skip == ByteSkip::ToEnd && (header.encoding != Encoding::Raw || data.left().is_none()) {
        return Err(ReadError::Nrrd { path: data.path().to_owned(), cause: NrrdError::SkipToEnd });
    }
    data.skip_lines(header.line_skip)?;
    let skip = match header.byte_skip {
        ByteSkip::Bytes(count) => count,
        ByteSkip::ToEnd => data.left().unwrap_or(0).saturating_sub(bytes),
    };
    let origin = Origin { format: FileFormat::Nrrd, byte_order: header.byte_order, fortran_order: false };
    let metadata = Metadata { rank: header.extent.rank(), source: origin, lines: header.lines };
    let place =
        Place { encoding: header.encoding, byte_order: header.byte_order, skip, is_open_ended: false };
    Stored::new(data, Header::scalar(header.extent.axes(), header.element, metadata), place)
}

/// Begins one file of header and samples, or two if `path` ends in `.nhdr`.
///
/// The losses are lines of the metadata that no header can hold: texts with a line break where none may be.
fn create(path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
    let encoding = if options.gzip { Encoding::Gzip } else { Encoding::Raw };
    let order = options.byte_order.unwrap_or(header.metadata.source.byte_order);
    let fault = |cause| WriteError::Io { path: path.to_owned(), cause };
    let (mut text, losses) = header_text(header, order, encoding);
    if !has_extension(path, &["nhdr"]) {
        text.push('\n');
        let mut file = AtomicFile::create(path).map_err(fault)?;
        file.write_all(text.as_bytes()).map_err(fault)?;
        let sink = StoredSink::new(file, path, header, encoding, order);
        return Ok(Created { sink: Box::new(sink), losses });
    }
    let data = path.with_extension(if options.gzip { "raw.gz" } else { "raw" });
    text.push_str(&data_file_line(&data).map_err(fault)?);
    if data.exists() && !belongs_to(&data, path) {
        return Err(WriteError::DataFileExists { path: path.to_owned(), data });
    }
    let mut header_file = AtomicFile::create(path).map_err(fault)?;
    header_file.write_all(text.as_bytes()).and_then(|()| header_file.flush()).map_err(fault)?;
    let file = AtomicFile::create(&data).map_err(|cause| WriteError::Io { path: data.clone(), cause })?;
    let sink = StoredSink::new(file, &data, header, encoding, order).followed_by(header_file, path);
    Ok(Created { sink: Box::new(sink), losses })
}

/// Header up to where the samples, or the name of their file, follow.
fn header_text(header: &Header, order: ByteOrder, encoding: Encoding) -> (String, Vec<String>) {
    let rank = header.rank();
    let sizes: Vec<String> = header.extent[..rank].iter().map(u64::to_string).collect();
    let version = if header.metadata.field("measurement frame").is_some() { 5 } else { 4 };
    let mut text = format!("NRRD000{version}\ntype: {}\ndimension: {rank}\n", type_name(header.element));
    text += &format!("sizes: {}\n", sizes.join(" "));
    if header.element.bytes() > 1 {
        text += &format!("endian: {order}\n");
    }
    text += match encoding {
        Encoding::Raw => "encoding: raw\n",
        _ => "encoding: gzip\n",
    };
    let mut losses = Vec::new();
    for line in &header.metadata.lines {
        let made_anew = matches!(line, HeaderLine::Field { name, .. } if is_structure(name));
        match line_text(line) {
            Some(line) if !made_anew => text += &(line + "\n"),
            _ => losses.push(name_of(line)),
        }
    }
    (text, losses)
}

fn beside(header: &Path, name: &str) -> PathBuf {
    header.parent().unwrap_or(Path::new("")).join(name)
}

/// Line that names a data file in the folder of its header.
fn data_file_line(data: &Path) -> io::Result<String> {
    let name = data.file_name().and_then(|name| name.to_str()).ok_or(io::ErrorKind::InvalidFilename)?;
    let line = HeaderLine::Field { name: "data file".to_owned(), value: name.to_owned() };
    Ok(line_text(&line).ok_or(io::ErrorKind::InvalidFilename)? + "\n")
}

/// Whether a header is there already and names these data: then the two are replaced together.
fn belongs_to(data: &Path, header: &Path) -> bool {
    let named = Input::open(header).and_then(|mut input| header::Header::read(&mut input));
    let named = named.ok().and_then(|found| fs::canonicalize(beside(header, &found.data_file?)).ok());
    named.is_some() && named == fs::canonicalize(data).ok()
}

#[cfg(test)]
mod tests;
