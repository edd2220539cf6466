//! The kernel's codestreams against the reference of the format: both write the same bytes, each reads what the other
//! writes, and both refuse the same bytes for the same reason.

mod agreement;
mod by_hand;
mod damage;
mod rejects;

use conformance::lent;
use conformance::oracle::coder::{Decoded, Reject, Weights, decode};
use conformance::oracle::noise::Noise;
use conformance::reference::sides;
use wavelift_kernel::{Codec, DecodeError, Extent, Header, Malformed, Plan, SampleType, Wavelet};

/// A plan; without a wavelet, one of no levels.
fn plan(wavelet: Option<Wavelet>, extent: [u32; 3], levels: u8) -> Plan {
    let extent = Extent::new(extent).expect("no axis is empty");
    Plan::new(wavelet.unwrap_or(Wavelet::Haar), extent, levels).expect("the extent allows the levels")
}

fn kernel_encode(plan: &Plan, sample_type: SampleType, samples: &[i32]) -> Vec<u8> {
    lent::encode(&mut const { Codec::NEW }, plan, sample_type, samples)
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
        DecodeError::Malformed(Malformed::Weight) => Reject::Weight,
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

/// Weights of all sizes, a third of them the largest there are; without `others`, for a single plane.
fn any_weights(noise: &mut Noise, others: bool) -> Weights {
    let mut weight = || match noise.bits() >> 60 {
        0..=2 => 2048,
        3..=5 => -2048,
        6..=9 => 0,
        _ => (noise.bits() % 4097) as i32 - 2048,
    };
    Weights {
        first: [(); 9].map(|()| weight()),
        others: [(); 19].map(|()| if others { weight() } else { 0 }),
    }
}
