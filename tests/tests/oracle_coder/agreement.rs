//! Sound codestreams: every wavelet, mixed extents, many kinds of data, every predictor.

use conformance::effort::Effort;
use conformance::oracle::coder::{
    self, Choices, Decoded, Header, Predictor, Storage, decode, encode, encode_as, shapes,
};
use conformance::oracle::lifting::{Psi, max_levels};
use conformance::oracle::noise::Noise;
use conformance::reference::{low_pass, psi, sides};
use conformance::vectors::Manifest;
use wavelift_kernel::{Extent, Plan, SampleType, Wavelet};

use super::{any_predictors, both_decode, kernel_encode, plan, uniform_predictors};

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

/// The part of a codestream that `level` needs.
fn bytes_to_level(bytes: &[u8], level: u8) -> &[u8] {
    let header = Header::parse(bytes).expect("it is sound");
    let segments = header.lengths.len().saturating_sub(level.into()).max(1);
    &bytes[..header.bytes + header.lengths[..segments].iter().sum::<usize>()]
}

/// The choices that the kernel's encoder makes of a codestream.
#[derive(Debug, Default)]
struct Tally {
    stored: usize,
    fixed: [usize; 5],
    zero: usize,
    weights_of_low_pass: usize,
    weights_of_details: usize,
}

impl Tally {
    fn add(&mut self, bytes: &[u8]) {
        let choices = Header::parse(bytes).expect("it is sound").choices;
        let predictors = coder::predictors(bytes).expect("it is sound");
        self.stored += usize::from(choices.storage == Storage::Stored);
        for (predictor, shape) in predictors.iter().zip(shapes(&choices)) {
            match predictor {
                Predictor::Fixed(number) => self.fixed[usize::from(*number)] += 1,
                Predictor::Zero => self.zero += 1,
                Predictor::Weights(_) if shape.is_low_pass => self.weights_of_low_pass += 1,
                Predictor::Weights(_) => self.weights_of_details += 1,
            }
        }
    }
}

/// Decodes what the kernel encodes, by both and to every level, and encodes it again by the oracle; then has the kernel
/// decode what the oracle encodes with other predictors.
fn assert_agreement(
    effort: Effort,
    plan: &Plan,
    sample_type: SampleType,
    samples: &[i32],
    tally: &mut Tally,
) {
    let bytes = kernel_encode(effort, plan, sample_type, samples);
    tally.add(&bytes);
    let choices = Header::parse(&bytes).expect("it is sound").choices;
    let wavelet = (plan.levels() > 0).then(|| psi(plan.wavelet()));
    assert_eq!((choices.psi, choices.levels), (wavelet, plan.levels().into()));
    for level in 0..=plan.levels() {
        let samples = low_pass(plan, samples, level);
        let extent = sides(plan.extent().coarsened(level));
        let decoded = both_decode(bytes_to_level(&bytes, level), level);
        assert_eq!(decoded, Ok(Decoded { extent, samples }), "{effort:?} {plan:?} {sample_type:?}");
    }
    assert_eq!(encode_as(&bytes, samples), bytes, "{effort:?} {plan:?} {sample_type:?}");
}

/// Has both decode, to every level, what the oracle encodes with any predictors.
fn assert_any_predictors(
    storage: Storage,
    plan: &Plan,
    sample_type: SampleType,
    samples: &[i32],
    noise: &mut Noise,
) {
    let choices = Choices {
        storage,
        sample_type: coder::SampleType::ALL[sample_type as usize],
        psi: (plan.levels() > 0).then(|| psi(plan.wavelet())),
        levels: plan.levels().into(),
        extent: sides(plan.extent()),
    };
    let uniform = (noise.bits() % 5) as u8;
    for predictors in [any_predictors(noise, &choices), uniform_predictors(uniform, &choices)] {
        let bytes = encode(&choices, &predictors, samples);
        assert_eq!(coder::predictors(&bytes), Ok(predictors));
        for level in 0..=plan.levels() {
            let samples = low_pass(plan, samples, level);
            let extent = sides(plan.extent().coarsened(level));
            assert_eq!(both_decode(bytes_to_level(&bytes, level), level), Ok(Decoded { extent, samples }));
        }
    }
}

#[test]
fn kernel_and_oracle_read_each_other() {
    let (mut noise, mut tally) = (Noise::new(3), Tally::default());
    for (turn, plan) in plans().flat_map(|plan| [plan; 2]).enumerate() {
        let (sample_type, field) = DATA[(turn + turn / DATA.len()) % DATA.len()];
        let samples = samples_of(field, sides(plan.extent()), turn as u64);
        for effort in [Effort::Fast, Effort::Default, Effort::Light] {
            assert_agreement(effort, &plan, sample_type, &samples, &mut tally);
        }
        for storage in [Storage::Coded, Storage::Light] {
            assert_any_predictors(storage, &plan, sample_type, &samples, &mut noise);
        }
    }
    println!("{tally:?}");
    assert!(tally.stored > 0 && tally.zero > 0, "the kernel's encoder makes every choice");
    assert!(tally.fixed.iter().all(|&count| count > 0), "the kernel's encoder makes every choice");
    assert!(tally.weights_of_low_pass > 0 && tally.weights_of_details > 0, "the kernel's encoder trains");
}

