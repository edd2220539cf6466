//! NRRD headers as text: lines, names of fields and types, and the fields that say where the samples are.

use std::io::{BufRead, Read};

use super::NrrdError;
use super::decoded::Method;
use crate::volume::error::excerpt;
use crate::volume::input::Input;
use crate::volume::metadata::is_same_name;
use crate::volume::stored::Encoding;
use crate::volume::{ByteOrder, ElementType, HeaderLine, ReadError};

/// Longest header that is read. Headers have some hundred bytes, with a table of key/value pairs some hundred KiB.
const HEADER_BYTES: u64 = 1 << 20;

/// Most axes of a file; the Teem library has the same limit.
const MAX_AXES: u32 = 16;

/// Fields that extent, type and encoding determine; they are made anew when a header is written.
const STRUCTURE: [&str; 10] = [
    "type",
    "dimension",
    "sizes",
    "endian",
    "encoding",
    "data file",
    "line skip",
    "byte skip",
    "number",
    "block size",
];

/// The other fields of the format.
const ANNOTATIONS: [&str; 21] = [
    "content",
    "space",
    "space dimension",
    "space units",
    "space origin",
    "space directions",
    "measurement frame",
    "spacings",
    "thicknesses",
    "axis mins",
    "axis maxs",
    "centers",
    "centerings",
    "labels",
    "units",
    "kinds",
    "min",
    "max",
    "old min",
    "old max",
    "sample units",
];

/// Bytes to pass over before the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteSkip {
    /// So many; in compressed data counted after decompression.
    Bytes(u64),
    /// As many as there are before the last sample's end meets the end of the file.
    ToEnd,
}

/// Where samples are if not behind the header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum DataFile {
    /// In this file.
    Name(String),
    /// In the files whose names follow the header, one a line.
    List,
    /// In files of these numbers.
    Pattern { pattern: String, first: i64, last: i64, step: i64 },
}

/// A header, understood.
#[derive(Debug, PartialEq)]
pub(super) struct Header {
    pub(super) sizes: Vec<u64>,
    pub(super) element: ElementType,
    pub(super) byte_order: ByteOrder,
    pub(super) encoding: Encoding,
    /// How the samples are to be decoded before they are read, if at all.
    pub(super) method: Option<Method>,
    pub(super) data_file: Option<DataFile>,
    pub(super) line_skip: u64,
    pub(super) byte_skip: ByteSkip,
    pub(super) lines: Vec<HeaderLine>,
}

impl Header {
    /// Reads up to and with the blank line, or to the end of the file if the header names a data file.
    pub(super) fn read(input: &mut Input) -> Result<Self, ReadError> {
        let (text, complete) = read_text(input)?;
        let parse = || {
            let header = Self::parse(&text)?;
            match (complete, &header.data_file) {
                (false, None) => Err(NrrdError::NoSamples),
                _ => Ok(header),
            }
        };
        parse().map_err(|cause| ReadError::Nrrd { path: input.path().to_owned(), cause })
    }

    /// Understands the lines of a header, the magic first, without the blank line.
    fn parse(text: &[String]) -> Result<Self, NrrdError> {
        let (magic, text) = text.split_first().ok_or(NrrdError::Magic { found: excerpt("") })?;
        if !matches!(magic.trim_end().strip_prefix("NRRD000"), Some("1" | "2" | "3" | "4" | "5")) {
            return Err(NrrdError::Magic { found: excerpt(magic) });
        }
        let numbered = text.iter().zip(2..).map(|(line, number)| {
            parse_line(line).ok_or_else(|| NrrdError::Line { number, text: excerpt(line) })
        });
        let mut fields = Fields { lines: numbered.collect::<Result<_, _>>()? };

        let sizes = fields.sizes()?;
        let element = fields.element()?;
        let (encoding, method) = fields.encoding()?;
        let byte_order = fields.byte_order(element, method)?;
        let data_file = fields.data_file()?;
        let line_skip = match fields.take("line skip")? {
            None => 0,
            Some(value) => value.parse().map_err(|_| bad("line skip", &value, "a number from 0 up"))?,
        };
        let byte_skip = match fields.take("byte skip")? {
            None => ByteSkip::Bytes(0),
            Some(value) if value == "-1" => ByteSkip::ToEnd,
            Some(value) => ByteSkip::Bytes(
                value.parse().map_err(|_| bad("byte skip", &value, "-1 or a number from 0 up"))?,
            ),
        };
        fields.take("number")?;
        fields.take("block size")?;
        let lines = fields.lines;
        Ok(Self { sizes, element, byte_order, encoding, method, data_file, line_skip, byte_skip, lines })
    }
}

