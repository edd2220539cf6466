//! Samples that lie in a file one after another, as they are or compressed.

use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use flate2::bufread::{MultiGzDecoder, ZlibDecoder};
use flate2::write::{GzEncoder, ZlibEncoder};

use super::element::{reorder, write_samples};
use super::input::Input;
use super::{ByteOrder, Found, Header, ReadError, Sink, Source, WriteError};
use crate::atomic::AtomicFile;

/// First bytes of a gzip member (RFC 1952).
pub(super) const GZIP: &[u8] = &[0x1f, 0x8b];

/// Most bytes that one byte of deflate data can stand for: two bits at least give 258 bytes at most (RFC 1951).
pub(super) const DEFLATE_EXPANSION: u64 = 4 * 258;

/// How samples are turned into the bytes of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// As they are.
    Raw,
    /// Gzip members (RFC 1952).
    Gzip,
    /// One zlib stream (RFC 1950).
    Zlib,
}

enum Reader {
    Raw(Input),
    Gzip(MultiGzDecoder<Input>),
    Zlib(ZlibDecoder<Input>),
}

impl Reader {
    fn new(input: Input, encoding: Encoding) -> Self {
        match encoding {
            Encoding::Raw => Self::Raw(input),
            Encoding::Gzip => Self::Gzip(MultiGzDecoder::new(input)),
            Encoding::Zlib => Self::Zlib(ZlibDecoder::new(input)),
        }
    }

    fn into_input(self) -> Input {
        match self {
            Self::Raw(input) => input,
            Self::Gzip(decoder) => decoder.into_inner(),
            Self::Zlib(decoder) => decoder.into_inner(),
        }
    }
}

impl Read for Reader {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Raw(input) => input.read(out),
            Self::Gzip(decoder) => decoder.read(out),
            Self::Zlib(decoder) => decoder.read(out),
        }
    }
}

/// Where samples lie in a file, and how.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) encoding: Encoding,
    pub(super) byte_order: ByteOrder,
    /// Bytes to pass over before the first sample, counted after decompression.
    pub(super) skip: u64,
    /// Whether bytes may follow the samples.
    pub(super) is_open_ended: bool,
}

/// A source of samples that lie in one file in the order of [`Header`].
pub(super) struct Stored {
    header: Header,
    /// Taken out only while it is made anew.
    reader: Option<Reader>,
    path: PathBuf,
    place: Place,
    /// Byte of the file where the samples, or what they are compressed to, begin.
    start: u64,
    /// Bytes of samples, and of those, the ones that were read.
    bytes: u64,
    at: u64,
}

impl Stored {
    /// Samples from where `input` stands on.
    ///
    /// # Errors
    /// [`ReadError::SampleBytes`] where the file's length shows that it has fewer or more.
    pub(super) fn new(input: Input, header: Header, place: Place) -> Result<Self, ReadError> {
        let path = input.path().to_owned();
        let too_large = || ReadError::TooLarge { path: path.clone(), bytes: u64::MAX };
        let bytes = header.bytes().ok_or_else(too_large)?;
        let needed = bytes.checked_add(place.skip).ok_or_else(too_large)?;
        let found = match (input.left(), place.encoding) {
            (Some(left), Encoding::Raw) if left < needed || left > needed && !place.is_open_ended => {
                Some(Found::Exactly(left.saturating_sub(place.skip)))
            }
            (Some(left), Encoding::Gzip | Encoding::Zlib) => {
                Some(left.saturating_mul(DEFLATE_EXPANSION)).filter(|most| needed > *most).map(Found::AtMost)
            }
            _ => None,
        };
        if let Some(found) = found {
            return Err(ReadError::SampleBytes { path, expected: bytes, found });
        }
        let start = input.position();
        let reader = Some(Reader::new(input, place.encoding));
        let mut stored = Self { header, reader, path, place, start, bytes, at: 0 };
        stored.begin()?;
        Ok(stored)
    }

    fn reader(&mut self) -> &mut Reader {
        self.reader.as_mut().expect("a reader is missing only within `seek`")
    }

    fn begin(&mut self) -> Result<(), ReadError> {
        self.at = 0;
        let skip = self.place.skip;
        self.skip(skip)
    }

    fn skip(&mut self, count: u64) -> Result<(), ReadError> {
        let skipped = io::copy(&mut self.reader().take(count), &mut io::sink());
        skipped.map_err(|cause| self.fault(cause))?;
        Ok(())
    }

    fn fault(&self, cause: io::Error) -> ReadError {
        let path = self.path.clone();
        match (self.place.encoding, cause.raw_os_error()) {
            (Encoding::Raw, _) | (_, Some(_)) => ReadError::Io { path, cause },
            _ => ReadError::Gzip { path, cause },
        }
    }

    fn wrong_count(&self, found: Found) -> ReadError {
        ReadError::SampleBytes { path: self.path.clone(), expected: self.bytes, found }
    }
}

