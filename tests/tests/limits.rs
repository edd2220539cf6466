//! Lent memory of every length, and how large things are.

use std::collections::BTreeSet;

use conformance::effort::Effort;
use conformance::inputs::Input;
use conformance::lent::{Lent, decode, encode, encode_within};
use conformance::oracle::coder::{self, Predictor};
use conformance::oracle::noise::Noise;
use wavelift_kernel::{
    Codec, DecodeError, Dense, EncodeError, Extent, Header, Lattice, LengthError, Malformed, Plan, PlanError,
    SampleType, Slice, Training, Wavelet, max_encoded_len,
};

fn plan(wavelet: Wavelet, axes: [u32; 3], levels: u8) -> Plan {
    Plan::new(wavelet, Extent::new(axes).expect("an extent"), levels).expect("levels that it has")
}

/// What gives codestreams of several predictors, trained ones too, and stored ones, with every form of segment.
fn streams() -> Vec<(Effort, Plan, SampleType, Vec<i32>)> {
    let waves = Input::Waves { periods: [9, 13, 19], amplitude: 100, offset: 128 };
    let noise = Input::Noise { bits: 8, offset: 0, seed: 5 };
    let faint = Input::Noise { bits: 6, offset: 0, seed: 5 };
    let wide = Input::Waves { periods: [40, 50, 60], amplitude: 20, offset: 30 };
    let sparse = Input::Sparse { one_in: 200, bits: 8, seed: 1 };
    let cases = [
        (plan(Wavelet::Linear, [13, 9, 11], 4), SampleType::U8, waves.clone()),
        (plan(Wavelet::Cubic, [40, 21, 1], 6), SampleType::U16, waves.clone()),
        (plan(Wavelet::Haar, [300, 1, 1], 0), SampleType::I16, waves.clone()),
        (plan(Wavelet::Haar, [10, 9, 8], 0), SampleType::I16, waves),
        (plan(Wavelet::Haar, [3000, 1, 1], 0), SampleType::I32, wide.clone()),
        (plan(Wavelet::Haar, [96, 96, 1], 1), SampleType::U8, wide),
        (plan(Wavelet::Quintic, [9, 8, 7], 2), SampleType::U8, noise.clone()),
        (plan(Wavelet::Haar, [31, 23, 1], 0), SampleType::U8, faint.clone()),
        (plan(Wavelet::Haar, [16, 12, 9], 0), SampleType::I16, faint),
        (plan(Wavelet::Haar, [5, 4, 3], 0), SampleType::U8, noise),
        (plan(Wavelet::Haar, [33, 17, 9], 6), SampleType::I32, sparse),
        (plan(Wavelet::Haar, [33, 17, 9], 6), SampleType::I32, Input::Constant { value: 0 }),
        (plan(Wavelet::Haar, [33, 17, 9], 6), SampleType::I32, Input::Constant { value: -77 }),
        (plan(Wavelet::Linear, [64, 64, 16], 6), SampleType::I16, Input::Constant { value: 1000 }),
        (plan(Wavelet::Haar, [1, 1, 1], 0), SampleType::I32, Input::Constant { value: i32::MIN.into() }),
        (
            plan(Wavelet::Haar, [26, 25, 27], 0),
            SampleType::U16,
            Input::Steps { width: 40, height: 700, offset: 0 },
        ),
        (plan(Wavelet::Haar, [129, 127, 1], 0), SampleType::I8, Input::Constant { value: -77 }),
    ];
    let generated = cases.into_iter().flat_map(|(plan, sample_type, input)| {
        let samples = input.generate(plan.extent()).expect("a generator");
        Effort::ALL.map(|effort| (effort, plan, sample_type, samples.clone()))
    });
    generated.collect()
}

/// Rooms that are too small for `len` bytes: all of them near both ends, and steps of a prime between, which meet every
/// place in a word and, over all streams, every place where an encoder writes.
fn too_small(len: usize) -> impl Iterator<Item = usize> {
    const EACH: usize = 160;
    const STEP: usize = 13;
    (0..len).filter(move |room| *room < EACH || len - room <= EACH || room % STEP == 0)
}

