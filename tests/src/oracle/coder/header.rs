//! The header: what the encoder chose, and how long the segments are.

use super::super::lifting::{Psi, max_levels};

/// What a decoder must reject, in the order of the table in the text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "named as in the table")]
pub enum Reject {
    Truncated,
    NotACodestream,
    UnsupportedVersion { found: u8 },
    Reserved,
    Number,
    Extent,
    Levels,
    StoredLength,
    Segment,
    Sample,
    TrailingBytes,
}

/// How the samples are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// As residuals under the models.
    Coded,
    /// As residuals in few decisions each.
    Light,
    /// As they are.
    Stored,
}

/// The type of the samples; `u32` travels as the same bits in an `i32`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "named as in Rust")]
pub enum SampleType {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
}

impl SampleType {
    /// Every type, in the order of their codes.
    pub const ALL: [Self; 6] = [Self::U8, Self::I8, Self::U16, Self::I16, Self::U32, Self::I32];

    /// Bytes of a sample.
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 => 4,
        }
    }

    /// Whether the type has this value.
    pub fn holds(self, value: i32) -> bool {
        self.value_of(&self.bytes_of(value)) == value
    }

    /// A sample, little-endian.
    pub fn bytes_of(self, value: i32) -> Vec<u8> {
        value.to_le_bytes()[..self.bytes()].to_vec()
    }

    /// The sample of which these are the bytes.
    pub fn value_of(self, bytes: &[u8]) -> i32 {
        match (self, bytes) {
            (Self::U8, &[b]) => i32::from(b),
            (Self::I8, &[b]) => i32::from(b as i8),
            (Self::U16, &[a, b]) => i32::from(u16::from_le_bytes([a, b])),
            (Self::I16, &[a, b]) => i32::from(i16::from_le_bytes([a, b])),
            (Self::U32 | Self::I32, &[a, b, c, d]) => i32::from_le_bytes([a, b, c, d]),
            _ => panic!("{self:?} has {} bytes", self.bytes()),
        }
    }
}

/// All that the header says but for the lengths of the segments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choices {
    /// How the samples are kept.
    pub storage: Storage,
    /// The type of the samples.
    pub sample_type: SampleType,
    /// The wavelet, if any.
    pub psi: Option<Psi>,
    /// Levels of the transform; 0 exactly if there is no wavelet.
    pub levels: usize,
    /// Samples along x, y, z.
    pub extent: [usize; 3],
}

impl Choices {
    /// Samples in all.
    pub fn places(&self) -> usize {
        self.extent.iter().product()
    }

    /// Whether the sums of predictions have 32 bits, or else 64.
    pub(super) const fn is_narrow(&self) -> bool {
        self.sample_type.bytes() < 4
    }

    /// The choices that remain after the `level` finest levels; without levels the wavelet changes nothing.
    pub(super) fn coarsened(&self, level: usize) -> Self {
        Self { extent: ceil_shift(self.extent, level), levels: self.levels - level, ..*self }
    }

    /// Whether extent and levels are possible and fit the wavelet.
    pub(super) fn check(&self) -> Result<(), Reject> {
        let places = self.extent.iter().try_fold(1_u64, |product, &n| product.checked_mul(n as u64));
        if !places.is_some_and(|places| (1..1 << 31).contains(&places)) {
            return Err(Reject::Extent);
        }
        if self.levels > max_levels(self.extent) || self.psi.is_some() != (self.levels > 0) {
            return Err(Reject::Levels);
        }
        Ok(())
    }

    fn segments(&self) -> usize {
        match self.storage {
            Storage::Coded | Storage::Light => self.levels + 1,
            Storage::Stored => 1,
        }
    }
}

/// E(l) of the text: ceil(n / 2^l) along each axis.
pub(super) fn ceil_shift(extent: [usize; 3], level: usize) -> [usize; 3] {
    extent.map(|n| n.div_ceil(1 << level))
}

/// A header, read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    /// What the encoder chose.
    pub choices: Choices,
    /// Bytes of the header itself.
    pub bytes: usize,
    /// Bytes of each segment.
    pub lengths: Vec<usize>,
}

