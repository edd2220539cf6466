//! Bits, which fill bytes from the lowest to the highest.

use crate::oracle::coder::Reject;

/// Bits to read.
#[derive(Debug)]
pub struct BitReader<'a> {
    bytes: &'a [u8],
    read: usize,
}

impl<'a> BitReader<'a> {
    /// All bits of these bytes.
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, read: 0 }
    }

    /// The next bits, the lowest first.
    pub fn bits(&mut self, count: u32) -> Result<i64, Reject> {
        let mut value = 0;
        for place in 0..count {
            let byte = *self.bytes.get(self.read / 8).ok_or(Reject::Segment)?;
            value |= i64::from(byte >> (self.read % 8) & 1) << place;
            self.read += 1;
        }
        Ok(value)
    }

    /// The bytes after the last that was begun, whose other bits are zero.
    pub fn finish(mut self) -> Result<&'a [u8], Reject> {
        while !self.read.is_multiple_of(8) {
            if self.bits(1)? != 0 {
                return Err(Reject::Segment);
            }
        }
        Ok(&self.bytes[self.read / 8..])
    }
}

/// Bits to write.
#[derive(Debug, Default, Clone)]
pub struct BitWriter {
    /// The last one with zeros above.
    pub bytes: Vec<u8>,
    written: usize,
}

impl BitWriter {
    /// The low bits of a value, the lowest first.
    pub fn bits(&mut self, count: u32, value: i64) {
        for place in 0..count {
            if self.written.is_multiple_of(8) {
                self.bytes.push(0);
            }
            self.bytes[self.written / 8] |= ((value >> place & 1) as u8) << (self.written % 8);
            self.written += 1;
        }
    }
}
