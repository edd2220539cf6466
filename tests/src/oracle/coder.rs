//! The codestream, written and read the plain way, from `kernel/docs/codestream.md` alone. The bytes of a segment are
//! one long number in base 256, carried digit by digit, and every place of every subband is looked up anew.
//!
//! The encoder chooses nothing: the predictor of each subband, weights included, is given.

pub(super) mod arithmetic;
pub(super) mod array;
mod distribution;
mod first;
mod header;
mod light;
pub(super) mod predict;
pub mod rows;
mod scan;
mod value;

use super::lifting;
use arithmetic::{Decoder, Encoder};
use array::Array;
use distribution::Models;
pub(super) use header::number_bytes;
pub use header::{Choices, Header, Reject, SampleType, Storage};
use light::Chances;
pub use predict::Predictor;
use predict::Scene;
use scan::{Reading, Writing};

/// What a codestream holds at the level asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Decoded {
    /// Samples along x, y, z at this level.
    pub extent: [usize; 3],
    /// The samples, x fastest.
    pub samples: Vec<i32>,
}

/// What a predictor of a subband must fit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shape {
    /// Whether it is the low-pass part, which alone has fixed predictors.
    pub is_low_pass: bool,
    /// The number of weights in each set.
    pub sets: Vec<usize>,
}

/// Every subband that has coefficients, in the order of the codestream; none if the samples are stored.
pub fn shapes(choices: &Choices) -> Vec<Shape> {
    if choices.storage == Storage::Stored {
        return Vec::new();
    }
    let low_pass = [Array::zeros(choices.coarsened(choices.levels).extent)];
    let shape = |level: &[Array], orientation: usize| {
        let sets = Scene { level, orientation, narrow: choices.is_narrow() }.sets();
        Shape { is_low_pass: level.len() == 1, sets }
    };
    let mut shapes = vec![shape(&low_pass, 0)];
    if choices.storage == Storage::Light {
        return shapes;
    }
    for level in (0..choices.levels).rev() {
        let level = Array::zeros(choices.coarsened(level).extent).split();
        let orientations = (1..8).filter(|&orientation| !level[orientation].is_empty());
        shapes.extend(orientations.map(|orientation| shape(&level, orientation)));
    }
    shapes
}

/// The codestream of `samples` (x fastest) under these choices, with a predictor for each of [`shapes`]. Panics if the
/// choices contradict each other, if a sample is outside its type, or if a set has another number of weights; what else
/// is illegal of a predictor is written as it is.
pub fn encode(choices: &Choices, predictors: &[Predictor], samples: &[i32]) -> Vec<u8> {
    assert_eq!(choices.check(), Ok(()), "the choices are those of some codestream");
    assert_eq!(samples.len(), choices.places(), "one sample a place");
    assert!(samples.iter().all(|&v| choices.sample_type.holds(v)), "a sample is outside its type");
    encode_unchecked(choices, predictors, samples)
}

/// [`encode`] of samples that may be outside of their type.
pub fn encode_unchecked(choices: &Choices, predictors: &[Predictor], samples: &[i32]) -> Vec<u8> {
    let segments = match choices.storage {
        Storage::Stored => {
            vec![samples.iter().flat_map(|&v| choices.sample_type.bytes_of(v)).collect()]
        }
        Storage::Coded | Storage::Light => encode_segments(choices, predictors, samples),
    };
    let lengths: Vec<_> = segments.iter().map(Vec::len).collect();
    let mut bytes = header::write(choices, &lengths);
    bytes.extend(segments.into_iter().flatten());
    bytes
}

/// The codestream of other samples under the choices and predictors that `stream` was written with. Panics if it is not
/// sound.
pub fn encode_as(stream: &[u8], samples: &[i32]) -> Vec<u8> {
    let choices = Header::parse(stream).expect("the header is sound").choices;
    encode(&choices, &predictors(stream).expect("the codestream is sound"), samples)
}

/// Decodes the part of a codestream that makes `level`: 0 is full resolution. Panics if the codestream has no such level.
pub fn decode(bytes: &[u8], level: usize) -> Result<Decoded, Reject> {
    decode_with_predictors(bytes, level).map(|(decoded, _)| decoded)
}

/// The predictors of a whole codestream, in its order.
pub fn predictors(bytes: &[u8]) -> Result<Vec<Predictor>, Reject> {
    decode_with_predictors(bytes, 0).map(|(_, predictors)| predictors)
}

