//! Sound codestreams: every wavelet, mixed extents, many kinds of data, every predictor.

use conformance::oracle::coder::{self, Choices, Decoded, Header, Storage, decode, encode, encode_as};
use conformance::oracle::lifting::{Psi, max_levels};
use conformance::oracle::noise::Noise;
use conformance::reference::{psi, sides};
use conformance::vectors::Manifest;
use wavelift_kernel::{Extent, Plan, SampleType, Wavelet};

use super::{any_weights, both_decode, kernel_encode, plan};

const LENGTHS: [u32; 12] = [1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 31, 33];

/// Lines, slices and bricks of mixed lengths, and one long one of each.
fn extents() -> impl Iterator<Item = [u32; 3]> {
    let length = |i: usize| LENGTHS[i % LENGTHS.len()];
    let lines = LENGTHS.map(|n| [n, 1, 1]);
    let slices = (0..12).flat_map(move |i| [1, 5, 8].map(|k| [length(i), length(i + k), 1]));
    let bricks = (0..12)
        .flat_map(move |i| [0, 1, 2, 3].map(|k| [length(i), length(5 * i + k), length(7 * i + 3 * k)]));
    let long = [[4000, 1, 1], [90, 70, 1], [40, 32, 20]];
    lines.into_iter().chain(slices).chain(bricks).chain(long)
}

/// Every wavelet, and none, over every extent; every second time all levels, else fewer.
fn plans() -> impl Iterator<Item = Plan> {
    let wavelets = Wavelet::ALL.into_iter().map(Some).chain([None]);
    let pairs = wavelets.flat_map(|wavelet| extents().map(move |extent| (wavelet, extent)));
    (0..).zip(pairs).filter_map(|(turn, (wavelet, extent))| {
        let most = Extent::new(extent).expect("no axis is empty").max_levels();
        match (wavelet, most) {
            (None, _) => Some(plan(None, extent, 0)),
            (Some(_), 0) => None,
            (Some(_), _) => {
                Some(plan(wavelet, extent, if turn % 2 == 0 { most } else { 1 + turn as u8 % most }))
            }
        }
    })
}

/// A sample at a place; of more than 32 bits it keeps the low ones.
type Field = fn(&mut Noise, [i64; 3]) -> i64;

/// Data for every class and every part of a value.
const DATA: [(SampleType, Field); 16] = [
    (SampleType::U8, |_, [x, y, z]| (60 + x + 2 * y + (x * y + z * z) / 32) & 0xFF),
    (SampleType::I16, |_, [x, y, z]| (30 * x - 20 * y + 100 * z - x * z) % (1 << 15)),
    (SampleType::I32, |_, [x, y, z]| (x * x * 70_000 - y * z * 90_000) + (x - 8).pow(3) * 1000),
    // planes alike, and planes that change alike
    (SampleType::U16, |noise, [x, y, _]| texture(x, y) + (noise.bits() % 3) as i64),
    (SampleType::I32, |noise, [x, y, z]| texture(x, y) + z * texture(y, x) + (noise.bits() % 2) as i64),
    (SampleType::U8, |noise, _| (noise.bits() >> 63) as i64),
    (SampleType::I8, |noise, _| (noise.bits() >> 59) as i64 - 16),
    (SampleType::U16, |noise, _| (noise.bits() >> 54) as i64),
    (SampleType::I16, |noise, _| (noise.bits() >> 48) as i64 - (1 << 15)),
    (SampleType::I32, |noise, _| (noise.bits() >> 40) as i64),
    (SampleType::I32, |noise, _| i64::from(noise.full_range(1)[0])),
    (SampleType::U32, |noise, _| noise.bits() as i64),
    (SampleType::U8, |noise, _| i64::from(noise.bits().is_multiple_of(20)) * 200),
    (SampleType::I32, |noise, _| i64::from(noise.bits().is_multiple_of(50)) * (noise.bits() as i64 >> 8)),
    (SampleType::I8, |_, _| 0),
    (SampleType::U32, |_, _| 4_000_000_000),
];

