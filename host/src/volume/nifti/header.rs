//! NIfTI headers as bytes: version, order, shape and type, and the fields and extensions beside them.

use std::io::{self, Read};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::NiftiError;
use super::fields::{Fields, Version};
use crate::volume::error::excerpt;
use crate::volume::{ByteOrder, ElementType};

/// Most bytes of extensions that are read. A connectome's table has some MiB.
const EXTENSION_BYTES: u64 = 1 << 26;

/// A header, understood.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NiftiHeader {
    pub(super) version: Version,
    pub(super) order: ByteOrder,
    /// Whether the samples are in a file of their own.
    pub(super) is_pair: bool,
    /// Samples along each axis, fastest first.
    pub(super) dim: Vec<u64>,
    pub(super) datatype: i16,
    /// Where samples begin in their file.
    pub(super) offset: u64,
    pub(super) fields: Fields,
    /// Code and bytes (base64) of each extension.
    pub(super) extensions: Vec<String>,
}

/// Why a header could not be read: what is wrong with it, or with the file.
#[derive(Debug)]
pub(super) enum HeaderFault {
    Nifti(NiftiError),
    Io(io::Error),
}

impl From<NiftiError> for HeaderFault {
    fn from(error: NiftiError) -> Self {
        Self::Nifti(error)
    }
}

fn fill(input: &mut dyn Read, bytes: &mut [u8]) -> Result<(), HeaderFault> {
    input.read_exact(bytes).map_err(|cause| match cause.kind() {
        io::ErrorKind::UnexpectedEof => HeaderFault::Nifti(NiftiError::Truncated),
        _ => HeaderFault::Io(cause),
    })
}

impl NiftiHeader {
    /// Reads a header and its extensions.
    pub(super) fn read(input: &mut dyn Read) -> Result<Self, HeaderFault> {
        let mut bytes = vec![0; 4];
        fill(input, &mut bytes)?;
        let size = i32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let (version, order) = match (size, size.swap_bytes()) {
            (348, _) => (Version::One, ByteOrder::Little),
            (_, 348) => (Version::One, ByteOrder::Big),
            (540, _) => (Version::Two, ByteOrder::Little),
            (_, 540) => (Version::Two, ByteOrder::Big),
            _ => return Err(NiftiError::Size { found: size }.into()),
        };
        bytes.resize(version.bytes(), 0);
        fill(input, &mut bytes[4..])?;
        let mut header = Self::parse(&bytes, version, order)?;
        header.extensions = read_extensions(input, &header)?;
        Ok(header)
    }

    fn parse(bytes: &[u8], version: Version, order: ByteOrder) -> Result<Self, NiftiError> {
        let as_nifti = of_analyze(bytes, version);
        let bytes = as_nifti.as_deref().unwrap_or(bytes);
        let magic = match version {
            Version::One => &bytes[344..348],
            Version::Two => &bytes[4..8],
        };
        let is_pair = match (magic, version) {
            (b"n+1\0", Version::One) | (b"n+2\0", Version::Two) => false,
            (b"ni1\0", Version::One) | (b"ni2\0", Version::Two) => true,
            _ => return Err(NiftiError::Magic { found: excerpt(&String::from_utf8_lossy(magic)) }),
        };
        let reader = Numbers { bytes, order };
        let (dim, datatype, offset): (Vec<i64>, i16, f64) = match version {
            Version::One => (
                (0..8).map(|axis| reader.i16(40 + 2 * axis).into()).collect(),
                reader.i16(70),
                f32::from_le_bytes(reader.at(108)).into(),
            ),
            Version::Two => (
                (0..8).map(|axis| i64::from_le_bytes(reader.at(16 + 8 * axis))).collect(),
                reader.i16(12),
                i64::from_le_bytes(reader.at(168)) as f64,
            ),
        };
        // No file has so many bytes that a double does not count them exactly.
        if !(0.0..=(1_u64 << 53) as f64).contains(&offset) {
            return Err(NiftiError::Offset { found: offset.to_string() });
        }
        let first = if is_pair { 0 } else { version.bytes() as u64 + 4 };
        Ok(Self {
            version,
            order,
            is_pair,
            dim: shape(&dim)?,
            datatype,
            offset: (offset as u64).max(first),
            fields: Fields::of_bytes(bytes, version, order),
            extensions: Vec::new(),
        })
    }

