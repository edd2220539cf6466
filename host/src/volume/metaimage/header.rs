//! MetaImage headers as text: lines `Key = value`, of which `ElementDataFile` is the last.

use std::io::{BufRead, Read};

use super::MetaImageError;
use crate::volume::error::excerpt;
use crate::volume::input::Input;
use crate::volume::{ByteOrder, ElementType, FileFormat, ReadError};

/// Longest header that is read.
const HEADER_BYTES: u64 = 1 << 20;

/// Most axes of a file; the MetaIO library has the same limit.
const MAX_AXES: u64 = 10;

/// Keys that extent, type and place of the samples determine; they are made anew when a header is written.
const STRUCTURE: [&str; 13] = [
    "ObjectType",
    "NDims",
    "BinaryData",
    "BinaryDataByteOrderMSB",
    "ElementByteOrderMSB",
    "CompressedData",
    "CompressedDataSize",
    "DimSize",
    "ElementNumberOfChannels",
    "ElementType",
    "HeaderSize",
    "HeaderSizePerSlice",
    "ElementDataFile",
];

/// A header, understood.
#[derive(Debug, PartialEq)]
pub(super) struct MetaHeader {
    pub(super) sizes: Vec<u64>,
    pub(super) channels: u32,
    pub(super) element: ElementType,
    pub(super) byte_order: ByteOrder,
    pub(super) is_compressed: bool,
    /// `None` if the last sample ends where its file does.
    pub(super) header_size: Option<u64>,
    pub(super) data_file: String,
    /// All other lines.
    pub(super) pairs: Vec<(String, String)>,
}

impl MetaHeader {
    /// Reads up to and with the line `ElementDataFile`.
    pub(super) fn read(input: &mut Input) -> Result<Self, ReadError> {
        let path = input.path().to_owned();
        let fault = |cause: MetaImageError| ReadError::Format {
            path: path.clone(),
            format: FileFormat::MetaImage,
            cause: Box::new(cause),
        };
        let mut pairs = Vec::new();
        let mut left = HEADER_BYTES;
        for number in 1.. {
            let mut line = Vec::new();
            let read = input.by_ref().take(left).read_until(b'\n', &mut line);
            let count = read.map_err(|cause| ReadError::Io { path: path.clone(), cause })?;
            left -= count as u64;
            if !line.ends_with(b"\n") && (count == 0 || left == 0) {
                break;
            }
            let text = match String::from_utf8(line) {
                Ok(text) => text,
                Err(error) => error.into_bytes().into_iter().map(char::from).collect(),
            };
            if text.trim().is_empty() {
                continue;
            }
            let Some((key, value)) = text.split_once('=') else {
                return Err(fault(MetaImageError::Line { number, text: excerpt(text.trim()) }));
            };
            let is_last = key.trim() == "ElementDataFile";
            pairs.push((key.trim().to_owned(), value.trim().to_owned()));
            if is_last {
                return Self::of_pairs(pairs).map_err(fault);
            }
        }
        Err(fault(MetaImageError::NoEnd { limit: HEADER_BYTES }))
    }

    fn of_pairs(pairs: Vec<(String, String)>) -> Result<Self, MetaImageError> {
        let value = |key: &str| pairs.iter().find(|(found, _)| found == key).map(|(_, value)| value.as_str());
        let required = |key| value(key).ok_or(MetaImageError::Missing { key });
        let truth = |key| match value(key).and_then(|text| text.bytes().next()) {
            Some(b'T' | b't' | b'1') => Some(true),
            Some(_) => Some(false),
            None => None,
        };
        if let Some(found) = value("ObjectType").filter(|found| !found.eq_ignore_ascii_case("image")) {
            return Err(MetaImageError::Object { found: excerpt(found) });
        }
        if truth("BinaryData") == Some(false) {
            return Err(MetaImageError::Text);
        }
        let sizes = sizes(required("NDims")?, required("DimSize")?)?;
        let element = element_named(required("ElementType")?)?;
        let is_big = truth("BinaryDataByteOrderMSB").or(truth("ElementByteOrderMSB")).unwrap_or(false);
        let channels = match value("ElementNumberOfChannels") {
            None => 1,
            Some(text) => text
                .parse()
                .ok()
                .filter(|count| *count > 0)
                .ok_or_else(|| bad("ElementNumberOfChannels", text, "a number from 1 up"))?,
        };
        let header_size = match value("HeaderSize") {
            None => Some(0),
            Some("-1") => None,
            Some(text) => {
                Some(text.parse().map_err(|_| bad("HeaderSize", text, "-1 or a number from 0 up"))?)
            }
        };
        let byte_order = if is_big && element.bytes() > 1 { ByteOrder::Big } else { ByteOrder::Little };
        let is_compressed = truth("CompressedData").unwrap_or(false);
        let data_file = required("ElementDataFile")?.to_owned();
        let pairs = pairs.into_iter().filter(|(key, _)| !is_structure(key)).collect();
        Ok(Self { sizes, channels, element, byte_order, is_compressed, header_size, data_file, pairs })
    }
}

fn bad(key: &'static str, value: &str, expected: &'static str) -> MetaImageError {
    MetaImageError::Value { key, value: excerpt(value), expected }
}

fn sizes(rank: &str, text: &str) -> Result<Vec<u64>, MetaImageError> {
    let found: Option<u64> = rank.parse().ok().filter(|rank| (1..=MAX_AXES).contains(rank));
    let rank = found.ok_or_else(|| bad("NDims", rank, "a number from 1 to 10"))?;
    let sizes = text.split_whitespace().map(str::parse).collect::<Result<Vec<u64>, _>>();
    let sizes = sizes.map_err(|_| bad("DimSize", text, "a list of whole numbers"))?;
    match sizes.len() as u64 == rank {
        true => Ok(sizes),
        false => Err(bad("DimSize", text, "as many numbers as `NDims` says")),
    }
}

/// Whether a key is made anew when a header is written.
pub(super) fn is_structure(key: &str) -> bool {
    STRUCTURE.contains(&key)
}

/// Type of that name. A `MET_LONG` has four bytes, as in the MetaIO library.
fn element_named(name: &str) -> Result<ElementType, MetaImageError> {
    Ok(match name.trim_end_matches("_ARRAY") {
        "MET_CHAR" => ElementType::I8,
        "MET_UCHAR" => ElementType::U8,
        "MET_SHORT" => ElementType::I16,
        "MET_USHORT" => ElementType::U16,
        "MET_INT" | "MET_LONG" => ElementType::I32,
        "MET_UINT" | "MET_ULONG" => ElementType::U32,
        "MET_LONG_LONG" => ElementType::I64,
        "MET_ULONG_LONG" => ElementType::U64,
        "MET_FLOAT" => ElementType::F32,
        "MET_DOUBLE" => ElementType::F64,
        _ => return Err(bad("ElementType", name, "a type from MET_CHAR to MET_DOUBLE")),
    })
}

/// Name written for a type.
pub(super) const fn type_name(element: ElementType) -> &'static str {
    match element {
        ElementType::U8 => "MET_UCHAR",
        ElementType::I8 => "MET_CHAR",
        ElementType::U16 => "MET_USHORT",
        ElementType::I16 => "MET_SHORT",
        ElementType::U32 => "MET_UINT",
        ElementType::I32 => "MET_INT",
        ElementType::U64 => "MET_ULONG_LONG",
        ElementType::I64 => "MET_LONG_LONG",
        ElementType::F32 => "MET_FLOAT",
        ElementType::F64 => "MET_DOUBLE",
    }
}
