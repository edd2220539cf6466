//! NRRD files ("nearly raw raster data"): a header of text lines, then samples or the name of their file.
//!
//! Source: *Definition of the NRRD file format*, the Teem project. Axes are listed fastest first there too, so the
//! first of `sizes` is x. Written are the encodings `raw` and `gzip`, attached and detached; `ascii`, `hex` and `bzip2` are
//! read, too.

mod axes;
mod decoded;
mod error;
mod header;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use axes::{axes_of, kinds_of};
use decoded::Method;
pub use error::NrrdError;
use header::{ByteSkip, DataFile, is_structure, line_text, type_name};

use super::error::excerpt;
use super::format::{Format, has_extension};
use super::input::Input;
use super::joined::{Joined, PartLayout, beside, listed, numbered};
use super::rearranged::{ordered, ordered_sink};
use super::stored::{Encoding, Stored, StoredSink};
use super::{
    Axis, ByteOrder, Created, ExtentError, FileFormat, Header, HeaderLine, Metadata, Origin, ReadError,
    Source, WriteError, WriteOptions, name_of,
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

    fn begins(&self, first: &[u8]) -> bool {
        first.starts_with(MAGIC)
    }

    fn compresses(&self, _: &Path) -> bool {
        true
    }

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        open(input)
    }

    fn writes(&self, path: &Path) -> Vec<PathBuf> {
        let data: &[&str] = if has_extension(path, &["nhdr"]) { &["raw", "raw.gz"] } else { &[] };
        let data = data.iter().map(|extension| path.with_extension(extension));
        std::iter::once(path.to_owned()).chain(data).collect()
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        create(path, header, options)
    }
}

fn open(mut input: Input) -> Result<Box<dyn Source>, ReadError> {
    let parsed = header::Header::read(&mut input)?;
    let path = input.path().to_owned();
    let fault = |cause| ReadError::Nrrd { path: path.clone(), cause };
    let layout = PartLayout {
        encoding: parsed.encoding,
        byte_order: parsed.byte_order,
        line_skip: parsed.line_skip,
        byte_skip: match parsed.byte_skip {
            ByteSkip::Bytes(count) => Some(count),
            ByteSkip::ToEnd => None,
        },
    };
    let (data_file, method) = (parsed.data_file.clone(), parsed.method);
    let header = meaning(parsed).map_err(|cause| fault(NrrdError::Extent(cause)))?;
    let axes = header.metadata.axes.clone();
    let files = match data_file {
        None => return ordered(alone(input, header, layout, method)?, &path, &axes),
        Some(DataFile::Name(name)) => {
            let data = Input::open(&beside(&path, &name))?;
            return ordered(alone(data, header, layout, method)?, &path, &axes);
        }
        Some(_) if method.is_some() => return Err(fault(NrrdError::SeveralFiles)),
        Some(DataFile::List) => listed(&mut input)?,
        Some(DataFile::Pattern { pattern, first, last, step }) => {
            let files = numbered(&path, &pattern, first, last, step);
            files.ok_or_else(|| fault(NrrdError::Pattern { found: excerpt(&pattern), first, last, step }))?
        }
    };
    let count = files.len();
    let is_to_end_of_packed = layout.byte_skip.is_none() && layout.encoding != Encoding::Raw;
    if is_to_end_of_packed {
        return Err(fault(NrrdError::SkipToEnd));
    }
    let joined = Joined::new(header, files, layout).ok_or_else(|| fault(NrrdError::Files { count }))?;
    ordered(joined, &path, &axes)
}

/// Samples in one file.
fn alone(
    mut input: Input,
    header: Header,
    layout: PartLayout,
    method: Option<Method>,
) -> Result<Stored, ReadError> {
    let is_packed = layout.encoding != Encoding::Raw || method.is_some();
    if layout.byte_skip.is_none() && (is_packed || input.left().is_none()) {
        return Err(ReadError::Nrrd { path: input.path().to_owned(), cause: NrrdError::SkipToEnd });
    }
    match method {
        Some(method) => {
            input.skip_lines(layout.line_skip)?;
            method.open(input, header, (layout.byte_order, layout.byte_skip.unwrap_or(0)))
        }
        None => layout.open(input, header),
    }
}

