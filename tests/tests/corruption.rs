//! Hostile bytes: whatever they are, the decoder returns, and writes only what it was lent.

use conformance::corrupt::Damage;
use conformance::effort::Effort;
use conformance::inputs::Input;
use conformance::lent::{Lent, decode, encode};
use conformance::mutation::{self, Kind};
use conformance::oracle::coder::{self, Predictor};
use conformance::oracle::noise::Noise;
use conformance::oracle::tabled::{self, Breadth, Form};
use conformance::reference::sides;
use wavelift_kernel::{
    Codec, DecodeError, Extent, Header, LengthError, Malformed, Plan, SampleType, Slice, Wavelet,
};

/// Samples for which memory is lent when damage asks for it.
const MOST_SAMPLES: usize = 1 << 14;

/// Where the storage field is, and what it says of tabled samples, narrow, wide and celled.
const TABLED: (usize, [u8; 3]) = (3, [3, 4, 6]);

/// One codestream each of the forms there are: coded, with trained weights and without, light, tabled in all ways, and
/// stored, with levels and without, of 1 to 3 axes.
fn streams() -> Vec<(Vec<u8>, Header)> {
    let waves = Input::Waves { periods: [9, 13, 19], amplitude: 100, offset: 128 };
    let noise = Input::Noise { bits: 8, offset: 0, seed: 5 };
    let faint = Input::Noise { bits: 6, offset: 0, seed: 5 };
    let steps = Input::Steps { width: 40, height: 700, offset: 0 };
    let gentle = Input::Waves { periods: [64, 64, 64], amplitude: 25, offset: 0 };
    let cases = [
        (Effort::Fast, Wavelet::Haar, [7, 5, 3], 3, SampleType::U8, &waves),
        (Effort::Default, Wavelet::Quadratic, [17, 9, 1], 5, SampleType::I16, &waves),
        (Effort::Fast, Wavelet::Duchaineau, [40, 1, 1], 6, SampleType::U16, &waves),
        (Effort::Default, Wavelet::Linear, [9, 9, 9], 2, SampleType::U8, &waves),
        (Effort::Fast, Wavelet::Cubic, [12, 10, 2], 4, SampleType::U32, &waves),
        (Effort::Default, Wavelet::Quintic, [1, 13, 8], 4, SampleType::I32, &waves),
        (Effort::Fast, Wavelet::Haar, [15, 12, 9], 0, SampleType::I16, &faint),
        (Effort::Default, Wavelet::Cubic, [6, 5, 4], 2, SampleType::U8, &noise),
        (Effort::Fast, Wavelet::Linear, [25, 1, 1], 0, SampleType::U8, &noise),
        (Effort::Default, Wavelet::Linear, [16, 16, 16], 4, SampleType::U8, &Input::Constant { value: 9 }),
        (Effort::Default, Wavelet::Haar, [60, 50, 1], 0, SampleType::U8, &waves),
        (Effort::Default, Wavelet::Haar, [28, 28, 18], 1, SampleType::I32, &gentle),
        (Effort::Light, Wavelet::Linear, [17, 16, 15], 2, SampleType::U16, &waves),
        (Effort::Light, Wavelet::Haar, [60, 50, 1], 0, SampleType::I32, &gentle),
        (Effort::Tabled, Wavelet::Haar, [128, 128, 1], 0, SampleType::I8, &gentle),
        (Effort::Tabled, Wavelet::Haar, [32, 32, 16], 0, SampleType::U16, &steps),
        (Effort::Wide, Wavelet::Haar, [128, 128, 1], 0, SampleType::I8, &gentle),
        (Effort::Wide, Wavelet::Haar, [32, 32, 16], 0, SampleType::U16, &steps),
    ];
    let encoded = cases.map(|(effort, wavelet, axes, levels, sample_type, input)| {
        let extent = Extent::new(axes).expect("a small extent");
        let plan = Plan::new(wavelet, extent, levels).expect("levels that it has");
        let samples = input.generate(extent).expect("a generator");
        let bytes = encode(&mut { Codec::NEW }, effort, &plan, sample_type, &samples);
        let header = Header::parse(&bytes).expect("a codestream");
        (bytes, header)
    });
    let (storage, [_, _, celled]) = TABLED;
    let wide = |(bytes, header): &(Vec<u8>, Header)| (bytes[storage] == celled).then(|| wide(bytes, header));
    let wide: Vec<_> = encoded.iter().filter_map(wide).collect();
    encoded.into_iter().chain(wide).collect()
}

