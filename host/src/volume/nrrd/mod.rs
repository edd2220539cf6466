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
use header::{ByteSkip, Encoding, Header, is_structure, line_text, type_name};

use super::element::{reorder, write_samples};
use super::input::Input;
use super::{ByteOrder, FileFormat, HeaderLine, Metadata, ReadError, Source, Volume, WriteError, name_of};
use crate::atomic::AtomicFile;

/// First bytes of every NRRD file.
pub(super) const MAGIC: &[u8] = b"NRRD";

pub(super) fn read(mut input: Input) -> Result<Volume, ReadError> {
    let header = Header::read(&mut input)?;
    let fault = |cause| ReadError::Nrrd { path: input.path().to_owned(), cause };
    let bytes = header.extent.samples() * header.element.bytes() as u64;
    let mut detached = match &header.data_file {
        Some(name) => Some(Input::open(&beside(input.path(), name))?),
        None => None,
    };
    let end_is_known = detached.as_ref().unwrap_or(&input).left().is_some();
    if header.byte_skip == ByteSkip::ToEnd && (header.encoding == Encoding::Gzip || !end_is_known) {
        return Err(fault(NrrdError::SkipToEnd));
    }
    let data = detached.as_mut().unwrap_or(&mut input);
    data.skip_lines(header.line_skip)?;
    let skip = match header.byte_skip {
        ByteSkip::Bytes(count) => count,
        ByteSkip::ToEnd => data.left().unwrap_or(0).saturating_sub(bytes),
    };
    let mut samples = match header.encoding {
        Encoding::Gzip => data.gzip_samples(skip, bytes)?,
        Encoding::Raw => {
            data.skip_bytes(skip)?;
            data.samples(bytes)?
        }
    };
    reorder(&mut samples, header.element, header.byte_order);
    let source = Source { format: FileFormat::Nrrd, byte_order: header.byte_order, fortran_order: false };
    let metadata = Metadata { rank: header.extent.rank(), source, lines: header.lines };
    Ok(Volume { extent: header.extent.axes(), element: header.element, samples, metadata })
}

/// Writes header and samples into one file, or into two if `path` ends in `.nhdr`.
///
/// Returns the lines of the metadata that no header can hold: texts with a line break where none may be.
pub(super) fn write(
    volume: &Volume,
    path: &Path,
    order: ByteOrder,
    gzip: bool,
) -> Result<Vec<String>, WriteError> {
    let encoding = if gzip { Encoding::Gzip } else { Encoding::Raw };
    let fault = |cause| WriteError::Io { path: path.to_owned(), cause };
    let (mut header, losses) = header_text(volume, order, encoding);
    if !path.extension().is_some_and(|found| found.eq_ignore_ascii_case("nhdr")) {
        header.push('\n');
        let mut file = AtomicFile::create(path).map_err(fault)?;
        let written = file.write_all(header.as_bytes());
        written.and_then(|()| write_data(file, volume, order, encoding)?.commit()).map_err(fault)?;
        return Ok(losses);
    }
    let data = path.with_extension(if gzip { "raw.gz" } else { "raw" });
    header.push_str(&data_file_line(&data).map_err(fault)?);
    if data.exists() && !belongs_to(&data, path) {
        return Err(WriteError::DataFileExists { path: path.to_owned(), data });
    }
    let mut header_file = AtomicFile::create(path).map_err(fault)?;
    header_file.write_all(header.as_bytes()).and_then(|()| header_file.flush()).map_err(fault)?;
    let data_file =
        AtomicFile::create(&data).and_then(|file| write_data(file, volume, order, encoding)?.commit());
    data_file.map_err(|cause| WriteError::Io { path: data.clone(), cause })?;
    header_file.commit().map_err(|cause| {
        let _samples_without_header = fs::remove_file(&data);
        fault(cause)
    })?;
    Ok(losses)
}

/// Header up to where the samples, or the name of their file, follow.
fn header_text(volume: &Volume, order: ByteOrder, encoding: Encoding) -> (String, Vec<String>) {
    let rank = volume.rank();
    let sizes: Vec<String> = volume.extent[..rank].iter().map(u64::to_string).collect();
    let version = if volume.metadata.field("measurement frame").is_some() { 5 } else { 4 };
    let mut text = format!("NRRD000{version}\ntype: {}\ndimension: {rank}\n", type_name(volume.element));
    text += &format!("sizes: {}\n", sizes.join(" "));
    if volume.element.bytes() > 1 {
        text += &format!("endian: {order}\n");
    }
    text += match encoding {
        Encoding::Raw => "encoding: raw\n",
        Encoding::Gzip => "encoding: gzip\n",
    };
    let mut losses = Vec::new();
    for line in &volume.metadata.lines {
        let made_anew = matches!(line, HeaderLine::Field { name, .. } if is_structure(name));
        match line_text(line) {
            Some(line) if !made_anew => text += &(line + "\n"),
            _ => losses.push(name_of(line)),
        }
    }
    (text, losses)
}

fn write_data(
    mut file: AtomicFile,
    volume: &Volume,
    order: ByteOrder,
    encoding: Encoding,
) -> io::Result<AtomicFile> {
    match encoding {
        Encoding::Raw => write_samples(&mut file, &volume.samples, volume.element, order)?,
        Encoding::Gzip => {
            let mut encoder = flate2::write::GzEncoder::new(&mut file, flate2::Compression::default());
            write_samples(&mut encoder, &volume.samples, volume.element, order)?;
            encoder.finish()?;
        }
    }
    Ok(file)
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
    let named = Input::open(header).and_then(|mut input| Header::read(&mut input));
    let named = named.ok().and_then(|found| fs::canonicalize(beside(header, &found.data_file?)).ok());
    named.is_some() && named == fs::canonicalize(data).ok()
}

#[cfg(test)]
mod tests;