    /// The bytes before the samples, or of the header's own file; the names of fields that do not fit.
    pub(super) fn to_bytes(&self) -> (Vec<u8>, Vec<&'static str>) {
        let mut bytes = vec![0; self.version.bytes()];
        let losses = self.fields.write(&mut bytes, self.version, self.order);
        let mut dim = vec![self.dim.len() as u64];
        dim.extend(&self.dim);
        dim.resize(8, 1);
        let bits =
            layout_of(self.datatype).map_or(0, |(element, lead)| 8 * element.bytes() as i16 * lead as i16);
        let mut extensions = vec![u8::from(!self.extensions.is_empty()), 0, 0, 0];
        self.extensions
            .iter()
            .filter_map(|text| self.extension_bytes(text))
            .for_each(|more| extensions.extend(more));
        let mut put = |place: usize, mut number: Vec<u8>| {
            if self.order == ByteOrder::Big {
                number.reverse();
            }
            bytes[place..place + number.len()].copy_from_slice(&number);
        };
        let offset = if self.is_pair { 0 } else { self.version.bytes() + extensions.len() };
        put(0, (self.version.bytes() as i32).to_le_bytes().to_vec());
        match self.version {
            Version::One => {
                dim.iter()
                    .enumerate()
                    .for_each(|(axis, &count)| put(40 + 2 * axis, (count as i16).to_le_bytes().to_vec()));
                put(70, self.datatype.to_le_bytes().to_vec());
                put(72, bits.to_le_bytes().to_vec());
                put(108, (offset as f32).to_le_bytes().to_vec());
                bytes[344..].copy_from_slice(if self.is_pair { b"ni1\0" } else { b"n+1\0" });
            }
            Version::Two => {
                dim.iter()
                    .enumerate()
                    .for_each(|(axis, &count)| put(16 + 8 * axis, (count as i64).to_le_bytes().to_vec()));
                put(12, self.datatype.to_le_bytes().to_vec());
                put(14, bits.to_le_bytes().to_vec());
                put(168, (offset as i64).to_le_bytes().to_vec());
                bytes[4..12].copy_from_slice(if self.is_pair {
                    b"ni2\0\r\n\x1a\n"
                } else {
                    b"n+2\0\r\n\x1a\n"
                });
            }
        }
        bytes.extend(extensions);
        (bytes, losses)
    }

    /// Length, code, bytes, and zeros up to a multiple of 16.
    fn extension_bytes(&self, text: &str) -> Option<Vec<u8>> {
        let (code, data) = text.split_once(' ')?;
        let (code, mut data) = (code.parse::<i32>().ok()?, STANDARD.decode(data).ok()?);
        data.resize((data.len() + 8).next_multiple_of(16) - 8, 0);
        let in_order = |number: i32| match self.order {
            ByteOrder::Little => number.to_le_bytes(),
            ByteOrder::Big => number.to_be_bytes(),
        };
        let size = i32::try_from(data.len() + 8).ok()?;
        Some([&in_order(size)[..], &in_order(code), &data].concat())
    }
}

/// An ANALYZE 7.5 header, which has no magic, as one of a NIfTI pair: with zeros where it has something else than NIfTI.
/// So it does not say left from right, nor where the samples lie; a scale is where SPM put it.
///
/// Source: *ANALYZE 7.5 File Format* (Mayo Clinic), and `nifti1.h`, which says what it took over.
fn of_analyze(bytes: &[u8], version: Version) -> Option<Vec<u8>> {
    const OTHERS: [std::ops::Range<usize>; 6] = [39..40, 56..70, 74..76, 120..124, 132..140, 252..344];
    if version == Version::Two || bytes[344..348] != [0; 4] {
        return None;
    }
    let mut bytes = bytes.to_vec();
    OTHERS.into_iter().for_each(|other| bytes[other].fill(0));
    bytes[344..348].copy_from_slice(b"ni1\0");
    Some(bytes)
}

struct Numbers<'a> {
    bytes: &'a [u8],
    order: ByteOrder,
}

impl Numbers<'_> {
    /// Bytes from `place` on, least significant first.
    fn at<const BYTES: usize>(&self, place: usize) -> [u8; BYTES] {
        let mut number = [0; BYTES];
        number.copy_from_slice(&self.bytes[place..place + BYTES]);
        if self.order == ByteOrder::Big {
            number.reverse();
        }
        number
    }

    fn i16(&self, place: usize) -> i16 {
        i16::from_le_bytes(self.at(place))
    }
}

