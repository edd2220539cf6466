//! Rows that come one after another: they come back bit for bit, their coefficients are those of the whole slice,
//! pieces do not matter, and damage does no harm.

use conformance::corrupt::Damage;
use conformance::effort::Effort;
use conformance::inputs::Input;
use conformance::lent;
use conformance::oracle::coder::rows;
use conformance::oracle::noise::Noise;
use conformance::slabs;
use conformance::streams::{Pieces, agree, decode, decode_fast, encode};
use conformance::vectors::{Expect, Manifest, Recipe, crc32};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use wavelift_kernel::stream::{RowCodec, RowDecoder, RowEncoder, RowError, RowPlan, Status};
use wavelift_kernel::{
    Codec, DecodeError, Extent, LengthError, Malformed, Plan, PlanError, SampleType, Slice, Wavelet,
};

const WIDTHS: [u32; 9] = [1, 2, 3, 4, 5, 8, 9, 17, 33];

fn waves(width: u32, height: u32) -> Vec<i32> {
    let input = Input::Waves { periods: [9, 13, 1], amplitude: 3000, offset: 17 };
    let extent = Extent::slice(width, height).expect("a small extent");
    input.generate(extent).expect("a generator")
}

fn rows_of(wavelet: Wavelet, width: u32, levels: u8) -> RowPlan {
    RowPlan::new(wavelet, width, levels, SampleType::I16).expect("a plan of rows")
}

/// Noise of the whole range of 32 bits too.
#[test]
fn every_extent_comes_back_and_the_oracle_agrees() {
    let mut noise = Noise::new(1);
    let mut checked = 0;
    for wavelet in Wavelet::ALL {
        for (width, height) in
            WIDTHS.into_iter().flat_map(|w| [0, 1, 2, 3, 4, 5, 7, 8, 16, 17, 33, 60].map(|h| (w, h)))
        {
            for levels in [0, 1, 2, 3, 5, 7] {
                let strip = [1, 3, 8, 1000][checked % 4];
                let sample_type = [SampleType::I32, SampleType::I16][checked % 2];
                let plan = RowPlan::new(wavelet, width, levels, sample_type).unwrap().with_strip(strip);
                let samples = match sample_type {
                    SampleType::I32 => noise.full_range((width * height) as usize),
                    _ if height == 0 => Vec::new(),
                    _ => waves(width, height),
                };
                let stream = encode(&plan, &samples, Pieces::Whole);
                for decode in [decode, decode_fast] {
                    let (back, end) = decode(&stream, samples.len(), Pieces::Whole);
                    assert_eq!(end, Ok(0), "{wavelet} {width} {height} {levels}");
                    assert!(back == samples, "{wavelet} {width} {height} {levels}");
                }
                // Its inverse transform is that of the whole slice: so are the coefficients.
                let (slice, rest) = rows::decode(&stream).expect("a stream");
                assert!(
                    slice.samples == samples && rest.is_empty(),
                    "oracle: {wavelet} {width} {height} {levels}"
                );
                checked += 1;
            }
        }
    }
    println!("{checked} slices");
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 3000,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(3),
        ..ProptestConfig::default()
    })]

    /// Where numbers take as few bits as they can, too: the ends of every type, every wavelet, as deep as levels go.
    #[test]
    fn rows_of_any_kind_come_back(
        wavelet in prop::sample::select(Wavelet::ALL.as_slice()),
        sample_type in prop::sample::select(SampleType::ALL.as_slice()),
        (width, height) in (1..=70_u32, 1..=70_u32),
        levels in 0..=9_u8,
        strip in 1..=70_u16,
        kind in 0..Input::KINDS,
        amount in any::<u8>(),
        seed in any::<u64>(),
        most in 1..=300_usize,
    ) {
        let plan = RowPlan::new(wavelet, width, levels, sample_type).expect("a plan").with_strip(strip);
        let extent = Extent::slice(width, height).expect("a small extent");
        let samples = Input::of_kind(kind, sample_type, amount, seed).generate(extent).expect("a generator");
        let pieces = || Pieces::UpTo(most, Noise::new(seed));
        let stream = encode(&plan, &samples, pieces());
        prop_assert!(decode(&stream, samples.len(), pieces()) == (samples.clone(), Ok(0)));
        prop_assert!(decode_fast(&stream, samples.len(), pieces()) == (samples, Ok(0)));
    }
}

/// Where a header has the type and the wavelet.
const TYPE: usize = 4;