impl Header {
    /// Reads and checks the header at the beginning of `bytes`.
    pub fn parse(bytes: &[u8]) -> Result<Self, Reject> {
        let mut fields = Fields { bytes, read: 0 };
        for expected in [0x77, 0x4C] {
            if fields.byte()? != expected {
                return Err(Reject::NotACodestream);
            }
        }
        match fields.byte()? {
            2 => {}
            found => return Err(Reject::UnsupportedVersion { found }),
        }
        let storage = match fields.byte()? {
            0 => Storage::Coded,
            5 => Storage::Light,
            0x80 => Storage::Stored,
            _ => return Err(Reject::Reserved),
        };
        let (sample_type, psi) = type_and_wavelet(fields.byte()?)?;
        let levels = usize::from(fields.byte()?);
        let extent = [fields.number()?, fields.number()?, fields.number()?];
        let choices = Choices { storage, sample_type, psi, levels, extent };
        choices.check()?;
        let lengths = (0..choices.segments()).map(|_| fields.number()).collect::<Result<Vec<_>, _>>()?;
        if storage == Storage::Stored && lengths[0] != choices.places() * sample_type.bytes() {
            return Err(Reject::StoredLength);
        }
        Ok(Self { choices, bytes: fields.read, lengths })
    }

    /// Bytes of the whole codestream.
    pub fn total_bytes(&self) -> usize {
        self.bytes + self.lengths.iter().sum::<usize>()
    }

    /// The segments that `level` needs.
    pub(super) fn segments<'a>(&self, bytes: &'a [u8], level: usize) -> Result<Vec<&'a [u8]>, Reject> {
        let needed = self.choices.coarsened(level).segments();
        let mut start = self.bytes;
        let segment = |&length: &usize| {
            start += length;
            bytes.get(start - length..start).ok_or(Reject::Truncated)
        };
        self.lengths[..needed].iter().map(segment).collect()
    }
}

/// The bytes of a header.
pub(super) fn write(choices: &Choices, lengths: &[usize]) -> Vec<u8> {
    let storage = match choices.storage {
        Storage::Coded => 0,
        Storage::Light => 5,
        Storage::Stored => 0x80,
    };
    let sample_type = SampleType::ALL.iter().position(|&t| t == choices.sample_type).expect("all are listed");
    let psi = Psi::ALL.iter().position(|&psi| Some(psi) == choices.psi).map_or(0, |position| position + 1);
    let mut bytes = vec![0x77, 0x4C, 2, storage, (psi << 4 | sample_type) as u8, choices.levels as u8];
    bytes.extend(choices.extent.iter().flat_map(|&samples| number_bytes(samples)));
    bytes.extend(lengths.iter().flat_map(|&length| number_bytes(length)));
    bytes
}

pub(super) fn type_and_wavelet(byte: u8) -> Result<(SampleType, Option<Psi>), Reject> {
    let sample_type = SampleType::ALL.get(usize::from(byte & 0x0F)).ok_or(Reject::Reserved)?;
    let psi = match usize::from(byte >> 4) {
        0 => None,
        code => Some(*Psi::ALL.get(code - 1).ok_or(Reject::Reserved)?),
    };
    Ok((*sample_type, psi))
}

/// Seven bits to a byte, least significant first; all but the last have the top bit set.
pub(in crate::oracle) fn number_bytes(number: usize) -> Vec<u8> {
    if number < 128 {
        return vec![number as u8];
    }
    let mut bytes = vec![(number % 128) as u8 | 0x80];
    bytes.extend(number_bytes(number / 128));
    bytes
}

pub(super) struct Fields<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) read: usize,
}

impl Fields<'_> {
    pub(super) fn byte(&mut self) -> Result<u8, Reject> {
        let byte = *self.bytes.get(self.read).ok_or(Reject::Truncated)?;
        self.read += 1;
        Ok(byte)
    }

    pub(super) fn number(&mut self) -> Result<usize, Reject> {
        let mut number = 0;
        for place in 0..5 {
            let byte = self.byte()?;
            number |= usize::from(byte & 0x7F) << (7 * place);
            if byte & 0x80 == 0 {
                let shortest = byte != 0 || place == 0;
                return if shortest && number < 1 << 32 { Ok(number) } else { Err(Reject::Number) };
            }
        }
        Err(Reject::Number)
    }
}