#[test]
fn an_output_is_full_or_holds_the_same_bytes() {
    let (mut codec, mut storages, mut trained) = (Codec::NEW, BTreeSet::new(), false);
    for (effort, plan, sample_type, samples) in streams() {
        let bytes = encode(&mut codec, effort, &plan, sample_type, &samples);
        storages.insert(bytes[3]);
        if let Ok(predictors) = coder::predictors(&bytes) {
            trained |= predictors.iter().any(|predictor| matches!(predictor, Predictor::Weights(_)));
        }
        for room in too_small(bytes.len()) {
            let (encoded, left) = encode_within(&mut codec, effort, &plan, sample_type, &samples, room);
            assert_eq!(encoded, Err(EncodeError::OutputFull), "{room} of {} bytes: {plan:?}", bytes.len());
            assert!(left == samples, "the samples stay: {plan:?}");
        }
        let bound = max_encoded_len(plan.extent(), sample_type).expect("a small brick");
        for room in (bytes.len()..bytes.len() + 20).chain(bound.saturating_sub(30)..bound + 30) {
            if room >= bytes.len() {
                let (encoded, _) = encode_within(&mut codec, effort, &plan, sample_type, &samples, room);
                assert_eq!(encoded.as_ref(), Ok(&bytes), "{room} for {} bytes: {plan:?}", bytes.len());
            }
        }
    }
    assert_eq!(storages, BTreeSet::from([0, 3, 5, 6, 0x80]), "coded, light, tabled both ways and stored");
    assert!(trained, "no weights");
}

/// Carries may turn the last bytes of a segment to zeros, which are taken away: their room is not needed.
#[test]
fn an_output_of_just_the_length_suffices() {
    let (mut codec, plan) = (Codec::NEW, plan(Wavelet::Haar, [24, 1, 1], 1));
    for seed in 0..300_000 {
        let effort = Effort::ALL[usize::from(seed % 16 == 0)];
        let input = Input::Noise { bits: 3, offset: 0, seed };
        let samples = input.generate(plan.extent()).expect("a generator");
        let bytes = encode(&mut codec, effort, &plan, SampleType::I16, &samples);
        let (encoded, _) = encode_within(&mut codec, effort, &plan, SampleType::I16, &samples, bytes.len());
        assert_eq!(encoded.as_ref(), Ok(&bytes), "seed {seed}");
    }
}

/// Each wrong length around the right one: an exact length, or one that may be longer.
fn wrong_lengths(right: usize, may_be_longer: bool) -> Vec<usize> {
    let shorter = (0..right).step_by(1 + right / 50).chain(right.checked_sub(1));
    if may_be_longer { shorter.collect() } else { shorter.chain([right + 1, 2 * right]).collect() }
}

/// All calls with lent memory of those lengths give that error, and leave the memory as it is.
fn check_refused(plan: &Plan, bytes: &[u8], (samples, scratch): (usize, usize), error: LengthError) {
    let lend = || (Lent::stale(samples), Lent::stale(scratch));
    let untouched = |(samples, scratch): (Lent<i32>, Lent<i32>)| {
        let stale = Lent::stale(1).take_back()[0];
        let mut all = samples.take_back().into_iter().chain(scratch.take_back());
        assert!(all.all(|value| value == stale), "{error:?}: written to");
    };
    let mut codec = Codec::NEW;
    let mut lent = lend();
    assert_eq!(plan.forward(lent.0.lend(), lent.1.lend()), Err(error));
    untouched(lent);
    let mut lent = lend();
    assert_eq!(plan.inverse(lent.0.lend(), lent.1.lend()), Err(error));
    untouched(lent);
    for effort in Effort::ALL {
        let (mut lent, mut out) = (lend(), Lent::new(1 << 14, 0xA5));
        let encoded = effort.lend(|effort| {
            codec.encode(effort, plan, SampleType::I32, lent.0.lend(), lent.1.lend(), out.lend())
        });
        assert_eq!(encoded, Err(EncodeError::Length(error)));
        untouched(lent);
        assert!(out.take_back().iter().all(|byte| *byte == 0xA5), "{error:?}: written to");
    }
    let mut lent = lend();
    let decoded = codec.decode(bytes, lent.0.lend(), lent.1.lend());
    assert_eq!(decoded, Err(DecodeError::Length(error)));
    untouched(lent);
}

