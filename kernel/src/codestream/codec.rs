//! Encoding and decoding of one line, slice or brick.

use super::header::{Header, MAX_STORED_HEADER_BYTES, Segments, Storage};
use crate::coder::{Coefficients, Decoder, Dense, Encoder, Models, Predictor, Training};
use crate::error::{at_least, exactly};
use crate::extent::to_usize;
use crate::memory::{copy, move_within};
use crate::{DecodeError, EncodeError, Extent, Malformed, Plan, SampleType, Slice};

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
    models: Models,
}

/// How much an encoder tries to make codestreams short.
#[derive(Debug)]
pub enum Effort<'a> {
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
}

impl Codec {
    /// A codec that can be the value of a `static`.
    pub const NEW: Self = Self { models: Models::NEW };

    /// Makes `self` equal to [`Codec::NEW`].
    pub fn reset(&mut self) {
        self.models.reset();
    }

    /// Encodes `samples` (x fastest) into the beginning of `out` and returns the length of the codestream.
    ///
    /// `samples` is used up: what it holds afterwards has no meaning. An `out` of [`max_encoded_len`] bytes always
    /// suffices; a shorter one does if the codestream happens to fit.
    ///
    /// # Errors
    /// [`EncodeError::Length`] if `samples` is not exactly the extent or `scratch` is shorter than
    /// [`Effort::scratch_len`]; [`EncodeError::SampleOutOfRange`] if a sample is outside `sample_type`;
    /// [`EncodeError::OutputFull`] if `out` is too short; `samples` are what they were then.
    #[expect(clippy::too_many_arguments, reason = "what to code, how, and the memory to do it in")]
    pub fn encode(
        &mut self,
        effort: Effort<'_>,
        plan: &Plan,
        sample_type: SampleType,
        samples: &mut [i32],
        scratch: &mut [i32],
        out: &mut [u8],
    ) -> Result<usize, EncodeError> {
        exactly(Slice::Samples, plan.extent().samples(), samples.len())?;
        at_least(Slice::Scratch, effort.scratch_len(plan), scratch.len())?;
        if let Some(index) = sample_type.first_outside(samples) {
            return Err(EncodeError::SampleOutOfRange { index });
        }
        plan.forward(samples, scratch)?;
        // Samples as they are bound the length; `None` where they would not fit the format.
        let stored = Header::stored(plan, sample_type).map(|header| (header.total_len(), header));
        let room = stored.as_ref().map_or(out.len(), |(len, _)| out.len().min(len.saturating_sub(1)));
        let mut coefficients = Coefficients { plan: *plan, samples, scratch, wide: sample_type.bytes() > 2 };
        let room = out.get_mut(..room).unwrap_or(&mut []);
        match self.encode_coefficients(effort, sample_type, &mut coefficients, room) {
            Ok(len) => return Ok(len),
            Err(Full { resolution }) => {
                let undone = plan.levels().saturating_sub(resolution.saturating_sub(1));
                for level in (0..undone).rev() {
                    plan.inverse_level(level, samples, scratch);
                }
            }
        }
        match stored {
            Some((len, header)) if len <= out.len() => {
                store(&header, samples, out);
                Ok(len)
            }
            _ => Err(EncodeError::OutputFull),
        }
    }

