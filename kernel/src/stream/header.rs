//! The first bytes of a stream. The format is in `docs/stream.md`.

use heapless::Vec;

use crate::{DecodeError, Malformed, SampleType, Wavelet};

/// The version of the format that this crate writes, and the only one it reads.
const VERSION: u8 = 2;

/// The first two bytes of every stream.
const MAGIC: [u8; 2] = *b"wS";

/// The kind of a stream of rows.
pub(super) const ROWS: u8 = 0;

/// The kind of a stream of slabs.
pub(super) const SLABS: u8 = 1;

/// Levels of a stream, at most.
pub(super) const MAX_LEVELS: u8 = 31;

/// Bytes of the longest header: magic, version, kind, type and wavelet, levels, and up to three numbers.
pub(super) const MAX_BYTES: usize = 6 + 3 * 5;

/// A header as bytes.
pub(super) type Bytes = Vec<u8, MAX_BYTES>;

/// The fields that every header has; numbers follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Fields {
    pub(super) sample_type: SampleType,
    /// None without levels.
    pub(super) wavelet: Option<Wavelet>,
    pub(super) levels: u8,
}

impl Fields {
    /// The fields and `numbers` as bytes.
    pub(super) fn write(&self, kind: u8, numbers: &[u32]) -> Bytes {
        let mut bytes = Bytes::new();
        let wavelet = self.wavelet.map_or(0, Wavelet::code);
        // No call fails: there is room for the longest header.
        let _ = bytes.extend_from_slice(&MAGIC);
        let _ =
            bytes.extend_from_slice(&[VERSION, kind, wavelet << 4 | self.sample_type.code(), self.levels]);
        for &number in numbers {
            push_number(number, |byte| {
                let _ = bytes.push(byte);
            });
        }
        bytes
    }
}

/// Gives a number as bytes, seven bits to each, least significant first.
pub(super) fn push_number(mut number: u32, mut push: impl FnMut(u8)) {
    loop {
        let [low, ..] = number.to_le_bytes();
        number >>= 7;
        push(if number == 0 { low } else { low | 0x80 });
        if number == 0 {
            return;
        }
    }
}

/// A number that arrives byte by byte.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Number {
    value: u32,
    shift: u32,
}

impl Number {
    /// Takes a byte; the number, if that was its last.
    pub(super) fn push(&mut self, byte: u8) -> Result<Option<u32>, Malformed> {
        let bits = u32::from(byte & 0x7F);
        let shifted = bits << self.shift;
        let is_last = byte & 0x80 == 0;
        if shifted >> self.shift != bits || (byte == 0 && self.shift > 0) || (!is_last && self.shift == 28) {
            return Err(Malformed::Number);
        }
        self.value |= shifted;
        self.shift = self.shift.wrapping_add(7);
        Ok(is_last.then_some(self.value))
    }
}

/// Takes fields from the beginning of a stream.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    bytes: &'a [u8],
    taken: usize,
}

impl<'a> Reader<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, taken: 0 }
    }

    /// Bytes read.
    pub(super) const fn taken(&self) -> usize {
        self.taken
    }

    fn byte(&mut self) -> Result<u8, DecodeError> {
        let byte = self.bytes.get(self.taken).copied().ok_or(DecodeError::Truncated)?;
        self.taken = self.taken.wrapping_add(1);
        Ok(byte)
    }

    pub(super) fn number(&mut self) -> Result<u32, DecodeError> {
        let mut number = Number::default();
        loop {
            if let Some(number) = number.push(self.byte()?)? {
                return Ok(number);
            }
        }
    }

    /// The fields of a stream of `kind`.
    pub(super) fn fields(&mut self, kind: u8) -> Result<Fields, DecodeError> {
        for expected in MAGIC {
            if self.byte()? != expected {
                return Err(DecodeError::NotACodestream);
            }
        }
        let found = self.byte()?;
        if found != VERSION {
            return Err(DecodeError::UnsupportedVersion { found });
        }
        match self.byte()? {
            found if found == kind => {}
            ROWS | SLABS => return Err(DecodeError::OtherCodec),
            _ => return Err(Malformed::Reserved.into()),
        }
        let byte = self.byte()?;
        let sample_type = SampleType::from_code(byte & 0xF).ok_or(Malformed::Reserved)?;
        let wavelet = match byte >> 4 {
            0 => None,
            code => Some(Wavelet::from_code(code).ok_or(Malformed::Reserved)?),
        };
        let levels = self.byte()?;
        if levels > MAX_LEVELS || (levels > 0) != wavelet.is_some() {
            return Err(Malformed::Levels.into());
        }
        Ok(Fields { sample_type, wavelet, levels })
    }
}