/// Streams of wide samples under a header that says narrow ones: what comes before the first that is none is right.
#[test]
fn samples_outside_the_type_are_told_in_any_memory() {
    for (wavelet, levels) in
        Wavelet::ALL.into_iter().flat_map(|wavelet| [0, 1, 2, 3, 4].map(|l| (wavelet, l)))
    {
        for (outside, narrow) in [(3_000, SampleType::U8), (1 << 20, SampleType::I16)] {
            let [wide, narrow] = [SampleType::I32, narrow].map(|sample_type| {
                RowPlan::new(wavelet, 21, levels, sample_type).expect("a plan").with_strip(7)
            });
            let mut samples: Vec<i32> = waves(21, 60).iter().map(|sample| sample & 0x7F).collect();
            samples[21 * 40 + 3] = outside;
            let mut stream = encode(&wide, &samples, Pieces::Whole);
            stream[TYPE] = encode(&narrow, &[], Pieces::Whole)[TYPE];
            let least = decode(&stream, samples.len(), Pieces::Whole);
            let fast = decode_fast(&stream, samples.len(), Pieces::Of(5));
            let right = (samples[..21 * 40].to_vec(), Err(Malformed::Sample.into()));
            assert_eq!(fast, right, "{wavelet} {levels}");
            assert!(agree(&least, &fast), "{wavelet} {levels}: {:?} after {}", least.1, least.0.len());
        }
    }
}

#[test]
fn pieces_do_not_matter() {
    for (wavelet, levels) in Wavelet::ALL.into_iter().zip([3, 2, 3, 4, 0, 1]) {
        let plan = rows_of(wavelet, 21, levels).with_strip(5);
        let samples = waves(21, 37);
        let stream = encode(&plan, &samples, Pieces::Whole);
        for most in [1, 2, 3, 7, 30, 300] {
            assert!(encode(&plan, &samples, Pieces::Of(most)) == stream, "{wavelet} {most}");
            let random = || Pieces::UpTo(most, Noise::new(most as u64));
            assert!(encode(&plan, &samples, random()) == stream, "{wavelet} up to {most}");
            for pieces in [Pieces::Of(most), random()] {
                let (back, end) = decode(&stream, samples.len(), pieces);
                assert!(back == samples && end == Ok(0), "{wavelet} {most} {end:?}");
            }
        }
    }
}

#[test]
fn a_prefix_gives_the_first_rows_and_is_truncated() {
    let plan = rows_of(Wavelet::Cubic, 19, 2).with_strip(4);
    let samples = waves(19, 40);
    let stream = encode(&plan, &samples, Pieces::Whole);
    let mut before = 0;
    for len in 0..stream.len() {
        let (back, end) = decode(&stream[..len], samples.len(), Pieces::Whole);
        assert_eq!(end, Err(DecodeError::Truncated), "{len}");
        assert!(back == samples[..back.len()] && back.len() >= before, "{len}");
        before = back.len();
    }
    assert!(before >= 19 * 28, "most rows come long before the end: {before}");
    let followed = [&stream[..], b"wS"].concat();
    assert_eq!(decode(&followed, samples.len(), Pieces::Whole), (samples, Ok(2)));
}

/// A run of bytes that are held back is as long as the input makes it.
#[test]
fn constant_rows_of_any_number_take_next_to_nothing() {
    let plan = rows_of(Wavelet::Linear, 64, 3).with_strip(u16::MAX);
    let samples = vec![-5; 64 * 20_000];
    let stream = encode(&plan, &samples, Pieces::Whole);
    // 1/127 of a bit each, the least that a distribution takes.
    assert!(stream.len() < 1100, "{}", stream.len());
    let (back, end) = decode(&stream, samples.len(), Pieces::Whole);
    assert!(back == samples && end == Ok(0));
}

#[test]
fn what_cannot_be_is_refused() {
    let new = |width, levels| RowPlan::new(Wavelet::Haar, width, levels, SampleType::U8);
    assert_eq!(new(0, 1), Err(PlanError::ZeroExtent { axis: 0 }));
    assert_eq!(new(1 << 31, 1), Err(PlanError::ExtentTooLarge));
    assert_eq!(new(5, 32), Err(PlanError::TooManyLevels { max: 31 }));
    let plan = new(5, 2).unwrap();
    let mut codec = RowCodec::NEW;
    let (expected, mut memory) = (plan.encoder_memory_len(), vec![0; plan.encoder_memory_len()]);
    let short = RowEncoder::new(&plan, &mut codec, &mut memory[1..]).map(|_| ());
    assert_eq!(short, Err(LengthError { slice: Slice::Scratch, expected, actual: expected - 1 }));
    let short = RowDecoder::new(&plan, &mut codec, &mut []).map(|_| ());
    let expected = plan.decoder_memory_len();
    assert_eq!(short, Err(LengthError { slice: Slice::Scratch, expected, actual: 0 }));

    let mut encoder = RowEncoder::new(&plan, &mut codec, &mut memory).unwrap();
    let mut output = [0; 64];
    let step = encoder.step(&[1, 2, 256, 3], &mut output).unwrap();
    assert_eq!((step.consumed, step.produced, step.status), (2, 9, Status::NeedInput));
    let error = encoder.step(&[256, 3], &mut output);
    assert_eq!(error, Err(RowError::SampleOutOfRange { index: 0 }));
    assert_eq!(encoder.finish(), Err(RowError::UnfinishedRow { missing: 3 }));
    assert_eq!(encoder.step(&[3, 4, 5], &mut output).unwrap().consumed, 3);
    assert_eq!(encoder.finish(), Ok(()));
    assert_eq!(encoder.step(&[7], &mut output).unwrap().status, Status::Done);
}