/// The data set that a header speaks of.
fn meaning(parsed: header::Header) -> Result<Header, ExtentError> {
    let source = Origin { format: FileFormat::Nrrd, byte_order: parsed.byte_order, fortran_order: false };
    let mut metadata = Metadata { axes: Vec::new(), source, lines: parsed.lines };
    metadata.axes = axes_of(&parsed.sizes, metadata.field("kinds"), metadata.field("space directions"))
        .ok_or(ExtentError::TooLarge)?;
    Header::of_axes(&parsed.sizes, parsed.element, metadata)
}

/// Begins one file of header and samples, or two if `path` ends in `.nhdr`.
///
/// The losses are lines of the metadata that no header can hold: texts with a line break where none may be.
fn create(path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
    let encoding = if options.gzip { Encoding::Gzip } else { Encoding::Raw };
    let order = options.byte_order.unwrap_or(header.metadata.source.byte_order);
    let fault = |cause| WriteError::Io { path: path.to_owned(), cause };
    let axes = header.axes();
    let (mut text, losses) = header_text(header, &axes, order, encoding);
    let finished = |sink: StoredSink| Ok(Created { sink: ordered_sink(sink, path, header, &axes)?, losses });
    if !has_extension(path, &["nhdr"]) {
        text.push('\n');
        let mut file = AtomicFile::create(path).map_err(fault)?;
        file.write_all(text.as_bytes()).map_err(fault)?;
        let sink = StoredSink::new(file, path, header, encoding, order);
        return finished(sink);
    }
    let data = path.with_extension(if options.gzip { "raw.gz" } else { "raw" });
    text.push_str(&data_file_line(&data).map_err(fault)?);
    if data.exists() && !belongs_to(&data, path) {
        return Err(WriteError::DataFileExists { path: path.to_owned(), data });
    }
    let mut header_file = AtomicFile::create(path).map_err(fault)?;
    header_file.write_all(text.as_bytes()).and_then(|()| header_file.flush()).map_err(fault)?;
    let file = AtomicFile::create(&data).map_err(|cause| WriteError::Io { path: data.clone(), cause })?;
    finished(StoredSink::new(file, &data, header, encoding, order).followed_by(header_file, path))
}

/// Header up to where the samples, or the name of their file, follow.
fn header_text(
    header: &Header,
    axes: &[Axis],
    order: ByteOrder,
    encoding: Encoding,
) -> (String, Vec<String>) {
    let sizes: Vec<u64> = axes.iter().map(|axis| header.count(*axis)).collect();
    let words: Vec<String> = sizes.iter().map(u64::to_string).collect();
    let version = if header.metadata.field("measurement frame").is_some() { 5 } else { 4 };
    let mut text = format!("NRRD000{version}\ntype: {}\n", type_name(header.element));
    text += &format!("dimension: {}\nsizes: {}\n", axes.len(), words.join(" "));
    if header.element.bytes() > 1 {
        text += &format!("endian: {order}\n");
    }
    text += match encoding {
        Encoding::Raw => "encoding: raw\n",
        _ => "encoding: gzip\n",
    };
    let mut losses = Vec::new();
    for line in &lines_with_kinds(header, axes, &sizes) {
        let made_anew = matches!(line, HeaderLine::Field { name, .. } if is_structure(name));
        match line_text(line) {
            Some(line) if !made_anew => text += &(line + "\n"),
            _ => losses.push(name_of(line)),
        }
    }
    (text, losses)
}

/// The lines of a header, with `kinds` where without them a reader would take the axes for others.
fn lines_with_kinds(header: &Header, axes: &[Axis], sizes: &[u64]) -> Vec<HeaderLine> {
    let mut metadata =
        Metadata { lines: header.metadata.lines_for(axes), ..Metadata::plain(3, FileFormat::Nrrd) };
    let found = axes_of(sizes, metadata.field("kinds"), metadata.field("space directions"));
    let needs_kinds = header.metadata.source.format != FileFormat::Nrrd
        && metadata.field("kinds").is_none()
        && !axes.iter().all(|axis| axis.is_space());
    if needs_kinds || found.as_deref() != Some(axes) {
        metadata.set_field("kinds", &kinds_of(axes));
    }
    metadata.lines
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
    let named = named.ok().and_then(|found| match found.data_file? {
        DataFile::Name(name) => fs::canonicalize(beside(header, &name)).ok(),
        DataFile::List | DataFile::Pattern { .. } => None,
    });
    named.is_some() && named == fs::canonicalize(data).ok()
}

#[cfg(test)]
mod tests;
