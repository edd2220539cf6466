//! Netpbm's pictures: PGM (`.pgm`), PPM (`.ppm`), and the floats of PFM (`.pfm`). A file is one slice.
//!
//! Sources: the manual pages `pgm(5)`, `ppm(5)` and `pfm(5)` of the Netpbm project. Samples of more than 8 bits are
//! big-endian. PFM lists its rows from the bottom up; here they are from the top down, as in the others.

mod header;

use std::borrow::Cow;
use std::io::{BufRead, Read, Write};
use std::path::{Path, PathBuf};

use header::{Kind, Layout};

use super::element::{reorder, write_samples};
use super::format::{Format, has_extension};
use super::input::Input;
use super::planes::{PlaneSink, PlaneSource, PlaneWriter, Planes};
use super::{
    ByteOrder, Created, ElementType, FileFormat, Found, Header, HeaderLine, Metadata, ReadError, Source,
    WriteError, WriteOptions, losses,
};
use crate::atomic::AtomicFile;

/// Key of the largest value that samples may have, where it is not that of their type.
const MAXVAL: &str = "pnm.maxval";

/// Key of the factor that PFM has for its samples, where it is not 1.
const SCALE: &str = "pnm.scale";

/// What keeps a file from being read as a picture of Netpbm. Texts from the file are quoted and shortened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PnmError {
    /// The first bytes are others.
    #[error("it begins with {found}, not with P2, P3, P5, P6, Pf or PF")]
    Magic {
        /// The first two bytes.
        found: String,
    },
    /// Bits, or arbitrary channels.
    #[error("{found} files hold {what}, which are not read: convert with `pnmtopng` or to P5 and P6")]
    Unread {
        /// `P1`, `P4` or `P7`.
        found: String,
        /// What such files hold.
        what: &'static str,
    },
    /// The header ends early, or has something else where a number belongs.
    #[error("{text} stands where the {what} belongs")]
    Number {
        /// What stands there.
        text: String,
        /// What belongs there.
        what: &'static str,
    },
    /// A value that is not possible.
    #[error("the {what} is {value}, which is not possible")]
    Value {
        /// What it is.
        what: &'static str,
        /// Its value.
        value: String,
    },
    /// More bytes before the samples than any picture has.
    #[error("the header is longer than {bytes} bytes")]
    HeaderTooLong {
        /// Bytes that are read at most.
        bytes: u64,
    },
}

/// Netpbm's formats.
pub(super) struct Pnm;

impl Format for Pnm {
    fn format(&self) -> FileFormat {
        FileFormat::Pgm
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(path, &["pgm", "ppm", "pnm", "pfm"])
    }

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        open(input)
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        create(path, header, options)
    }
}

fn open(mut input: Input) -> Result<Box<dyn Source>, ReadError> {
    let path = input.path().to_owned();
    let layout = Layout::read(&mut input)?;
    let header = Header {
        components: layout.kind.components(),
        ..Header::scalar(layout.extent, layout.element, metadata(&layout))
    };
    let too_large = || ReadError::TooLarge { path: path.clone(), bytes: u64::MAX };
    let bytes = header.bytes().ok_or_else(too_large)?;
    // A number and a blank for each value, where they are numbers in decimal.
    let (needed, is_exact) = match layout.kind.is_plain() {
        true => ((bytes / header.element.bytes() as u64).checked_mul(2).ok_or_else(too_large)? - 1, false),
        false => (bytes, true),
    };
    if let Some(left) = input.left()
        && (left < needed || is_exact && left > needed)
    {
        let found = if is_exact { Found::Exactly(left) } else { Found::AtMost(left) };
        return Err(ReadError::SampleBytes { path, expected: needed, found });
    }
    let start = input.position();
    Ok(Box::new(PlaneSource::new(&path, header, Picture { input, layout, start })?))
}

