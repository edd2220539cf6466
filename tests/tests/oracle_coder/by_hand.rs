//! Codestreams worked out by hand, byte by byte.
//!
//! Each line of a comment gives what is coded, the unit, and low and range after the step, in hexadecimal; a symbol is
//! followed by its share. A range below 2^24 shifts the top byte of low out.

use conformance::effort::Effort;
use conformance::oracle::coder::Predictor::{Fixed, Weights, Zero};
use conformance::oracle::coder::{Choices, Decoded, Predictor, SampleType, Storage, encode};
use conformance::oracle::lifting::Psi;

use super::{both_decode, kernel_encode, plan};

/// Asserts that the oracle makes these bytes of these samples, and that both decoders make the samples of the bytes.
fn assert_oracle(choices: &Choices, predictors: &[Predictor], samples: &[i32], bytes: &[u8]) {
    assert_eq!(encode(choices, predictors, samples), bytes, "{choices:?}");
    let decoded = Decoded { extent: choices.extent, samples: samples.to_vec() };
    assert_eq!(both_decode(bytes, 0), Ok(decoded), "{choices:?}");
}

const fn coded(sample_type: SampleType, extent: [usize; 3]) -> Choices {
    Choices { storage: Storage::Coded, sample_type, psi: None, levels: 0, extent }
}

#[test]
fn one_sample() {
    // The prediction and its offset are 0, the class small and 0, the fraction 0. The rank of 5 is 9.
    //                  unit      low       range
    //                            00000000  FFFFFFFF
    // predictor 000    1FFFFFFF  00000000  1FFFFFFF
    // symbol 9         00003FFF  1FAB4151  00077FE2   32431 to 32461; the segment is 1F,
    //                            AB415100  077FE200
    // low rises to AC000000.
    let bytes = [0x77, 0x4C, 2, 0, 0x05, 0, 1, 1, 1, 2, 0x1F, 0xAC];
    assert_oracle(&coded(SampleType::I32, [1, 1, 1]), &[Fixed(0)], &[5], &bytes);
}

#[test]
fn one_sample_in_few_decisions() {
    // The energy is 0, and so are the class and the bits of a step. The rank of 5 is 9: 9 steps, and 9 - 3 = 6 = 4 + 2
    // beyond, of the exponent 2. All chances are 8000.
    //                            00000000  FFFFFFFF
    // predictor 000    1FFFFFFF  00000000  1FFFFFFF
    //                  share
    // not 0            0FFF8000  0FFF8000  10007FFF
    // not 1            08000000  17FF8000  08007FFF
    // not 2            04000000  1BFF8000  04007FFF
    // not 3            02000000  1DFF8000  02007FFF
    // exponent not 0   01000000  1EFF8000  01007FFF
    // not 1            00800000  1F7F8000  00807FFF   the segment is 1F,
    //                            7F800000  807FFF00
    // but 2            403F8000  7F800000  403F8000
    // bits 10          100FE000  9F9FC000  100FE000
    // low rises to A0000000.
    let bytes = [0x77, 0x4C, 2, 5, 0x05, 0, 1, 1, 1, 2, 0x1F, 0xA0];
    let choices = Choices { storage: Storage::Light, ..coded(SampleType::I32, [1, 1, 1]) };
    assert_oracle(&choices, &[Fixed(0)], &[5], &bytes);
    assert_eq!(
        kernel_encode(Effort::Light, &plan(None, [1, 1, 1], 0), wavelift_kernel::SampleType::I32, &[5]).len(),
        12
    );
}

#[test]
fn two_samples_and_a_level() {
    // d = 10 - 4 = 6, c = 10 - [6/2] = 7, of the ranks 11 and 13, both in class 0.
    //                            00000000  FFFFFFFF
    // predictor 000    1FFFFFFF  00000000  1FFFFFFF
    // symbol 13        00003FFF  1FC900DA  0006FFE4   32550 to 32578; the segment is 1F,
    //                            C900DA00  06FFE400
    // low rises to CA000000. With rate 3, below[11] = 32493 has gone down by (32493 - 11 + 7) / 8 = 4061 to 28432, and
    // below[12] = 32522 by 4064 to 28458.
    //                            00000000  FFFFFFFF
    // predictor 110    1FFFFFFF  BFFFFFFA  1FFFFFFF
    // symbol 11        00003FFF  DBC390EA  00067FE6   28432 to 28458; the segment is DB,
    //                            C390EA00  067FE600
    // low rises to C4000000.
    let bytes = [0x77, 0x4C, 2, 0, 0x13, 1, 2, 1, 1, 2, 2, 0x1F, 0xCA, 0xDB, 0xC4];
    let choices = Choices { psi: Some(Psi::H), levels: 1, ..coded(SampleType::I16, [2, 1, 1]) };
    assert_oracle(&choices, &[Fixed(0), Zero], &[10, 4], &bytes);
    assert_eq!(both_decode(&bytes[..13], 1), Ok(Decoded { extent: [1, 1, 1], samples: vec![7] }));
}