fn decode_with_predictors(bytes: &[u8], level: usize) -> Result<(Decoded, Vec<Predictor>), Reject> {
    let header = Header::parse(bytes)?;
    assert!(level <= header.choices.levels, "the codestream has no level {level}");
    let segments = header.segments(bytes, level)?;
    if bytes.len() > header.total_bytes() {
        return Err(Reject::TrailingBytes);
    }
    match header.choices.storage {
        Storage::Stored => Ok((low_pass_of_stored(&header.choices, segments[0], level), Vec::new())),
        Storage::Coded | Storage::Light => {
            let choices = header.choices.coarsened(level);
            let (samples, predictors) = decode_segments(&choices, &segments)?;
            if level == 0 && !samples.iter().all(|&v| choices.sample_type.holds(v)) {
                return Err(Reject::Sample);
            }
            Ok((Decoded { extent: choices.extent, samples }, predictors))
        }
    }
}

fn encode_segments(choices: &Choices, predictors: &[Predictor], samples: &[i32]) -> Vec<Vec<u8>> {
    let mut low_pass = Array { extent: choices.extent, values: samples.to_vec() };
    let mut levels = Vec::new();
    for _ in 0..choices.levels {
        let psi = choices.psi.expect("levels have a wavelet");
        lifting::forward(psi, &mut low_pass.values, low_pass.extent, 1);
        levels.push(low_pass.split());
        low_pass = low_pass.split()[0].clone();
    }
    let (mut models, mut chances, mut predictors) = (Models::new(), Chances::new(), predictors.iter());
    let mut segments = Vec::new();
    let mut resolutions = vec![vec![low_pass]];
    resolutions.extend(levels.into_iter().rev().map(Vec::from));
    for mut resolution in resolutions {
        let mut writing = Writing { to: Encoder::new(), predictors: &mut predictors };
        for orientation in orientations(&resolution) {
            if choices.storage == Storage::Light {
                let predictor = match orientation {
                    0 => writing.predictors.next().expect("a predictor of the low-pass part"),
                    _ => &Predictor::Zero,
                };
                if let Predictor::Fixed(number) = predictor {
                    writing.to.raw(3, (*number).into());
                }
                light::subband(&mut writing.to, &mut chances, &mut resolution, orientation, predictor);
                continue;
            }
            scan::subband(&mut writing, &mut models, &mut resolution, (orientation, choices.is_narrow()))
                .expect("an encoder has its predictors");
        }
        segments.push(writing.to.finish());
    }
    assert_eq!(predictors.len(), 0, "a predictor for every subband, and no more");
    segments
}

fn decode_segments(choices: &Choices, segments: &[&[u8]]) -> Result<(Vec<i32>, Vec<Predictor>), Reject> {
    let (mut models, mut chances, mut predictors) = (Models::new(), Chances::new(), Vec::new());
    let mut whole = Array::zeros(choices.coarsened(choices.levels).extent);
    for (resolution, segment) in segments.iter().enumerate() {
        let extent = choices.coarsened(choices.levels - resolution).extent;
        let mut subbands = vec![whole];
        if resolution > 0 {
            subbands.extend(array::subbands(extent)[1..].iter().map(|(_, extent)| Array::zeros(*extent)));
        }
        let mut reading = Reading { from: Decoder::new(segment)?, predictors: &mut predictors };
        for orientation in orientations(&subbands) {
            if choices.storage == Storage::Light {
                let predictor = match orientation {
                    0 => light::predictor(&mut reading.from)?,
                    _ => Predictor::Zero,
                };
                light::subband(&mut reading.from, &mut chances, &mut subbands, orientation, &predictor);
                reading.predictors.extend((orientation == 0).then_some(predictor));
                continue;
            }
            scan::subband(&mut reading, &mut models, &mut subbands, (orientation, choices.is_narrow()))?;
        }
        reading.from.finish()?;
        whole = match <[Array; 8]>::try_from(subbands) {
            Ok(level) => {
                let mut joined = Array::join(&level, extent);
                let psi = choices.psi.expect("levels have a wavelet");
                lifting::inverse(psi, &mut joined.values, extent, 1);
                joined
            }
            Err(mut low_pass) => low_pass.remove(0),
        };
    }
    Ok((whole.values, predictors))
}

/// The orientations that a resolution codes: that of the low-pass part in the coarsest one, else all others.
fn orientations(subbands: &[Array]) -> std::ops::Range<usize> {
    if subbands.len() == 1 { 0..1 } else { 1..8 }
}

fn low_pass_of_stored(choices: &Choices, segment: &[u8], level: usize) -> Decoded {
    let sample_type = choices.sample_type;
    let mut samples: Vec<_> = segment.chunks(sample_type.bytes()).map(|b| sample_type.value_of(b)).collect();
    if let Some(psi) = choices.psi {
        lifting::forward(psi, &mut samples, choices.extent, level);
    }
    let [width, height, _] = choices.extent;
    let extent = choices.coarsened(level).extent;
    let inside = |place: usize| {
        place % width < extent[0]
            && place / width % height < extent[1]
            && place / (width * height) < extent[2]
    };
    let low_pass = samples.iter().enumerate().filter(|&(place, _)| inside(place)).map(|(_, &v)| v);
    Decoded { extent, samples: low_pass.collect() }
}