#[test]
fn memory_of_other_lengths_is_refused() {
    let mut codec = Codec::NEW;
    for (effort, plan, sample_type, samples) in
        streams().into_iter().filter(|(_, plan, ..)| plan.extent().samples() < 6000)
    {
        let bytes = encode(&mut codec, effort, &plan, sample_type, &samples);
        let right = (plan.extent().samples(), plan.scratch_len());
        for actual in wrong_lengths(right.0, false) {
            let error = LengthError { slice: Slice::Samples, expected: right.0, actual };
            check_refused(&plan, &bytes, (actual, right.1), error);
        }
        for actual in wrong_lengths(right.1, true) {
            let error = LengthError { slice: Slice::Scratch, expected: right.1, actual };
            check_refused(&plan, &bytes, (right.0, actual), error);
        }
    }
}

#[test]
fn scratch_may_be_longer_and_hold_anything() {
    let mut noise = Noise::new(9);
    for (effort, plan, sample_type, samples) in streams() {
        let bytes = encode(&mut { Codec::NEW }, effort, &plan, sample_type, &samples);
        for longer in [0, 1, 1000] {
            let mut scratch = noise.full_range(plan.scratch_len() + longer);
            let (mut used, mut out) = (samples.clone(), vec![0; bytes.len() + 40]);
            let len = effort.lend(|effort| {
                { Codec::NEW }.encode(effort, &plan, sample_type, &mut used, &mut scratch, &mut out)
            });
            assert_eq!(len.map(|len| &out[..len]), Ok(&bytes[..]));
            let (mut decoded, mut scratch) =
                (noise.full_range(samples.len()), noise.full_range(scratch.len()));
            { Codec::NEW }.decode(&bytes, &mut decoded, &mut scratch).expect("a codestream");
            assert!(decoded == samples);
        }
    }
}

/// A level takes the samples that the header says, no more and no fewer.
#[test]
fn a_level_takes_samples_of_its_own_number() {
    let mut codec = Codec::NEW;
    for (effort, plan, sample_type, samples) in streams() {
        let bytes = encode(&mut codec, effort, &plan, sample_type, &samples);
        let header = Header::parse(&bytes).expect("a codestream");
        for level in 0..=plan.levels() {
            let expected = header.samples_len(level);
            let coarse = plan.extent().coarsened(if header.is_stored() { 0 } else { level });
            assert_eq!(expected, coarse.samples());
            for actual in [0, expected - 1, expected + 1] {
                let (mut lent, mut scratch) = (Lent::stale(actual), Lent::stale(plan.scratch_len()));
                let decoded = codec.decode_to_level(&bytes, level, lent.lend(), scratch.lend());
                let error = LengthError { slice: Slice::Samples, expected, actual };
                assert_eq!(decoded, Err(DecodeError::Length(error)), "level {level}");
            }
            decode(&mut codec, &bytes, level, &header).expect("memory of the right length");
        }
    }
}

#[test]
fn a_sample_outside_its_type_is_refused_where_it_stands() {
    let plan = plan(Wavelet::Linear, [7, 5, 3], 2);
    for sample_type in [SampleType::U8, SampleType::I8, SampleType::U16, SampleType::I16] {
        let range = sample_type.range();
        for outside in [range.start() - 1, range.end() + 1, i32::MIN, i32::MAX] {
            for index in [0, 50, 104] {
                let mut samples = vec![*range.end(); 105];
                samples[index] = outside;
                samples[104] = outside;
                for effort in Effort::ALL {
                    let (encoded, left) =
                        encode_within(&mut { Codec::NEW }, effort, &plan, sample_type, &samples, 1000);
                    assert_eq!(encoded, Err(EncodeError::SampleOutOfRange { index }));
                    assert!(left == samples, "the samples stay");
                }
            }
        }
    }
}

