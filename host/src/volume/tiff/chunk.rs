//! Strips and tiles: what is stored, and the values that it stands for.

use std::io::Read;

use flate2::read::ZlibDecoder;
use ruzstd::decoding::StreamingDecoder;
use weezl::BitOrder;
use weezl::decode::Decoder as LzwDecoder;

use super::TiffError;
use crate::volume::element::reorder;
use crate::volume::half::widened;
use crate::volume::packbits::unpack_bits;
use crate::volume::raster::Raster;
use crate::volume::{ByteOrder, ElementType, jpeg, jpeg2000};

/// How chunks are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compression {
    None,
    Lzw,
    Deflate,
    PackBits,
    Jpeg,
    Jpeg2000,
    Zstd,
}

impl Compression {
    /// The compression with that number.
    pub(super) fn of(code: u16) -> Result<Self, TiffError> {
        let name = match code {
            1 => return Ok(Self::None),
            5 => return Ok(Self::Lzw),
            7 => return Ok(Self::Jpeg),
            8 | 32_946 => return Ok(Self::Deflate),
            32_773 => return Ok(Self::PackBits),
            33_005 | 34_712 => return Ok(Self::Jpeg2000),
            50_000 => return Ok(Self::Zstd),
            2..=4 => "fax",
            6 => "JPEG of the old kind",
            33_003 => "JPEG 2000 of brightness and two differences",
            34_887 => "LERC",
            34_925 => "LZMA",
            50_001 => "WebP",
            50_002 => "JPEG XL",
            _ => "unknown",
        };
        Err(TiffError::Compression { code, name })
    }

    /// Bytes that one byte can stand for at most: 258 for two bits in deflate (RFC 1951), 4096 for a code in LZW; of JPEG,
    /// JPEG 2000 and Zstandard, more than are met.
    pub(super) const fn expansion(self) -> u64 {
        match self {
            Self::None => 1,
            Self::Lzw => 4096,
            Self::Deflate => 4 * 258,
            Self::PackBits => 64,
            Self::Jpeg | Self::Jpeg2000 => 1024,
            Self::Zstd => 1 << 16,
        }
    }
}

/// The shape of a chunk.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chunk {
    pub(super) width: usize,
    pub(super) rows: usize,
    /// Values of a sample that are in the chunk.
    pub(super) samples: usize,
    /// Bits of a value.
    pub(super) bits: usize,
    /// Type of a value in memory.
    pub(super) element: ElementType,
    pub(super) predictor: u16,
    pub(super) byte_order: ByteOrder,
}

impl Chunk {
    /// The values of a chunk of JPEG, whose tables may lie elsewhere; as [`Chunk::decode`]. Colours come out as red,
    /// green and blue.
    pub(super) fn decode_jpeg(self, tables: &[u8], stored: &[u8], is_rgb: bool) -> Option<Vec<u8>> {
        // Both are whole streams; together they are one, without the end of the first and the start of the second.
        let tables = tables.strip_suffix(&[0xFF, 0xD9]).unwrap_or(tables);
        let rest = if tables.is_empty() { stored } else { stored.strip_prefix(&[0xFF, 0xD8])? };
        jpeg::decode(&[tables, rest].concat(), self.raster(), Some(is_rgb)).ok()
    }

    /// The values of a chunk of JPEG 2000; as [`Chunk::decode`].
    pub(super) fn decode_jpeg2000(self, stored: &[u8]) -> Option<Vec<u8>> {
        jpeg2000::decode(stored, self.raster()).ok()
    }

    /// What a chunk holds that is a picture itself.
    fn raster(self) -> Raster {
        Raster {
            width: self.width as u64,
            height: self.rows as u64,
            components: self.samples as u32,
            bytes: self.element.bytes(),
        }
    }

    /// Whether values are floats of 16 bits.
    fn is_half(self) -> bool {
        self.bits == 16 && self.element == ElementType::F32
    }

