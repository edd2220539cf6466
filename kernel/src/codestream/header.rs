//! The header of a codestream: its fields, checked once when parsed. The format is in `docs/codestream.md`.

use heapless::Vec;

use crate::coder::{IN_PLANE, LARGEST_WEIGHT, Predictor, WEIGHTS, Weights};
use crate::extent::to_usize;
use crate::memory::copy;
use crate::{DecodeError, Extent, Malformed, Plan, SampleType, Wavelet};

/// The version of the format that this crate writes, and the only one it reads.
pub(crate) const VERSION: u8 = 1;

/// The first two bytes of every codestream.
pub(crate) const MAGIC: [u8; 2] = *b"wL";

/// Segments of a codestream: one per resolution of the longest extent there is, 2^31 - 1 samples in a line.
const MAX_SEGMENTS: usize = 32;

/// Bytes of a number in its longest form.
const NUMBER_BYTES: usize = 5;

/// Bytes of each segment, coarse to fine.
pub(super) type Segments = Vec<u32, MAX_SEGMENTS>;

/// How the samples are held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) enum Storage {
    /// As coefficients, one segment per resolution; the low-pass part is predicted.
    Coded(Predictor),
    /// As they are, little-endian, in one segment.
    Stored,
}

/// What a codestream holds, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Header {
    pub(super) sample_type: SampleType,
    pub(super) plan: Plan,
    pub(super) storage: Storage,
    /// Bytes of each segment, coarse to fine.
    pub(super) segments: Segments,
    header_bytes: u32,
}

impl Header {
    /// Bytes of the longest header there is.
    pub const MAX_BYTES: usize = MAX_HEADER_BYTES;

    /// Reads and checks the header at the beginning of `bytes`; what follows it is not looked at.
    ///
    /// # Errors
    /// [`DecodeError::Truncated`] if `bytes` ends first; otherwise what is wrong with the header.
    pub fn parse(bytes: &[u8]) -> Result<Self, DecodeError> {
        let mut fields = Fields { bytes, taken: 0 };
        for expected in MAGIC {
            if fields.byte()? != expected {
                return Err(DecodeError::NotACodestream);
            }
        }
        let found = fields.byte()?;
        if found != VERSION {
            return Err(DecodeError::UnsupportedVersion { found });
        }
        let storage = fields.storage()?;
        let (sample_type, wavelet) = fields.sample_type_and_wavelet()?;
        let plan = fields.plan(wavelet)?;
        let storage = fields.weights(storage, &plan)?;
        let mut segments = Segments::new();
        let count = if storage == Storage::Stored { 1 } else { plan.levels().wrapping_add(1) };
        for _ in 0..count {
            // A plan has at most 31 levels, so the list cannot overflow.
            let _ = segments.push(fields.number()?);
        }
        let header = Self { sample_type, plan, storage, segments, header_bytes: fields.taken };
        if storage == Storage::Stored && header.segments.first() != stored_bytes(&plan, sample_type).as_ref()
        {
            return Err(Malformed::StoredLength.into());
        }
        Ok(header)
    }

    /// The type of the samples.
    #[must_use]
    pub const fn sample_type(&self) -> SampleType {
        self.sample_type
    }

    /// Wavelet, extent and levels.
    #[must_use]
    pub const fn plan(&self) -> Plan {
        self.plan
    }

    /// Whether the samples are stored as they are, because coding would not have made them shorter.
    #[must_use]
    pub const fn is_stored(&self) -> bool {
        matches!(self.storage, Storage::Stored)
    }

    /// Bytes of the whole codestream, header included.
    #[must_use]
    pub fn encoded_bytes(&self) -> u64 {
        self.bytes_to_level(0)
    }

    /// Bytes from the beginning of the codestream that decode to `level`: 0 is full resolution, level L has
    /// ceil(n / 2^L) samples along each axis. Levels beyond the coarsest count as the coarsest.
    #[must_use]
    pub fn bytes_to_level(&self, level: u8) -> u64 {
        let segments =
            if self.is_stored() { 1 } else { self.plan.levels().saturating_sub(level).saturating_add(1) };
        let payload = self.segments.iter().take(usize::from(segments)).map(|&bytes| u64::from(bytes));
        payload.fold(u64::from(self.header_bytes), u64::saturating_add)
    }