/// The samples of a codestream as a wide one, which encoders of today no longer write: each by the one before.
fn wide(bytes: &[u8], header: &Header) -> (Vec<u8>, Header) {
    let samples = decode(&mut { Codec::NEW }, bytes, 0, header).expect("an undamaged codestream");
    let form = Form { breadth: Breadth::Wide, extent: sides(header.plan().extent()) };
    let weights = form.sets().into_iter().map(|count| vec![0; count]).collect();
    let bounds = tabled::bounds(&samples);
    let model = tabled::fit(&samples, form, bounds, tabled::Model::new(weights));
    let segment = tabled::encode(&samples, form, bounds, &model).bytes();
    let index = SampleType::ALL.iter().position(|&t| t == header.sample_type()).expect("all are listed");
    let bytes = tabled::codestream(&segment, form, coder::SampleType::ALL[index]);
    let header = Header::parse(&bytes).expect("a codestream");
    (bytes, header)
}

/// Decodes to every level and one more, in memory as the bytes ask for it, if that is not too much, or else of
/// the lengths that the codestream had before the damage. Returns whether it was noticed at the finest level.
fn survives(codec: &mut Codec, bytes: &[u8], undamaged: &Header) -> bool {
    let parsed = Header::parse(bytes);
    let claimed = parsed.as_ref().ok().filter(|header| header.samples_len(0) <= MOST_SAMPLES);
    let lent_for = claimed.unwrap_or(undamaged);
    for level in (0..=lent_for.plan().levels() + 1).rev() {
        let decoded = decode(codec, bytes, level, lent_for);
        match (&decoded, &parsed) {
            (Ok(samples), Ok(header)) => {
                let range = if level == 0 { header.sample_type().range() } else { i32::MIN..=i32::MAX };
                assert!(samples.iter().all(|sample| range.contains(sample)), "a sample outside its type");
            }
            (Ok(_), Err(error)) => panic!("decoded without a header: {error}"),
            (Err(error), Err(unparsed)) => assert_eq!(error, unparsed),
            (Err(error), Ok(_)) => {
                let length = matches!(error, DecodeError::Length(_));
                assert!(claimed.is_none() || !length, "{error} in memory as it was asked for");
            }
        }
        if level == 0 {
            return decoded.is_err();
        }
    }
    false
}

/// Damages each codestream `rounds` times in each way, once or twice over.
fn inflict(seed: u64, rounds: usize) -> (usize, usize) {
    let (streams, mut noise, mut codec) = (streams(), Noise::new(seed), Codec::NEW);
    let (mut cases, mut noticed) = (0, 0);
    for _ in 0..rounds {
        for (at, (bytes, header)) in streams.iter().enumerate() {
            for damage in Damage::ALL {
                let (other, _) = &streams[(at + 1 + cases % (streams.len() - 1)) % streams.len()];
                let mut damaged = bytes.clone();
                damage.inflict(&mut damaged, other, &mut noise);
                if noise.bits().is_multiple_of(4) && !damaged.is_empty() {
                    damage.inflict(&mut damaged, other, &mut noise);
                }
                noticed += usize::from(survives(&mut codec, &damaged, header));
                cases += 1;
            }
        }
    }
    for (bytes, header) in &streams {
        assert!(!survives(&mut codec, bytes, header), "an undamaged codestream");
    }
    (cases, noticed)
}

#[test]
fn some_have_weights_and_some_have_none() {
    let trained = streams().into_iter().filter(|(bytes, _)| {
        let predictors = coder::predictors(bytes).unwrap_or_default();
        predictors.iter().any(|predictor| matches!(predictor, Predictor::Weights(_)))
    });
    assert!((1..streams().len()).contains(&trained.count()));
    let (storage, tabled) = TABLED;
    for tabled in tabled {
        assert_eq!(streams().iter().filter(|(bytes, _)| bytes[storage] == tabled).count(), 2);
    }
}

#[test]
fn damage_anywhere_is_survived() {
    let (cases, noticed) = inflict(1, 600);
    println!("{cases} damaged codestreams, {noticed} noticed");
    assert_eq!(cases, 108_000);
    assert!(
        noticed > cases / 4,
        "only {noticed} of {cases} noticed: the damage does not reach the decoder's checks"
    );
    assert!(noticed < cases, "none of {cases} reached the samples");
}

