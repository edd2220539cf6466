//! Encoding loses nothing, costs little, and holds every level that it says it holds.

use conformance::effort::Effort;
use conformance::inputs::Input;
use conformance::lent::{Lent, decode, encode, encode_within};
use conformance::reference::{forward, low_pass};
use conformance::vectors::Manifest;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use wavelift_kernel::{Codec, Extent, Header, Plan, SampleType, Wavelet, max_encoded_len};

/// Samples and what to do with them.
#[derive(Debug)]
struct Case {
    effort: Effort,
    plan: Plan,
    sample_type: SampleType,
    input: Input,
}

impl Case {
    fn samples(&self) -> Vec<i32> {
        self.input.generate(self.plan.extent()).expect("a generator")
    }
}

/// Lines, slices and bricks along any axes, and some in which predictors are trained.
fn extent() -> impl Strategy<Value = Extent> {
    let axes = prop_oneof![
        [1..=300_u32, 1..=1, 1..=1],
        [1..=1_u32, 1..=200, 1..=1],
        [1..=1_u32, 1..=1, 1..=200],
        [1..=40_u32, 1..=40, 1..=1],
        [1..=30_u32, 1..=1, 1..=30],
        [1..=1_u32, 1..=30, 1..=30],
        [1..=13_u32, 1..=13, 1..=13],
        [2500..=5000_u32, 1..=1, 1..=1],
        [50..=100_u32, 50..=100, 1..=1],
        [13..=25_u32, 13..=25, 13..=25],
    ];
    axes.prop_map(|axes| Extent::new(axes).expect("a small extent"))
}

prop_compose! {
    fn case()(
        effort in prop::sample::select(Effort::ALL.as_slice()),
        extent in extent(),
        wavelet in prop::sample::select(Wavelet::ALL.as_slice()),
        level in any::<u8>(),
        sample_type in prop::sample::select(SampleType::ALL.as_slice()),
        kind in 0..Input::KINDS,
        amount in any::<u8>(),
        seed in any::<u64>(),
    ) -> Case {
        let plan = Plan::new(wavelet, extent, level % (extent.max_levels() + 1)).expect("levels that it has");
        Case { effort, plan, sample_type, input: Input::of_kind(kind, sample_type, amount, seed) }
    }
}

/// Encodes, and checks what holds for all samples: nothing is lost, each level decodes from the bytes said to
/// suffice, to the low-pass part of the reference, and the codestream is hardly longer than the samples.
fn check(effort: Effort, plan: &Plan, sample_type: SampleType, samples: &[i32]) -> (Vec<u8>, Header) {
    let mut codec = Codec::NEW;
    let bytes = encode(&mut codec, effort, plan, sample_type, samples);
    let raw = samples.len() * sample_type.bytes();
    assert!(bytes.len() <= raw + raw / 1000 + 32, "{} bytes for {raw} bytes of samples", bytes.len());
    assert!(Some(bytes.len()) <= max_encoded_len(plan.extent(), sample_type));
    let (again, _) = encode_within(&mut codec, effort, plan, sample_type, samples, bytes.len());
    assert_eq!(again.as_ref(), Ok(&bytes), "in an output of just its length");

    let header = Header::parse(&bytes).expect("a codestream");
    assert_eq!((header.sample_type(), header.encoded_bytes()), (sample_type, bytes.len() as u64));
    assert_eq!((header.plan().extent(), header.plan().levels()), (plan.extent(), plan.levels()));
    if plan.levels() > 0 {
        assert_eq!(header.plan().wavelet(), plan.wavelet());
    }
    for level in 0..=plan.levels() {
        let expected = low_pass(plan, samples, level);
        let enough = usize::try_from(header.bytes_to_level(level)).expect("a few bytes");
        for bytes in [&bytes[..enough], &bytes] {
            let decoded = decode(&mut codec, bytes, level, &header).expect("a codestream");
            assert!(decoded == expected, "level {level}");
        }
    }
    (bytes, header)
}

/// Slices and bricks large enough for tables, of widths that states take turns in and of others.
fn large_extent() -> impl Strategy<Value = Extent> {
    let axes = prop_oneof![
        [128..=140_u32, 128..=140, 1..=1],
        [1..=1_u32, 128..=140, 128..=140],
        [128..=140_u32, 1..=1, 128..=140],
        [26..=30_u32, 26..=30, 26..=30],
        [1..=5_u32, 100..=110, 164..=170],
        [2048..=2060_u32, 2..=3, 4..=5],
    ];
    axes.prop_map(|axes| Extent::new(axes).expect("a small extent"))
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 240,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(2),
        ..ProptestConfig::default()
    })]

    #[test]
    fn what_is_tabled_comes_back(
        extent in large_extent(),
        sample_type in prop::sample::select(SampleType::ALL.as_slice()),
        kind in 0..Input::KINDS,
        amount in any::<u8>(),
        seed in any::<u64>(),
    ) {
        let plan = Plan::new(Wavelet::Haar, extent, 0).expect("a plan");
        let samples = Input::of_kind(kind, sample_type, amount, seed).generate(extent).expect("a generator");
        let effort = if seed.is_multiple_of(2) { Effort::Tabled } else { Effort::Wide };
        check(effort, &plan, sample_type, &samples);
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 4000,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    #[test]
    fn every_level_comes_back(case in case()) {
        check(case.effort, &case.plan, case.sample_type, &case.samples());
    }

    #[test]
    fn single_values_of_full_range_come_back(
        samples in prop::collection::vec(any::<i32>(), 1..200),
        wavelet in prop::sample::select(Wavelet::ALL.as_slice()),
        effort in prop::sample::select(Effort::ALL.as_slice()),
    ) {
        let extent = Extent::line(u32::try_from(samples.len()).expect("a few")).expect("a line");
        let plan = Plan::new(wavelet, extent, extent.max_levels()).expect("levels that it has");
        check(effort, &plan, SampleType::I32, &samples);
        check(effort, &plan, SampleType::U32, &samples);
    }
}

