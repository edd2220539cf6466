//! Near-lossless codestreams: bounds, levels, extremes, hostile bytes.

use wavelift_kernel::{Codec, DecodeError, Extent, Header, Lattice, Near, SampleType, max_encoded_len};

/// A reproducible stream of numbers (xorshift).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 32) as u32
    }
}

fn encode(near: Near, samples: &[i32]) -> Vec<u8> {
    let mut samples = samples.to_vec();
    let before = samples.clone();
    let mut scratch = vec![7; Lattice::encoding_scratch_len(near.extent)];
    let mut out = vec![0; max_encoded_len(near.extent, near.sample_type).unwrap()];
    let len = { Lattice::NEW }.encode(near, &mut samples, &mut scratch, &mut out).unwrap();
    assert_eq!(samples, before, "the samples are what they were");
    out.truncate(len);
    assert_eq!(
        decode(&out, 0).as_deref(),
        Ok(&scratch[..samples.len()]),
        "the encoder knows what is decoded"
    );
    out
}

fn decode(bytes: &[u8], level: u8) -> Result<Vec<i32>, DecodeError> {
    let header = Header::parse(bytes)?;
    let mut samples = vec![-1; header.samples_len(level)];
    let mut scratch = vec![9; Lattice::decoding_scratch_len(header.extent_at(level))];
    { Lattice::NEW }.decode_to_level(bytes, level, &mut samples, &mut scratch)?;
    Ok(samples)
}

/// The value that a sample stands for.
fn value(sample_type: SampleType, sample: i32) -> i64 {
    if sample_type == SampleType::U32 { i64::from(sample.cast_unsigned()) } else { i64::from(sample) }
}

/// Encodes, decodes every level from as few bytes as it takes, and checks every sample.
fn check(near: Near, samples: &[i32]) -> Vec<u8> {
    let bytes = encode(near, samples);
    let header = Header::parse(&bytes).unwrap();
    let [width, height, _] = near.extent.axes().map(|side| side as usize);
    for level in 0..=header.plan().levels() {
        let end = usize::try_from(header.bytes_to_level(level)).unwrap();
        let decoded = decode(&bytes[..end], level).unwrap();
        let [x, y, _] = header.extent_at(level).axes().map(|side| side as usize);
        for (index, &sample) in decoded.iter().enumerate() {
            let [i, j, k] = [index % x, index / x % y, index / x / y].map(|at| at << level);
            let original = samples[(k * height + j) * width + i];
            let off = value(near.sample_type, sample) - value(near.sample_type, original);
            assert!(
                off.unsigned_abs() <= u64::from(near.slack),
                "{near:?} level {level} sample {index}: off by {off}"
            );
        }
        if end > 0 {
            assert_eq!(decode(&bytes[..end - 1], level), Err(DecodeError::Truncated));
        }
    }
    bytes
}

fn wave(extent: Extent, noise: u32) -> Vec<i32> {
    let [x, y, z] = extent.axes();
    let mut numbers = Numbers(0x1234_5678_9abc_def1);
    let places = (0..z).flat_map(|z| (0..y).flat_map(move |y| (0..x).map(move |x| [x, y, z].map(f64::from))));
    let smooth = |[x, y, z]: [f64; 3]| {
        (1000.0 * ((x * 0.31).sin() + (y * 0.17 + x * 0.05).cos() + (z * 0.23).sin())) as i32
    };
    places.map(|place| smooth(place) + (numbers.next() % noise) as i32).collect()
}

#[test]
fn every_extent_and_slack_keeps_its_bound() {
    let sides = [1, 2, 3, 4, 5, 8, 17];
    for x in sides {
        for y in sides {
            for z in [1, 2, 5, 9] {
                let extent = Extent::brick(x, y, z).unwrap();
                for slack in [0, 1, 2, 7, 1000] {
                    check(Near { extent, sample_type: SampleType::I32, slack }, &wave(extent, 5));
                }
            }
        }
    }
}