impl Source for Stored {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        if out.len() as u64 > self.bytes.saturating_sub(self.at) {
            return Err(ReadError::BeyondEnd { path: self.path.clone() });
        }
        let mut filled = 0;
        while filled < out.len() {
            match self.reader().read(&mut out[filled..]) {
                Ok(0) => return Err(self.wrong_count(Found::Exactly(self.at + filled as u64))),
                Ok(count) => filled += count,
                Err(cause) if cause.kind() == io::ErrorKind::Interrupted => {}
                Err(cause) => return Err(self.fault(cause)),
            }
        }
        self.at += out.len() as u64;
        reorder(out, self.header.element, self.place.byte_order);
        if self.at == self.bytes && !self.place.is_open_ended {
            let more = self.reader().read(&mut [0]).map_err(|cause| self.fault(cause))?;
            if more > 0 {
                return Err(self.wrong_count(Found::MoreThan(self.bytes)));
            }
        }
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        let is_raw = self.place.encoding == Encoding::Raw;
        if is_raw || position < self.at || self.at == self.bytes {
            let mut input = self.reader.take().expect("a reader is missing only here").into_input();
            let to = if is_raw { self.place.skip.saturating_add(position) } else { 0 };
            let moved = input.seek(self.start.saturating_add(to));
            self.reader = Some(Reader::new(input, self.place.encoding));
            moved?;
            if is_raw {
                self.at = position;
                return Ok(());
            }
            self.begin()?;
        }
        self.skip(position - self.at)?;
        self.at = position;
        Ok(())
    }

    fn is_random(&self) -> bool {
        self.place.encoding == Encoding::Raw
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.path.clone()]
    }
}

enum Writer {
    Raw(AtomicFile),
    Gzip(GzEncoder<AtomicFile>),
    Zlib(ZlibEncoder<AtomicFile>),
}

impl Write for Writer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Raw(file) => file.write(bytes),
            Self::Gzip(encoder) => encoder.write(bytes),
            Self::Zlib(encoder) => encoder.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Raw(file) => file.flush(),
            Self::Gzip(encoder) => encoder.flush(),
            Self::Zlib(encoder) => encoder.flush(),
        }
    }
}

/// Ends a zlib stream, and writes its length where digits wait for it.
fn finish_zlib(mut encoder: ZlibEncoder<AtomicFile>, size_at: Option<u64>) -> io::Result<AtomicFile> {
    encoder.try_finish()?;
    let bytes = encoder.total_out();
    let mut file = encoder.finish()?;
    if let Some(position) = size_at {
        file.overwrite(position, format!("{bytes:020}").as_bytes())?;
    }
    Ok(file)
}

/// A sink of samples into one file in the order of [`Header`].
pub(super) struct StoredSink {
    writer: Writer,
    path: PathBuf,
    header: Header,
    byte_order: ByteOrder,
    written: u64,
    /// A file to appear after this one, such as a detached header.
    next: Option<(AtomicFile, PathBuf)>,
    /// Where twenty digits wait for the number of compressed bytes.
    size_at: Option<u64>,
}

impl StoredSink {
    /// Values of `header` go to `file`, which will be at `path`, behind what is in it.
    pub(super) fn new(
        file: AtomicFile,
        path: &Path,
        header: &Header,
        encoding: Encoding,
        byte_order: ByteOrder,
    ) -> Self {
        let level = flate2::Compression::default();
        let writer = match encoding {
            Encoding::Raw => Writer::Raw(file),
            Encoding::Gzip => Writer::Gzip(GzEncoder::new(file, level)),
            Encoding::Zlib => Writer::Zlib(ZlibEncoder::new(file, level)),
        };
        Self {
            writer,
            path: path.to_owned(),
            header: header.clone(),
            byte_order,
            written: 0,
            next: None,
            size_at: None,
        }
    }

    /// Puts bytes before the values, compressed with them; they are not counted as values.
    pub(super) fn write_head(&mut self, head: &[u8]) -> Result<(), WriteError> {
        self.writer.write_all(head).map_err(|cause| WriteError::Io { path: self.path.clone(), cause })
    }

    /// Writes the number of compressed bytes, in twenty digits, at that byte of the file when it is known.
    pub(super) fn with_size_at(self, position: u64) -> Self {
        Self { size_at: Some(position), ..self }
    }

    /// Lets `file` appear at `path` when the samples have, and takes the samples back if it cannot.
    pub(super) fn followed_by(self, file: AtomicFile, path: &Path) -> Self {
        Self { next: Some((file, path.to_owned())), ..self }
    }
}

impl Sink for StoredSink {
    fn write(&mut self, values: &[u8]) -> Result<(), WriteError> {
        self.written += values.len() as u64;
        write_samples(&mut self.writer, values, self.header.element, self.byte_order)
            .map_err(|cause| WriteError::Io { path: self.path.clone(), cause })
    }

    fn finish(self: Box<Self>) -> Result<(), WriteError> {
        let Self { writer, path, header, written, next, size_at, .. } = *self;
        let expected = header.bytes().unwrap_or(u64::MAX);
        if written != expected {
            return Err(WriteError::SampleBytes { path, expected, found: written });
        }
        let file = match writer {
            Writer::Raw(file) => Ok(file),
            Writer::Gzip(encoder) => encoder.finish(),
            Writer::Zlib(encoder) => finish_zlib(encoder, size_at),
        };
        let file = file.map_err(|cause| WriteError::Io { path: path.clone(), cause })?;
        let Some((header, next)) = next else {
            return file.commit().map_err(|cause| WriteError::Io { path, cause });
        };
        AtomicFile::commit_in_turn([file, header]).map_err(|(index, cause)| match index {
            0 => WriteError::Io { path, cause },
            _ => {
                let _samples_without_header = std::fs::remove_file(&path);
                WriteError::Io { path: next, cause }
            }
        })
    }
}
