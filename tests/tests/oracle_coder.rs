//! The kernel's codestreams against the reference of the format: both write the same bytes, and each reads what the
//! other writes.

use conformance::oracle::coder::{Choices, Decoded, Header, Reject, Storage, decode, encode, encode_as};
use conformance::oracle::lifting::{self, Psi};
use conformance::oracle::noise::Noise;
use wavelift_kernel::{Codec, DecodeError, Extent, Malformed, Plan, SampleType, Wavelet, max_encoded_len};

const LENGTHS: [usize; 12] = [1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 31, 33];

fn kernel_encode(plan: &Plan, sample_type: SampleType, samples: &[i32]) -> Vec<u8> {
    let mut codec = Codec::NEW;
    let mut bytes = vec![0; max_encoded_len(plan.extent(), sample_type).expect("it is small")];
    let (mut used_up, mut scratch) = (samples.to_vec(), vec![0; plan.scratch_len()]);
    let length = codec.encode(plan, sample_type, &mut used_up, &mut scratch, &mut bytes);
    bytes.truncate(length.expect("the output is long enough"));
    bytes
}

fn kernel_decode(bytes: &[u8], level: usize) -> Result<Decoded, DecodeError> {
    let mut codec = Codec::NEW;
    let header = wavelift_kernel::Header::parse(bytes)?;
    let level = u8::try_from(level).expect("levels are few");
    let (mut samples, mut scratch) =
        (vec![0; header.samples_len(level)], vec![0; header.plan().scratch_len()]);
    codec.decode_to_level(bytes, level, &mut samples, &mut scratch)?;
    let extent = header.extent_at(level);
    samples.truncate(extent.samples());
    Ok(Decoded { extent: extent.axes().map(|n| n as usize), samples })
}

/// The row of the table of errors that the kernel's error stands for.
fn row(error: DecodeError) -> Reject {
    match error {
        DecodeError::Truncated => Reject::Truncated,
        DecodeError::NotACodestream => Reject::NotACodestream,
        DecodeError::UnsupportedVersion { found } => Reject::UnsupportedVersion { found },
        DecodeError::TrailingBytes => Reject::TrailingBytes,
        DecodeError::Malformed(rule) => match rule {
            Malformed::Reserved => Reject::Reserved,
            Malformed::Number => Reject::Number,
            Malformed::Extent => Reject::Extent,
            Malformed::Levels => Reject::Levels,
            Malformed::StoredLength => Reject::StoredLength,
            Malformed::Segment => Reject::Segment,
            Malformed::Sample => Reject::Sample,
            _ => panic!("{rule:?} has no row"),
        },
        _ => panic!("{error} is no fault of the data"),
    }
}

/// What both decoders make of the bytes, the same.
fn both_decode(bytes: &[u8], level: usize) -> Result<Decoded, Reject> {
    let decoded = decode(bytes, level);
    assert_eq!(kernel_decode(bytes, level).map_err(row), decoded, "kernel, oracle: level {level} of {bytes:02X?}");
    decoded
}

fn plan(psi: Option<Psi>, extent: [usize; 3], levels: usize) -> Plan {
    let wavelet = psi.map_or(Wavelet::Haar, |psi| {
        let position = Psi::ALL.iter().position(|&other| other == psi).expect("all are listed");
        Wavelet::ALL[position]
    });
    let extent = Extent::new(extent.map(|n| u32::try_from(n).expect("it is small")));
    Plan::new(wavelet, extent.expect("no axis is empty"), u8::try_from(levels).expect("levels are few"))
        .expect("the extent allows the levels")
}

/// Storage under every predictor, and as it is.
fn storages() -> impl Iterator<Item = Storage> {
    (0..=4).map(|predictor| Storage::Coded { predictor }).chain([Storage::Stored])
}

fn wavelets() -> impl Iterator<Item = Option<Psi>> {
    Psi::ALL.into_iter().map(Some).chain([None])
}

