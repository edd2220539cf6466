//! Encoding and decoding of one line, slice or brick.

use super::header::{Header, MAX_STORED_HEADER_BYTES, Segments, Storage};
use crate::coder::{Coefficients, Decoder, Encoder, Equations, Models, Predictor};
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
    equations: Equations,
}

impl Codec {
    /// A codec that can be the value of a `static`.
    pub const NEW: Self = Self { models: Models::NEW, equations: Equations::NEW };

    /// Makes `self` equal to [`Codec::NEW`].
    pub fn reset(&mut self) {
        self.models.reset();
        self.equations.reset();
    }

    /// Encodes `samples` (x fastest) into the beginning of `out` and returns the length of the codestream.
    ///
    /// `samples` is used up: what it holds afterwards has no meaning. An `out` of [`max_encoded_len`] bytes always
    /// suffices; a shorter one does if the codestream happens to fit.
    ///
    /// # Errors
    /// [`EncodeError::Length`] if `samples` is not exactly the extent or `scratch` is shorter than
    /// [`Plan::scratch_len`]; [`EncodeError::SampleOutOfRange`] if a sample is outside `sample_type`;
    /// [`EncodeError::OutputFull`] if `out` is too short; `samples` are what they were then.
    pub fn encode(
        &mut self,
        plan: &Plan,
        sample_type: SampleType,
        samples: &mut [i32],
        scratch: &mut [i32],
        out: &mut [u8],
    ) -> Result<usize, EncodeError> {
        exactly(Slice::Samples, plan.extent().samples(), samples.len())?;
        at_least(Slice::Scratch, plan.scratch_len(), scratch.len())?;
        if let Some(index) = sample_type.first_outside(samples) {
            return Err(EncodeError::SampleOutOfRange { index });
        }
        plan.forward(samples, scratch)?;
        // Samples as they are bound the length; `None` where they would not fit the format.
        let stored = Header::stored(plan, sample_type).map(|header| (header.total_len(), header));
        let room = stored.as_ref().map_or(out.len(), |(len, _)| out.len().min(len.saturating_sub(1)));
        let mut coefficients = Coefficients { plan: *plan, samples, scratch };
        if let Some(len) =
            self.encode_coefficients(sample_type, &mut coefficients, out.get_mut(..room).unwrap_or(&mut []))
        {
            return Ok(len);
        }
        plan.inverse(samples, scratch)?;
        match stored {
            Some((len, header)) if len <= out.len() => {
                store(&header, samples, out);
                Ok(len)
            }
            _ => Err(EncodeError::OutputFull),
        }
    }

    /// Codes every resolution into `out`; `None` if they do not fit.
    fn encode_coefficients(
        &mut self,
        sample_type: SampleType,
        coefficients: &mut Coefficients<'_>,
        out: &mut [u8],
    ) -> Option<usize> {
        let plan = coefficients.plan;
        let predictor = Predictor::best(&plan, coefficients.samples, &mut self.equations);
        let header = |segments| Header::new(sample_type, plan, Storage::Coded(predictor), segments);
        // The header holds the lengths of the segments, so it is written last: the segments go where they begin if
        // every length takes one byte, and are moved up afterwards.
        let mut segments = Segments::new();
        segments.resize(usize::from(plan.levels()).wrapping_add(1), 0).ok()?;
        let gap = header(segments.clone()).header_len();
        let mut end = gap;
        self.models.reset();
        for (resolution, bytes) in (0..).zip(segments.iter_mut()) {
            let mut encoder = Encoder::new(out.get_mut(end..)?);
            coefficients.code(&mut encoder, &mut self.models, resolution, &predictor)?;
            let len = encoder.finish()?;
            *bytes = u32::try_from(len).ok()?;
            end = end.checked_add(len)?;
        }
        let header = header(segments);
        let total = header.total_len();
        if total > out.len() {
            return None;
        }
        move_within(out, gap..end, header.header_len());
        header.write(out);
        Some(total)
    }

    /// Decodes a whole codestream into `samples`, x fastest.
    ///
    /// # Errors
    /// [`DecodeError::Length`] if `samples` is not exactly the extent or `scratch` is shorter than
    /// [`Plan::scratch_len`] of the header's plan; otherwise what is wrong with `bytes`. After an error `samples`
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
        let header = Header::parse(bytes)?;
        let plan = header.plan();
        if level > plan.levels() {
            return Err(DecodeError::LevelOutOfRange { max: plan.levels() });
        }
        exactly(Slice::Samples, header.samples_len(level), samples.len())?;
        at_least(Slice::Scratch, plan.scratch_len(), scratch.len())?;
        if bytes.len() < header.len_to_level(level) {
            return Err(DecodeError::Truncated);
        }
        if bytes.len() > header.total_len() {
            return Err(DecodeError::TrailingBytes);
        }
        let payload = bytes.get(header.header_len()..).unwrap_or(&[]);
        match header.storage {
            Storage::Coded(predictor) => {
                let target = Coefficients { plan: plan.coarsened(level), samples, scratch };
                self.decode_coefficients(&header, payload, target, predictor)?;
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
        predictor: Predictor,
    ) -> Result<(), DecodeError> {
        self.models.reset();
        let mut payload = payload;
        for (resolution, &bytes) in (0..=target.plan.levels()).zip(&header.segments) {
            let (segment, rest) = payload.split_at_checked(to_usize(bytes)).ok_or(DecodeError::Truncated)?;
            let mut decoder = Decoder::new(segment).ok_or(Malformed::Segment)?;
            let coded = target.code(&mut decoder, &mut self.models, resolution, &predictor);
            if coded.is_none() || !decoder.is_consumed() {
                return Err(Malformed::Segment.into());
            }
            payload = rest;
        }
        target.plan.inverse(target.samples, target.scratch)?;
        Ok(())
    }
}

/// Writes `header` and the samples as they are, little-endian, to the beginning of `out`.
fn store(header: &Header, samples: &[i32], out: &mut [u8]) {
    header.write(out);
    let payload = out.get_mut(header.header_len()..).unwrap_or(&mut []);
    let size = header.sample_type().bytes();
    for (bytes, sample) in payload.chunks_exact_mut(size.max(1)).zip(samples) {
        let sample = sample.to_le_bytes();
        copy(&sample, bytes);
    }
}

/// Reads samples that are stored as they are.
fn restore(sample_type: SampleType, payload: &[u8], samples: &mut [i32]) {
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
