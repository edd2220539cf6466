//! Bytes that no encoder has made: both decoders make the same of them.

use conformance::oracle::coder::{Choices, Header, Predictor, Reject, SampleType, Storage, encode};
use conformance::oracle::lifting::Psi;
use conformance::oracle::noise::Noise;

use super::{any_predictors, both_decode, row};

/// A brick of small values under these choices, with any predictors.
fn codestream(storage: Storage, sample_type: SampleType, psi: Psi, noise: &mut Noise) -> Vec<u8> {
    let extent = [9, 6, 11];
    let choices = Choices { storage, sample_type, psi: Some(psi), levels: 2, extent };
    let samples: Vec<_> = Noise::new(7).within(40, 9 * 6 * 11).into_iter().map(|v| v + 60).collect();
    encode(&choices, &any_predictors(noise, &choices), &samples)
}

#[test]
fn every_byte_of_a_header_takes_every_value() {
    for storage in [Storage::Coded, Storage::Light, Storage::Stored] {
        let sound = codestream(storage, SampleType::I16, Psi::Q, &mut Noise::new(6));
        for at in 0..Header::parse(&sound).expect("it is sound").bytes {
            for value in 0..=255 {
                let mut damaged = sound.clone();
                damaged[at] = value;
                // Dense and tabled codestreams and lattices have pages, and tests, of their own.
                if matches!(damaged[3], 1..=4 | 6) {
                    continue;
                }
                let oracle = Header::parse(&damaged).map(|header| header.total_bytes() as u64);
                let kernel = wavelift_kernel::Header::parse(&damaged).map(|header| header.encoded_bytes());
                assert_eq!(kernel.map_err(row), oracle, "{damaged:02X?}");
            }
        }
    }
}

#[test]
fn damaged_segments() {
    let mut noise = Noise::new(8);
    let mut outcomes = Vec::new();
    for (turn, psi) in Psi::ALL.into_iter().cycle().enumerate().take(1200) {
        let sample_type = [SampleType::U8, SampleType::I32, SampleType::U16][turn % 3];
        let storage = [Storage::Coded, Storage::Light][turn / 6 % 2];
        let mut bytes = codestream(storage, sample_type, psi, &mut noise);
        let header = Header::parse(&bytes).expect("it is sound").bytes;
        let at = header + noise.bits() as usize % (bytes.len() - header);
        bytes[at] = (noise.bits() >> 56) as u8;
        outcomes.extend([0, 1, 2].map(|level| both_decode(&bytes, level)));
    }
    for expected in [Reject::Segment, Reject::Sample] {
        assert!(outcomes.contains(&Err(expected)), "{expected:?} never happened");
    }
}

#[test]
fn segments_of_any_bytes() {
    // A segment that begins with a predictor and then many set bits has the largest magnitudes, beyond 2^31 too.
    let mut noise = Noise::new(9);
    let mut decoded = 0;
    for turn in 0..20_000 {
        let predictor = [0x00, 0x20, 0x40, 0x60, 0x80, 0xA0, 0xC0][turn % 7];
        let ones = [0, 1, 3, 9][turn % 4];
        let mut segment = vec![predictor | 0x1F];
        segment.resize(1 + ones, 0xFF);
        segment.resize_with(ones + 2 + turn % 31, || (noise.bits() >> 56) as u8);
        let storage = [0, 5][turn / 84 % 2];
        let mut bytes = vec![0x77, 0x4C, 2, storage, [0x05, 0x04, 0x03][turn % 3], 0, 2, 2, 3];
        bytes.push(segment.len() as u8);
        bytes.extend(segment);
        decoded += usize::from(both_decode(&bytes, 0).is_ok());
    }
    assert!(decoded > 500, "only {decoded} codestreams are sound");
}

/// Illegal predictors, which the oracle writes if it is asked to.
fn reject(predictor: Predictor, extent: [usize; 3]) {
    let choices =
        Choices { storage: Storage::Coded, sample_type: SampleType::I32, psi: None, levels: 0, extent };
    let bytes = encode(&choices, std::slice::from_ref(&predictor), &vec![3; choices.places()]);
    assert_eq!(both_decode(&bytes, 0), Err(Reject::Segment), "{predictor:?}");
}

#[test]
fn weights_beyond_their_bounds() {
    for weight in [2049, -2049, 4096, 1 << 20, i32::MAX, -i32::MAX, i32::MIN] {
        for at in [0, 1] {
            let mut weights = vec![0; 2];
            weights[at] = weight;
            reject(Predictor::Weights(vec![weights]), [3, 1, 1]);
        }
    }
    // 17 weights of a slice: 2 of the own row, 7, 5 and 3 of those above.
    let largest = |last| Predictor::Weights(vec![[vec![-2048; 16], vec![last]].concat()]);
    reject(largest(1), [2, 2, 1]);
    reject(largest(-1), [2, 2, 1]);
    reject(largest(2048), [2, 2, 1]);
    let choices = Choices {
        storage: Storage::Coded,
        sample_type: SampleType::I32,
        psi: None,
        levels: 0,
        extent: [2, 2, 1],
    };
    let sound = encode(&choices, &[largest(0)], &[3; 4]);
    assert!(both_decode(&sound, 0).is_ok(), "a sum of 32768");
}

/// So many symbols that some numbers lie beyond the last share, where a range is no multiple of its unit, and grow out
/// of the 32 bits of a decoder.
#[test]
fn long_segments_of_any_bytes() {
    let mut noise = Noise::new(10);
    let mut decoded = 0;
    for turn in 0..40 {
        let mut segment = vec![[0x00, 0x40, 0x80, 0xC0][turn % 4]];
        segment.resize_with(1000, || (noise.bits() >> 56) as u8 | (noise.bits() >> 59) as u8);
        // A line of 2^14 samples, and a segment of 1000 bytes.
        let storage = [0, 5][turn / 4 % 2];
        let mut bytes = vec![0x77, 0x4C, 2, storage, 0x05, 0, 0x80, 0x80, 1, 1, 1, 0xE8, 0x07];
        bytes.extend(segment);
        decoded += usize::from(both_decode(&bytes, 0).is_ok());
    }
    assert!(decoded > 20, "only {decoded} codestreams are sound");
}