#[test]
fn headers_that_lie_are_refused() {
    let header = |bytes: &[u8]| RowPlan::parse(bytes).map(|(_, len)| len);
    let sound = [0x77, 0x53, 2, 0, 0x40, 3, 21, 8];
    assert_eq!(header(&sound), Ok(8));
    let with = |at: usize, byte| {
        let mut bytes = sound;
        bytes[at] = byte;
        header(&bytes)
    };
    assert_eq!(with(0, 0x78), Err(DecodeError::NotACodestream));
    assert_eq!(with(1, 0x4C), Err(DecodeError::NotACodestream));
    assert_eq!(with(2, 1), Err(DecodeError::UnsupportedVersion { found: 1 }));
    assert_eq!(with(3, 1), Err(DecodeError::OtherCodec));
    assert_eq!(with(3, 2), Err(Malformed::Reserved.into()));
    assert_eq!(with(4, 0x46), Err(Malformed::Reserved.into()));
    assert_eq!(with(4, 0x70), Err(Malformed::Reserved.into()));
    assert_eq!(with(4, 0x00), Err(Malformed::Levels.into()));
    assert_eq!(with(5, 0), Err(Malformed::Levels.into()));
    assert_eq!(with(5, 32), Err(Malformed::Levels.into()));
    assert_eq!(with(6, 0), Err(Malformed::Extent.into()));
    assert_eq!(with(7, 0), Err(Malformed::Reserved.into()));
    assert_eq!(header(&[&sound[..7], &[0x80, 0]].concat()), Err(Malformed::Number.into()));
    assert_eq!(header(&[&sound[..7], &[0x80, 0x80, 4]].concat()), Err(Malformed::Reserved.into()));
    assert_eq!(
        header(&[&sound[..6], &[0x80, 0x80, 0x80, 0x80, 8, 8]].concat()),
        Err(Malformed::Extent.into())
    );
    for len in 0..8 {
        assert_eq!(header(&sound[..len]), Err(DecodeError::Truncated));
    }
}

/// Whatever the bytes are, the decoder returns, writes only what it was lent, and says the same however they come.
#[test]
fn damage_does_no_harm() {
    let mut noise = Noise::new(5);
    let plans = [
        (Wavelet::Haar, 3, 7),
        (Wavelet::Duchaineau, 2, 18),
        (Wavelet::Quintic, 1, 9),
        (Wavelet::Cubic, 0, 12),
    ];
    let streams = plans.map(|(wavelet, levels, width)| {
        encode(&rows_of(wavelet, width, levels).with_strip(6), &waves(width, 30), Pieces::Whole)
    });
    let (mut cases, mut noticed) = (0, 0);
    for _ in 0..60 {
        for at in 0..streams.len() {
            for damage in Damage::ALL {
                let mut bytes = streams[at].clone();
                damage.inflict(&mut bytes, &streams[(at + 1) % streams.len()], &mut noise);
                let claims = RowPlan::parse(&bytes).map_or(0, |(plan, _)| plan.decoder_memory_len());
                if claims > 1 << 16 {
                    continue;
                }
                let (samples, end) = decode(&bytes, 4000, Pieces::Whole);
                let (dripped, dripped_end) = decode(&bytes, 4000, Pieces::Of(1));
                let fast = decode_fast(&bytes, 4000, Pieces::Of(7));
                if [&samples, &dripped, &fast.0].iter().all(|samples| samples.len() <= 4000) {
                    assert_eq!((&samples, end), (&dripped, dripped_end));
                    assert!(agree(&(dripped, dripped_end), &fast), "{dripped_end:?} {:?}", fast.1);
                    match (rows::decode(&bytes), end) {
                        (Ok((slice, rest)), Ok(left)) => {
                            assert!(slice.samples == samples && rest.len() == left)
                        }
                        (Err(_), Err(_)) => noticed += 1,
                        (oracle, kernel) => panic!("oracle {:?}, kernel {kernel:?}", oracle.map(|_| ())),
                    }
                }
                cases += 1;
            }
        }
    }
    println!("{cases} cases, {noticed} noticed");
    assert!(noticed > cases / 2, "{noticed} of {cases} noticed");
}

