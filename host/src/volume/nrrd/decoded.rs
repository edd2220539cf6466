//! Samples as text, as hexadecimal digits, or compressed with bzip2: they go to a temporary file, and are read from there.
//!
//! Source: *Definition of the NRRD file format*, the Teem project, field `encoding`.

use std::io::{self, BufRead, BufWriter, Read, Seek, Write};

use super::NrrdError;
use crate::volume::element::value_of_text;
use crate::volume::error::excerpt;
use crate::volume::input::Input;
use crate::volume::stored::{Encoding, Place, Stored};
use crate::volume::{ByteOrder, ElementType, Found, Header, ReadError};

/// How samples are stored, other than as they are or with gzip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// Numbers between blanks.
    Text,
    /// Two digits a byte.
    Hex,
    /// One bzip2 stream, or several.
    Bzip2,
}

/// Longest number in text; the longest of all types is one of f64 with some three hundred digits.
const LONGEST_NUMBER: usize = 512;

/// Why samples could not be decoded.
enum Fault {
    /// The file says what cannot be.
    Data(String),
    /// It cannot be read.
    Read(io::Error),
    /// The temporary file cannot be written.
    Write(io::Error),
}

impl Method {
    /// The name in messages.
    const fn name(self) -> &'static str {
        match self {
            Self::Text => "ascii",
            Self::Hex => "hex",
            Self::Bzip2 => "bzip2",
        }
    }

    /// Decodes the samples that begin where `input` stands, behind so many bytes of them.
    pub(super) fn open(
        self,
        input: Input,
        header: Header,
        (byte_order, skip): (ByteOrder, u64),
    ) -> Result<Stored, ReadError> {
        let path = input.path().to_owned();
        let expected = header.bytes().unwrap_or(u64::MAX);
        let bytes = expected.saturating_add(skip);
        let mut file = tempfile::tempfile().map_err(|cause| ReadError::Io { path: path.clone(), cause })?;
        let out = BufWriter::new(&mut file);
        let decoded = match self {
            Self::Text => text(input, header.element, bytes, out),
            Self::Hex => hex(input, bytes, out),
            Self::Bzip2 => bzip2(input, bytes, out),
        };
        let found = decoded.map_err(|fault| match fault {
            Fault::Data(cause) => {
                let cause = NrrdError::Samples { encoding: self.name(), cause };
                ReadError::Nrrd { path: path.clone(), cause }
            }
            Fault::Read(cause) | Fault::Write(cause) => ReadError::Io { path: path.clone(), cause },
        })?;
        if found != bytes {
            let found = if found > bytes {
                Found::MoreThan(expected)
            } else {
                Found::Exactly(found.saturating_sub(skip))
            };
            return Err(ReadError::SampleBytes { path, expected, found });
        }
        file.rewind().map_err(|cause| ReadError::Io { path: path.clone(), cause })?;
        let byte_order = if self == Self::Text { ByteOrder::Little } else { byte_order };
        let place = Place { encoding: Encoding::Raw, byte_order, skip, is_open_ended: false };
        Stored::new(Input::of_file(file, &path)?, header, place)
    }
}

/// Numbers as little-endian values; returns how many bytes they take, one beyond `most` if there are more.
fn text(mut input: Input, element: ElementType, most: u64, mut out: impl Write) -> Result<u64, Fault> {
    let (mut number, mut bytes) = (Vec::new(), 0);
    loop {
        let piece = input.fill_buf().map_err(Fault::Read)?;
        let len = piece.len();
        let is_end = len == 0;
        for &byte in piece.iter().chain(is_end.then_some(&b' ')) {
            if !byte.is_ascii_whitespace() && byte != b',' {
                number.push(byte);
                if number.len() > LONGEST_NUMBER {
                    return Err(Fault::Data("a number has more than 512 digits".to_owned()));
                }
            } else if !number.is_empty() {
                let word = String::from_utf8_lossy(&number);
                let value = value_of_text(element, &word);
                let value =
                    value.ok_or_else(|| Fault::Data(format!("{} is no {element}", excerpt(&word))))?;
                if bytes + element.bytes() as u64 > most {
                    return Ok(most.saturating_add(1));
                }
                out.write_all(&value[..element.bytes()]).map_err(Fault::Write)?;
                bytes += element.bytes() as u64;
                number.clear();
            }
        }
        if is_end {
            break;
        }
        input.consume(len);
    }
    out.flush().map_err(Fault::Write)?;
    Ok(bytes)
}

/// Digits as bytes; returns how many these are, one beyond `most` if there are more.
fn hex(mut input: Input, most: u64, mut out: impl Write) -> Result<u64, Fault> {
    let (mut high, mut bytes) = (None, 0);
    loop {
        let piece = input.fill_buf().map_err(Fault::Read)?;
        let len = piece.len();
        if len == 0 {
            break;
        }
        for &byte in piece.iter().filter(|byte| !byte.is_ascii_whitespace()) {
            let digit = char::from(byte).to_digit(16);
            let digit =
                digit.ok_or_else(|| Fault::Data(format!("{:?} is no digit", char::from(byte))))? as u8;
            match high.take() {
                None => high = Some(digit),
                Some(_) if bytes == most => return Ok(most.saturating_add(1)),
                Some(high) => {
                    out.write_all(&[high << 4 | digit]).map_err(Fault::Write)?;
                    bytes += 1;
                }
            }
        }
        input.consume(len);
    }
    out.flush().map_err(Fault::Write)?;
    match high {
        None => Ok(bytes),
        Some(_) => Err(Fault::Data("the last byte has one digit only".to_owned())),
    }
}

/// What bzip2 made smaller; returns how many bytes these are, one beyond `most` if there are more.
fn bzip2(input: Input, most: u64, mut out: impl Write) -> Result<u64, Fault> {
    let mut decoder = bzip2::bufread::MultiBzDecoder::new(input).take(most.saturating_add(1));
    let (mut piece, mut bytes) = (vec![0; 1 << 16], 0);
    loop {
        let count = match decoder.read(&mut piece) {
            Ok(0) => break,
            Ok(count) => count,
            Err(cause) if cause.kind() == io::ErrorKind::Interrupted => continue,
            Err(cause) if cause.raw_os_error().is_some() => return Err(Fault::Read(cause)),
            Err(cause) => return Err(Fault::Data(cause.to_string())),
        };
        out.write_all(&piece[..count]).map_err(Fault::Write)?;
        bytes += count as u64;
    }
    out.flush().map_err(Fault::Write)?;
    Ok(bytes)
}
