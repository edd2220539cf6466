//! What one writes, the other reads.

use conformance::effort::Effort;
use conformance::inputs::Input;
use conformance::lent::encode;
use conformance::oracle::coder::SampleType;
use conformance::oracle::noise::Noise;
use conformance::oracle::tabled::{self, fit, sets};
use conformance::reference::sides;
use conformance::vectors::Manifest;
use wavelift_kernel::{Codec, Extent, Header, Plan, Wavelet};

use crate::{both, oracle, random_weights, written};

/// Of 2^14 samples or more, of which the kernel writes a table.
const EXTENTS: [[u32; 3]; 14] = [
    [128, 128, 1],
    [129, 131, 1],
    [1, 16_387, 1],
    [2, 8_193, 1],
    [8_194, 2, 1],
    [1, 1, 16_385],
    [1, 131, 127],
    [130, 1, 127],
    [8_193, 1, 2],
    [26, 25, 27],
    [3, 74, 75],
    [5, 2, 1_640],
    [67, 123, 2],
    [1_366, 3, 4],
];

/// Inputs and types that are tabled: what is left of them is not nearly as wide as the type.
fn inputs() -> Vec<(Input, SampleType)> {
    let waves = |amplitude, offset| Input::Waves { periods: [230, 170, 130], amplitude, offset };
    vec![
        (waves(100, 128), SampleType::U8),
        (waves(120, 0), SampleType::I8),
        (waves(30_000, 32_768), SampleType::U16),
        (waves(20_000, -1000), SampleType::I16),
        (waves(260_000, -2_147_000_000), SampleType::I32),
        (waves(200_000, 4_000_000_000), SampleType::U32),
        (Input::Steps { width: 9, height: 1, offset: -900 }, SampleType::I16),
        (Input::Noise { bits: 7, offset: -100, seed: 4 }, SampleType::I8),
        (Input::Noise { bits: 19, offset: -400_000, seed: 5 }, SampleType::I32),
        (Input::Sparse { one_in: 40, bits: 12, seed: 6 }, SampleType::U16),
        (Input::Constant { value: -77 }, SampleType::I8),
    ]
}

fn kernel_type(sample_type: SampleType) -> wavelift_kernel::SampleType {
    let index = SampleType::ALL.iter().position(|&t| t == sample_type);
    wavelift_kernel::SampleType::ALL[index.expect("all are listed")]
}

/// Where the one segment begins: after magic, version, storage, type, levels and four numbers.
fn segment_of(bytes: &[u8]) -> &[u8] {
    let mut last_bytes = bytes.iter().enumerate().skip(6).filter(|(_, byte)| **byte < 0x80);
    let (last, _) = last_bytes.nth(3).expect("extent and length");
    &bytes[last + 1..]
}

#[test]
fn what_the_kernel_writes_is_read() {
    let mut codec = Codec::NEW;
    for axes in EXTENTS {
        for (input, sample_type) in inputs() {
            let extent = Extent::new(axes).expect("an extent");
            let plan = Plan::new(Wavelet::Haar, extent, 0).expect("a plan");
            let samples = input.generate(extent).expect("a generator");
            let bytes = encode(&mut codec, Effort::Tabled, &plan, kernel_type(sample_type), &samples);
            assert_eq!(bytes[3], 3, "{axes:?} {input:?} is tabled");
            let found = oracle(segment_of(&bytes), sides(extent), sample_type);
            assert!(found == Ok(samples), "{axes:?} {input:?} {sample_type:?}: {:?}", found.err());
        }
    }
}

#[test]
fn what_the_oracle_writes_is_read() {
    let mut noise = Noise::new(1);
    let sides = [1, 2, 3, 4, 5, 9];
    let rows = sides.iter().flat_map(|&y| sides.map(|z| [y, z])).filter(|&[y, z]| y * z > 1);
    for [height, depth] in rows.collect::<Vec<_>>() {
        for width in [1, 2, 3, 4, 5, 6, 7, 8, 17] {
            for (input, sample_type) in inputs() {
                let extent = Extent::new([width, height, depth]).expect("an extent");
                let samples = input.generate(extent).expect("a generator");
                let extent = [width, height, depth].map(|n| n as usize);
                let segment = written(&samples, extent, random_weights(extent, &mut noise));
                assert!(both(&segment, extent, sample_type) == Ok(samples), "{extent:?} {input:?}");
            }
        }
    }
}

/// Gradients, with which all weights add up to more than one.
#[test]
fn weights_at_their_limits_are_read() {
    let extent = [13, 11, 7];
    let mut noise = Noise::new(2);
    let samples = noise.within(262_143, 13 * 11 * 7);
    for weight in [2047, -2048] {
        for place in 0..13 {
            let alone = |count: usize| (0..count).map(move |i| if i == place % count { weight } else { 0 });
            let weights = sets(extent).into_iter().map(|count| alone(count).collect()).collect();
            let segment = written(&samples, extent, weights);
            assert!(both(&segment, extent, SampleType::I32).as_ref() == Ok(&samples), "{weight} {place}");
        }
    }
}

/// The kernel gives a class that only has token 0 a table of one; none at all says the same.
#[test]
fn a_class_without_tokens_has_the_first() {
    let extent = [9, 8, 1];
    // One step in each row, the same but for the last.
    let samples: Vec<i32> = (0..72).map(|i| if i % 9 > 4 || i == 70 { 40 } else { 0 }).collect();
    let weights = vec![vec![0, 0, 0, 256, 0, 0]];
    let mut model = fit(&samples, extent, [0, 40], weights);
    let full = model.clone();
    model.tables.iter_mut().filter(|table| **table == [4096]).for_each(Vec::clear);
    assert_ne!(model, full, "no class has one token only");
    for model in [model, full] {
        let segment = tabled::encode(&samples, extent, [0, 40], &model).bytes();
        assert_eq!(both(&segment, extent, SampleType::U8).as_ref(), Ok(&samples));
    }
}

#[test]
fn golden_vectors_are_those_of_the_oracle() {
    let manifest = Manifest::read().expect("the manifest");
    let mut tabled = 0;
    for vector in &manifest.vectors {
        let bytes = vector.read().expect("its file");
        if bytes.get(3) == Some(&3)
            && let Ok(header) = Header::parse(&bytes)
        {
            let index = wavelift_kernel::SampleType::ALL.iter().position(|&t| t == header.sample_type());
            let sample_type = SampleType::ALL[index.expect("all are listed")];
            let found = both(segment_of(&bytes), sides(header.plan().extent()), sample_type);
            assert!(vector.input.is_none() || found.ok() == manifest.samples(vector).ok(), "{}", vector.id);
            tabled += 1;
        }
    }
    assert!(tabled > 0, "no tabled vector");
}
