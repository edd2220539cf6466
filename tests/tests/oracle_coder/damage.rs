//! Bytes that no encoder has made: both decoders make the same of them.

use conformance::oracle::coder::{Choices, Header, Reject, SampleType, Storage, encode};
use conformance::oracle::lifting::Psi;
use conformance::oracle::noise::Noise;

use super::{any_weights, both_decode, row};

/// A brick of small values under these choices.
fn codestream(storage: Storage, sample_type: SampleType, psi: Psi) -> Vec<u8> {
    let extent = [9, 6, 11];
    let choices = Choices { storage, sample_type, psi: Some(psi), levels: 2, extent };
    let samples: Vec<_> = Noise::new(7).within(40, 9 * 6 * 11).into_iter().map(|v| v + 60).collect();
    encode(&choices, &samples)
}

#[test]
fn every_byte_of_a_header_takes_every_value() {
    let trained = Storage::Trained { weights: any_weights(&mut Noise::new(6), true) };
    for storage in [Storage::Coded { predictor: 3 }, trained, Storage::Stored] {
        let sound = codestream(storage, SampleType::I16, Psi::Q);
        for at in 0..Header::parse(&sound).expect("it is sound").bytes {
            for value in 0..=255 {
                let mut damaged = sound.clone();
                damaged[at] = value;
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
    for (turn, psi) in Psi::ALL.into_iter().cycle().enumerate().take(600) {
        let sample_type = [SampleType::U8, SampleType::I32, SampleType::U16][turn % 3];
        let storage = match turn as u8 % 7 {
            predictor @ 0..=4 => Storage::Coded { predictor },
            _ => Storage::Trained { weights: any_weights(&mut noise, true) },
        };
        let mut bytes = codestream(storage, sample_type, psi);
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
    // A segment that begins with many set bits begins with the largest magnitudes, beyond 2^31 too.
    let mut noise = Noise::new(9);
    let mut decoded = 0;
    for turn in 0..4000 {
        let ones = [0, 1, 3, 9][turn % 4];
        let mut segment = vec![0xFF; ones];
        segment.resize_with(ones + 1 + turn % 31, || (noise.bits() >> 56) as u8);
        if ones > 3 {
            segment[3] = 0xFE;
        }
        let predictor = (turn / 4 % 6) as u8;
        let mut bytes = vec![0x77, 0x4C, 1, predictor, 0x05, 0, 2, 2, 3];
        if predictor == 5 {
            // two bytes each, of 2048 and -2048 too
            let numbers = (0..28).map(|_| 128 + noise.bits() % (4097 - 128));
            bytes.extend(numbers.flat_map(|number| [0x80 | number as u8, (number >> 7) as u8]));
        }
        bytes.push(segment.len() as u8);
        bytes.extend(segment);
        decoded += usize::from(both_decode(&bytes, 0).is_ok());
    }
    assert!(decoded > 500, "only {decoded} codestreams are sound");
}