/// Plans of subbands of some thousand coefficients, along all axes and along few.
fn large_plans() -> [Plan; 17] {
    [
        (None, [5000, 1, 1], 0),
        (None, [1, 1, 3000], 0),
        (None, [80, 73, 1], 0),
        (None, [1, 60, 75], 0),
        (None, [61, 1, 73], 0),
        (None, [2, 1500, 2], 0),
        (None, [23, 17, 15], 0),
        (None, [4096, 1, 1], 0),
        (None, [16, 16, 16], 0),
        (Some(Wavelet::Haar), [9025, 1, 1], 1),
        (Some(Wavelet::Quadratic), [130, 121, 1], 1),
        (Some(Wavelet::Linear), [93, 97, 1], 2),
        (Some(Wavelet::Cubic), [36, 34, 32], 1),
        (Some(Wavelet::Duchaineau), [33, 34, 35], 2),
        (Some(Wavelet::Quintic), [1, 126, 120], 1),
        (Some(Wavelet::Linear), [50, 1, 63], 1),
        (Some(Wavelet::Haar), [111, 107, 2], 1),
    ]
    .map(|(wavelet, extent, levels)| plan(wavelet, extent, levels))
}

#[test]
fn kernel_and_oracle_agree_on_trained_weights() {
    let mut tally = Tally::default();
    for (turn, (plan, (sample_type, field))) in
        large_plans().iter().flat_map(|plan| DATA.map(|data| (plan, data))).enumerate()
    {
        let samples = samples_of(field, sides(plan.extent()), turn as u64);
        assert_agreement(Effort::Default, plan, sample_type, &samples, &mut tally);
    }
    println!("{tally:?}");
    assert!(tally.weights_of_low_pass >= 20, "the kernel's encoder trains too seldom");
    assert!(tally.weights_of_details >= 20, "the kernel's encoder trains too seldom");
}

/// The storage field of tabled codestreams, which have a page, and tests, of their own.
const TABLED: [u8; 3] = [3, 4, 6];

#[test]
fn golden_vectors_are_those_of_the_oracle() {
    for vector in Manifest::read().expect("the manifest").vectors {
        let bytes = vector.read().expect("its file");
        let header = wavelift_kernel::Header::parse(&bytes);
        if header.is_ok_and(|header| header.is_dense() || header.slack().is_some())
            || vector.file.starts_with("streams/")
            || bytes.get(3).is_some_and(|storage| TABLED.contains(storage))
        {
            continue;
        }
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
        let sample_type = coder::SampleType::ALL[turn / 6 % 6];
        let samples: Vec<_> = noise
            .full_range(extent.iter().product())
            .into_iter()
            .map(|v| sample_type.value_of(&sample_type.bytes_of(v)))
            .collect();
        let choices = Choices { storage: Storage::Coded, sample_type, psi, levels, extent };
        let predictors = any_predictors(&mut noise, &choices);
        let stream = encode(&choices, &predictors, &samples);
        assert_eq!(Header::parse(&stream).expect("it is sound").choices, choices);
        for level in 1..=levels as u8 {
            assert!(both_decode(bytes_to_level(&stream, level), level).is_ok(), "{choices:?}");
        }
        assert_eq!(both_decode(&stream, 0), Ok(Decoded { extent, samples }), "{choices:?} {predictors:?}");
    }
}

#[test]
fn oracle_decodes_what_it_encodes() {
    let mut noise = Noise::new(1);
    let psis = Psi::ALL.into_iter().map(Some).chain([None]);
    let pairs = psis.flat_map(|psi| [[17, 1, 1], [6, 9, 1], [5, 4, 7]].map(|extent| (psi, extent)));
    for ((psi, extent), sample_type) in
        pairs.flat_map(|pair| coder::SampleType::ALL.map(|sample_type| (pair, sample_type)))
    {
        let levels = psi.map_or(0, |_| max_levels(extent));
        let samples = noise.full_range(extent.iter().product());
        let samples: Vec<_> =
            samples.into_iter().map(|v| sample_type.value_of(&sample_type.bytes_of(v))).collect();
        for storage in [Storage::Coded, Storage::Light, Storage::Stored] {
            let choices = Choices { storage, sample_type, psi, levels, extent };
            let bytes = encode(&choices, &any_predictors(&mut noise, &choices), &samples);
            let decoded = Decoded { extent, samples: samples.clone() };
            assert_eq!(decode(&bytes, 0), Ok(decoded), "{choices:?}");
        }
    }
}
