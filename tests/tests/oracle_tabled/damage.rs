//! Damage is decoded or refused alike.

use conformance::corrupt::Damage;
use conformance::inputs::Input;
use conformance::oracle::coder::SampleType;
use conformance::oracle::noise::Noise;
use wavelift_kernel::Extent;

use crate::{both, random_weights, written};

const EXTENTS: [[u32; 3]; 5] = [[9, 7, 1], [1, 40, 1], [7, 1, 9], [5, 6, 4], [1, 5, 9]];

/// A segment of each extent: from a few bits to as many as there can be.
fn segments() -> Vec<(Vec<u8>, [usize; 3], SampleType)> {
    let mut noise = Noise::new(3);
    let mut segments = Vec::new();
    for axes in EXTENTS {
        for (bits, sample_type) in
            [(3, SampleType::U8), (8, SampleType::U8), (13, SampleType::I16), (19, SampleType::I32)]
        {
            let input = Input::Noise { bits, offset: 0, seed: noise.bits() };
            let samples = input.generate(Extent::new(axes).expect("an extent")).expect("a generator");
            let extent = axes.map(|n| n as usize);
            segments.push((
                written(&samples, extent, random_weights(extent, &mut noise)),
                extent,
                sample_type,
            ));
        }
    }
    segments
}

#[test]
fn every_flipped_bit() {
    for (mut segment, extent, sample_type) in segments() {
        for bit in 0..8 * segment.len() {
            segment[bit / 8] ^= 1 << (bit % 8);
            let _decoded_or_refused = both(&segment, extent, sample_type);
            segment[bit / 8] ^= 1 << (bit % 8);
        }
    }
}

#[test]
fn every_prefix_is_refused() {
    for (segment, extent, sample_type) in segments() {
        for len in 0..segment.len() {
            assert!(both(&segment[..len], extent, sample_type).is_err(), "{len} of {}", segment.len());
        }
    }
}

#[test]
fn random_damage() {
    let segments = segments();
    let mut noise = Noise::new(4);
    let (mut decoded, mut refused) = (0, 0);
    for round in 0..20_000 {
        let (segment, extent, sample_type) = &segments[round % segments.len()];
        let (other, ..) = &segments[noise.bits() as usize % segments.len()];
        let mut damaged = segment.clone();
        Damage::ALL[round % Damage::ALL.len()].inflict(&mut damaged, other, &mut noise);
        match both(&damaged, *extent, *sample_type) {
            Ok(_) => decoded += 1,
            Err(_) => refused += 1,
        }
    }
    println!("{decoded} decoded, {refused} refused");
    assert!(decoded > 0 && refused > 10_000, "{decoded} decoded, {refused} refused");
}