    /// `i32`s that [`Codec::decode_to_level`](crate::Codec::decode_to_level) needs for its samples: those of the
    /// level, but all of them for a codestream that holds its samples as they are.
    #[must_use]
    pub const fn samples_len(&self, level: u8) -> usize {
        self.plan.coarsened(if self.is_stored() { 0 } else { level }).extent().samples()
    }

    /// Samples per axis at `level`.
    #[must_use]
    pub const fn extent_at(&self, level: u8) -> Extent {
        self.plan.extent().coarsened(level)
    }
}

/// Bytes of stored samples; `None` if a segment cannot be that long.
pub(super) fn stored_bytes(plan: &Plan, sample_type: SampleType) -> Option<u32> {
    u32::try_from(plan.extent().samples().checked_mul(sample_type.bytes())?).ok()
}

/// Weights in a header: those of the first plane, and those of the others if the low-pass part has any.
const fn weights_len(plan: &Plan) -> usize {
    let [_, _, depth] = plan.extent().coarsened(plan.levels()).axes();
    if depth > 1 { IN_PLANE + WEIGHTS } else { IN_PLANE }
}

/// A weight as a number: 0, 1, 2, 3, 4, … for 0, -1, 1, -2, 2, …
fn weight_number(weight: i16) -> u32 {
    u32::from(weight.unsigned_abs()).wrapping_mul(2).wrapping_sub(u32::from(weight < 0))
}

/// Takes fields from the beginning of a codestream.
struct Fields<'a> {
    bytes: &'a [u8],
    taken: u32,
}

impl Fields<'_> {
    fn byte(&mut self) -> Result<u8, DecodeError> {
        let (&byte, rest) = self.bytes.split_first().ok_or(DecodeError::Truncated)?;
        self.bytes = rest;
        self.taken = self.taken.wrapping_add(1);
        Ok(byte)
    }

    /// A number of up to 32 bits, seven to a byte, least significant first, in its shortest form.
    fn number(&mut self) -> Result<u32, DecodeError> {
        let mut number = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            let bits = u32::from(byte & 0x7F);
            if (bits << shift) >> shift != bits || (byte == 0 && shift > 0) {
                return Err(Malformed::Number.into());
            }
            number |= bits << shift;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
        }
        Err(Malformed::Number.into())
    }

    /// How the samples are held; the weights of a trained predictor follow later.
    fn storage(&mut self) -> Result<Storage, DecodeError> {
        Ok(match self.byte()? {
            STORED => Storage::Stored,
            Predictor::TRAINED => Storage::Coded(Predictor::Trained(Weights::ZERO)),
            code => Storage::Coded(Predictor::from_code(code).ok_or(Malformed::Reserved)?),
        })
    }

    /// `storage` with the weights that it promises.
    fn weights(&mut self, mut storage: Storage, plan: &Plan) -> Result<Storage, DecodeError> {
        if let Storage::Coded(Predictor::Trained(weights)) = &mut storage {
            for weight in weights.first.iter_mut().chain(&mut weights.rest).take(weights_len(plan)) {
                *weight = self.weight()?;
            }
        }
        Ok(storage)
    }

    /// A weight; see [`weight_number`].
    fn weight(&mut self) -> Result<i16, DecodeError> {
        let number = self.number()?;
        let magnitude = i16::try_from(number.div_ceil(2)).map_err(|_| Malformed::Weight)?;
        if magnitude > LARGEST_WEIGHT {
            return Err(Malformed::Weight.into());
        }
        Ok(if number % 2 == 1 { magnitude.wrapping_neg() } else { magnitude })
    }

    /// The type in the low half of the byte, the wavelet in the high half: 0 for none.
    fn sample_type_and_wavelet(&mut self) -> Result<(SampleType, Option<Wavelet>), DecodeError> {
        let byte = self.byte()?;
        let sample_type = SampleType::from_code(byte & 0xF).ok_or(Malformed::Reserved)?;
        let wavelet = match byte >> 4 {
            0 => None,
            code => Some(Wavelet::from_code(code).ok_or(Malformed::Reserved)?),
        };
        Ok((sample_type, wavelet))
    }

    fn plan(&mut self, wavelet: Option<Wavelet>) -> Result<Plan, DecodeError> {
        let levels = self.byte()?;
        let axes = [self.number()?, self.number()?, self.number()?];
        let extent = Extent::new(axes).map_err(|_| Malformed::Extent)?;
        if (levels > 0) != wavelet.is_some() {
            return Err(Malformed::Levels.into());
        }
        Plan::new(wavelet.unwrap_or(NO_WAVELET), extent, levels).map_err(|_| Malformed::Levels.into())
    }
}

