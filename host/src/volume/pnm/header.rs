//! The lines before the samples: two letters, then numbers between blanks.

use std::io::BufRead;

use super::PnmError;
use crate::volume::error::excerpt;
use crate::volume::input::Input;
use crate::volume::{ByteOrder, ElementType, FileFormat, ReadError};

/// Bytes of a header that are read at most, comments among them.
const HEADER_BYTES: u64 = 1 << 16;

/// What samples are, and how they are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// `P2`: one value each, in decimal.
    PlainGray,
    /// `P3`: red, green, blue, in decimal.
    PlainColor,
    /// `P5`.
    Gray,
    /// `P6`.
    Color,
    /// `Pf`.
    FloatGray,
    /// `PF`.
    FloatColor,
}

impl Kind {
    const ALL: [(&'static str, Self); 6] = [
        ("P2", Self::PlainGray),
        ("P3", Self::PlainColor),
        ("P5", Self::Gray),
        ("P6", Self::Color),
        ("Pf", Self::FloatGray),
        ("PF", Self::FloatColor),
    ];

    pub(super) const fn is_plain(self) -> bool {
        matches!(self, Self::PlainGray | Self::PlainColor)
    }

    pub(super) const fn is_float(self) -> bool {
        matches!(self, Self::FloatGray | Self::FloatColor)
    }

    /// Values of a sample.
    pub(super) const fn components(self) -> u32 {
        match self {
            Self::PlainGray | Self::Gray | Self::FloatGray => 1,
            Self::PlainColor | Self::Color | Self::FloatColor => 3,
        }
    }
}

/// A header.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) kind: Kind,
    pub(super) extent: [u64; 3],
    pub(super) element: ElementType,
    /// Largest value that a sample may have; integers only.
    pub(super) maxval: Option<u32>,
    /// Factor for samples; floats only.
    pub(super) scale: Option<f32>,
    pub(super) byte_order: ByteOrder,
    /// Texts of comments, with the blank before them.
    pub(super) comments: Vec<String>,
}

impl Layout {
    /// Reads a header up to the samples.
    pub(super) fn read(input: &mut Input) -> Result<Self, ReadError> {
        let kind = kind(input)?;
        let mut comments = Vec::new();
        if kind.is_float() {
            return Self::read_float(input, kind);
        }
        let [width, height, maxval] = ["width", "height", "largest value"].map(|what| {
            match number(input, HEADER_BYTES, what, &mut comments)? {
                0 => Err(fault(input, PnmError::Value { what, value: "0".to_owned() })),
                value => Ok(value),
            }
        });
        let (extent, maxval) = ([width?, height?, 1], maxval?);
        let element = match maxval {
            1..=255 => ElementType::U8,
            256..=65_535 => ElementType::U16,
            _ => {
                let cause = PnmError::Value { what: "largest value", value: maxval.to_string() };
                return Err(fault(input, cause));
            }
        };
        let byte_order = if element == ElementType::U8 { ByteOrder::Little } else { ByteOrder::Big };
        Ok(Self { kind, extent, element, maxval: Some(maxval as u32), scale: None, byte_order, comments })
    }

    fn read_float(input: &mut Input, kind: Kind) -> Result<Self, ReadError> {
        let [width, height] =
            ["width", "height"].map(|what| match number(input, HEADER_BYTES, what, &mut Vec::new())? {
                0 => Err(fault(input, PnmError::Value { what, value: "0".to_owned() })),
                value => Ok(value),
            });
        let extent = [width?, height?, 1];
        let text = word(input, HEADER_BYTES, &mut Vec::new())?;
        let scale = text
            .parse()
            .ok()
            .filter(|scale: &f32| scale.is_normal())
            .ok_or_else(|| fault(input, PnmError::Number { text: excerpt(&text), what: "scale" }))?;
        let byte_order = if scale < 0.0 { ByteOrder::Little } else { ByteOrder::Big };
        let scale = Some(scale.abs());
        let element = ElementType::F32;
        Ok(Self { kind, extent, element, maxval: None, scale, byte_order, comments: Vec::new() })
    }

