//! Golden streams: decoded, compared, encoded again, compared.

use fixture::{Recipe, Vector, crc32_of_samples};
#[cfg(feature = "streams")]
use wavelift_kernel::stream::{RowDecoder, RowEncoder, RowPlan};
use wavelift_kernel::stream::{RowError, SlabDecoder, SlabEncoder, SlabMemory, SlabPlan, Status, Step};
use wavelift_kernel::{DecodeError, EncodeError, Extent};

use crate::golden::Outcome;
use crate::memory::{Efforts, Parts};

/// Elements that are given and taken at once: prime, so that they end anywhere.
const PIECE: usize = 61;

/// Checks a vector that is a stream.
pub(crate) fn check(vector: &Vector, parts: &mut Parts<'_>) -> Outcome {
    match decode(vector.bytes, parts) {
        None => Outcome::TooLarge,
        Some(Err(DecodeError::OtherCodec)) if cfg!(not(feature = "streams")) => Outcome::Refused,
        Some(Err(DecodeError::NotBuilt(feature))) if !feature.is_built() => Outcome::Refused,
        Some(decoded)
            if decoded.map(|count| crc32_of_samples(&parts.samples[..count])) != vector.expected =>
        {
            Outcome::Failed
        }
        Some(Err(_)) => Outcome::Passed,
        Some(Ok(count)) => match vector.recipe {
            None => Outcome::Passed,
            Some(recipe) => encode(recipe, count, vector.bytes, parts).unwrap_or(Outcome::Decoded),
        },
    }
}

/// How many samples a stream holds, now in memory; `None` if there is no memory for it.
fn decode(bytes: &[u8], parts: &mut Parts<'_>) -> Option<Result<usize, DecodeError>> {
    #[cfg(feature = "streams")]
    match RowPlan::parse(bytes) {
        Err(DecodeError::OtherCodec) => {}
        Err(error) => return Some(Err(error)),
        Ok((plan, header)) => {
            let Parts { rows, samples, scratch, .. } = parts;
            let memory = scratch.get_mut(..plan.decoder_memory_len())?;
            let mut decoder = RowDecoder::new(&plan, rows, memory).ok()?;
            return drain(&bytes[header..], samples, |input, output| decoder.step(input, output));
        }
    }
    let (plan, header) = match SlabPlan::parse(bytes) {
        Ok(parsed) => parsed,
        Err(error) => return Some(Err(error)),
    };
    let Parts { codec, samples, scratch, bytes: room, .. } = parts;
    let (slab, scratch) = scratch.split_at_mut_checked(plan.samples_len())?;
    let memory = SlabMemory { samples: slab, scratch, bytes: room };
    let mut decoder = SlabDecoder::new(&plan, codec, memory).ok()?;
    drain(&bytes[header..], samples, |input, output| decoder.step(input, output))
}

/// Gives all of `input` to a decoder, and takes its samples; returns how many.
fn drain(
    mut input: &[u8],
    samples: &mut [i32],
    mut step: impl FnMut(&[u8], &mut [i32]) -> Result<Step, DecodeError>,
) -> Option<Result<usize, DecodeError>> {
    let mut count = 0;
    loop {
        let piece = input.len().min(PIECE);
        let room = (samples.len() - count).min(PIECE);
        let step = match step(&input[..piece], &mut samples[count..count + room]) {
            Ok(step) => step,
            Err(error) => return Some(Err(error)),
        };
        (input, count) = (&input[step.consumed..], count + step.produced);
        match step.status {
            Status::NeedInput if input.is_empty() => return Some(Err(DecodeError::Truncated)),
            Status::NeedOutput if count == samples.len() => return None,
            Status::Done if input.is_empty() => return Some(Ok(count)),
            Status::Done => return Some(Err(DecodeError::TrailingBytes)),
            _ => {}
        }
    }
}

/// What becomes of the samples, just decoded, when they are encoded again; `None` if there is no memory for it.
fn encode(recipe: Recipe, count: usize, expected: &[u8], parts: &mut Parts<'_>) -> Option<Outcome> {
    match recipe {
        #[cfg(feature = "streams")]
        Recipe::Rows { strip, wavelet, extent: [width, ..], levels, sample_type } => {
            let plan = RowPlan::new(wavelet, width, levels, sample_type).ok()?.with_strip(strip);
            let Parts { rows, samples, scratch, .. } = parts;
            let memory = scratch.get_mut(..plan.encoder_memory_len())?;
            Some(feed(RowEncoder::new(&plan, rows, memory).ok()?, &samples[..count], expected))
        }
        Recipe::Slabs { slab, effort, wavelet, extent: [width, height, _], levels, sample_type } => {
            let extent = Extent::brick(width, height, slab).ok()?;
            let plan = SlabPlan::new(wavelet, extent, levels, sample_type).ok()?;
            let Parts { codec, samples, scratch, bytes, efforts, .. } = parts;
            let (slab, scratch) = scratch.split_at_mut_checked(plan.samples_len())?;
            let memory = SlabMemory { samples: slab, scratch, bytes };
            let effort = Efforts::lend(efforts.as_deref_mut(), effort)?;
            match SlabEncoder::new(&plan, codec, effort, memory) {
                Ok(encoder) => Some(feed(encoder, &samples[..count], expected)),
                Err(EncodeError::NotBuilt(feature)) if !feature.is_built() => Some(Outcome::Refused),
                Err(_) => None,
            }
        }
        _ => None,
    }
}

/// An encoder of a stream.
pub(crate) trait Encoder {
    fn step(&mut self, input: &[i32], output: &mut [u8]) -> Result<Step, RowError>;
    fn finish(&mut self) -> Result<(), RowError>;
}

#[cfg(feature = "streams")]
impl Encoder for RowEncoder<'_> {
    fn step(&mut self, input: &[i32], output: &mut [u8]) -> Result<Step, RowError> {
        self.step(input, output)
    }

    fn finish(&mut self) -> Result<(), RowError> {
        self.finish()
    }
}

impl Encoder for SlabEncoder<'_> {
    fn step(&mut self, input: &[i32], output: &mut [u8]) -> Result<Step, RowError> {
        self.step(input, output)
    }

    fn finish(&mut self) -> Result<(), RowError> {
        self.finish()
    }
}

/// Gives all samples to an encoder, which should give the expected bytes.
fn feed(mut encoder: impl Encoder, mut samples: &[i32], mut expected: &[u8]) -> Outcome {
    loop {
        let mut output = [0; PIECE];
        let Ok(step) = encoder.step(&samples[..samples.len().min(PIECE)], &mut output) else {
            return Outcome::Failed;
        };
        samples = &samples[step.consumed..];
        match expected.split_at_checked(step.produced) {
            Some((same, rest)) if same == &output[..step.produced] => expected = rest,
            _ => return Outcome::Failed,
        }
        match step.status {
            Status::NeedInput if samples.is_empty() && encoder.finish().is_err() => return Outcome::Failed,
            Status::Done if expected.is_empty() => return Outcome::Passed,
            Status::Done => return Outcome::Failed,
            _ => {}
        }
    }
}