fn shape(dim: &[i64]) -> Result<Vec<u64>, NiftiError> {
    let fault = || {
        let words: Vec<String> = dim.iter().map(i64::to_string).collect();
        NiftiError::Dim { found: words.join(" ") }
    };
    let rank = usize::try_from(dim[0]).ok().filter(|rank| (1..=7).contains(rank)).ok_or_else(fault)?;
    let axes = dim[1..=rank].iter().map(|&count| u64::try_from(count).ok().filter(|count| *count > 0));
    axes.collect::<Option<_>>().ok_or_else(fault)
}

/// Reads what lies between the header and the samples, or the end of the header's own file.
fn read_extensions(input: &mut dyn Read, header: &NiftiHeader) -> Result<Vec<String>, HeaderFault> {
    let mut flag = [0; 4];
    match input.read_exact(&mut flag) {
        Err(cause) if cause.kind() == io::ErrorKind::UnexpectedEof && header.is_pair => return Ok(Vec::new()),
        Err(cause) if cause.kind() == io::ErrorKind::UnexpectedEof => {
            return Err(NiftiError::Truncated.into());
        }
        Err(cause) => return Err(HeaderFault::Io(cause)),
        Ok(()) if flag[0] == 0 => return Ok(Vec::new()),
        Ok(()) => {}
    }
    let bytes = match header.is_pair {
        true => EXTENSION_BYTES,
        false => header.offset - header.version.bytes() as u64 - 4,
    };
    if bytes > EXTENSION_BYTES {
        return Err(NiftiError::Extensions { bytes, limit: EXTENSION_BYTES }.into());
    }
    let mut found = Vec::new();
    input.take(bytes).read_to_end(&mut found).map_err(HeaderFault::Io)?;
    Ok(extensions_of(&found, header.order))
}

/// Code and data of each extension, up to the first that does not fit.
fn extensions_of(bytes: &[u8], order: ByteOrder) -> Vec<String> {
    let mut extensions = Vec::new();
    let mut rest = bytes;
    while rest.len() >= 16 {
        let numbers = Numbers { bytes: rest, order };
        let (size, code) = (i32::from_le_bytes(numbers.at(0)), i32::from_le_bytes(numbers.at(4)));
        let Some(size) = usize::try_from(size).ok().filter(|size| (8..=rest.len()).contains(size)) else {
            break;
        };
        extensions.push(format!("{code} {}", STANDARD.encode(&rest[8..size])));
        rest = &rest[size..];
    }
    extensions
}

/// Type of a value and values that lie together, by the field `datatype`.
pub(super) const fn layout_of(datatype: i16) -> Option<(ElementType, u32)> {
    Some(match datatype {
        2 => (ElementType::U8, 1),
        4 => (ElementType::I16, 1),
        8 => (ElementType::I32, 1),
        16 => (ElementType::F32, 1),
        32 => (ElementType::F32, 2),
        64 => (ElementType::F64, 1),
        128 => (ElementType::U8, 3),
        256 => (ElementType::I8, 1),
        512 => (ElementType::U16, 1),
        768 => (ElementType::U32, 1),
        1024 => (ElementType::I64, 1),
        1280 => (ElementType::U64, 1),
        1792 => (ElementType::F64, 2),
        2304 => (ElementType::U8, 4),
        _ => return None,
    })
}

/// The field `datatype` of single values.
pub(super) const fn datatype_of(element: ElementType) -> i16 {
    match element {
        ElementType::U8 => 2,
        ElementType::I8 => 256,
        ElementType::U16 => 512,
        ElementType::I16 => 4,
        ElementType::U32 => 768,
        ElementType::I32 => 8,
        ElementType::U64 => 1280,
        ElementType::I64 => 1024,
        ElementType::F32 => 16,
        ElementType::F64 => 64,
    }
}

/// What a type that is not read is called.
pub(super) const fn name_of_type(datatype: i16) -> &'static str {
    match datatype {
        0 => "unknown",
        1 => "single bits",
        1536 => "floats of 128 bits",
        2048 => "complex numbers of 256 bits",
        _ => "no type of NIfTI",
    }
}
