//! What a codec did before never shows: not in the bytes, not in the samples, and after a reset not in its state.

use conformance::effort::Effort;
use conformance::inputs::Input;
use conformance::lent::{decode, encode, encode_within};
use wavelift_kernel::{Codec, DecodeError, EncodeError, Extent, Header, Plan, SampleType, Wavelet};

/// A codestream, and what it is of.
struct Sample {
    effort: Effort,
    plan: Plan,
    samples: Vec<i32>,
    bytes: Vec<u8>,
    header: Header,
}

const TYPE: SampleType = SampleType::I16;

/// What a codec that did nothing before makes of an input.
fn sample(effort: Effort, wavelet: Wavelet, axes: [u32; 3], levels: u8, input: &Input) -> Sample {
    let extent = Extent::new(axes).expect("a small extent");
    let plan = Plan::new(wavelet, extent, levels).expect("levels that it has");
    let samples = input.generate(extent).expect("a generator");
    let bytes = encode(&mut { Codec::NEW }, effort, &plan, TYPE, &samples);
    let header = Header::parse(&bytes).expect("a codestream");
    Sample { effort, plan, samples, bytes, header }
}

fn samples() -> [Sample; 9] {
    let waves = Input::Waves { periods: [9, 13, 19], amplitude: 9000, offset: -1000 };
    let faint = Input::Waves { periods: [40, 1, 1], amplitude: 20, offset: 0 };
    [
        sample(Effort::Fast, Wavelet::Quintic, [11, 9, 5], 2, &waves),
        sample(
            Effort::Default,
            Wavelet::Linear,
            [23, 8, 1],
            5,
            &Input::Sparse { one_in: 9, bits: 12, seed: 1 },
        ),
        sample(
            Effort::Fast,
            Wavelet::Haar,
            [150, 1, 1],
            0,
            &Input::Steps { width: 20, height: 300, offset: 7 },
        ),
        sample(Effort::Default, Wavelet::Haar, [2300, 1, 1], 0, &faint),
        sample(
            Effort::Default,
            Wavelet::Cubic,
            [9, 9, 3],
            3,
            &Input::Noise { bits: 16, offset: -32_768, seed: 2 },
        ),
        sample(
            Effort::Fast,
            Wavelet::Quadratic,
            [15, 12, 9],
            0,
            &Input::Noise { bits: 6, offset: 0, seed: 5 },
        ),
        sample(Effort::Light, Wavelet::Linear, [19, 18, 3], 1, &Input::Noise { bits: 6, offset: 0, seed: 6 }),
        sample(
            Effort::Tabled,
            Wavelet::Haar,
            [26, 25, 27],
            0,
            &Input::Steps { width: 40, height: 700, offset: 0 },
        ),
        sample(
            Effort::Wide,
            Wavelet::Haar,
            [26, 25, 27],
            0,
            &Input::Steps { width: 40, height: 700, offset: 0 },
        ),
    ]
}

/// The codec works like a new one, and becomes one by a reset.
fn check_like_new(codec: &mut Codec, next: &Sample) {
    assert_eq!(encode(codec, next.effort, &next.plan, TYPE, &next.samples), next.bytes);
    assert_eq!(decode(codec, &next.bytes, 0, &next.header).as_ref(), Ok(&next.samples));
    codec.reset();
    assert!(*codec == Codec::NEW, "a reset makes it new");
}

#[test]
fn a_codec_works_the_same_after_anything_that_succeeds() {
    let samples = samples();
    for first in &samples {
        for next in &samples {
            let mut codec = Codec::NEW;
            assert_eq!(encode(&mut codec, first.effort, &first.plan, TYPE, &first.samples), first.bytes);
            check_like_new(&mut codec, next);
            assert_eq!(decode(&mut codec, &first.bytes, 0, &first.header).as_ref(), Ok(&first.samples));
            check_like_new(&mut codec, next);
        }
    }
}

#[test]
fn one_of_the_samples_is_tabled() {
    assert!(samples().iter().any(|sample| sample.bytes[3] == 3));
}

#[test]
fn a_reset_shows_that_the_state_was_used() {
    let [brick, ..] = samples();
    let mut codec = Codec::NEW;
    encode(&mut codec, brick.effort, &brick.plan, TYPE, &brick.samples);
    assert!(codec != Codec::NEW, "the models have learnt");
    codec.reset();
    assert!(codec == Codec::NEW);
}

#[test]
fn a_codec_works_the_same_after_an_output_was_full() {
    let samples = samples();
    for first in &samples {
        for room in 0..first.bytes.len() {
            let mut codec = Codec::NEW;
            let (encoded, _) =
                encode_within(&mut codec, first.effort, &first.plan, TYPE, &first.samples, room);
            assert_eq!(encoded, Err(EncodeError::OutputFull));
            check_like_new(&mut codec, &samples[room % samples.len()]);
        }
    }
}

#[test]
fn a_codec_works_the_same_after_a_cut_or_a_level() {
    let samples = samples();
    for first in &samples {
        for cut in 0..first.bytes.len() {
            let mut codec = Codec::NEW;
            let level = u8::try_from(cut % (usize::from(first.plan.levels()) + 1)).expect("a level");
            let decoded = decode(&mut codec, &first.bytes[..cut], level, &first.header);
            let complete = cut as u64 >= first.header.bytes_to_level(level);
            assert_eq!(decoded.err(), (!complete).then_some(DecodeError::Truncated));
            check_like_new(&mut codec, &samples[cut % samples.len()]);
        }
    }
}

#[test]
fn a_codec_works_the_same_after_damage() {
    let samples = samples();
    for first in &samples {
        for at in 0..first.bytes.len() {
            let mut codec = Codec::NEW;
            let mut damaged = first.bytes.clone();
            damaged[at] ^= 0x55;
            // Damage may go unnoticed; what matters is what comes next.
            let _ = decode(&mut codec, &damaged, 0, &first.header);
            check_like_new(&mut codec, &samples[at % samples.len()]);
        }
    }
}

#[test]
fn two_runs_give_the_same_bytes() {
    let (first, second) = (samples(), samples());
    assert!(first.iter().zip(&second).all(|(first, second)| first.bytes == second.bytes));
}
