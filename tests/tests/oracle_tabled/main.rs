//! The plain encoder and decoder of tabled codestreams against those of the kernel.

mod agreement;
mod damage;
mod rejects;

use conformance::lent::decode_any;
use conformance::oracle::coder::{Reject, SampleType};
use conformance::oracle::noise::Noise;
use conformance::oracle::tabled::{self, Breadth, Form, Model, bounds, codestream, constant, fit};
use wavelift_kernel::{DecodeError, Header, Malformed};

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

/// Weights of every kind at once, drawn at random; if celled the scale, and in a slice several sets for its cells too.
fn random_model(form: Form, noise: &mut Noise) -> Model {
    let count = if form.has_cells() { 1 + noise.bits() as usize % 8 } else { 1 };
    let set = |count: usize| {
        let limit = (form.breadth.largest_sum() as i32 / count as i32).min(2047);
        noise.within(limit, count).into_iter().map(i64::from).collect()
    };
    let mut model = Model::new(form.sets().repeat(count).into_iter().map(set).collect());
    if form.breadth == Breadth::Celled {
        model.scale = (noise.bits() % 17) as u32;
    }
    if count > 1 {
        model.labels = (0..form.cells()).map(|_| noise.bits() as usize % count).collect();
    }
    model
}

/// The segment that the oracle writes of samples under a model that gets its tables from them.
fn written(samples: &[i32], form: Form, model: Model) -> Vec<u8> {
    let bounds = bounds(samples);
    if bounds[1] == 0 {
        return constant(bounds[0], 0);
    }
    let model = fit(samples, form, bounds, model);
    tabled::encode(samples, form, bounds, &model).bytes()
}