    /// The header as a file has it.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let magic = Kind::ALL.iter().find(|(_, kind)| *kind == self.kind).map_or("P5", |(magic, _)| magic);
        let [width, height, _] = self.extent;
        let mut text = format!("{magic}\n");
        if self.kind.is_float() {
            let scale = self.scale.unwrap_or(1.0);
            let signed = if self.byte_order == ByteOrder::Little { -scale } else { scale };
            text += &format!("{width} {height}\n{signed:?}\n");
        } else {
            self.comments.iter().for_each(|comment| text += &format!("#{comment}\n"));
            text += &format!("{width} {height}\n{}\n", self.maxval.unwrap_or(255));
        }
        text.into_bytes()
    }
}

fn kind(input: &mut Input) -> Result<Kind, ReadError> {
    let found =
        input.fill_buf().map(|bytes| String::from_utf8_lossy(&bytes[..bytes.len().min(2)]).into_owned());
    let found = found.map_err(|cause| input.io(cause))?;
    if let Some((_, kind)) = Kind::ALL.into_iter().find(|(magic, _)| *magic == found) {
        input.consume(2);
        return Ok(kind);
    }
    let what = match found.as_str() {
        "P1" | "P4" => "single bits",
        "P7" => "arbitrary channels",
        _ => return Err(fault(input, PnmError::Magic { found: excerpt(&found) })),
    };
    Err(fault(input, PnmError::Unread { found, what }))
}

/// The number that comes next, and the one byte behind it.
pub(super) fn number(
    input: &mut Input,
    most: u64,
    what: &'static str,
    comments: &mut Vec<String>,
) -> Result<u64, ReadError> {
    let text = word(input, most, comments)?;
    let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let number = text.parse().ok().filter(|_| is_number);
    number.ok_or_else(|| fault(input, PnmError::Number { text: excerpt(&text), what }))
}

/// The word that comes next, without what stands before it, and with the one blank behind it taken.
///
/// A comment goes from `#` to the end of its line; `most` bytes of the file are passed at most.
fn word(input: &mut Input, most: u64, comments: &mut Vec<String>) -> Result<String, ReadError> {
    let mut word = Vec::new();
    while let Some(byte) = next(input)? {
        if input.position() > most {
            return Err(fault(input, PnmError::HeaderTooLong { bytes: most }));
        }
        match byte {
            b'#' if word.is_empty() => comments.push(line(input, most)?),
            byte if byte.is_ascii_whitespace() => {
                if !word.is_empty() {
                    break;
                }
            }
            // No number is that long, and its first letters are enough for a message.
            _ if word.len() < 64 => word.push(byte),
            _ => break,
        }
    }
    Ok(String::from_utf8_lossy(&word).into_owned())
}

/// What is left of a line.
fn line(input: &mut Input, most: u64) -> Result<String, ReadError> {
    let mut line = Vec::new();
    while let Some(byte) = next(input)?.filter(|byte| *byte != b'\n') {
        if input.position() > most || line.len() as u64 > HEADER_BYTES {
            return Err(fault(input, PnmError::HeaderTooLong { bytes: HEADER_BYTES }));
        }
        line.push(byte);
    }
    let text = String::from_utf8(line);
    let text = text.unwrap_or_else(|error| error.as_bytes().iter().map(|&byte| char::from(byte)).collect());
    Ok(text.trim_end_matches('\r').to_owned())
}

fn next(input: &mut Input) -> Result<Option<u8>, ReadError> {
    let byte = input.fill_buf().map(|bytes| bytes.first().copied());
    let byte = byte.map_err(|cause| input.io(cause))?;
    input.consume(byte.map_or(0, |_| 1));
    Ok(byte)
}

pub(super) fn fault(input: &Input, cause: PnmError) -> ReadError {
    ReadError::Format { path: input.path().to_owned(), format: FileFormat::Pgm, cause: Box::new(cause) }
}
