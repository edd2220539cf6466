//! Encoding and decoding of one line, slice or brick.

use super::header::{Header, MAX_STORED_HEADER_BYTES, Storage};
use super::segments::SegmentWriter;
use super::stored::{Stored, restore};
use crate::coder::{Coefficients, Dense, Encoder, Memory, Models, Predictor, Training, described, tabled};
use crate::error::{at_least, exactly};
use crate::extent::to_usize;
use crate::{DecodeError, EncodeError, Extent, Feature, Malformed, Plan, SampleType, Slice};

/// Bytes that always suffice for a codestream of `extent` samples of `sample_type`, whatever their values, wavelet
/// and levels: the samples as they are and a header. `None` if they are 4 GiB or more, which no segment holds.
#[must_use]
pub const fn max_encoded_len(extent: Extent, sample_type: SampleType) -> Option<usize> {
    match extent.samples().checked_mul(sample_type.bytes()) {
        Some(samples) if samples <= to_usize(u32::MAX) => samples.checked_add(MAX_STORED_HEADER_BYTES),
        _ => None,
    }
}

/// The state of encoder and decoder: the adaptive models, of fixed size, for the caller to keep where there is room.
///
/// Every call starts from the same models, so one `Codec` serves any number of codestreams, and what it did before
/// never shows in the bytes.
#[derive(Debug, PartialEq, Eq)]
pub struct Codec {
    pub(super) memory: Memory,
}

/// How much an encoder tries to make codestreams short.
#[derive(Debug)]
pub enum Effort<'a> {
    /// Few decisions a sample and little memory, for processors to which every instruction counts; nearly as short as
    /// [`Effort::Fast`].
    Light,
    /// Predictions and tables of frequencies that the codestream brings, for plans without levels and bricks or slices
    /// of 2^14 samples or more that span at most 19 bits: the quickest both ways. As [`Effort::Fast`] for others.
    Tabled,
    /// As [`Effort::Tabled`], with predictions from as many samples as [`Effort::Default`], trained in memory lent by the
    /// caller, of slices several that suit parts of them, for samples that span at most 16 bits: about as short as that,
    /// and much quicker. As [`Effort::Default`] for others.
    Wide(&'a mut Training),
    /// Predictors without weights.
    Fast,
    /// Predictors trained on the samples, in memory lent by the caller.
    Default(&'a mut Training),
    /// Under what is learnt from all samples before, for plans without levels and samples that span at most 25 bits:
    /// the shortest, and by far the slowest both ways. As [`Effort::Default`] for others.
    ///
    /// [`Codec::decode_dense`] decodes what this encodes.
    Dense(&'a mut Dense, &'a mut Training),
}

impl Effort<'_> {
    /// `i32`s of scratch that encoding takes.
    #[must_use]
    pub const fn scratch_len(&self, plan: &Plan) -> usize {
        if let Self::Dense(..) = self { Dense::scratch_len(plan) } else { plan.scratch_len() }
    }

    /// Whether it has weights.
    const fn trains(&self) -> bool {
        Feature::Trained.is_built() && !matches!(self, Self::Light | Self::Tabled | Self::Fast)
    }

    /// What tabled codestreams predict from, if it writes any.
    const fn tabled(&mut self) -> Option<tabled::Means<'_>> {
        match self {
            Self::Tabled => Some(tabled::Means::Narrow),
            Self::Wide(training) if Feature::Trained.is_built() => Some(tabled::Means::Wide(training)),
            _ => None,
        }
    }

    /// The same, with its memory lent on.
    #[cfg(feature = "slabs")]
    pub(crate) const fn lend(&mut self) -> Effort<'_> {
        match self {
            Self::Light => Effort::Light,
            Self::Tabled => Effort::Tabled,
            Self::Wide(training) => Effort::Wide(training),
            Self::Fast => Effort::Fast,
            Self::Default(training) => Effort::Default(training),
            Self::Dense(dense, training) => Effort::Dense(dense, training),
        }
    }

    /// What it takes that this build has not.
    pub(crate) const fn missing(&self) -> Option<Feature> {
        match self {
            Self::Light if !Feature::Light.is_built() => Some(Feature::Light),
            Self::Fast if !Feature::Adaptive.is_built() => Some(Feature::Adaptive),
            Self::Default(_) if !Feature::Trained.is_built() => Some(Feature::Trained),
            Self::Dense(..) if !Feature::Dense.is_built() => Some(Feature::Dense),
            Self::Wide(_) if !Feature::Trained.is_built() => Some(Feature::Trained),
            Self::Tabled | Self::Wide(_) if !Feature::Tabled.is_built() => Some(Feature::Tabled),
            _ => None,
        }
    }
}