/// Segments of random bytes, without a wrong header in their way.
#[test]
fn random_segments_are_survived() {
    let (mut noise, mut codec) = (Noise::new(2), Codec::NEW);
    for (bytes, header) in streams().into_iter().filter(|(_, header)| !header.is_stored()) {
        let payload = usize::try_from(header.encoded_bytes()).expect("a few bytes");
        let start = bytes.len() - (payload - header_bytes(&bytes));
        for _ in 0..500 {
            let mut damaged = bytes.clone();
            damaged[start..].fill_with(|| noise.bits() as u8);
            survives(&mut codec, &damaged, &header);
        }
    }
}

/// Bytes before the first segment: those that a header is parsed from.
fn header_bytes(bytes: &[u8]) -> usize {
    (0..bytes.len()).find(|&len| Header::parse(&bytes[..len]).is_ok()).expect("a codestream")
}

#[test]
fn random_bytes_are_survived() {
    let (mut noise, mut codec) = (Noise::new(4), Codec::NEW);
    let streams = streams();
    for round in 0..20_000 {
        let mut bytes = vec![0; (noise.bits() % 64) as usize];
        bytes.fill_with(|| noise.bits() as u8);
        // The right magic, version and storage, more often than chance would have it.
        let known = [0x77, 0x4C, 2, [0, 3, 4, 6][round % 4]];
        bytes.iter_mut().zip(known).take(round % 5).for_each(|(byte, known)| *byte = known);
        survives(&mut codec, &bytes, &streams[round % streams.len()].1);
    }
}

/// The header of a codestream of `axes` samples, with as many empty segments as its levels need.
fn header_of(axes: [u32; 3], levels: u8) -> Vec<u8> {
    let mut bytes = vec![0x77, 0x4C, 2, 0, if levels > 0 { 0x15 } else { 0x05 }, levels];
    for mut axis in axes {
        while axis > 0x7F {
            bytes.push(axis as u8 | 0x80);
            axis >>= 7;
        }
        bytes.push(axis as u8);
    }
    bytes.resize(bytes.len() + usize::from(levels) + 1, 0);
    bytes
}

/// A header of a few bytes may claim 2^31 - 1 samples, all of them zero; that costs nothing but the header. Each
/// of these calls would take seconds if it did the work.
#[test]
fn huge_extents_fail_before_any_work() {
    let mut codec = Codec::NEW;
    let huge = [
        [0x7FFF_FFFF, 1, 1],
        [1, 0x7FFF_FFFF, 1],
        [1, 1, 0x7FFF_FFFF],
        [46_340, 46_340, 1],
        [1290, 1290, 1290],
    ];
    for axes in huge {
        let extent = Extent::new(axes).expect("an extent");
        for levels in 0..=extent.max_levels() {
            let bytes = header_of(axes, levels);
            let header = Header::parse(&bytes).expect("a codestream");
            assert_eq!((header.plan().extent(), header.plan().levels()), (extent, levels));
            for (level, actual) in (0..=levels).flat_map(|level| [(level, 0), (level, 1000)]) {
                let expected = header.samples_len(level);
                if expected > 1000 {
                    let (mut samples, mut scratch) = (Lent::stale(actual), Lent::stale(actual));
                    let decoded = codec.decode_to_level(&bytes, level, samples.lend(), scratch.lend());
                    let error = LengthError { slice: Slice::Samples, expected, actual };
                    assert_eq!(
                        decoded,
                        Err(DecodeError::Length(error)),
                        "{axes:?}, level {level} of {levels}"
                    );
                }
            }
        }
    }
}

#[test]
fn extents_beyond_the_largest_are_malformed() {
    let axes = [
        [0x8000_0000, 1, 1],
        [u32::MAX, u32::MAX, u32::MAX],
        [65_536, 32_768, 1],
        [1291, 1291, 1291],
        [0, 1, 1],
    ];
    for axes in axes {
        assert_eq!(
            Header::parse(&header_of(axes, 0)),
            Err(DecodeError::Malformed(Malformed::Extent)),
            "{axes:?}"
        );
    }
}

/// A million by `cargo xtask fuzz mutate`.
#[test]
fn golden_streams_survive_damage() {
    let tallies = mutation::run(7, 20_000).expect("the golden data");
    println!("{tallies}");
    // Ten kinds, and what is refused at once. Of each some damage is noticed, and some decodes.
    assert_eq!(tallies.0.len(), 11, "{tallies}");
    for (kind, tally) in &tallies.0 {
        assert!(tally.noticed > tally.cases / 4, "{kind:?}: {tally}");
        assert!(*kind == Kind::None || tally.noticed < tally.cases, "{kind:?}: {tally}");
    }
}