#[test]
fn trained_passes_keep_their_bound_and_pay() {
    let extent = Extent::brick(40, 33, 21).unwrap();
    for slack in [0, 1, 3, 20, 400] {
        let bytes = check(Near { extent, sample_type: SampleType::I16, slack }, &wave(extent, 3));
        assert!(bytes.len() * 8 < extent.samples() * 4, "{} bytes", bytes.len());
    }
    for extent in [Extent::line(5000).unwrap(), Extent::slice(100, 90).unwrap()] {
        check(Near { extent, sample_type: SampleType::I16, slack: 4 }, &wave(extent, 30));
    }
}

#[test]
fn extremes_of_every_type_keep_their_bound() {
    let extent = Extent::brick(13, 10, 9).unwrap();
    let mut numbers = Numbers(99);
    for sample_type in SampleType::ALL {
        let (low, high) = (*sample_type.range().start(), *sample_type.range().end());
        let samples: Vec<i32> = (0..extent.samples())
            .map(|_| match numbers.next() % 4 {
                0 => low,
                1 => high,
                2 => 0,
                _ => {
                    (i64::from(low) + i64::from(numbers.next()) % (i64::from(high) - i64::from(low) + 1))
                        as i32
                }
            })
            .collect();
        for slack in [0, 1, 5, 100, 1 << 20, (1 << 30) - 1, u32::MAX] {
            check(Near { extent, sample_type, slack }, &samples);
        }
    }
}

#[test]
fn a_constant_takes_next_to_nothing() {
    let extent = Extent::brick(64, 64, 64).unwrap();
    for value in [0, 5, i32::MIN, i32::MAX] {
        let bytes =
            check(Near { extent, sample_type: SampleType::I32, slack: 2 }, &vec![value; extent.samples()]);
        assert!(bytes.len() < 150, "{} bytes", bytes.len());
    }
}

#[test]
fn what_was_done_before_never_shows() {
    let extent = Extent::brick(20, 20, 20).unwrap();
    let near = Near { extent, sample_type: SampleType::I16, slack: 3 };
    let mut lattice = Box::new(Lattice::NEW);
    let mut scratch = vec![0; Lattice::encoding_scratch_len(extent)];
    let mut out = vec![0; max_encoded_len(extent, SampleType::I16).unwrap()];
    let first = encode(near, &wave(extent, 9));
    for _ in 0..2 {
        let len = lattice.encode(near, &mut wave(extent, 9), &mut scratch, &mut out).unwrap();
        assert_eq!(out[..len], first);
    }
    lattice.reset();
    assert_eq!(*lattice, Lattice::NEW);
}

#[test]
fn hostile_bytes_never_panic() {
    let extent = Extent::brick(11, 9, 7).unwrap();
    for slack in [0, 3] {
        let bytes = encode(Near { extent, sample_type: SampleType::I16, slack }, &wave(extent, 50));
        let mut changed = bytes.clone();
        for at in 3..bytes.len() {
            for bit in 0..8 {
                changed[at] ^= 1 << bit;
                let small =
                    Header::parse(&changed).is_ok_and(|header| header.plan().extent().samples() < 10_000);
                if small {
                    let _ = decode(&changed, 0);
                }
                changed[at] = bytes[at];
            }
        }
        let mut longer = bytes.clone();
        longer.push(0);
        assert_eq!(decode(&longer, 0), Err(DecodeError::TrailingBytes));
    }
}

#[test]
fn each_codec_refuses_what_is_for_the_other() {
    let extent = Extent::brick(11, 9, 7).unwrap();
    let bytes = encode(Near { extent, sample_type: SampleType::I16, slack: 2 }, &wave(extent, 5));
    let header = Header::parse(&bytes).unwrap();
    assert_eq!(header.slack(), Some(2));
    let (mut samples, mut scratch) = (vec![0; extent.samples()], vec![0; 10_000]);
    let mut codec = Codec::NEW;
    assert_eq!(codec.decode(&bytes, &mut samples, &mut scratch), Err(DecodeError::OtherCodec));
    let max = header.plan().levels();
    assert_eq!(decode(&bytes, max + 1), Err(DecodeError::LevelOutOfRange { max }));
}