/// The most that the fields of a header can be shorter than in their longest form.
const HEADER_SLACK: usize = 4 * 4;

#[test]
fn noise_takes_the_most_that_anything_takes() {
    let mut noise = Noise::new(3);
    for (axes, levels) in
        [([1, 1, 1], 0), ([200, 1, 1], 3), ([50, 60, 1], 2), ([20, 20, 20], 5), ([64, 64, 64], 6)]
    {
        let plan = plan(Wavelet::Linear, axes, levels);
        let samples: Vec<i32> = (0..plan.extent().samples()).map(|_| (noise.bits() >> 32) as i32).collect();
        for (effort, sample_type) in
            Effort::ALL.into_iter().flat_map(|effort| [(effort, SampleType::I32), (effort, SampleType::U32)])
        {
            let bytes = encode(&mut { Codec::NEW }, effort, &plan, sample_type, &samples);
            let bound = max_encoded_len(plan.extent(), sample_type).expect("a small brick");
            assert!(
                bytes.len() <= bound && bytes.len() + HEADER_SLACK >= bound,
                "{} of {bound}",
                bytes.len()
            );
            assert!(Header::parse(&bytes).expect("a codestream").is_stored(), "{axes:?}");
        }
    }
}

#[test]
fn the_longest_codestream_there_is_has_a_length() {
    let longest = Extent::line(i32::MAX.cast_unsigned()).expect("the longest line");
    assert_eq!(max_encoded_len(longest, SampleType::U8), Some(0x7FFF_FFFF + 26));
    // The samples as they are must fit one segment, whose length has 32 bits.
    assert_eq!(max_encoded_len(longest, SampleType::I32), None);
    let quarter = Extent::line((1 << 30) - 1).expect("a long line");
    let bytes = usize::try_from((4_u64 << 30) - 4 + 26).ok();
    assert_eq!(max_encoded_len(quarter, SampleType::I32), bytes);
}

#[test]
fn scratch_is_as_documented() {
    let scratch = |axes, levels| plan(Wavelet::Cubic, axes, levels).scratch_len();
    // Sixteen lines of the length of an axis and four samples of margin, where the coder takes less.
    assert_eq!([scratch([16, 16, 16], 4), scratch([32, 32, 32], 5)], [16 * 20, 16 * 36]);
    assert_eq!(scratch([512, 512, 1], 9), 16 * 516);
    // A plane of the largest subband with its margins, and five rows with theirs.
    assert_eq!(scratch([64, 64, 64], 6), (32 + 4) * (32 + 2) + 5 * (32 + 2));
    assert_eq!(scratch([64, 64, 64], 0), (64 + 4) * (64 + 2) + 5 * (64 + 2));
    // A slice or a line: three rows in place of the plane.
    assert_eq!(scratch([512, 512, 1], 0), (512 + 4) * 3 + 5 * (512 + 2));
    assert_eq!(scratch([1000, 1, 1], 0), (1000 + 4) * 3 + 5 * (1000 + 2));
    assert_eq!(scratch([1000, 1, 1], 10), (500 + 4) * 3 + 5 * (500 + 2));
}

#[test]
fn sizes_of_public_types() {
    // What the weights of tabled coding are learnt in; models and tables take less.
    assert_eq!(size_of::<Codec>(), 3_424);
    assert_eq!(size_of::<Training>(), 10_736);
    assert_eq!(size_of::<Dense>(), 75_456);
    assert_eq!(size_of::<Lattice>(), 22_928);
    assert_eq!(size_of::<Header>(), 168);
    assert_eq!(size_of::<Plan>(), 16);
    assert_eq!(size_of::<Extent>(), 12);
    assert_eq!([size_of::<Wavelet>(), size_of::<SampleType>(), size_of::<Malformed>()], [1; 3]);
    assert_eq!(size_of::<PlanError>(), 2);
    let pointer = size_of::<usize>();
    assert_eq!(
        [size_of::<LengthError>(), size_of::<EncodeError>(), size_of::<DecodeError>()],
        [3 * pointer; 3]
    );
}
