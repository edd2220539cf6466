//! Volumes whose slices arrive one after another, their number not known before, as a sequence of codestreams of a few
//! slices each: slabs.

use super::header::{Bytes, Fields, MAX_BYTES, Reader, SLABS};
use crate::{DecodeError, Extent, Header, Plan, PlanError, SampleType, Wavelet, max_encoded_len};

mod decoder;
mod encoder;

pub use decoder::SlabDecoder;
pub use encoder::SlabEncoder;

/// What a volume that arrives slice by slice is made of: wavelet, extent of a slab, levels, and type of the samples.
///
/// The last slab may have fewer slices, and then as many levels of these as its extent has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SlabPlan {
    plan: Plan,
    sample_type: SampleType,
    bytes: u32,
}

/// The memory in which slabs are coded, each slice of at least the length that [`SlabPlan`] says.
#[derive(Debug)]
pub struct SlabMemory<'a> {
    /// The samples of a slab: [`SlabPlan::samples_len`].
    pub samples: &'a mut [i32],
    /// [`SlabPlan::scratch_len`].
    pub scratch: &'a mut [i32],
    /// The codestream of a slab: [`SlabPlan::bytes_len`].
    pub bytes: &'a mut [u8],
}

impl SlabPlan {
    /// Slabs of `extent`, under `levels` levels of `wavelet`.
    ///
    /// # Errors
    /// Those of [`Plan::new`]; [`PlanError::ExtentTooLarge`] also for a slab of 4 GiB.
    pub const fn new(
        wavelet: Wavelet,
        extent: Extent,
        levels: u8,
        sample_type: SampleType,
    ) -> Result<Self, PlanError> {
        let plan = match Plan::new(wavelet, extent, levels) {
            Ok(plan) => plan,
            Err(error) => return Err(error),
        };
        #[expect(clippy::as_conversions, reason = "at most u32::MAX; TryFrom is not const")]
        match max_encoded_len(extent, sample_type) {
            Some(bytes) if bytes <= crate::extent::to_usize(u32::MAX) => {
                Ok(Self { plan, sample_type, bytes: bytes as u32 })
            }
            _ => Err(PlanError::ExtentTooLarge),
        }
    }

    /// Wavelet, extent and levels of a whole slab.
    #[must_use]
    pub const fn plan(&self) -> Plan {
        self.plan
    }

    /// The type of the samples.
    #[must_use]
    pub const fn sample_type(&self) -> SampleType {
        self.sample_type
    }

    /// `i32`s for the samples of a slab.
    #[must_use]
    pub const fn samples_len(&self) -> usize {
        self.plan.extent().samples()
    }

    /// `i32`s of scratch.
    #[must_use]
    pub const fn scratch_len(&self) -> usize {
        self.plan.scratch_len()
    }

    /// Bytes for the codestream of a slab.
    #[must_use]
    pub const fn bytes_len(&self) -> usize {
        crate::extent::to_usize(self.bytes)
    }

    /// Bytes that any stream of slabs begins with, at most.
    pub const MAX_HEADER_BYTES: usize = MAX_BYTES;

    /// Reads the header of a stream of slabs at the beginning of `bytes`; returns what it says and how long it is, at
    /// most [`SlabPlan::MAX_HEADER_BYTES`].
    ///
    /// # Errors
    /// [`DecodeError::Truncated`] if `bytes` ends first, [`DecodeError::OtherCodec`] if it is the header of a stream
    /// of rows, [`DecodeError::NotBuilt`] if this build lacks its wavelet; otherwise what is wrong with it.
    pub fn parse(bytes: &[u8]) -> Result<(Self, usize), DecodeError> {
        let mut reader = Reader::new(bytes);
        let Fields { sample_type, wavelet, levels } = reader.fields(SLABS)?;
        let axes = [reader.number()?, reader.number()?, reader.number()?];
        let extent = Extent::new(axes).map_err(PlanError::in_header)?;
        let plan = Self::new(wavelet.unwrap_or(Wavelet::Haar), extent, levels, sample_type);
        Ok((plan.map_err(PlanError::in_header)?, reader.taken()))
    }

    /// The header of a stream of such slabs.
    pub(super) fn header(&self) -> Bytes {
        let wavelet = (self.plan.levels() > 0).then(|| self.plan.wavelet());
        let fields = Fields { sample_type: self.sample_type, wavelet, levels: self.plan.levels() };
        fields.write(SLABS, &self.plan.extent().axes())
    }

    /// Samples of a slice.
    const fn slice(&self) -> usize {
        let [x, y, _] = self.plan.extent().axes();
        crate::extent::to_usize(x.wrapping_mul(y))
    }

    /// The plan of a slab of that many slices; `None` if none has.
    fn plan_of(&self, slices: u32) -> Option<Plan> {
        let [x, y, most] = self.plan.extent().axes();
        let extent = Extent::new([x, y, slices]).ok().filter(|_| slices <= most)?;
        Plan::new(self.plan.wavelet(), extent, self.plan.levels().min(extent.max_levels())).ok()
    }

    /// Whether a codestream is that of a slab; the number of its samples, if so.
    fn accept(&self, header: &Header) -> Option<usize> {
        let [_, _, slices] = header.plan().extent().axes();
        let fits = self.plan_of(slices) == Some(header.plan()) && header.sample_type() == self.sample_type;
        (fits && header.slack().is_none() && !header.is_dense()).then(|| header.plan().extent().samples())
    }
}