/// 12 bits that belong to a place.
fn texture(x: i64, y: i64) -> i64 {
    (Noise::new((64 * x + y) as u64).bits() >> 52) as i64
}

fn samples_of(field: Field, [width, height, depth]: [usize; 3], seed: u64) -> Vec<i32> {
    let mut noise = Noise::new(seed);
    (0..width * height * depth)
        .map(|at| [at % width, at / width % height, at / (width * height)].map(|k| k as i64))
        .map(|place| field(&mut noise, place) as i32)
        .collect()
}

/// Storage under every predictor without weights, and as it is.
fn storages() -> impl Iterator<Item = Storage> {
    (0..=4).map(|predictor| Storage::Coded { predictor }).chain([Storage::Stored])
}

/// Whether the low-pass part has more than one plane.
fn has_planes(plan: &Plan) -> bool {
    plan.extent().coarsened(plan.levels()).axes()[2] > 1
}

/// The part of a codestream that `level` needs.
fn bytes_to_level(bytes: &[u8], level: u8) -> &[u8] {
    let header = Header::parse(bytes).expect("it is sound");
    let segments = header.lengths.len().saturating_sub(level.into()).max(1);
    &bytes[..header.bytes + header.lengths[..segments].iter().sum::<usize>()]
}

/// Encodes by both and decodes, by both and to every level, what either makes; what storage the kernel chose.
fn assert_agreement(plan: &Plan, sample_type: SampleType, samples: &[i32]) -> Storage {
    let bytes = kernel_encode(plan, sample_type, samples);
    assert_eq!(encode_as(&bytes, samples), bytes, "{plan:?} {sample_type:?}");
    let choices = Header::parse(&bytes).expect("it is sound").choices;
    let wavelet = (plan.levels() > 0).then(|| psi(plan.wavelet()));
    assert_eq!((choices.psi, choices.levels), (wavelet, plan.levels().into()));
    let levels: Vec<_> = (0..=plan.levels()).map(|level| both_decode(&bytes, level)).collect();
    assert_eq!(levels[0], Ok(Decoded { extent: sides(plan.extent()), samples: samples.to_vec() }));
    let weights = any_weights(&mut Noise::new(samples.len() as u64), has_planes(plan));
    for storage in storages().chain([Storage::Trained { weights }]) {
        let stream = encode(&Choices { storage, ..choices }, samples);
        for (level, expected) in (0..).zip(&levels) {
            assert_eq!(
                both_decode(bytes_to_level(&stream, level), level),
                *expected,
                "{storage:?} of {plan:?}"
            );
        }
    }
    choices.storage
}

#[test]
fn kernel_and_oracle_write_the_same_bytes_and_read_each_other() {
    let cases = plans().flat_map(|plan| [plan; 2]).enumerate();
    let chosen: Vec<_> = cases
        .map(|(turn, plan)| {
            let (sample_type, field) = DATA[(turn + turn / DATA.len()) % DATA.len()];
            assert_agreement(&plan, sample_type, &samples_of(field, sides(plan.extent()), turn as u64))
        })
        .collect();
    assert!(storages().all(|storage| chosen.contains(&storage)), "the kernel's encoder makes every choice");
}

/// Plans whose low-pass part has the 512 samples that the kernel's encoder asks for before it trains, along all axes
/// and along few.
fn large_plans() -> [Plan; 17] {
    [
        (None, [700, 1, 1], 0),
        (None, [1, 1, 600], 0),
        (None, [40, 33, 1], 0),
        (None, [1, 30, 25], 0),
        (None, [31, 1, 33], 0),
        (None, [2, 300, 2], 0),
        (None, [13, 11, 9], 0),
        (None, [512, 1, 1], 0),
        (None, [8, 8, 8], 0),
        (Some(Wavelet::Haar), [1025, 1, 1], 1),
        (Some(Wavelet::Quadratic), [70, 61, 1], 1),
        (Some(Wavelet::Linear), [93, 97, 1], 2),
        (Some(Wavelet::Cubic), [26, 24, 22], 1),
        (Some(Wavelet::Duchaineau), [33, 34, 35], 2),
        (Some(Wavelet::Quintic), [1, 66, 70], 1),
        (Some(Wavelet::Linear), [50, 1, 63], 1),
        (Some(Wavelet::Haar), [51, 47, 2], 1),
    ]
    .map(|(wavelet, extent, levels)| plan(wavelet, extent, levels))
}

