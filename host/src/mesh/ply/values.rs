//! The numbers after the header.

use super::header::{Encoding, Header};
use crate::mesh::MeshFault;
use crate::mesh::text::number;

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// The type of a name, of which there are two each.
    pub(super) fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }
}

/// The numbers of a file one after another.
#[derive(Debug)]
pub(super) struct Values<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    encoding: Encoding,
}

impl<'a> Values<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self { bytes, at: header.end.min(bytes.len()), line: header.lines + 1, encoding: header.encoding }
    }

    /// Byte of the next number.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// Bytes to come.
    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next number, as one that holds those of all types.
    pub(super) fn next(&mut self, scalar: Scalar, within: &'static str) -> Result<f64, MeshFault> {
        if self.encoding == Encoding::Text {
            return self.next_word(within);
        }
        Ok(match scalar {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.take(within)?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.take(within)?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.take(within)?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.take(within)?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.take(within)?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.take(within)?)),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.take(within)?)),
            Scalar::F64 => f64::from_le_bytes(self.take(within)?),
        })
    }

    /// The next bytes, the lowest first.
    fn take<const N: usize>(&mut self, within: &'static str) -> Result<[u8; N], MeshFault> {
        let next = self.bytes[self.at..].first_chunk::<N>();
        let mut bytes = *next.ok_or(MeshFault::Truncated { within, byte: self.bytes.len() })?;
        self.at += N;
        if self.encoding == Encoding::Big {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn next_word(&mut self, within: &'static str) -> Result<f64, MeshFault> {
        while let Some(blank) = self.bytes.get(self.at).filter(|byte| byte.is_ascii_whitespace()) {
            self.line += usize::from(*blank == b'\n');
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        if length == 0 {
            return Err(MeshFault::Truncated { within, byte: self.bytes.len() });
        }
        self.at += length;
        number(&rest[..length]).ok_or_else(|| MeshFault::line(self.line, &rest[..length], "a number"))
    }
}
