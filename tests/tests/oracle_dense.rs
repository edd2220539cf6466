//! The plain decoder of dense codestreams against the kernel's encoder.

use conformance::effort::Effort;
use conformance::inputs::Input;
use conformance::lent::{decode_any, encode};
use conformance::oracle::coder::{self, Reject};
use conformance::oracle::dense;
use conformance::reference::sides;
use conformance::vectors::Manifest;
use wavelift_kernel::{Codec, DecodeError, Extent, Header, Malformed, Plan, SampleType, Wavelet};

/// What the oracle makes of a dense codestream.
fn decode(bytes: &[u8]) -> Result<Vec<i32>, Reject> {
    let header = Header::parse(bytes).expect("a codestream");
    assert!(header.is_dense(), "stored or coded");
    let index = wavelift_kernel::SampleType::ALL.iter().position(|&known| known == header.sample_type());
    let sample_type = coder::SampleType::ALL[index.expect("all are listed")];
    dense::decode(&bytes[segment_start(bytes)..], sides(header.plan().extent()), sample_type)
}

/// Where the one segment begins: after magic, version, storage, type, levels and four numbers.
fn segment_start(bytes: &[u8]) -> usize {
    let mut last_bytes = bytes.iter().enumerate().skip(6).filter(|(_, byte)| **byte < 0x80);
    let (last, _) = last_bytes.nth(3).expect("extent and length");
    last + 1
}

fn encoded(input: &Input, extent: [u32; 3], sample_type: SampleType) -> (Vec<u8>, Vec<i32>) {
    let extent = Extent::new(extent).expect("an extent");
    let plan = Plan::new(Wavelet::Haar, extent, 0).expect("a plan");
    let samples = input.generate(extent).expect("a generator");
    let bytes = encode(&mut { Codec::NEW }, Effort::Dense, &plan, sample_type, &samples);
    (bytes, samples)
}

fn check(input: &Input, extent: [u32; 3], sample_type: SampleType) {
    let (bytes, samples) = encoded(input, extent, sample_type);
    assert!(decode(&bytes) == Ok(samples), "{input:?} {extent:?} {sample_type:?}");
}

const EXTENTS: [[u32; 3]; 16] = [
    [60, 1, 1],
    [700, 1, 1],
    [1, 400, 1],
    [1, 1, 129],
    [30, 21, 1],
    [70, 33, 1],
    [193, 40, 1],
    [1, 37, 29],
    [40, 1, 30],
    [19, 17, 9],
    [2, 50, 6],
    [67, 11, 5],
    [6337, 6, 1],
    [600, 9, 3],
    [5, 90, 12],
    [33, 3, 40],
];

fn waves(amplitude: i64) -> Input {
    Input::Waves { periods: [23, 17, 13], amplitude, offset: 0 }
}

#[test]
fn smooth_samples_of_every_shape_and_span_are_decoded() {
    for extent in EXTENTS {
        check(&waves(100), extent, SampleType::I8);
        check(&waves(20_000), extent, SampleType::I16);
        check(&waves(16_000_000), extent, SampleType::I32);
    }
}

#[test]
fn plateaus_and_noise_are_decoded() {
    for extent in EXTENTS {
        check(&Input::Steps { width: 9, height: 31, offset: -500 }, extent, SampleType::I16);
        check(&Input::Noise { bits: 12, offset: 0, seed: 4 }, extent, SampleType::U16);
        check(&Input::Noise { bits: 25, offset: -2_147_483_648, seed: 5 }, extent, SampleType::U32);
        check(&Input::Constant { value: 9 }, extent, SampleType::U8);
    }
}

#[test]
fn golden_vectors_are_those_of_the_oracle() {
    let manifest = Manifest::read().expect("the manifest");
    let mut dense = 0;
    for vector in &manifest.vectors {
        let bytes = vector.read().expect("its file");
        if Header::parse(&bytes).is_ok_and(|header| header.is_dense()) && vector.input.is_some() {
            assert!(decode(&bytes).ok() == manifest.samples(vector).ok(), "{}", vector.id);
            dense += 1;
        }
    }
    assert!(dense > 0, "no dense vector");
}

#[test]
fn damage_is_decoded_or_rejected_alike() {
    for (amplitude, sample_type) in
        [(120, SampleType::I8), (900, SampleType::I16), (9_000_000, SampleType::I32)]
    {
        for extent in [[90, 1, 1], [17, 15, 1], [9, 8, 5]] {
            let (mut bytes, _) = encoded(&waves(amplitude), extent, sample_type);
            let header = Header::parse(&bytes).expect("a codestream");
            for bit in 8 * segment_start(&bytes)..8 * bytes.len() {
                bytes[bit / 8] ^= 1 << (bit % 8);
                let expected = decode(&bytes).map_err(|wrong| match wrong {
                    Reject::Segment => DecodeError::Malformed(Malformed::Segment),
                    Reject::Sample => DecodeError::Malformed(Malformed::Sample),
                    other => panic!("{other:?}"),
                });
                let found = decode_any(&bytes, 0, &header);
                assert!(
                    found == expected,
                    "{extent:?} {sample_type:?} bit {bit}: {:?} {:?}",
                    found.err(),
                    expected.err()
                );
                bytes[bit / 8] ^= 1 << (bit % 8);
            }
        }
    }
}