    /// The values of a chunk, little-endian; `None` if it does not have as many.
    pub(super) fn decode(self, compression: Compression, stored: &[u8]) -> Option<Vec<u8>> {
        let row_bytes = self.width.checked_mul(self.samples)?.checked_mul(self.bits)?.div_ceil(8);
        let bytes = row_bytes.checked_mul(self.rows)?;
        if bytes as u64 > (stored.len() as u64).saturating_mul(compression.expansion()) {
            return None;
        }
        if self.is_half() {
            let bits = Self { element: ElementType::U16, ..self }.decode(compression, stored)?;
            return Some(widened(&bits));
        }
        let mut data = decompress(compression, stored, bytes)?;
        if self.bits != self.element.bytes() * 8 {
            return (self.predictor == 1).then(|| self.unpack(&data, row_bytes));
        }
        match self.predictor {
            1 => reorder(&mut data, self.element, self.byte_order),
            2 => {
                reorder(&mut data, self.element, self.byte_order);
                data.chunks_mut(row_bytes).for_each(|row| self.sum(row));
            }
            3 if self.element.is_float() || self.element == ElementType::U16 => {
                data.chunks_mut(row_bytes).for_each(|row| self.join(row))
            }
            _ => return None,
        }
        Some(data)
    }

    /// Differences of a row to values (predictor 2).
    fn sum(self, row: &mut [u8]) {
        let bytes = self.element.bytes();
        let step = self.samples * bytes;
        for at in (step..row.len()).step_by(bytes) {
            let [before, now] = [at - step, at].map(|at| {
                row[at..at + bytes].iter().rev().fold(0, |value: u64, byte| value << 8 | u64::from(*byte))
            });
            row[at..at + bytes].copy_from_slice(&before.wrapping_add(now).to_le_bytes()[..bytes]);
        }
    }

    /// Bytes of floats that lie apart, the most significant ones first, as differences (predictor 3).
    fn join(self, row: &mut [u8]) {
        for at in self.samples..row.len() {
            row[at] = row[at].wrapping_add(row[at - self.samples]);
        }
        let apart = row.to_vec();
        let (bytes, count) = (self.element.bytes(), row.len() / self.element.bytes());
        for (index, value) in row.chunks_mut(bytes).enumerate() {
            value.iter_mut().rev().enumerate().for_each(|(byte, to)| *to = apart[byte * count + index]);
        }
    }

    /// Values of bits that make no bytes, the most significant bit first; each row begins with a byte.
    fn unpack(self, data: &[u8], row_bytes: usize) -> Vec<u8> {
        let values = self.width * self.samples;
        let bytes = self.element.bytes();
        let mut out = Vec::with_capacity(values * self.rows * bytes);
        for row in data.chunks(row_bytes) {
            for index in 0..values {
                let bits = index * self.bits..(index + 1) * self.bits;
                let value =
                    bits.fold(0_u16, |value, bit| value << 1 | u16::from(row[bit / 8] >> (7 - bit % 8) & 1));
                out.extend_from_slice(&value.to_le_bytes()[..bytes]);
            }
        }
        out
    }
}

/// Exactly `bytes` bytes; what is stored behind them does not count.
fn decompress(compression: Compression, stored: &[u8], bytes: usize) -> Option<Vec<u8>> {
    match compression {
        Compression::None => stored.get(..bytes).map(<[u8]>::to_vec),
        Compression::PackBits => unpack_bits(stored, bytes),
        // Not here.
        Compression::Jpeg | Compression::Jpeg2000 => None,
        Compression::Zstd => {
            let mut data = Vec::new();
            StreamingDecoder::new(stored).ok()?.take(bytes as u64).read_to_end(&mut data).ok()?;
            Some(data).filter(|data| data.len() == bytes)
        }
        Compression::Deflate => {
            let mut data = vec![0; bytes];
            ZlibDecoder::new(stored).read_exact(&mut data).ok()?;
            Some(data)
        }
        Compression::Lzw => {
            let mut decoder = LzwDecoder::with_tiff_size_switch(BitOrder::Msb, 8);
            let mut data = vec![0; bytes];
            let (mut read, mut written) = (0, 0);
            while written < bytes {
                let step = decoder.decode_bytes(&stored[read..], &mut data[written..]);
                if step.status.is_err() || step.consumed_in == 0 && step.consumed_out == 0 {
                    return None;
                }
                read += step.consumed_in;
                written += step.consumed_out;
            }
            Some(data)
        }
    }
}