    /// Codes every resolution into `out`, and undoes the transform.
    fn encode_coefficients(
        &mut self,
        mut effort: Effort<'_>,
        sample_type: SampleType,
        coefficients: &mut Coefficients<'_>,
        out: &mut [u8],
    ) -> Result<usize, Full> {
        let plan = coefficients.plan;
        if let Effort::Dense(dense, _) = &mut effort
            && plan.levels() == 0
            && Dense::suits(coefficients.samples)
        {
            return encode_dense(dense, sample_type, coefficients, out).ok_or(Full { resolution: 0 });
        }
        let header = |segments| Header::new(sample_type, plan, Storage::Coded, segments);
        // The header holds the lengths of the segments, so it is written last: the segments go where they begin if
        // every length takes one byte, and are moved up afterwards.
        let mut segments = Segments::new();
        let gap = header(no_segments(plan.levels())).header_len();
        let mut end = gap;
        self.models.reset();
        for resolution in 0..=plan.levels() {
            let room = out.get_mut(end..).unwrap_or(&mut []);
            let len = self
                .encode_resolution(&mut effort, coefficients, resolution, room)
                .ok_or(Full { resolution })?;
            end = end.saturating_add(len);
            let _ = segments.push(u32::try_from(len).unwrap_or(u32::MAX));
            if let Some(level) = plan.levels().checked_sub(resolution)
                && resolution > 0
            {
                plan.inverse_level(level, coefficients.samples, coefficients.scratch);
            }
        }
        let header = header(segments);
        let total = header.total_len();
        if total > out.len() {
            return Err(Full { resolution: plan.levels().saturating_add(1) });
        }
        move_within(out, gap..end, header.header_len());
        header.write(out);
        Ok(total)
    }

    /// Codes one resolution into `out`; `None` if it does not fit.
    fn encode_resolution(
        &mut self,
        effort: &mut Effort<'_>,
        coefficients: &mut Coefficients<'_>,
        resolution: u8,
        out: &mut [u8],
    ) -> Option<usize> {
        let mut encoder = Encoder::new(out);
        for subband in coefficients.plan.subbands(resolution) {
            let training = match effort {
                Effort::Fast => None,
                Effort::Default(training) | Effort::Dense(_, training) => Some(&mut **training),
            };
            let predictor = coefficients.best_predictor(subband, training)?;
            coefficients.code(&mut encoder, &mut self.models, subband, predictor)?;
        }
        encoder.finish()
    }