/// A sample at a place; where it needs more than `i32` it keeps its low 32 bits.
type Field = fn(&mut Noise, [i64; 3]) -> i64;

/// Data that exercise every class and every part of a value.
const DATA: [(SampleType, Field); 16] = [
    (SampleType::U8, |_, [x, y, z]| 60 + x + 2 * y + (x * y + z * z) / 32),
    (SampleType::I16, |_, [x, y, z]| 300 * x - 200 * y + 100 * z - 12 * x * z),
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

fn texture(x: i64, y: i64) -> i64 {
    (Noise::new((64 * x + y) as u64).bits() >> 52) as i64
}

fn samples_of(field: Field, extent: [usize; 3], seed: u64) -> Vec<i32> {
    let mut noise = Noise::new(seed);
    let [width, height, _] = extent;
    (0..extent.iter().product())
        .map(|at| [at % width, at / width % height, at / (width * height)].map(|k| k as i64))
        .map(|place| field(&mut noise, place) as i32)
        .collect()
}

/// Lines, slices and bricks of mixed lengths.
fn extents() -> Vec<[usize; 3]> {
    let length = |i: usize| LENGTHS[i % LENGTHS.len()];
    let lines = LENGTHS.map(|n| [n, 1, 1]);
    let slices = (0..12).flat_map(|i| [1, 5, 8].map(|k| [length(i), length(i + k), 1]));
    let bricks = (0..12).flat_map(|i| [0, 1, 2, 3].map(|k| [length(i), length(5 * i + k), length(7 * i + 3 * k)]));
    lines.into_iter().chain(slices).chain(bricks).collect()
}

/// All levels, or every second time fewer.
fn levels_of(psi: Option<Psi>, extent: [usize; 3], turn: usize) -> Option<usize> {
    match (psi, lifting::max_levels(extent)) {
        (None, _) => Some(0),
        (Some(_), 0) => None,
        (Some(_), most) => Some(if turn.is_multiple_of(2) { most } else { 1 + turn / 2 % most }),
    }
}

/// The bytes of a codestream that `level` needs.
fn bytes_to_level(bytes: &[u8], level: usize) -> &[u8] {
    let header = Header::parse(bytes).expect("the header is sound");
    let segments = header.lengths.len().saturating_sub(level).max(1);
    &bytes[..header.bytes + header.lengths[..segments].iter().sum::<usize>()]
}

#[test]
fn kernel_and_oracle_write_the_same_bytes_and_read_each_other() {
    let mut chosen = Vec::new();
    for (turn, (psi, extent)) in
        wavelets().flat_map(|psi| extents().into_iter().map(move |extent| (psi, extent))).enumerate()
    {
        let Some(levels) = levels_of(psi, extent, turn) else { continue };
        let (sample_type, field) = DATA[(turn + turn / DATA.len()) % DATA.len()];
        let samples = samples_of(field, extent, turn as u64);
        let bytes = kernel_encode(&plan(psi, extent, levels), sample_type, &samples);
        assert_eq!(encode_as(&bytes, &samples), bytes, "{psi:?} {extent:?} {levels} levels {sample_type:?}");
        let expected: Vec<_> = (0..=levels).map(|level| both_decode(&bytes, level)).collect();
        assert_eq!(expected[0].as_ref().map(|decoded| &decoded.samples), Ok(&samples));
        let choices = Header::parse(&bytes).expect("both have read it").choices;
        for storage in storages() {
            let stream = encode(&Choices { storage, ..choices }, &samples);
            for (level, expected) in expected.iter().enumerate() {
                assert_eq!(both_decode(bytes_to_level(&stream, level), level), *expected);
            }
        }
        chosen.push(choices.storage);
    }
    assert!(storages().all(|storage| chosen.contains(&storage)), "the kernel's encoder makes every choice");
    println!("{} codestreams", chosen.len());
    for s in storages() { println!("{s:?} {}", chosen.iter().filter(|&&c| c == s).count()); }
}