/// The wavelet that a plan without levels is given.
const NO_WAVELET: Wavelet = Wavelet::Haar;

/// The storage field of stored samples.
const STORED: u8 = 0x80;

/// Bytes of the longest header: the fixed fields, the extent, weights of up to two bytes, a length per segment.
const MAX_HEADER_BYTES: usize =
    MAGIC.len() + 4 + NUMBER_BYTES * (3 + MAX_SEGMENTS) + 2 * (IN_PLANE + WEIGHTS);

/// Bytes of the longest header with one segment.
pub(super) const MAX_STORED_HEADER_BYTES: usize = MAGIC.len() + 4 + NUMBER_BYTES * (3 + 1);

type Bytes = Vec<u8, MAX_HEADER_BYTES>;

impl Header {
    /// A header of the given segments.
    pub(super) fn new(sample_type: SampleType, plan: Plan, storage: Storage, segments: Segments) -> Self {
        let mut header = Self { sample_type, plan, storage, segments, header_bytes: 0 };
        header.header_bytes = header.to_bytes().len().try_into().unwrap_or(u32::MAX);
        header
    }

    /// A header of samples stored as they are; `None` if a segment cannot be that long.
    pub(super) fn stored(plan: &Plan, sample_type: SampleType) -> Option<Self> {
        let mut segments = Segments::new();
        segments.push(stored_bytes(plan, sample_type)?).ok()?;
        Some(Self::new(sample_type, *plan, Storage::Stored, segments))
    }

    /// Bytes before the first segment.
    pub(super) fn header_len(&self) -> usize {
        to_usize(self.header_bytes)
    }

    /// [`Header::bytes_to_level`], or the largest `usize`.
    pub(super) fn len_to_level(&self, level: u8) -> usize {
        usize::try_from(self.bytes_to_level(level)).unwrap_or(usize::MAX)
    }

    /// [`Header::encoded_bytes`], or the largest `usize`.
    pub(super) fn total_len(&self) -> usize {
        self.len_to_level(0)
    }

    /// Writes the header to the beginning of `out`, which has room for it.
    pub(super) fn write(&self, out: &mut [u8]) {
        let bytes = self.to_bytes();
        if let Some(out) = out.get_mut(..bytes.len()) {
            copy(&bytes, out);
        }
    }

    /// The header as bytes.
    fn to_bytes(&self) -> Bytes {
        let mut bytes = Bytes::new();
        let plan = &self.plan;
        let storage = match self.storage {
            Storage::Coded(predictor) => predictor.code(),
            Storage::Stored => STORED,
        };
        let wavelet = if plan.levels() == 0 { 0 } else { plan.wavelet().code() };
        let fixed = [VERSION, storage, wavelet << 4 | self.sample_type.code(), plan.levels()];
        // Neither call can fail: `Bytes` holds the longest header.
        let _ = bytes.extend_from_slice(&MAGIC);
        let _ = bytes.extend_from_slice(&fixed);
        for number in plan.extent().axes() {
            push_number(&mut bytes, number);
        }
        if let Storage::Coded(Predictor::Trained(weights)) = &self.storage {
            for &weight in weights.first.iter().chain(&weights.rest).take(weights_len(plan)) {
                push_number(&mut bytes, weight_number(weight));
            }
        }
        for &number in &self.segments {
            push_number(&mut bytes, number);
        }
        bytes
    }
}

fn push_number(bytes: &mut Bytes, mut number: u32) {
    loop {
        let [low, ..] = number.to_le_bytes();
        number >>= 7;
        let _ = bytes.push(if number == 0 { low } else { low | 0x80 });
        if number == 0 {
            return;
        }
    }
}