/// A built-in data file as a plan of all levels, and its samples.
fn built_in(id: &str, wavelet: Wavelet) -> (Plan, Vec<i32>) {
    let manifest = Manifest::read().expect("the manifest");
    let (extent, samples) = manifest.data_samples(id).expect("a data file");
    (Plan::new(wavelet, extent, extent.max_levels()).expect("levels that it has"), samples)
}

/// For the linear wavelet this ties the kernel to JPEG 2000: `filters.rs` has that the reference is its 5/3.
#[test]
fn built_in_data_are_transformed_as_by_the_reference() {
    for wavelet in Wavelet::ALL {
        for id in ["rt_slice512", "rt_brick64"] {
            let (plan, samples) = built_in(id, wavelet);
            let (mut lent, mut scratch) = (Lent::samples(&samples), Lent::stale(plan.scratch_len()));
            plan.forward(lent.lend(), scratch.lend()).expect("memory of the right lengths");
            assert!(lent.take_back() == forward(&plan, &samples), "{wavelet:?} of {id}");
        }
    }
}

/// Bits that an ideal code of the values, each by itself, would take.
fn order_0_bits(values: &[i32]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable();
    let runs = sorted.chunk_by(|a, b| a == b).map(|run| run.len() as f64);
    runs.map(|count| count * (values.len() as f64 / count).log2()).sum()
}

#[test]
fn real_data_take_less_than_their_coefficients_one_by_one() {
    for wavelet in Wavelet::ALL {
        let (plan, samples) = built_in("rt_brick64", wavelet);
        let (bytes, _) = check(Effort::Default, &plan, SampleType::U8, &samples);
        let (bits, bound) = (bytes.len() as f64 * 8.0, 0.95 * order_0_bits(&forward(&plan, &samples)));
        println!("{wavelet:?}: {:.4}", bits / bound * 0.95);
        assert!(bits <= bound, "{wavelet:?}: {bits} bits, {bound} allowed");
    }
}

/// Bytes, header included, that are next to nothing for a brick of 64 samples along each axis: a bit for 136 samples.
const NEXT_TO_NOTHING: usize = 240;

fn brick(wavelet: Wavelet, levels: u8) -> Plan {
    let extent = Extent::brick(64, 64, 64).expect("a brick");
    Plan::new(wavelet, extent, levels).expect("levels that it has")
}

fn constant_bytes(effort: Effort, plan: &Plan, value: i32) -> usize {
    let samples = vec![value; plan.extent().samples()];
    encode(&mut { Codec::NEW }, effort, plan, SampleType::I32, &samples).len()
}

/// From values that no step can wrap to those that most do.
const CONSTANTS: [i32; 13] =
    [0, 1, -1, 2, 7, 100, 255, 12_345, -32_768, 1 << 20, 0x5555_5555, i32::MAX, i32::MIN];

#[test]
fn constant_bricks_without_details_cost_next_to_nothing() {
    for (effort, value) in Effort::ALL.into_iter().flat_map(|effort| CONSTANTS.map(|value| (effort, value))) {
        for levels in [0, 1, 3, 6] {
            let bytes = constant_bytes(effort, &brick(Wavelet::Haar, levels), value);
            assert!(bytes <= NEXT_TO_NOTHING, "haar, {levels} levels of {value}: {bytes} bytes, {effort:?}");
            // The sum of two such neighbours must not wrap.
            if value.unsigned_abs() < 1 << 30 {
                let bytes = constant_bytes(effort, &brick(Wavelet::Linear, levels), value);
                assert!(
                    bytes <= NEXT_TO_NOTHING,
                    "linear, {levels} levels of {value}: {bytes} bytes, {effort:?}"
                );
            }
        }
    }
    for (effort, wavelet) in
        Effort::ALL.into_iter().flat_map(|effort| Wavelet::ALL.map(|wavelet| (effort, wavelet)))
    {
        let bytes = constant_bytes(effort, &brick(wavelet, 6), 0);
        assert!(bytes <= NEXT_TO_NOTHING, "{wavelet:?} of 0: {bytes} bytes, {effort:?}");
    }
}

/// Where rounding leaves details of a constant, they are all alike, in magnitude and sign: hundreds of thousands of
/// them cost about a kilobyte.
#[test]
fn constant_bricks_cost_little_where_rounding_leaves_details() {
    let bounds = [240, 1300, 2150, 240, 1000, 950];
    for (wavelet, bound) in Wavelet::ALL.into_iter().zip(bounds) {
        for value in CONSTANTS.into_iter().filter(|value| value.unsigned_abs() <= 1 << 20) {
            let bytes = constant_bytes(Effort::Default, &brick(wavelet, 6), value);
            println!("{wavelet:?} of {value}: {bytes} bytes");
            assert!(bytes <= bound, "{wavelet:?} of {value}: {bytes} bytes");
        }
    }
}

/// Bricks of cells of two constant samples along each axis: the Haar wavelet leaves nothing of its finest level.
#[test]
fn a_level_without_details_costs_next_to_nothing() {
    let (plan, samples) = built_in("rt_brick64", Wavelet::Haar);
    let cell = |index: usize| samples[index & !(1 | 1 << 6 | 1 << 12)];
    let samples: Vec<i32> = (0..samples.len()).map(cell).collect();
    let (bytes, header) = check(Effort::Default, &plan, SampleType::U8, &samples);
    let finest = bytes.len() as u64 - header.bytes_to_level(1);
    assert!(finest <= 180, "{finest} bytes of zeros, {} in all", bytes.len());
}
