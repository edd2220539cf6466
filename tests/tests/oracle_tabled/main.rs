//! The plain encoder and decoder of tabled codestreams against those of the kernel.

mod agreement;
mod damage;
mod rejects;

use conformance::lent::decode_any;
use conformance::oracle::coder::{Reject, SampleType};
use conformance::oracle::noise::Noise;
use conformance::oracle::tabled::{self, Breadth, Form, bounds, codestream, constant, fit};
use wavelift_kernel::{DecodeError, Header, Malformed};

const BREADTHS: [Breadth; 2] = [Breadth::Narrow, Breadth::Wide];

/// What the kernel makes of a segment.
fn kernel(segment: &[u8], form: Form, sample_type: SampleType) -> Result<Vec<i32>, DecodeError> {
    let bytes = codestream(segment, form, sample_type);
    decode_any(&bytes, 0, &Header::parse(&bytes)?)
}

/// What the oracle makes of it, as the kernel should.
fn oracle(segment: &[u8], form: Form, sample_type: SampleType) -> Result<Vec<i32>, DecodeError> {
    tabled::decode(segment, form, sample_type).map_err(|wrong| match wrong {
        Reject::Segment => DecodeError::Malformed(Malformed::Segment),
        Reject::Sample => DecodeError::Malformed(Malformed::Sample),
        other => panic!("{other:?}"),
    })
}

/// What both make of it.
fn both(segment: &[u8], form: Form, sample_type: SampleType) -> Result<Vec<i32>, DecodeError> {
    let (found, expected) = (kernel(segment, form, sample_type), oracle(segment, form, sample_type));
    assert!(found == expected, "{form:?} {sample_type:?}: {:?}, {:?}", found.err(), expected.err());
    found
}

/// Weights of every kind at once, drawn at random.
fn random_weights(form: Form, noise: &mut Noise) -> Vec<Vec<i64>> {
    let set = |count: usize| {
        let limit = (form.breadth.largest_sum() as i32 / count as i32).min(2047);
        noise.within(limit, count).into_iter().map(i64::from).collect()
    };
    form.sets().into_iter().map(set).collect()
}

/// The segment that the oracle writes of samples under these weights.
fn written(samples: &[i32], form: Form, weights: Vec<Vec<i64>>) -> Vec<u8> {
    let bounds = bounds(samples);
    if bounds[1] == 0 {
        return constant(bounds[0], 0);
    }
    let model = fit(samples, form, bounds, weights);
    tabled::encode(samples, form, bounds, &model).bytes()
}