    /// Decodes a whole codestream into `samples`, x fastest.
    ///
    /// # Errors
    /// [`DecodeError::Length`] if `samples` is not exactly the extent or `scratch` is shorter than
    /// [`Header::scratch_len`]; [`DecodeError::NeedsDense`] for what [`Effort::Dense`] encoded, which
    /// [`Codec::decode_dense`] decodes; otherwise what is wrong with `bytes`. After an error `samples`
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
        match header.storage {
            Storage::Lattice { .. } => return Err(DecodeError::OtherCodec),
            Storage::Dense if dense.is_none() => return Err(DecodeError::NeedsDense),
            _ => {}
        }
        if level > plan.levels() {
            return Err(DecodeError::LevelOutOfRange { max: plan.levels() });
        }
        exactly(Slice::Samples, header.samples_len(level), samples.len())?;
        at_least(Slice::Scratch, header.scratch_len(), scratch.len())?;
        if bytes.len() < header.len_to_level(level) {
            return Err(DecodeError::Truncated);
        }
        if bytes.len() > header.total_len() {
            return Err(DecodeError::TrailingBytes);
        }
        let payload = bytes.get(header.header_len()..).unwrap_or(&[]);
        match header.storage {
            Storage::Lattice { .. } => return Err(DecodeError::OtherCodec),
            Storage::Coded => {
                let wide = header.sample_type().bytes() > 2;
                let target = Coefficients { plan: plan.coarsened(level), samples, scratch, wide };
                self.decode_coefficients(&header, payload, target)?;
            }
            Storage::Dense => {
                let dense = dense.ok_or(DecodeError::NeedsDense)?;
                decode_dense(dense, &header, payload, samples, scratch).ok_or(Malformed::Segment)?;
            }
            Storage::Stored => {
                restore(header.sample_type(), payload, samples);
                if level > 0 {
                    let finest =
                        Plan::new(plan.wavelet(), plan.extent(), level).map_err(|_| Malformed::Levels)?;
                    finest.low_pass(samples, scratch)?;
                }
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
        self.models.reset();
        let mut payload = payload;
        for (resolution, &bytes) in (0..=target.plan.levels()).zip(&header.segments) {
            let (segment, rest) = payload.split_at_checked(to_usize(bytes)).ok_or(DecodeError::Truncated)?;
            let mut decoder = Decoder::new(segment).ok_or(Malformed::Segment)?;
            for subband in target.plan.subbands(resolution) {
                let coded = target.code(&mut decoder, &mut self.models, subband, Predictor::Zero);
                coded.ok_or(Malformed::Segment)?;
            }
            if !decoder.is_consumed() {
                return Err(Malformed::Segment.into());
            }
            payload = rest;
            if let Some(level) = target.plan.levels().checked_sub(resolution)
                && resolution > 0
            {
                target.plan.inverse_level(level, target.samples, target.scratch);
            }
        }
        Ok(())
    }
}

/// Codes the samples of a plan without levels into `out`; they are what they were afterwards. `None` if they do not
/// fit.
fn encode_dense(
    dense: &mut Dense,
    sample_type: SampleType,
    brick: &mut Coefficients<'_>,
    out: &mut [u8],
) -> Option<usize> {
    let header = |segments| Header::new(sample_type, brick.plan, Storage::Dense, segments);
    let gap = header(no_segments(0)).header_len();
    let mut encoder = Encoder::new(out.get_mut(gap..)?);
    dense.code(&mut encoder, brick.plan.extent(), sample_type, brick.samples, brick.scratch)?;
    let len = encoder.finish()?;
    let mut segments = Segments::new();
    segments.push(u32::try_from(len).ok()?).ok()?;
    let header = header(segments);
    let total = header.total_len();
    out.get(..total)?;
    move_within(out, gap..gap.wrapping_add(len), header.header_len());
    header.write(out);
    Some(total)
}

/// The output was too short for a resolution: the finer ones are still transformed.
struct Full {
    resolution: u8,
}

/// Decodes dense samples; `None` if no encoder wrote them.
fn decode_dense(
    dense: &mut Dense,
    header: &Header,
    segment: &[u8],
    samples: &mut [i32],
    scratch: &mut [i32],
) -> Option<()> {
    let mut decoder = Decoder::new(segment)?;
    dense.code(&mut decoder, header.plan().extent(), header.sample_type(), samples, scratch)?;
    decoder.is_consumed().then_some(())
}

/// A length of 0 for every segment.
pub(super) fn no_segments(levels: u8) -> Segments {
    let mut segments = Segments::new();
    let _ = segments.resize(usize::from(levels).wrapping_add(1), 0);
    segments
}

/// Writes `header` and the samples as they are, little-endian, to the beginning of `out`.
pub(super) fn store(header: &Header, samples: &[i32], out: &mut [u8]) {
    header.write(out);
    let payload = out.get_mut(header.header_len()..).unwrap_or(&mut []);
    let size = header.sample_type().bytes();
    for (bytes, sample) in payload.chunks_exact_mut(size.max(1)).zip(samples) {
        let sample = sample.to_le_bytes();
        copy(&sample, bytes);
    }
}

/// Reads samples that are stored as they are.
pub(super) fn restore(sample_type: SampleType, payload: &[u8], samples: &mut [i32]) {
    for (sample, bytes) in samples.iter_mut().zip(payload.chunks_exact(sample_type.bytes())) {
        *sample = match (sample_type, bytes) {
            (SampleType::I8, &[byte]) => i8::from_le_bytes([byte]).into(),
            (SampleType::U8, &[byte]) => byte.into(),
            (SampleType::I16, &[a, b]) => i16::from_le_bytes([a, b]).into(),
            (SampleType::U16, &[a, b]) => u16::from_le_bytes([a, b]).into(),
            (_, &[a, b, c, d]) => i32::from_le_bytes([a, b, c, d]),
            _ => 0,
        };
    }
}