#[test]
fn escapes_and_a_large_class() {
    // The rank of 100 is 199: the symbol 15, and the number 199 - 14 = 185 = 128 + 57, of 7 bits below its leading one.
    // The energy of the second is 4 * 100: o = 8 and h = 1, large class 7 with steps of 3 bits. Of -3, m = 2 and
    // j = 0: the symbol 1, then the low bits 010 of m, then 1 for the sign.
    //                            00000000  FFFFFFFF
    // predictor 110    1FFFFFFF  BFFFFFFA  1FFFFFFF
    // symbol 15        00003FFF  DFD6C09D  0028BF5D   32605 to 32768; the segment is DF,
    //                            D6C09D00  28BF5D00
    // exponent 7       0000517E  FE56EE48  0061171E   31836 to 32141; the segment is DF FE,
    //                            56EE4800  61171E00
    // raw 0111001      00C22E3C  822A935C  00C22E3C   the segment is DF FE 82,
    //                            2A935C00  C22E3C00
    // symbol 1         0001845C  3A6D6954  35170FA4   2675 to 11634
    // raw 0101         035170FA  4B049E36  035170FA
    // low rises to 4C000000.
    let bytes = [0x77, 0x4C, 2, 0, 0x01, 0, 2, 1, 1, 4, 0xDF, 0xFE, 0x82, 0x4C];
    assert_oracle(&coded(SampleType::I8, [2, 1, 1]), &[Zero], &[100, -3], &bytes);
}

#[test]
fn a_carry() {
    // Two planes of one sample, predicted by the mean, to which all neighbours are replaced by u: the residuals are 1
    // and 1, the second with the energy 4.
    //                            00000000  FFFFFFFF
    // predictor 100    1FFFFFFF  7FFFFFFC  1FFFFFFF
    // symbol 1         00003FFF  9DD7C89B  00F7BC21   30561 to 31552; the segment is 9D,
    //                            D7C89B00  F7BC2100
    // symbol 1         0001EF78  995B38E0  1A532630   25604 to 29086, carrying into the segment: 9E
    // low rises to 9A000000.
    let bytes = [0x77, 0x4C, 2, 0, 0x03, 0, 1, 1, 2, 2, 0x9E, 0x9A];
    assert_oracle(&coded(SampleType::I16, [1, 1, 2]), &[Fixed(4)], &[1, 2], &bytes);
}

#[test]
fn weights() {
    // The weights are -256 and 0, of the samples at x - 2 and x - 3, as the numbers 513 = 512 + 1 and 1. Before the
    // row stand zeros. S is 0 for 4; 256 * 4 - 256 * (0 - 4) = 2048 for 6; 256 * 6 - 256 * (4 - 6) = 2048 for 8: the
    // predictions are 0, 8 and 8, the offsets 0. The residuals 4, -2 and 0 have the ranks 7, 4 and 0, and the energies
    // 0, 4 * 4 and 4 * 2 + 4, of the classes 0, 8 and 7.
    //                            00000000  FFFFFFFF
    // predictor 101    1FFFFFFF  9FFFFFFB  1FFFFFFF
    // weight 9         00003FFF  BFB04138  000ABFD5   32451 to 32494; the segment is BF,
    //                            B0413800  0ABFD500
    // raw 000000001    00055FEA  B04697EA  00055FEA   the segment is BF B0,
    //                            4697EA00  055FEA00
    // weight 0         00000ABF  4697EA00  005F94DB   0 to 2277, as it has gone down from 2603 by (2603 - 1 + 7) / 8
    //                            97EA0000  5F94DB00   the segment is BF B0 46,
    // symbol 7         0000BF29  F64F54FA  00196372   32362 to 32396; the segment is BF B0 46 F6,
    //                            4F54FA00  19637200
    // symbol 4         000032C6  64C0B4C6  017A9E7E   27649 to 29558
    // symbol 0         000002F5  64C0B4C6  00C65145   0 to 17169; the segment is BF B0 46 F6 64,
    //                            C0B4C600  C6514500
    // low rises to C1000000.
    let mut bytes = vec![0x77, 0x4C, 2, 0, 0x00, 0, 3, 1, 1, 6];
    bytes.extend([0xBF, 0xB0, 0x46, 0xF6, 0x64, 0xC1]);
    assert_oracle(&coded(SampleType::U8, [3, 1, 1]), &[Weights(vec![vec![-256, 0]])], &[4, 6, 8], &bytes);
}

