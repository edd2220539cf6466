//! Codestreams worked out by hand, byte by byte.
//!
//! In the comments T and F are decisions, true and false, and R is a raw bit that is 0. Each line gives the split or
//! unit, then low and range after the step, in hexadecimal. Where nothing else is said, P is 8000, that of a new
//! probability; after one T it is 8000 - 2000 = 6000, after one F it is 8000 + (7FFF >> 2) = 9FFF.

use conformance::oracle::coder::{self, Choices, Decoded, Storage, Weights, encode};
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
    // The prediction is 0, the class 0 and the context of signs 13. The residual 5 is binary 101, so e = 2.
    //             split     low       range
    //                       00000000  FFFFFFFF
    // T not 0     7FFF8000  7FFF8000  80007FFF
    // F negative  40000000  7FFF8000  40000000
    // T e > 0     20000000  9FFF8000  20000000
    // T e > 1     10000000  AFFF8000  10000000
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
    // low rises to B6000000. The second segment codes 6, binary 110, again in class 0 and in the context of signs 13,
    // where the probabilities have seen one decision each:
    //                      split     low       range
    //                                00000000  FFFFFFFF
    // T not 0     P 6000   5FFFA000  5FFFA000  A0005FFF
    // F negative  P 9FFF   63FF6000  5FFFA000  63FF6000
    // T e > 0     P 6000   257FA000  857F4000  3E7FC000
    // T e > 1     P 6000   176FA000  9CEEE000  27102000
    // F e > 2     P 9FFF   1869D8F0  9CEEE000  1869D8F0
    // T bit 1     P 6000   09276000  A6164000  0F4278F0
    // F bit 0     P 6000   05B8C000  A6164000  05B8C000
    // low rises to A7000000.
    let bytes = [0x77, 0x4C, 1, 0, 0x13, 1, 2, 1, 1, 1, 1, 0xB6, 0xA7];
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
    //                        AFFF8000  10000000
    // T e > 2      08000000  B7FF8000  08000000
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
    // So does predictor 5, whose differences are all 0.
    let weights = Weights { first: [1; 9], others: [1; 19] };
    let mut bytes = vec![0x77, 0x4C, 1, 5, 0x03, 0, 1, 1, 2];
    bytes.extend([2; 28]);
    bytes.extend([1, 0xB9]);
    let choices = Choices {
        storage: Storage::Trained { weights },
        sample_type: coder::SampleType::I16,
        psi: None,
        levels: 0,
        extent: [1, 1, 2],
    };
    assert_oracle(&choices, &[10, 10], &bytes);
    let bytes = kernel_encode(&plan(None, [1, 1, 2], 0), SampleType::I16, &[10, 10]);
    assert_eq!(bytes[4..], [0x03, 0, 1, 1, 2, 1, 0xB9]);
}

#[test]
fn signs() {
    // -5 and -10 make the residual -5 twice. The first has the class 0 and the context of signs 13:
    //              split     low       range
    // T not 0      7FFF8000  7FFF8000  80007FFF
    // T negative   40000000  BFFF8000  40007FFF
    // T e > 0      20000000  DFFF8000  20007FFF
    // T e > 1      10000000  EFFF8000  10007FFF
    // F e > 2      08000000  EFFF8000  08000000
    // F bit 1      04000000  EFFF8000  04000000
    // T bit 0      02000000  F1FF8000  02000000
    // The second has the class 8, of s = 4 W = 20, and the context of signs 9 * 0 + 3 * 1 + 1 = 4; all is new but for
    // the bits, which have seen those of the first:
    // T not 0      01000000  F2FF8000  01000000
    // T negative   00800000  F37F8000  00800000, which is below 2^24: the segment is F3,
    //                        7F800000  80000000
    // T e > 0      40000000  BF800000  40000000
    // T e > 1      20000000  DF800000  20000000
    // F e > 2      10000000  DF800000  10000000
    // F P = 9FFF   09FFF000  DF800000  09FFF000
    // T P = 6000   03BFA000  E33FA000  06405000
    // low rises to E4000000.
    let bytes = [0x77, 0x4C, 1, 0, 0x01, 0, 2, 1, 1, 2, 0xF3, 0xE4];
    let choices = Choices {
        storage: CODED,
        sample_type: coder::SampleType::I8,
        psi: None,
        levels: 0,
        extent: [2, 1, 1],
    };
    assert_oracle(&choices, &[-5, -10], &bytes);
}

#[test]
fn trained() {
    // The weight -256 of the sample at x - 2 is the number 511 = 3 * 128 + 127. The predictions of 4 and 6 are 0 and
    // 4, as all D are 0; that of 8 is 6 + ((-256 * (4 - 6) + 128) >> 8) = 8. The residual 4, binary 100, is coded like
    // the 5 in `one_sample` but for the last bit:
    //              split     low       range
    //                        AFFF8000  04000000
    // F bit 0      02000000  AFFF8000  02000000
    // The residual 2 has the class 8, of s = 4 W = 16, and the context of signs 9 * 2 + 3 * 1 + 1 = 22:
    // T not 0      01000000  B0FF8000  01000000
    // F negative   00800000  B0FF8000  00800000, which is below 2^24: the segment is B0,
    //                        FF800000  80000000
    // T e > 0      40000000  3F800000  40000000, carrying into the segment: B1
    // F e > 1      20000000  3F800000  20000000
    // F bit 0      10000000  3F800000  10000000
    // The residual 0 has the class 7, of s = 4 W + WW = 12:
    // F not 0      08000000  3F800000  08000000
    // low rises to 40000000.
    let mut bytes = vec![0x77, 0x4C, 1, 5, 0x00, 0, 3, 1, 1, 0xFF, 0x03, 0, 0, 0, 0, 0, 0, 0, 0];
    bytes.extend([2, 0xB1, 0x40]);
    let choices = Choices {
        storage: Storage::Trained {
            weights: Weights { first: [-256, 0, 0, 0, 0, 0, 0, 0, 0], others: [0; 19] },
        },
        sample_type: coder::SampleType::U8,
        psi: None,
        levels: 0,
        extent: [3, 1, 1],
    };
    assert_oracle(&choices, &[4, 6, 8], &bytes);
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