impl Codec {
    /// A codec that can be the value of a `static`.
    pub const NEW: Self = Self { memory: Memory::NEW };

    /// Makes `self` equal to [`Codec::NEW`].
    pub fn reset(&mut self) {
        self.memory = Memory::NEW;
    }

    /// Encodes `samples` (x fastest) into the beginning of `out` and returns the length of the codestream.
    ///
    /// `samples` is used up: what it holds afterwards has no meaning. An `out` of [`max_encoded_len`] bytes always
    /// suffices; a shorter one does if the codestream happens to fit.
    ///
    /// # Errors
    /// [`EncodeError::Length`] if `samples` is not exactly the extent or `scratch` is shorter than
    /// [`Effort::scratch_len`]; [`EncodeError::SampleOutOfRange`] if a sample is outside `sample_type`;
    /// [`EncodeError::NotBuilt`] if this build lacks the effort; [`EncodeError::OutputFull`] if `out` is too short;
    /// `samples` are what they were then.
    #[expect(clippy::too_many_arguments, reason = "what to code, how, and the memory to do it in")]
    // Where the effort is known, what the others take is left out of the program.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub fn encode(
        &mut self,
        effort: Effort<'_>,
        plan: &Plan,
        sample_type: SampleType,
        samples: &mut [i32],
        scratch: &mut [i32],
        out: &mut [u8],
    ) -> Result<usize, EncodeError> {
        if let Some(part) = effort.missing() {
            return Err(EncodeError::NotBuilt(part));
        }
        exactly(Slice::Samples, plan.extent().samples(), samples.len())?;
        at_least(Slice::Scratch, effort.scratch_len(plan), scratch.len())?;
        if let Some(index) = sample_type.first_outside(samples) {
            return Err(EncodeError::SampleOutOfRange { index });
        }
        plan.forward(samples, scratch)?;
        let stored = Stored::new(plan, sample_type);
        let mut coefficients = Coefficients { plan: *plan, samples, scratch, wide: sample_type.bytes() > 2 };
        match self.encode_coefficients(effort, sample_type, &mut coefficients, stored.room(out)) {
            Ok(len) => return Ok(len),
            Err(Full { transformed }) => {
                for level in (0..transformed).rev() {
                    plan.inverse_level(level, samples, scratch);
                }
            }
        }
        stored.write(samples, out)
    }

    /// Codes every resolution into `out`, and undoes the transform as far as that takes.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn encode_coefficients(
        &mut self,
        mut effort: Effort<'_>,
        sample_type: SampleType,
        coefficients: &mut Coefficients<'_>,
        out: &mut [u8],
    ) -> Result<usize, Full> {
        let plan = coefficients.plan;
        if Feature::Light.is_built() && matches!(effort, Effort::Light) {
            let len = self.encode_light(sample_type, coefficients, out);
            return len.ok_or(Full { transformed: plan.levels() });
        }
        if Feature::Dense.is_built()
            && let Effort::Dense(dense, _) = &mut effort
            && plan.levels() == 0
            && Dense::suits(coefficients.samples)
        {
            let mut writer = SegmentWriter::new(sample_type, plan, Storage::Dense, out);
            let Coefficients { samples, scratch, .. } = coefficients;
            let coded =
                writer.push(|encoder| dense.code(encoder, plan.extent(), sample_type, samples, scratch));
            return coded.and_then(|()| writer.finish()).ok_or(Full { transformed: 0 });
        }
        if Feature::Tabled.is_built()
            && let Some(means) = effort.tabled()
            && plan.levels() == 0
            && let Some(span) = means.suit(plan.extent(), coefficients.samples)
        {
            let storage = Storage::Tabled(means.form());
            let mut writer = SegmentWriter::new(sample_type, plan, storage, out);
            let Coefficients { samples, scratch, .. } = coefficients;
            let brick = (plan.extent(), span);
            let coded =
                writer.push_only(|out| tabled::encode(&mut self.memory, means, brick, samples, scratch, out));
            return coded.and_then(|()| writer.finish()).ok_or(Full { transformed: 0 });
        }
        let mut writer = SegmentWriter::new(sample_type, plan, Storage::Coded, out);
        let models = self.memory.models().ok_or(Full { transformed: plan.levels() })?;
        let mut transformed = plan.levels();
        for resolution in 0..=plan.levels() {
            let coded = writer.push(|encoder| code(encoder, models, &mut effort, coefficients, resolution));
            coded.ok_or(Full { transformed })?;
            // Only trained predictors look at the low-pass part of a level.
            if effort.trains() {
                coefficients.undo_resolution(resolution);
                transformed = plan.levels().saturating_sub(resolution);
            }
        }
        writer.finish().ok_or(Full { transformed })
    }

    /// Decodes a whole codestream into `samples`, x fastest.
    ///
    /// # Errors
    /// [`DecodeError::Length`] if `samples` is not exactly the extent or `scratch` is shorter than
    /// [`Header::scratch_len`]; [`DecodeError::NeedsDense`] for what [`Effort::Dense`] encoded, which
    /// [`Codec::decode_dense`] decodes; [`DecodeError::NotBuilt`] for what this build lacks; otherwise what is wrong with `bytes`. After an error `samples`
    /// and `scratch` are meaningless.
    pub fn decode(
        &mut self,
        bytes: &[u8],
        samples: &mut [i32],
        scratch: &mut [i32],
    ) -> Result<Header, DecodeError> {
        self.decode_to_level(bytes, 0, samples, scratch)
    }

    /// Decodes the part of a codestream that makes `level`: 0 is full resolution, level L the low-pass part after
    /// L levels of the transform, ceil(n / 2^L) samples along each axis, in the scale of the transform
    /// ([`Wavelet::low_pass_gain`](crate::Wavelet::low_pass_gain)).
    ///
    /// `bytes` may end after the segment of that level ([`Header::bytes_to_level`]). The result is in the first
    /// `extent_at(level).samples()` of the [`Header::samples_len`] elements lent.
    ///
    /// # Errors
    /// As [`Codec::decode`], and [`DecodeError::LevelOutOfRange`] for a level that the codestream does not hold.
    pub fn decode_to_level(
        &mut self,
        bytes: &[u8],
        level: u8,
        samples: &mut [i32],
        scratch: &mut [i32],
    ) -> Result<Header, DecodeError> {
        self.decode_any(None, bytes, level, samples, scratch)
    }

    /// Decodes any codestream to `level`, dense ones too, as [`Codec::decode_to_level`] the others.
    ///
    /// # Errors
    /// As [`Codec::decode_to_level`].
    pub fn decode_dense(
        &mut self,
        dense: &mut Dense,
        bytes: &[u8],
        level: u8,
        samples: &mut [i32],
        scratch: &mut [i32],
    ) -> Result<Header, DecodeError> {
        self.decode_any(Some(dense), bytes, level, samples, scratch)
    }

    fn decode_any(
        &mut self,
        dense: Option<&mut Dense>,
        bytes: &[u8],
        level: u8,
        samples: &mut [i32],
        scratch: &mut [i32],
    ) -> Result<Header, DecodeError> {
        let header = Header::parse(bytes)?;
        let plan = header.plan();
        let dense = match (header.storage, dense) {
            (Storage::Lattice { .. }, _) => return Err(DecodeError::OtherCodec),
            (Storage::Dense, None) => return Err(DecodeError::NeedsDense),
            (Storage::Dense, dense) => dense,
            (_, _) => None,
        };
        if level > plan.levels() {
            return Err(DecodeError::LevelOutOfRange { max: plan.levels() });
        }
        let payload = header.payload(bytes, level, samples, (header.scratch_len(), scratch))?;
        if Feature::Dense.is_built()
            && let Some(dense) = dense
        {
            header.each_segment(payload, 1, |_, decoder| {
                let coded = dense.code(decoder, plan.extent(), header.sample_type(), samples, scratch);
                Ok(coded.ok_or(Malformed::Segment)?)
            })?;
        } else if let Storage::Tabled(form) = header.storage {
            if !Feature::Tabled.is_built() {
                return Err(DecodeError::NotBuilt(Feature::Tabled));
            }
            if form.is_trained() && !Feature::Trained.is_built() {
                return Err(DecodeError::NotBuilt(Feature::Trained));
            }
            let brick = (plan.extent(), form);
            let decoded = tabled::decode(&mut self.memory, brick, payload, samples, scratch);
            decoded.ok_or(Malformed::Segment)?;
        } else if header.is_stored() {
            restore(header.sample_type(), payload, samples);
            if level > 0 {
                let finest =
                    Plan::new(plan.wavelet(), plan.extent(), level).map_err(|_| Malformed::Levels)?;
                finest.low_pass(samples, scratch)?;
            }
        } else {
            let wide = header.sample_type().bytes() > 2;
            let target = Coefficients { plan: plan.coarsened(level), samples, scratch, wide };
            match header.storage {
                Storage::Light if Feature::Light.is_built() => self.decode_light(&header, payload, target)?,
                _ => self.decode_coefficients(&header, payload, target)?,
            }
        }
        if level == 0 && header.sample_type().first_outside(samples).is_some() {
            return Err(Malformed::Sample.into());
        }
        Ok(header)
    }

    /// Decodes the resolutions that `target` has, and undoes its transform.
    fn decode_coefficients(
        &mut self,
        header: &Header,
        payload: &[u8],
        mut target: Coefficients<'_>,
    ) -> Result<(), DecodeError> {
        let models = self.memory.models().ok_or(Malformed::Segment)?;
        header.each_segment(payload, target.plan.levels().saturating_add(1), |resolution, decoder| {
            for subband in target.plan.subbands(resolution) {
                let coder = described(decoder);
                let predictor = Predictor::Zero.code(coder, models, &target.plan, subband)?;
                let coded = target.code(coder, models, subband, predictor);
                coded.ok_or(Malformed::Segment)?;
            }
            target.undo_resolution(resolution);
            Ok(())
        })
    }
}

/// The output was too short; so many of the finest levels are still transformed.
struct Full {
    transformed: u8,
}

/// Codes one resolution; `None` if it does not fit.
fn code(
    encoder: &mut Encoder<'_>,
    models: &mut Models,
    effort: &mut Effort<'_>,
    coefficients: &mut Coefficients<'_>,
    resolution: u8,
) -> Option<()> {
    for subband in coefficients.plan.subbands(resolution) {
        let training = match effort {
            Effort::Light | Effort::Tabled | Effort::Fast => None,
            Effort::Wide(training) | Effort::Default(training) | Effort::Dense(_, training) => {
                Some(&mut **training)
            }
        };
        let predictor = coefficients.best_predictor(subband, training)?;
        let coder = described(encoder);
        let predictor = predictor.code(coder, models, &coefficients.plan, subband).ok()?;
        coefficients.code(coder, models, subband, predictor)?;
    }
    Some(())
}
