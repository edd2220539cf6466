//! Sample types of files and the order of their bytes.

use std::fmt;
use std::io::{self, Write};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::sample::Sample;

/// Type of one sample in a file: integers and IEEE 754 floats of 8 to 64 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[expect(missing_docs, reason = "each variant is its own name")]
pub enum ElementType {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl ElementType {
    /// Every type, in the order of declaration.
    pub const ALL: [Self; 10] = [
        Self::U8,
        Self::I8,
        Self::U16,
        Self::I16,
        Self::U32,
        Self::I32,
        Self::U64,
        Self::I64,
        Self::F32,
        Self::F64,
    ];

    /// Name on the command line: a letter for the kind and the bits, `u8` to `f64`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::U8 => "u8",
            Self::I8 => "i8",
            Self::U16 => "u16",
            Self::I16 => "i16",
            Self::U32 => "u32",
            Self::I32 => "i32",
            Self::U64 => "u64",
            Self::I64 => "i64",
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }

    /// NumPy's name of it, which is taken as well: `uint8` to `float64`.
    pub const fn long_name(self) -> &'static str {
        match self {
            Self::U8 => "uint8",
            Self::I8 => "int8",
            Self::U16 => "uint16",
            Self::I16 => "int16",
            Self::U32 => "uint32",
            Self::I32 => "int32",
            Self::U64 => "uint64",
            Self::I64 => "int64",
            Self::F32 => "float32",
            Self::F64 => "float64",
        }
    }

    /// Bytes of one sample: 1, 2, 4 or 8.
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// Whether samples are floating-point numbers.
    pub const fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// Whether samples are signed integers.
    pub const fn is_signed_integer(self) -> bool {
        matches!(self, Self::I8 | Self::I16 | Self::I32 | Self::I64)
    }
}

impl fmt::Display for ElementType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The text is no sample type.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{text:?} is no sample type: give one of u8, i8, u16, i16, u32, i32, u64, i64, f32, f64")]
pub struct UnknownElementType {
    text: String,
}

impl FromStr for ElementType {
    type Err = UnknownElementType;

    /// Finds the type of that [`name`](Self::name) or [`long_name`](Self::long_name).
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found =
            Self::ALL.into_iter().find(|element| [element.name(), element.long_name()].contains(&text));
        found.ok_or_else(|| UnknownElementType { text: text.to_owned() })
    }
}

/// Order of the bytes of a sample in a file. In memory the order is always little.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ByteOrder {
    /// Least significant byte first.
    #[default]
    Little,
    /// Most significant byte first.
    Big,
}

impl ByteOrder {
    /// `little` or `big`, as on the command line and in NRRD.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Little => "little",
            Self::Big => "big",
        }
    }
}

impl fmt::Display for ByteOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The text is no byte order.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{text:?} is no byte order: give little or big")]
pub struct UnknownByteOrder {
    text: String,
}

impl FromStr for ByteOrder {
    type Err = UnknownByteOrder;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "little" => Ok(Self::Little),
            "big" => Ok(Self::Big),
            _ => Err(UnknownByteOrder { text: text.to_owned() }),
        }
    }
}

/// Turns samples of `order` into little-endian ones, or back, in place.
///
/// A trailing part shorter than a sample stays as it is. One pass; nothing is done where the orders agree.
pub(super) fn reorder(samples: &mut [u8], element: ElementType, order: ByteOrder) {
    fn reverse_each<const BYTES: usize>(samples: &mut [u8]) {
        samples.as_chunks_mut::<BYTES>().0.iter_mut().for_each(|sample| sample.reverse());
    }
    match (order, element.bytes()) {
        (ByteOrder::Big, 2) => reverse_each::<2>(samples),
        (ByteOrder::Big, 4) => reverse_each::<4>(samples),
        (ByteOrder::Big, 8) => reverse_each::<8>(samples),
        _ => {}
    }
}

