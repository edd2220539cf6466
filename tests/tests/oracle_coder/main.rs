//! The kernel's codestreams against the reference of the format: each reads what the other writes, both write the
//! same bytes with the same predictors, and both refuse the same bytes for the same reason.

mod agreement;
mod by_hand;
mod damage;
mod rejects;

use conformance::effort::Effort;
use conformance::lent;
use conformance::oracle::coder::{Choices, Decoded, Predictor, Reject, Shape, Storage, decode, shapes};
use conformance::oracle::noise::Noise;
use conformance::reference::sides;
use wavelift_kernel::{Codec, DecodeError, Extent, Header, Malformed, Plan, SampleType, Wavelet};

/// A plan; without a wavelet, one of no levels.
fn plan(wavelet: Option<Wavelet>, extent: [u32; 3], levels: u8) -> Plan {
    let extent = Extent::new(extent).expect("no axis is empty");
    Plan::new(wavelet.unwrap_or(Wavelet::Haar), extent, levels).expect("the extent allows the levels")
}

fn kernel_encode(effort: Effort, plan: &Plan, sample_type: SampleType, samples: &[i32]) -> Vec<u8> {
    lent::encode(&mut const { Codec::NEW }, effort, plan, sample_type, samples)
}

fn kernel_decode(bytes: &[u8], level: u8) -> Result<Decoded, DecodeError> {
    let header = Header::parse(bytes)?;
    let samples = lent::decode(&mut const { Codec::NEW }, bytes, level, &header)?;
    Ok(Decoded { extent: sides(header.extent_at(level)), samples })
}

/// The row of the table of errors that the kernel's error stands for.
fn row(error: DecodeError) -> Reject {
    match error {
        DecodeError::Truncated => Reject::Truncated,
        DecodeError::NotACodestream => Reject::NotACodestream,
        DecodeError::UnsupportedVersion { found } => Reject::UnsupportedVersion { found },
        DecodeError::TrailingBytes => Reject::TrailingBytes,
        DecodeError::Malformed(Malformed::Reserved) => Reject::Reserved,
        DecodeError::Malformed(Malformed::Number) => Reject::Number,
        DecodeError::Malformed(Malformed::Extent) => Reject::Extent,
        DecodeError::Malformed(Malformed::Levels) => Reject::Levels,
        DecodeError::Malformed(Malformed::StoredLength) => Reject::StoredLength,
        DecodeError::Malformed(Malformed::Segment) => Reject::Segment,
        DecodeError::Malformed(Malformed::Sample) => Reject::Sample,
        other => panic!("{other} has no row"),
    }
}

/// What both decoders, the oracle's and the kernel's, make of the bytes.
fn both_decode(bytes: &[u8], level: u8) -> Result<Decoded, Reject> {
    let decoded = decode(bytes, level.into());
    assert_eq!(kernel_decode(bytes, level).map_err(row), decoded, "level {level} of {bytes:02X?}");
    decoded
}

/// A legal predictor of each kind that the subband may have, at random; weights more often than all others.
fn any_predictor(noise: &mut Noise, shape: &Shape) -> Predictor {
    match noise.bits() % 8 {
        0 => Predictor::Zero,
        kind @ 1..=2 if shape.is_low_pass => Predictor::Fixed(((noise.bits() ^ kind) % 5) as u8),
        _ => Predictor::Weights(shape.sets.iter().map(|&count| any_weights(noise, count)).collect()),
    }
}

/// Legal weights of all sizes, a third of them the largest there are, as long as the largest sum allows them.
fn any_weights(noise: &mut Noise, count: usize) -> Vec<i32> {
    let mut weights = vec![0; count];
    let (mut left, start) = (32_768, noise.bits() as usize % count);
    for at in (start..count).chain(0..start) {
        let weight = match noise.bits() >> 60 {
            0..=2 => 2048,
            3..=5 => -2048,
            6..=9 => 0,
            10..=12 => (noise.bits() % 129) as i32 - 64,
            _ => (noise.bits() % 4097) as i32 - 2048,
        };
        weights[at] = weight.clamp(-left, left);
        left -= weights[at].abs();
    }
    weights
}

/// Predictors for all subbands.
fn any_predictors(noise: &mut Noise, choices: &Choices) -> Vec<Predictor> {
    if choices.storage == Storage::Light {
        return vec![Predictor::Fixed((noise.bits() % 5) as u8)];
    }
    shapes(choices).iter().map(|shape| any_predictor(noise, shape)).collect()
}

/// For all subbands the one that is asked for, where they may have it, else zero.
fn uniform_predictors(number: u8, choices: &Choices) -> Vec<Predictor> {
    let predictor = |shape: &Shape| match number {
        0..=4 if shape.is_low_pass => Predictor::Fixed(number),
        _ => Predictor::Zero,
    };
    shapes(choices).iter().map(predictor).collect()
}
