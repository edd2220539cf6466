//! Damage is decoded or refused alike.

use conformance::corrupt::Damage;
use conformance::inputs::Input;
use conformance::oracle::coder::SampleType;
use conformance::oracle::noise::Noise;
use conformance::oracle::tabled::{Breadth, Form};
use wavelift_kernel::Extent;

use crate::{both, random_model, written};

const EXTENTS: [[u32; 3]; 5] = [[9, 7, 1], [1, 40, 1], [7, 1, 9], [5, 6, 4], [1, 5, 9]];

/// A segment of each extent: from a few bits to as many as there can be.
fn segments() -> Vec<(Vec<u8>, Form, SampleType)> {
    let mut noise = Noise::new(3);
    let mut segments = Vec::new();
    for (breadth, axes) in Breadth::ALL.into_iter().flat_map(|breadth| EXTENTS.map(|axes| (breadth, axes))) {
        for (bits, sample_type) in
            [(3, SampleType::U8), (8, SampleType::U8), (13, SampleType::I16), (19, SampleType::I32)]
        {
            let bits = bits.min(breadth.span_limit().ilog2());
            let input = Input::Noise { bits, offset: 0, seed: noise.bits() };
            let samples = input.generate(Extent::new(axes).expect("an extent")).expect("a generator");
            let form = Form { breadth, extent: axes.map(|n| n as usize) };
            let segment = written(&samples, form, random_model(form, &mut noise));
            segments.push((segment, form, sample_type));
        }
    }
    segments
}

#[test]
fn every_flipped_bit() {
    for (mut segment, form, sample_type) in segments() {
        for bit in 0..8 * segment.len() {
            segment[bit / 8] ^= 1 << (bit % 8);
            let _decoded_or_refused = both(&segment, form, sample_type);
            segment[bit / 8] ^= 1 << (bit % 8);
        }
    }
}

#[test]
fn every_prefix_is_refused() {
    for (segment, form, sample_type) in segments() {
        for len in 0..segment.len() {
            assert!(both(&segment[..len], form, sample_type).is_err(), "{len} of {}", segment.len());
        }
    }
}

#[test]
fn random_damage() {
    let segments = segments();
    let mut noise = Noise::new(4);
    let (mut decoded, mut refused) = (0, 0);
    for round in 0..20_000 {
        let (segment, form, sample_type) = &segments[round % segments.len()];
        let (other, ..) = &segments[noise.bits() as usize % segments.len()];
        let mut damaged = segment.clone();
        Damage::ALL[round % Damage::ALL.len()].inflict(&mut damaged, other, &mut noise);
        match both(&damaged, *form, *sample_type) {
            Ok(_) => decoded += 1,
            Err(_) => refused += 1,
        }
    }
    println!("{decoded} decoded, {refused} refused");
    assert!(decoded > 0 && refused > 10_000, "{decoded} decoded, {refused} refused");
}