/// What a header says beside extent and type.
fn metadata(layout: &Layout) -> Metadata {
    let mut metadata = Metadata::plain(2, FileFormat::Pgm);
    metadata.source.byte_order = layout.byte_order;
    metadata.lines.extend(layout.comments.iter().cloned().map(HeaderLine::Comment));
    let pair = |key: &str, value: String| HeaderLine::KeyValue { key: key.to_owned(), value };
    if let Some(maxval) = layout.maxval.filter(|maxval| *maxval != largest(layout.element)) {
        metadata.lines.push(pair(MAXVAL, maxval.to_string()));
    }
    if let Some(scale) = layout.scale.filter(|scale| *scale != 1.0) {
        metadata.lines.push(pair(SCALE, scale.to_string()));
    }
    metadata
}

const fn largest(element: ElementType) -> u32 {
    match element {
        ElementType::U8 => 255,
        _ => 65_535,
    }
}

/// The picture in a file.
struct Picture {
    input: Input,
    layout: Layout,
    /// Byte of the file where the samples begin.
    start: u64,
}

impl Planes for Picture {
    fn read(&mut self, _: u64, out: &mut [u8]) -> Result<(), ReadError> {
        self.input.seek(self.start)?;
        if self.layout.kind.is_plain() {
            return self.read_plain(out);
        }
        let path = self.input.path().to_owned();
        let expected = out.len() as u64;
        let wrong = |found| ReadError::SampleBytes { path: path.clone(), expected, found };
        let mut filled = 0;
        while filled < out.len() {
            let count = self.input.read(&mut out[filled..]).map_err(|cause| self.input.io(cause))?;
            if count == 0 {
                return Err(wrong(Found::Exactly(filled as u64)));
            }
            filled += count;
        }
        if !self.input.fill_buf().map_err(|cause| ReadError::Io { path: path.clone(), cause })?.is_empty() {
            return Err(wrong(Found::MoreThan(expected)));
        }
        reorder(out, self.layout.element, self.layout.byte_order);
        if self.layout.kind.is_float() {
            let rows = self.layout.extent[1] as usize;
            turn_over(out, rows);
        }
        Ok(())
    }
}

impl Picture {
    /// Reads numbers in decimal.
    fn read_plain(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        let bytes = self.layout.element.bytes();
        for value in out.chunks_mut(bytes) {
            let number = header::number(&mut self.input, u64::MAX, "value of a sample", &mut Vec::new())?;
            if number > u64::from(largest(self.layout.element)) {
                let cause = PnmError::Value { what: "value of a sample", value: number.to_string() };
                return Err(header::fault(&self.input, cause));
            }
            value.copy_from_slice(&number.to_le_bytes()[..bytes]);
        }
        Ok(())
    }
}

/// Puts the last row first.
fn turn_over(plane: &mut [u8], rows: usize) {
    let row = plane.len() / rows.max(1);
    let (top, bottom) = plane.split_at_mut(rows / 2 * row);
    top.chunks_mut(row).zip(bottom.rchunks_mut(row)).for_each(|(upper, lower)| upper.swap_with_slice(lower));
}

fn create(path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
    let kind = kind_for(path, header).map_err(|what| WriteError::CannotHold {
        path: path.to_owned(),
        format: FileFormat::Pgm,
        what,
    })?;
    let metadata = &header.metadata;
    let maxval = metadata.key_value(MAXVAL).and_then(|text| text.parse().ok());
    let scale = metadata.key_value(SCALE).and_then(|text| text.parse().ok());
    let largest = largest(header.element);
    let maxval = maxval.filter(|maxval| (1..=largest).contains(maxval) && (largest == 255 || *maxval > 255));
    let byte_order = match kind.is_float() {
        true => options.byte_order.unwrap_or(metadata.source.byte_order),
        false => ByteOrder::Big,
    };
    let layout = Layout {
        kind,
        extent: header.extent,
        element: header.element,
        maxval: Some(maxval.unwrap_or(largest)),
        scale: Some(scale.filter(|scale: &f32| scale.is_normal() && *scale > 0.0).unwrap_or(1.0)),
        byte_order,
        comments: if kind.is_float() { Vec::new() } else { comments(metadata) },
    };
    let mut left = metadata.clone();
    left.lines.retain(|line| match line {
        HeaderLine::Comment(text) => !layout.comments.contains(text),
        HeaderLine::KeyValue { key, .. } => key != MAXVAL && key != SCALE,
        HeaderLine::Field { .. } => true,
    });
    let file = AtomicFile::create(path).map_err(|cause| WriteError::Io { path: path.to_owned(), cause })?;
    let writer = Box::new(Writer { file, path: path.to_owned(), layout });
    Ok(Created { sink: Box::new(PlaneSink::new(path, header, writer)), losses: losses(&left) })
}

