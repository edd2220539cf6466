//! The codestream, written and read the plain way, from `kernel/docs/codestream.md` alone. The bytes of a segment are
//! one long number in base 256, carried digit by digit, and every place of every subband is looked up anew.

mod arithmetic;
mod header;
mod scan;
mod value;

use super::lifting;
use arithmetic::{Decoder, Encoder};
pub use header::{Choices, Header, Reject, SampleType, Storage, Weights};
use scan::Scan;
use value::Models;

/// What a codestream holds at the level asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Decoded {
    /// Samples along x, y, z at this level.
    pub extent: [usize; 3],
    /// The samples, x fastest.
    pub samples: Vec<i32>,
}

/// The codestream of `samples` (x fastest) under these choices. Panics if the choices contradict each other, or if a
/// sample is outside its type.
pub fn encode(choices: &Choices, samples: &[i32]) -> Vec<u8> {
    assert_eq!(choices.check(), Ok(()), "the choices are those of some codestream");
    assert_eq!(samples.len(), choices.places(), "one sample a place");
    assert!(samples.iter().all(|&v| choices.sample_type.holds(v)), "a sample is outside its type");
    let segments = match choices.storage {
        Storage::Stored => {
            vec![samples.iter().flat_map(|&v| choices.sample_type.bytes_of(v)).collect()]
        }
        Storage::Coded { .. } | Storage::Trained { .. } => encode_segments(choices, samples),
    };
    let lengths: Vec<_> = segments.iter().map(Vec::len).collect();
    let mut bytes = header::write(choices, &lengths);
    bytes.extend(segments.into_iter().flatten());
    bytes
}

/// The codestream of other samples under the choices, weights included, that `stream` was written with. Panics if its header is malformed.
pub fn encode_as(stream: &[u8], samples: &[i32]) -> Vec<u8> {
    encode(&Header::parse(stream).expect("the header is sound").choices, samples)
}

/// Decodes the part of a codestream that makes `level`: 0 is full resolution. Panics if the codestream has no such level.
pub fn decode(bytes: &[u8], level: usize) -> Result<Decoded, Reject> {
    let header = Header::parse(bytes)?;
    assert!(level <= header.choices.levels, "the codestream has no level {level}");
    let segments = header.segments(bytes, level)?;
    if bytes.len() > header.total_bytes() {
        return Err(Reject::TrailingBytes);
    }
    match header.choices.storage {
        Storage::Stored => Ok(low_pass_of_stored(&header.choices, segments[0], level)),
        Storage::Coded { .. } | Storage::Trained { .. } => {
            let choices = header.choices.coarsened(level);
            let samples = decode_segments(&choices, &segments)?;
            if level == 0 && !samples.iter().all(|&v| choices.sample_type.holds(v)) {
                return Err(Reject::Sample);
            }
            Ok(Decoded { extent: choices.extent, samples })
        }
    }
}

fn encode_segments(choices: &Choices, samples: &[i32]) -> Vec<Vec<u8>> {
    let mut coefficients = samples.to_vec();
    if let Some(psi) = choices.psi {
        lifting::forward(psi, &mut coefficients, choices.extent, choices.levels);
    }
    let mut scan = Scan::new(choices, coefficients);
    let mut models = Models::new();
    (0..=choices.levels)
        .map(|resolution| {
            let mut segment = Encoder::new();
            scan.resolution(resolution, |context, value| {
                models.encode(&mut segment, context, value);
                value
            });
            segment.finish()
        })
        .collect()
}

fn decode_segments(choices: &Choices, segments: &[&[u8]]) -> Result<Vec<i32>, Reject> {
    let mut scan = Scan::new(choices, vec![0; choices.places()]);
    let mut models = Models::new();
    for (resolution, segment) in segments.iter().enumerate() {
        let mut decoder = Decoder::new(segment)?;
        scan.resolution(resolution, |context, _| models.decode(&mut decoder, context));
        decoder.finish()?;
    }
    let mut samples = scan.into_coefficients();
    if let Some(psi) = choices.psi {
        lifting::inverse(psi, &mut samples, choices.extent, choices.levels);
    }
    Ok(samples)
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