/// Writes little-endian `samples` in `order`, through a buffer of 64 KiB where bytes must be moved.
///
/// # Errors
///
/// What `out` returns; how much has been written by then is unknown.
pub(super) fn write_samples(
    out: &mut dyn Write,
    samples: &[u8],
    element: ElementType,
    order: ByteOrder,
) -> io::Result<()> {
    const PIECE_BYTES: usize = 1 << 16;
    if order == ByteOrder::Little || element.bytes() == 1 {
        return out.write_all(samples);
    }
    let mut buffer = Vec::with_capacity(PIECE_BYTES);
    for piece in samples.chunks(PIECE_BYTES) {
        buffer.clear();
        buffer.extend_from_slice(piece);
        reorder(&mut buffer, element, order);
        out.write_all(&buffer)?;
    }
    Ok(())
}

/// The value of a type that a text says, little-endian from the first byte on: exactly for integers, the nearest for
/// floats. `None` for what is no such value.
pub(crate) fn value_of_text(element: ElementType, text: &str) -> Option<[u8; 8]> {
    fn parse<T: Sample + FromStr>(text: &str) -> Option<[u8; 8]> {
        let value: T = text.parse().ok()?;
        let mut bytes = [0; 8];
        bytes[..size_of::<T>()].copy_from_slice(bytemuck::bytes_of(&T::of_little(value)));
        Some(bytes)
    }
    match element {
        ElementType::U8 => parse::<u8>(text),
        ElementType::I8 => parse::<i8>(text),
        ElementType::U16 => parse::<u16>(text),
        ElementType::I16 => parse::<i16>(text),
        ElementType::U32 => parse::<u32>(text),
        ElementType::I32 => parse::<i32>(text),
        ElementType::U64 => parse::<u64>(text),
        ElementType::I64 => parse::<i64>(text),
        ElementType::F32 => parse::<f32>(text),
        ElementType::F64 => parse::<f64>(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_to_their_types() {
        for element in ElementType::ALL {
            assert_eq!(element.name().parse(), Ok(element));
            assert_eq!(element.bytes() * 8, element.name()[1..].parse::<usize>().unwrap());
        }
        assert_eq!("little".parse(), Ok(ByteOrder::Little));
        assert_eq!("big".parse(), Ok(ByteOrder::Big));
        assert_eq!(
            "U16".parse::<ElementType>().unwrap_err().to_string(),
            "\"U16\" is no sample type: give one of u8, i8, u16, i16, u32, i32, u64, i64, f32, f64"
        );
        assert_eq!(
            "middle".parse::<ByteOrder>().unwrap_err().to_string(),
            "\"middle\" is no byte order: give little or big"
        );
    }

    #[test]
    fn big_endian_samples_are_reversed_one_by_one() {
        let bytes = [1, 2, 3, 4, 5, 6, 7, 8];
        for (element, expected) in [
            (ElementType::I8, [1, 2, 3, 4, 5, 6, 7, 8]),
            (ElementType::U16, [2, 1, 4, 3, 6, 5, 8, 7]),
            (ElementType::F32, [4, 3, 2, 1, 8, 7, 6, 5]),
            (ElementType::I64, [8, 7, 6, 5, 4, 3, 2, 1]),
        ] {
            let mut out = Vec::new();
            write_samples(&mut out, &bytes, element, ByteOrder::Big).unwrap();
            assert_eq!(out, expected);
            reorder(&mut out, element, ByteOrder::Big);
            assert_eq!(out, bytes);
            out.clear();
            write_samples(&mut out, &bytes, element, ByteOrder::Little).unwrap();
            assert_eq!(out, bytes);
        }
    }

    #[test]
    fn pieces_of_the_buffer_join_without_a_seam() {
        let samples: Vec<u8> = (0..200_000_u32).flat_map(u32::to_le_bytes).collect();
        let expected: Vec<u8> = (0..200_000_u32).flat_map(u32::to_be_bytes).collect();
        let mut out = Vec::new();
        write_samples(&mut out, &samples, ElementType::U32, ByteOrder::Big).unwrap();
        assert_eq!(out, expected);
    }
}