/// Reads lines up to the blank one, or to that behind which a list of files begins; whether there was a blank one. Text that is not UTF-8 is taken as Latin-1.
fn read_text(input: &mut Input) -> Result<(Vec<String>, bool), ReadError> {
    let mut text = Vec::new();
    let mut left = HEADER_BYTES;
    loop {
        let mut line = Vec::new();
        let count =
            input.by_ref().take(left).read_until(b'\n', &mut line).map_err(|cause| input.io(cause))?;
        left -= count as u64;
        if count > 0 && left == 0 {
            let cause = NrrdError::HeaderTooLong { limit: HEADER_BYTES };
            return Err(ReadError::Nrrd { path: input.path().to_owned(), cause });
        }
        let line = line.strip_suffix(b"\n").unwrap_or(&line);
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        if line.is_empty() {
            return Ok((text, count > 0));
        }
        let line = match str::from_utf8(line) {
            Ok(line) => line.to_owned(),
            Err(_) => line.iter().copied().map(char::from).collect(),
        };
        let begins_list = line.split_once(": ").is_some_and(|(name, value)| {
            is_same_name(name, "data file") && value.split_whitespace().next() == Some("LIST")
        });
        text.push(line);
        if begins_list {
            return Ok((text, false));
        }
    }
}

/// Lines from which the fields that are understood are taken out.
struct Fields {
    lines: Vec<HeaderLine>,
}

impl Fields {
    /// Takes the value of a field out, if it is there.
    fn take(&mut self, field: &'static str) -> Result<Option<String>, NrrdError> {
        let is_wanted = |line: &mut HeaderLine| matches!(line, HeaderLine::Field { name, .. } if is_same_name(name, field));
        let mut values = self.lines.extract_if(.., is_wanted).filter_map(|line| match line {
            HeaderLine::Field { value, .. } => Some(value),
            HeaderLine::Comment(_) | HeaderLine::KeyValue { .. } => None,
        });
        let value = values.next();
        if values.next().is_some() {
            return Err(NrrdError::Repeated { field });
        }
        Ok(value)
    }

    fn required(&mut self, field: &'static str) -> Result<String, NrrdError> {
        self.take(field)?.ok_or(NrrdError::Missing { field })
    }

    fn sizes(&mut self) -> Result<Vec<u64>, NrrdError> {
        let dimension = self.required("dimension")?;
        let rank: u32 = dimension.parse().map_err(|_| bad("dimension", &dimension, "a number from 1 up"))?;
        if !(1..=MAX_AXES).contains(&rank) {
            return Err(NrrdError::Dimension { found: rank });
        }
        let sizes = self.required("sizes")?;
        let axes = sizes.split_whitespace().map(str::parse).collect::<Result<Vec<u64>, _>>();
        let axes = axes.map_err(|_| bad("sizes", &sizes, "a list of whole numbers"))?;
        if axes.len() as u64 != u64::from(rank) {
            return Err(bad("sizes", &sizes, "as many numbers as `dimension` says"));
        }
        Ok(axes)
    }

    fn element(&mut self) -> Result<ElementType, NrrdError> {
        let value = self.required("type")?;
        let words: Vec<String> = value.split_whitespace().map(str::to_ascii_lowercase).collect();
        match words.join(" ").as_str() {
            "block" => Err(NrrdError::BlockType),
            name => element_named(name).ok_or_else(|| bad("type", &value, "a type of the NRRD format")),
        }
    }

    fn encoding(&mut self) -> Result<(Encoding, Option<Method>), NrrdError> {
        let value = self.required("encoding")?;
        match value.to_ascii_lowercase().as_str() {
            "raw" => Ok((Encoding::Raw, None)),
            "gz" | "gzip" => Ok((Encoding::Gzip, None)),
            "bz2" | "bzip2" => Ok((Encoding::Raw, Some(Method::Bzip2))),
            "hex" => Ok((Encoding::Raw, Some(Method::Hex))),
            "txt" | "text" | "ascii" => Ok((Encoding::Raw, Some(Method::Text))),
            _ => Err(NrrdError::Encoding { found: excerpt(&value) }),
        }
    }