#[test]
fn zeros() {
    // The first segment is empty, as low stays 0; the second names seven predictors, each with a zero:
    //                            00000000  FFFFFFFF
    // predictor 110    1FFFFFFF  BFFFFFFA  1FFFFFFF
    // symbol 0         00003FFF  BFFFFFFA  1E1C478D   0 to 30835
    // predictor 110    03C388F1  D69535A0  03C388F1
    // symbol 0         00000787  D69535A0  0391B0AE   0 to 31074
    // predictor 110    00723615  D9427A1E  00723615   the segment is D9,
    //                            427A1E00  72361500
    // symbol 0         0000E46C  427A1E00  6CAB4938   0 to 31178
    // predictor 110    0D956927  93FA94EA  0D956927
    // symbol 0         00001B2A  93FA94EA  0CF6AF38   0 to 31276
    // predictor 110    019ED5E7  9DB39854  019ED5E7
    // symbol 0         0000033D  9DB39854  018CCA68   0 to 31368
    // predictor 110    0031994D  9EDD3022  0031994D   the segment is D9 9E,
    //                            DD302200  31994D00
    // symbol 0         00006332  DD302200  2F9BD95C   0 to 31454
    // predictor 110    05F37B2B  00E50502  05F37B2B   carrying into the segment: D9 9F
    // symbol 0         00000BE6  00E50502  05B9B13A   0 to 31535
    // low rises to 01000000.
    let bytes = [0x77, 0x4C, 2, 0, 0x12, 1, 2, 2, 2, 0, 3, 0xD9, 0x9F, 0x01];
    let choices = Choices { psi: Some(Psi::H), levels: 1, ..coded(SampleType::U16, [2, 2, 2]) };
    let mut predictors = vec![Fixed(0)];
    predictors.resize(8, Zero);
    assert_oracle(&choices, &predictors, &[0; 8], &bytes);
}

#[test]
fn the_largest_rank() {
    // That of -2^31 is 2^32 - 1: the symbol 15, and the number 2^32 - 15, whose exponent 31 is 15 and 16 more.
    //                            00000000  FFFFFFFF
    // predictor 110    1FFFFFFF  BFFFFFFA  1FFFFFFF
    // symbol 15        00003FFF  DFD6C09D  0028BF5D   32605 to 32768; the segment is DF,
    //                            D6C09D00  28BF5D00
    // exponent 15      0000517E  FF6B8EFE  00140E02   32705 to 32768; the segment is DF FF,
    //                            6B8EFE00  140E0200
    // raw 10000        00A07010  7595FF00  00A07010   the segment is DF FF 75,
    //                            95FF0000  A0701000
    // raw 111111111111 000A0701  366508FF  000A0701   carrying into the segment, which is DF FF 76 36,
    //                            6508FF00  0A070100
    // raw 111111111111 0000A070  6F0F5E90  0000A170   what is left; the segment is DF FF 76 36 6F 0F,
    //                            5E900000  A1700000
    // raw 1110001      0142E000  ED14E000  0142E000
    // low rises to EE000000.
    let mut bytes = vec![0x77, 0x4C, 2, 0, 0x05, 0, 1, 1, 1, 7];
    bytes.extend([0xDF, 0xFF, 0x76, 0x36, 0x6F, 0x0F, 0xEE]);
    assert_oracle(&coded(SampleType::I32, [1, 1, 1]), &[Zero], &[i32::MIN], &bytes);
}

#[test]
fn stored() {
    // 200 needs two bytes as a number: 200 = 1 * 128 + 72, and 72 = 48 hexadecimal, C8 with the top bit.
    let mut bytes = vec![0x77, 0x4C, 2, 0x80, 0x63, 1, 100, 1, 1, 0xC8, 1];
    bytes.extend((0..50).flat_map(|_| [0xFF, 0x7F, 0x00, 0x80]));
    let samples = [32767, -32768].repeat(50);
    let stored = |sample_type, extent| Choices { storage: Storage::Stored, ..coded(sample_type, extent) };
    let choices = Choices { psi: Some(Psi::Five), levels: 1, ..stored(SampleType::I16, [100, 1, 1]) };
    assert_oracle(&choices, &[], &samples, &bytes);
    // -2^31 alone costs more than 4 bytes, as above.
    let bytes = [0x77, 0x4C, 2, 0x80, 0x05, 0, 1, 1, 1, 4, 0, 0, 0, 0x80];
    assert_oracle(&stored(SampleType::I32, [1, 1, 1]), &[], &[i32::MIN], &bytes);
    for effort in Effort::ALL {
        let sample_type = wavelift_kernel::SampleType::I32;
        assert_eq!(kernel_encode(effort, &plan(None, [1, 1, 1], 0), sample_type, &[i32::MIN]), bytes);
    }
}
