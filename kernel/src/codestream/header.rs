//! The header of a codestream: its fields, checked once when parsed. The format is in `docs/codestream.md`.

use heapless::Vec;

use crate::coder::{LARGEST_SLACK, SHRINKING, tabled};
use crate::extent::to_usize;
use crate::{DecodeError, Dense, Extent, Feature, Lattice, Malformed, Plan, PlanError, SampleType, Wavelet};

/// The version of the format that this crate writes, and the only one it reads.
pub(crate) const VERSION: u8 = 2;

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
    /// As coefficients, one segment per resolution.
    Coded,
    /// The same, in few decisions each.
    Light,
    /// Under what is learnt from all samples before, in one segment.
    Dense,
    /// Under weights and tables that it brings, in one segment.
    Tabled(tabled::Form),
    /// As they are, little-endian, in one segment.
    Stored,
    /// As residuals of finer and finer lattices, one segment per lattice: no further off than `slack`, in steps that
    /// shrink from level to level by rule `shrinking`.
    Lattice { slack: u32, shrinking: u8 },
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
    /// [`DecodeError::Truncated`] if `bytes` ends first; [`DecodeError::NotBuilt`] if this build lacks what the header
    /// names; otherwise what is wrong with the header.
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
        let plan = fields.plan(wavelet, storage)?;
        if matches!(storage, Storage::Dense | Storage::Tabled(_)) && plan.levels() > 0 {
            return Err(Malformed::Levels.into());
        }
        let storage = fields.precision(storage)?;
        let mut segments = Segments::new();
        let count = if matches!(storage, Storage::Stored) { 1 } else { plan.levels().wrapping_add(1) };
        for _ in 0..count {
            // A plan has at most 31 levels, so the list cannot overflow.
            let _ = segments.push(fields.number()?);
        }
        let header = Self { sample_type, plan, storage, segments, header_bytes: fields.taken };
        if header.is_stored() && header.segments.first() != stored_bytes(&plan, sample_type).as_ref() {
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

    /// Whether the codestream is dense: [`Codec::decode_dense`](crate::Codec::decode_dense) decodes it.
    #[must_use]
    pub const fn is_dense(&self) -> bool {
        matches!(self.storage, Storage::Dense)
    }

    /// `i32`s of scratch that decoding takes.
    #[must_use]
    pub const fn scratch_len(&self) -> usize {
        match self.storage {
            Storage::Dense => Dense::scratch_len(&self.plan),
            Storage::Lattice { .. } => Lattice::decoding_scratch_len(self.plan.extent()),
            Storage::Coded | Storage::Light | Storage::Tabled(_) | Storage::Stored => self.plan.scratch_len(),
        }
    }

    /// How far a sample may be off, for a codestream of [`Lattice`](crate::Lattice); `None` for any other. Its plan has
    /// levels but no wavelet: level L holds every 2^L-th sample along each axis.
    #[must_use]
    pub const fn slack(&self) -> Option<u32> {
        match self.storage {
            Storage::Lattice { slack, .. } => Some(slack),
            _ => None,
        }
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

    /// How the samples are held.
    fn storage(&mut self) -> Result<Storage, DecodeError> {
        match self.byte()? {
            STORED => Ok(Storage::Stored),
            CODED if !Feature::Adaptive.is_built() => Err(DecodeError::NotBuilt(Feature::Adaptive)),
            CODED => Ok(Storage::Coded),
            DENSE if !Feature::Dense.is_built() => Err(DecodeError::NotBuilt(Feature::Dense)),
            DENSE => Ok(Storage::Dense),
            LATTICE if !Feature::Lattice.is_built() => Err(DecodeError::NotBuilt(Feature::Lattice)),
            TABLED => Ok(Storage::Tabled(tabled::Form::Narrow)),
            WIDE => Ok(Storage::Tabled(tabled::Form::Wide)),
            CELLED => Ok(Storage::Tabled(tabled::Form::Celled)),
            LIGHT if !Feature::Light.is_built() => Err(DecodeError::NotBuilt(Feature::Light)),
            LIGHT => Ok(Storage::Light),
            LATTICE => Ok(Storage::Lattice { slack: 0, shrinking: 0 }),
            _ => Err(Malformed::Reserved.into()),
        }
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

    /// What a lattice has besides: its slack and how its steps shrink.
    fn precision(&mut self, storage: Storage) -> Result<Storage, DecodeError> {
        let Storage::Lattice { .. } = storage else { return Ok(storage) };
        if !Feature::Lattice.is_built() {
            return Ok(storage);
        }
        let (slack, shrinking) = (self.number()?, self.byte()?);
        if slack > LARGEST_SLACK || usize::from(shrinking) >= SHRINKING.len() {
            return Err(Malformed::Reserved.into());
        }
        Ok(Storage::Lattice { slack, shrinking })
    }

    fn plan(&mut self, wavelet: Option<Wavelet>, storage: Storage) -> Result<Plan, DecodeError> {
        let levels = self.byte()?;
        let axes = [self.number()?, self.number()?, self.number()?];
        let extent = Extent::new(axes).map_err(PlanError::in_header)?;
        let is_lattice = matches!(storage, Storage::Lattice { .. });
        if (levels > 0 && !is_lattice) != wavelet.is_some() {
            return Err(Malformed::Levels.into());
        }
        if is_lattice {
            return Plan::without_wavelet(extent, levels).ok_or(Malformed::Levels.into());
        }
        Plan::new(wavelet.unwrap_or(NO_WAVELET), extent, levels).map_err(PlanError::in_header)
    }
}

/// The wavelet that a plan without levels is given.
const NO_WAVELET: Wavelet = Wavelet::Haar;

/// The storage field of coefficients.
const CODED: u8 = 0;

/// The storage field of dense samples.
const DENSE: u8 = 1;

/// The storage field of samples under tables.
const TABLED: u8 = 3;

/// The storage field of samples under tables, predicted from more neighbours.
const WIDE: u8 = 4;

/// The storage field of samples under tables, predicted from more neighbours by the weights of each cell.
const CELLED: u8 = 6;

/// The storage field of coefficients in few decisions each.
const LIGHT: u8 = 5;

/// The storage field of a lattice.
const LATTICE: u8 = 2;

/// The storage field of stored samples.
const STORED: u8 = 0x80;

/// Bytes of the longest header: the fixed fields, the extent, a length per segment.
const MAX_HEADER_BYTES: usize = MAGIC.len() + 4 + NUMBER_BYTES * (3 + MAX_SEGMENTS) + PRECISION_BYTES;

/// Bytes of the slack of a lattice in its longest form, and of how its steps shrink.
const PRECISION_BYTES: usize = NUMBER_BYTES + 1;

/// Bytes of the longest header with one segment.
pub(super) const MAX_STORED_HEADER_BYTES: usize = MAGIC.len() + 4 + NUMBER_BYTES * (3 + 1);

/// Where a header is written: bytes beyond the end are only counted.
struct Bytes<'a> {
    out: &'a mut [u8],
    len: usize,
}

impl Header {
    /// A header of the given segments.
    pub(super) fn new(sample_type: SampleType, plan: Plan, storage: Storage, segments: Segments) -> Self {
        let mut header = Self { sample_type, plan, storage, segments, header_bytes: 0 };
        header.header_bytes = header.write(&mut []).try_into().unwrap_or(u32::MAX);
        header
    }

    /// A header of samples stored as they are; `None` if a segment cannot be that long.
    pub(super) fn stored(plan: &Plan, sample_type: SampleType) -> Option<Self> {
        let mut segments = Segments::new();
        segments.push(stored_bytes(plan, sample_type)?).ok()?;
        Some(Self::new(sample_type, *plan, Storage::Stored, segments))
    }

    /// Bytes before the first segment.
    pub(crate) fn header_len(&self) -> usize {
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

    /// Writes as much of the header as fits to the beginning of `out`, and returns its length.
    pub(super) fn write(&self, out: &mut [u8]) -> usize {
        let mut bytes = Bytes { out, len: 0 };
        let plan = &self.plan;
        let storage = match self.storage {
            Storage::Coded => CODED,
            Storage::Light => LIGHT,
            Storage::Dense => DENSE,
            Storage::Tabled(tabled::Form::Narrow) => TABLED,
            Storage::Tabled(tabled::Form::Wide) => WIDE,
            Storage::Tabled(tabled::Form::Celled) => CELLED,
            Storage::Stored => STORED,
            Storage::Lattice { .. } => LATTICE,
        };
        let is_lattice = matches!(self.storage, Storage::Lattice { .. });
        let wavelet = if plan.levels() == 0 || is_lattice { 0 } else { plan.wavelet().code() };
        let [first, second] = MAGIC;
        let kind = wavelet << 4 | self.sample_type.code();
        for byte in &[first, second, VERSION, storage, kind, plan.levels()] {
            bytes.push(*byte);
        }
        for axis in &plan.extent().axes() {
            bytes.push_number(*axis);
        }
        if let Storage::Lattice { slack, shrinking } = self.storage {
            bytes.push_number(slack);
            bytes.push(shrinking);
        }
        self.segments.iter().for_each(|&number| bytes.push_number(number));
        bytes.len
    }
}

impl Bytes<'_> {
    #[cfg_attr(feature = "small", inline(never))]
    fn push(&mut self, byte: u8) {
        if let Some(slot) = self.out.get_mut(self.len) {
            *slot = byte;
        }
        self.len = self.len.wrapping_add(1);
    }

    fn push_number(&mut self, mut number: u32) {
        loop {
            let [low, ..] = number.to_le_bytes();
            number >>= 7;
            self.push(if number == 0 { low } else { low | 0x80 });
            if number == 0 {
                return;
            }
        }
    }
}