    fn byte_order(&mut self, element: ElementType, method: Option<Method>) -> Result<ByteOrder, NrrdError> {
        match self.take("endian")? {
            _ if element.bytes() == 1 || method == Some(Method::Text) => Ok(ByteOrder::Little),
            None => Err(NrrdError::Missing { field: "endian" }),
            Some(value) => {
                value.to_ascii_lowercase().parse().map_err(|_| bad("endian", &value, "`little` or `big`"))
            }
        }
    }

    fn data_file(&mut self) -> Result<Option<DataFile>, NrrdError> {
        let Some(value) = self.take("data file")? else { return Ok(None) };
        let words: Vec<&str> = value.split_whitespace().collect();
        let numbers: Option<Vec<i64>> = words.iter().skip(1).map(|word| word.parse().ok()).collect();
        Ok(Some(match (words.as_slice(), numbers.as_deref()) {
            ([], _) => return Err(bad("data file", &value, "the name of a file")),
            (["LIST"] | ["LIST", _], Some(_)) => DataFile::List,
            ([pattern, ..], Some([first, last, step, ..])) if pattern.contains('%') => {
                DataFile::Pattern { pattern: (*pattern).to_owned(), first: *first, last: *last, step: *step }
            }
            _ => DataFile::Name(value),
        }))
    }
}

fn bad(field: &'static str, value: &str, expected: &'static str) -> NrrdError {
    NrrdError::Value { field, value: excerpt(value), expected }
}

/// Name written for a type: the short one that says its width.
pub(super) const fn type_name(element: ElementType) -> &'static str {
    match element {
        ElementType::U8 => "uint8",
        ElementType::I8 => "int8",
        ElementType::U16 => "uint16",
        ElementType::I16 => "int16",
        ElementType::U32 => "uint32",
        ElementType::I32 => "int32",
        ElementType::U64 => "uint64",
        ElementType::I64 => "int64",
        ElementType::F32 => "float",
        ElementType::F64 => "double",
    }
}

fn element_named(name: &str) -> Option<ElementType> {
    Some(match name {
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => ElementType::U8,
        "signed char" | "int8" | "int8_t" => ElementType::I8,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => ElementType::U16,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => ElementType::I16,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => ElementType::U32,
        "int" | "signed int" | "int32" | "int32_t" => ElementType::I32,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => {
            ElementType::U64
        }
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => ElementType::I64,
        "float" => ElementType::F32,
        "double" => ElementType::F64,
        _ => return None,
    })
}

/// Whether a field is made anew when a header is written.
pub(super) fn is_structure(name: &str) -> bool {
    STRUCTURE.iter().any(|known| is_same_name(known, name))
}

/// Understands one line. A name before `: ` counts as a field if the format has it, else `:=` makes a pair.
fn parse_line(line: &str) -> Option<HeaderLine> {
    if let Some(text) = line.strip_prefix('#') {
        return Some(HeaderLine::Comment(text.to_owned()));
    }
    let field = |(name, value): (&str, &str)| HeaderLine::Field {
        name: name.trim().to_owned(),
        value: value.trim().to_owned(),
    };
    let is_known =
        |name: &str| is_structure(name) || ANNOTATIONS.iter().any(|known| is_same_name(known, name));
    if let Some(parts) = line.split_once(": ").filter(|(name, _)| is_known(name)) {
        return Some(field(parts));
    }
    match line.split_once(":=") {
        Some((key, value)) => Some(HeaderLine::KeyValue { key: unescape(key), value: unescape(value) }),
        None => line.split_once(':').map(field),
    }
}

/// Text of a line that [`parse_line`] turns into the same line; `None` if there is no such text.
pub(super) fn line_text(line: &HeaderLine) -> Option<String> {
    let text = match line {
        HeaderLine::Comment(text) => format!("#{text}"),
        HeaderLine::Field { name, value } => format!("{name}: {value}"),
        HeaderLine::KeyValue { key, value } => format!("{}:={}", escape(key), escape(value)),
    };
    let one_line = !text.contains('\n') && !text.ends_with('\r');
    (one_line && parse_line(&text).as_ref() == Some(line)).then_some(text)
}

fn escape(text: &str) -> String {
    text.replace('\\', "\\\\").replace('\n', "\\n")
}

/// Resolves `\n` and `\\`; a backslash before anything else stands for itself.
fn unescape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('\\') {
        out.push_str(before);
        let (character, skipped) = match after.bytes().next() {
            Some(b'n') => ('\n', 1),
            Some(b'\\') => ('\\', 1),
            _ => ('\\', 0),
        };
        out.push(character);
        rest = &after[skipped..];
    }
    out + rest
}