#[test]
fn kernel_and_oracle_agree_on_trained_weights() {
    let (mut of_planes, mut of_one_plane) = (0, 0);
    for (turn, (plan, (sample_type, field))) in
        large_plans().iter().flat_map(|plan| DATA.map(|data| (plan, data))).enumerate()
    {
        let samples = samples_of(field, sides(plan.extent()), turn as u64);
        if let Storage::Trained { .. } = assert_agreement(plan, sample_type, &samples) {
            *(if has_planes(plan) { &mut of_planes } else { &mut of_one_plane }) += 1;
        }
    }
    println!("trained: {of_planes} with several planes, {of_one_plane} with one");
    assert!(of_planes >= 10 && of_one_plane >= 10, "the kernel's encoder trains too seldom");
}

#[test]
fn golden_vectors_are_those_of_the_oracle() {
    for vector in Manifest::read().expect("the manifest").vectors {
        let bytes = vector.read().expect("its file");
        match both_decode(&bytes, 0) {
            Ok(Decoded { samples, .. }) => assert_eq!(encode_as(&bytes, &samples), bytes, "{}", vector.id),
            Err(_) => assert!(vector.file.starts_with("reject/"), "{}", vector.id),
        }
    }
}

#[test]
fn any_weights_predict_the_same() {
    let mut noise = Noise::new(12);
    for turn in 0..3000 {
        let extent = [0; 3].map(|_| 1 + noise.bits() as usize % 6);
        let levels = noise.bits() as usize % (1 + max_levels(extent)).min(3);
        let psi = (levels > 0).then(|| Psi::ALL[turn % Psi::ALL.len()]);
        let weights = any_weights(&mut noise, extent[2].div_ceil(1 << levels) > 1);
        let sample_type = [coder::SampleType::I32, coder::SampleType::U32, coder::SampleType::I16][turn % 3];
        let samples: Vec<_> = noise
            .full_range(extent.iter().product())
            .into_iter()
            .map(|v| if sample_type == coder::SampleType::I16 { v >> 16 } else { v })
            .collect();
        let choices = Choices { storage: Storage::Trained { weights }, sample_type, psi, levels, extent };
        let stream = encode(&choices, &samples);
        assert_eq!(Header::parse(&stream).expect("it is sound").choices, choices);
        for level in 1..=levels as u8 {
            assert!(both_decode(bytes_to_level(&stream, level), level).is_ok(), "{choices:?}");
        }
        assert_eq!(both_decode(&stream, 0), Ok(Decoded { extent, samples }), "{choices:?}");
    }
}

#[test]
fn oracle_decodes_what_it_encodes() {
    let psis = Psi::ALL.into_iter().map(Some).chain([None]);
    let pairs = psis.flat_map(|psi| [[17, 1, 1], [6, 9, 1], [5, 4, 7]].map(|extent| (psi, extent)));
    for ((psi, extent), (code, storage)) in
        pairs.flat_map(|pair| storages().enumerate().map(move |s| (pair, s)))
    {
        let sample_type = coder::SampleType::ALL[code];
        let levels = psi.map_or(0, |_| max_levels(extent));
        let noise = Noise::new(code as u64).full_range(extent.iter().product());
        let samples: Vec<_> =
            noise.into_iter().map(|v| sample_type.value_of(&sample_type.bytes_of(v))).collect();
        let choices = Choices { storage, sample_type, psi, levels, extent };
        assert_eq!(decode(&encode(&choices, &samples), 0), Ok(Decoded { extent, samples }), "{choices:?}");
    }
}