/// Comments that a header can hold.
fn comments(metadata: &Metadata) -> Vec<String> {
    let lines = metadata.lines.iter().filter_map(|line| match line {
        HeaderLine::Comment(text) if !text.contains(['\n', '\r']) => Some(text.clone()),
        _ => None,
    });
    lines.collect()
}

/// The kind of file that holds such samples under such a name, or what none can hold.
fn kind_for(path: &Path, header: &Header) -> Result<Kind, String> {
    let kind = match (header.element, header.components) {
        (ElementType::U8 | ElementType::U16, 1) => Kind::Gray,
        (ElementType::U8 | ElementType::U16, 3) => Kind::Color,
        (ElementType::F32, 1) => Kind::FloatGray,
        (ElementType::F32, 3) => Kind::FloatColor,
        (element, 1 | 3) => {
            return Err(format!("{element}, only u8, u16 and (.pfm) f32: write .tif or .nrrd"));
        }
        (_, components) => return Err(format!("{components} components, only 1 and 3: write .tif or .nrrd")),
    };
    if header.extent[2] > 1 || header.steps > 1 {
        return Err("more than one slice: write a file for each, as in \"slice_%04d.pgm\"".to_owned());
    }
    let fits = match kind {
        Kind::Gray => has_extension(path, &["pgm", "pnm"]),
        Kind::Color => has_extension(path, &["ppm", "pnm"]),
        _ => has_extension(path, &["pfm"]),
    };
    match fits {
        true => Ok(kind),
        false => Err(format!(
            "{} of {} components under this name: write {}",
            header.element,
            header.components,
            match kind {
                Kind::Gray => ".pgm",
                Kind::Color => ".ppm",
                _ => ".pfm",
            }
        )),
    }
}

/// A file that is being written.
struct Writer {
    file: AtomicFile,
    path: PathBuf,
    layout: Layout,
}

impl PlaneWriter for Writer {
    fn write(&mut self, plane: &[u8]) -> Result<(), WriteError> {
        let Layout { kind, element, byte_order, maxval, extent, .. } = &self.layout;
        // Samples may have grown since, in a decoder that is allowed an error.
        let is_beyond = |value: &[u8]| {
            let value = value.iter().rev().fold(0, |all, byte| all << 8 | u32::from(*byte));
            maxval.is_some_and(|maxval| value > maxval)
        };
        let mut head = self.layout.clone();
        if !kind.is_float()
            && *maxval != Some(largest(*element))
            && plane.chunks(element.bytes()).any(is_beyond)
        {
            head.maxval = Some(largest(*element));
        }
        let mut plane = Cow::Borrowed(plane);
        if kind.is_float() {
            turn_over(plane.to_mut(), extent[1] as usize);
        }
        let written = self.file.write_all(&head.bytes());
        let written = written.and_then(|()| write_samples(&mut self.file, &plane, *element, *byte_order));
        written.map_err(|cause| WriteError::Io { path: self.path.clone(), cause })
    }

    fn finish(self: Box<Self>) -> Result<(), WriteError> {
        let Self { file, path, .. } = *self;
        file.commit().map_err(|cause| WriteError::Io { path, cause })
    }
}

#[cfg(test)]
mod tests;