/// The wavelets of which decoders keep to 64 bytes a column with three levels, for samples of so many bits at most.
fn bits_within_64_bytes(wavelet: Wavelet) -> usize {
    match wavelet {
        Wavelet::Haar => 32,
        Wavelet::Linear => 16,
        Wavelet::Quadratic | Wavelet::Cubic => 8,
        Wavelet::Duchaineau | Wavelet::Quintic => 0,
    }
}

/// At most 64 bytes a column and 8 KiB, all in all: three levels of every wavelet to encode; to decode one, and three as
/// far as [`bits_within_64_bytes`] says.
#[test]
fn memory_is_as_it_is_told() {
    assert_eq!(size_of::<RowCodec>(), 6324);
    assert!(size_of::<RowEncoder<'_>>() <= 1024 && size_of::<RowDecoder<'_>>() <= 1844);
    for (wavelet, sample_type) in
        Wavelet::ALL.into_iter().flat_map(|wavelet| SampleType::ALL.map(|sample_type| (wavelet, sample_type)))
    {
        let plan = |width, levels| RowPlan::new(wavelet, width, levels, sample_type).expect("a plan of rows");
        let levels = if 8 * sample_type.bytes() <= bits_within_64_bytes(wavelet) { 3 } else { 1 };
        let mut most = 0.0_f64;
        for width in (1..200).chain([512, 4096, 65_537]) {
            let encoder = 4 * plan(width, 3).encoder_memory_len() + size_of::<RowEncoder<'_>>();
            let decoder = 4 * plan(width, levels).decoder_memory_len() + size_of::<RowDecoder<'_>>();
            for all in [encoder, decoder].map(|state| state + size_of::<RowCodec>()) {
                most = most.max((all as f64 - 8192.0) / width as f64);
            }
        }
        let decoder = |levels| 4.0 * plan(1 << 16, levels).decoder_memory_len() as f64 / 65_536.0;
        println!("{wavelet} {sample_type}: {:.1?} bytes a column, at most {most:.1}", [1, 2, 3].map(decoder));
        assert!(most <= 64.0, "{wavelet} {sample_type}, {levels} levels: {most} bytes a column");
    }
}

/// As the codec makes the whole slice without training, within 3 in 100.
#[test]
fn streams_are_nearly_as_short_as_codestreams() {
    let manifest = Manifest::read().expect("the manifest");
    let (extent, samples) = manifest.data_samples("rt_slice512").expect("a data file");
    for (wavelet, levels) in
        [(Wavelet::Haar, 3), (Wavelet::Linear, 3), (Wavelet::Cubic, 3), (Wavelet::Haar, 0)]
    {
        let whole = Plan::new(wavelet, extent, levels).expect("levels that it has");
        let whole = lent::encode(&mut { Codec::NEW }, Effort::Fast, &whole, SampleType::U8, &samples).len();
        let plan = RowPlan::new(wavelet, 512, levels, SampleType::U8).expect("a plan of rows");
        let stream = encode(&plan, &samples, Pieces::Whole).len();
        println!("{wavelet} {levels}: {stream} bytes, {whole} as a codestream");
        assert!(100 * stream <= 103 * whole, "{wavelet} {levels}: {stream} bytes, {whole} as a codestream");
    }
}

#[test]
fn golden_streams() {
    let manifest = Manifest::read().expect("the manifest");
    let mut streams = 0;
    for vector in manifest.vectors.iter().filter(|vector| vector.file.starts_with("streams/")) {
        let (id, bytes) = (&vector.id, vector.read().expect("its file"));
        let samples = manifest.samples(vector).expect("a recipe");
        assert_eq!(Expect::Crc32(crc32(&samples)), vector.expect, "{id}");
        let (_, recipe) = vector.recipe().expect("a recipe");
        assert!(recipe.encode(&samples).as_ref() == Ok(&bytes), "{id}: the encoder makes other bytes");
        let of = |bytes: &[u8], piece| match recipe {
            Recipe::Slabs(_) => slabs::decode(bytes, piece),
            _ => decode(bytes, samples.len(), Pieces::Of(piece)),
        };
        for piece in [1, 5, 4096] {
            assert!(of(&bytes, piece) == (samples.clone(), Ok(0)), "{id} in pieces of {piece}");
        }
        if let Recipe::Rows(_) = recipe {
            assert!(rows::decode(&bytes).expect("a stream").0.samples == samples, "{id}: the oracle");
        }
        for len in 0..bytes.len() {
            let (before, end) = of(&bytes[..len], 64);
            assert!(end == Err(DecodeError::Truncated) && samples.starts_with(&before), "{id} {len}");
        }
        streams += 1;
    }
    assert!(streams >= 12, "{streams} streams");
}
