//! Codestreams worked out by hand, byte by byte.
//!
//! In the comments T and F are decisions, true and false, and R is a raw bit that is 0. Each line gives the split or
//! unit, then low and range after the step, in hexadecimal. Where nothing else is said, P is 8000, that of a new
//! probability; after one T it is 8000 - 2000 = 6000, after one F it is 8000 + (7FFF >> 2) = 9FFF.

use conformance::oracle::coder::{self, Choices, Decoded, Storage, encode};
use conformance::oracle::lifting::Psi;
use wavelift_kernel::{SampleType, Wavelet};

use super::{both_decode, kernel_encode, plan};

/// Asserts that the oracle makes these bytes of these samples, and that both decoders make the samples of the bytes.
fn assert_oracle(choices: &Choices, samples: &[i32], bytes: &[u8]) {
    assert_eq!(encode(choices, samples), bytes, "{choices:?}");
    let decoded = Decoded { extent: choices.extent, samples: samples.to_vec() };
    assert_eq!(both_decode(bytes, 0), Ok(decoded), "{choices:?}");
}

const CODED: Storage = Storage::Coded { predictor: 0 };

#[test]
fn one_sample() {
    // The prediction is 0 and the class is 0. The residual 5 is binary 101, so e = 2.
    //             split     low       range
    //                       00000000  FFFFFFFF
    // T not 0     7FFF8000  7FFF8000  80007FFF
    // R positive  40003FFF  7FFF8000  40003FFF
    // T e > 0     20000000  9FFF8000  20003FFF
    // T e > 1     10000000  AFFF8000  10003FFF
    // F e > 2     08000000  AFFF8000  08000000
    // F bit 1     04000000  AFFF8000  04000000
    // T bit 0     02000000  B1FF8000  02000000
    // low rises to B2000000.
    let bytes = [0x77, 0x4C, 1, 0, 0x05, 0, 1, 1, 1, 1, 0xB2];
    let choices = Choices {
        storage: CODED,
        sample_type: coder::SampleType::I32,
        psi: None,
        levels: 0,
        extent: [1, 1, 1],
    };
    assert_oracle(&choices, &[5], &bytes);
    assert_eq!(kernel_encode(&plan(None, [1, 1, 1], 0), SampleType::I32, &[5]), bytes);
}

#[test]
fn two_samples_and_a_level() {
    // d = 10 - 4 = 6, c = 10 - [6/2] = 7. The first segment is that of 5 in `one_sample` as far as e; the bits of 7,
    // binary 111, are both set:
    //                        AFFF8000  08000000
    // T bit 1      04000000  B3FF8000  04000000
    // T bit 0      02000000  B5FF8000  02000000
    // low rises to B6000000. The second segment codes 6, binary 110, again in class 0, where the probabilities
    // have seen one decision each:
    //              split     low       range
    //                        00000000  FFFFFFFF
    // T P = 6000   5FFFA000  5FFFA000  A0005FFF
    // R positive   50002FFF  5FFFA000  50002FFF
    // T P = 6000   1E000000  7DFFA000  32002FFF
    // T P = 6000   12C00000  90BFA000  1F402FFF
    // F P = 9FFF   1387E0C0  90BFA000  1387E0C0
    // T P = 6000   0752A000  98124000  0C3540C0
    // F P = 6000   0493E000  98124000  0493E000
    // low rises to 99000000.
    let bytes = [0x77, 0x4C, 1, 0, 0x13, 1, 2, 1, 1, 1, 1, 0xB6, 0x99];
    let choices = Choices {
        storage: CODED,
        sample_type: coder::SampleType::I16,
        psi: Some(Psi::H),
        levels: 1,
        extent: [2, 1, 1],
    };
    assert_oracle(&choices, &[10, 4], &bytes);
    assert_eq!(kernel_encode(&plan(Some(Wavelet::Haar), [2, 1, 1], 1), SampleType::I16, &[10, 4]), bytes);
    assert_eq!(both_decode(&bytes[..12], 1), Ok(Decoded { extent: [1, 1, 1], samples: vec![7] }));
}

#[test]
fn a_carry() {
    // Two planes of one sample. The first residual is 10, binary 1010, so e = 3; as far as e > 1 it is coded like the 5
    // in `one_sample`:
    //              split     low       range
    //                        AFFF8000  10003FFF
    // T e > 2      08000000  B7FF8000  08003FFF
    // F e > 3      04000000  B7FF8000  04000000
    // F bit 2      02000000  B7FF8000  02000000
    // T bit 1      01000000  B8FF8000  01000000
    // R bit 0      00800000  B8FF8000  00800000, which is below 2^24: the segment is B8,
    //                        FF800000  80000000
    // Every predictor gives 10 for the second sample, as all its neighbours are replaced by u: the residual is 0.
    // s = 4 U = 40 = 101000 binary, so the class is 2 * 5 + 0 and its probability new:
    // F not 0      40000000  FF800000  40000000
    // low rises to 1 00000000, which carries into the segment: B9; the top byte of low, 0, is left out.
    for predictor in 0..=4 {
        let bytes = [0x77, 0x4C, 1, predictor, 0x03, 0, 1, 1, 2, 1, 0xB9];
        let choices = Choices {
            storage: Storage::Coded { predictor },
            sample_type: coder::SampleType::I16,
            psi: None,
            levels: 0,
            extent: [1, 1, 2],
        };
        assert_oracle(&choices, &[10, 10], &bytes);
    }
    let bytes = kernel_encode(&plan(None, [1, 1, 2], 0), SampleType::I16, &[10, 10]);
    assert_eq!(bytes[4..], [0x03, 0, 1, 1, 2, 1, 0xB9]);
}

#[test]
fn zeros() {
    // Every decision is false, so both segments are empty.
    let bytes = [0x77, 0x4C, 1, 0, 0x12, 1, 2, 2, 2, 0, 0];
    let choices = Choices {
        storage: CODED,
        sample_type: coder::SampleType::U16,
        psi: Some(Psi::H),
        levels: 1,
        extent: [2, 2, 2],
    };
    assert_oracle(&choices, &[0; 8], &bytes);
    assert_eq!(kernel_encode(&plan(Some(Wavelet::Haar), [2, 2, 2], 1), SampleType::U16, &[0; 8]), bytes);
}

#[test]
fn stored() {
    // 200 needs two bytes as a number: 200 = 1 * 128 + 72, and 72 = 48 hexadecimal, C8 with the top bit.
    let mut bytes = vec![0x77, 0x4C, 1, 0x80, 0x63, 1, 100, 1, 1, 0xC8, 1];
    bytes.extend((0..50).flat_map(|_| [0xFF, 0x7F, 0x00, 0x80]));
    let samples = [32767, -32768].repeat(50);
    let choices = Choices {
        storage: Storage::Stored,
        sample_type: coder::SampleType::I16,
        psi: Some(Psi::Five),
        levels: 1,
        extent: [100, 1, 1],
    };
    assert_oracle(&choices, &samples, &bytes);
    // -2^31 alone costs more than 4 bytes: e = 31 takes 31 decisions.
    let bytes = [0x77, 0x4C, 1, 0x80, 0x05, 0, 1, 1, 1, 4, 0, 0, 0, 0x80];
    let choices =
        Choices { sample_type: coder::SampleType::I32, psi: None, levels: 0, extent: [1, 1, 1], ..choices };
    assert_oracle(&choices, &[i32::MIN], &bytes);
    assert_eq!(kernel_encode(&plan(None, [1, 1, 1], 0), SampleType::I32, &[i32::MIN]), bytes);
}
