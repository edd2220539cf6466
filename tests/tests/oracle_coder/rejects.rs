//! What a decoder must reject, row by row of the table, in codestreams made by hand.

use conformance::oracle::coder::{Decoded, Reject};

use super::both_decode;

/// A sound codestream of a line of two samples and one level; see `by_hand`.
const SOUND: &str = "77 4C 02 00 13 01 02 01 01 02 02 1F CA DB C4";

fn bytes(hex: &str) -> Vec<u8> {
    hex.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).expect("two digits")).collect()
}

fn assert_rejected(reason: Reject, codestreams: &[&str]) {
    for hex in codestreams {
        assert_eq!(both_decode(&bytes(hex), 0), Err(reason), "{hex}");
    }
}

#[test]
fn every_proper_prefix_is_truncated() {
    let sound = bytes(SOUND);
    for len in 0..sound.len() {
        assert_eq!(both_decode(&sound[..len], 0), Err(Reject::Truncated), "{len} bytes");
    }
    for len in 0..13 {
        assert_eq!(both_decode(&sound[..len], 1), Err(Reject::Truncated), "{len} bytes for level 1");
    }
    for len in 13..=sound.len() {
        assert_eq!(both_decode(&sound[..len], 1), Ok(Decoded { extent: [1; 3], samples: vec![7] }));
    }
}

#[test]
fn magic_and_version() {
    assert_rejected(Reject::NotACodestream, &["00", "4C 77", "77 00", "77 4D 01", "78 4C 01 00"]);
    for found in (0..=255).filter(|&found| found != 2) {
        assert_eq!(both_decode(&[0x77, 0x4C, found, 0xFF], 0), Err(Reject::UnsupportedVersion { found }));
    }
}

#[test]
fn reserved_values() {
    for storage in (7..=255).filter(|&storage| storage != 0x80) {
        assert_eq!(both_decode(&[0x77, 0x4C, 2, storage], 0), Err(Reject::Reserved), "storage {storage:02X}");
    }
    for kind in (0..=255).filter(|kind| kind & 0x0F > 5 || kind >> 4 > 6) {
        assert_eq!(both_decode(&[0x77, 0x4C, 2, 0, kind], 0), Err(Reject::Reserved), "type {kind:02X}");
    }
}

#[test]
fn numbers() {
    assert_rejected(
        Reject::Number,
        &[
            // a byte too long: 0, 1, 2^28
            "77 4C 02 00 05 00 80 00",
            "77 4C 02 00 05 00 81 00",
            "77 4C 02 00 05 00 80 80 80 80 81 00",
            "77 4C 02 00 05 00 01 01 01 81 00 00",
            // 2^32, a sixth byte
            "77 4C 02 00 05 00 80 80 80 80 10",
            "77 4C 02 00 05 00 FF FF FF FF FF",
            "77 4C 02 00 05 00 01 01 01 80 80 80 80 10",
            // before the extent and the levels
            "77 4C 02 00 05 09 00 01 80 00",
        ],
    );
    // 2^32 - 1 is a number, and so many bytes are not here
    assert_rejected(Reject::Truncated, &["77 4C 02 00 05 00 01 01 01 FF FF FF FF 0F"]);
}

#[test]
fn extents() {
    assert_rejected(
        Reject::Extent,
        &[
            "77 4C 02 00 05 00 00 01 01 00",
            "77 4C 02 00 05 00 01 00 01 00",
            "77 4C 02 00 05 00 01 01 00 00",
            // 2^31; 2^11 by 2^10 by 2^10; three times 2^32 - 1
            "77 4C 02 00 05 00 80 80 80 80 08 01 01 00",
            "77 4C 02 00 05 00 80 10 80 08 80 08 00",
            "77 4C 02 00 05 00 FF FF FF FF 0F FF FF FF FF 0F FF FF FF FF 0F 00",
            // before the levels
            "77 4C 02 00 15 09 01 00 01",
        ],
    );
    // 2^31 - 1 samples are an extent
    assert_rejected(Reject::Truncated, &["77 4C 02 00 05 00 FF FF FF FF 07 01 01"]);
}

#[test]
fn levels() {
    assert_rejected(
        Reject::Levels,
        &[
            // more than the extent allows: one sample, 2, 5, 2^31 - 1
            "77 4C 02 00 15 01 01 01 01",
            "77 4C 02 00 15 02 02 01 01",
            "77 4C 02 80 65 04 01 05 04",
            "77 4C 02 00 15 20 01 01 FF FF FF FF 07",
            "77 4C 02 00 15 FF 02 02 02",
            // levels without a wavelet, a wavelet without levels
            "77 4C 02 00 05 01 02 01 01",
            "77 4C 02 80 15 00 02 01 01",
        ],
    );
    assert_rejected(
        Reject::Truncated,
        &["77 4C 02 00 15 1F 01 01 FF FF FF FF 07", "77 4C 02 80 65 03 01 05 04"],
    );
}

#[test]
fn stored_lengths() {
    assert_rejected(
        Reject::StoredLength,
        &[
            "77 4C 02 80 00 00 02 01 01 00",
            "77 4C 02 80 00 00 02 01 01 03 00 00 00",
            "77 4C 02 80 03 00 02 01 01 02 00 00",
            "77 4C 02 80 04 00 02 01 01 04 00 00 00 00",
            "77 4C 02 80 14 01 02 01 01 FF FF FF FF 0F",
        ],
    );
}

#[test]
fn segments() {
    assert_rejected(
        Reject::Segment,
        &[
            // a zero byte at the end
            "77 4C 02 00 05 00 01 01 01 01 00",
            "77 4C 02 00 05 00 01 01 01 03 1F AC 00",
            "77 4C 02 00 13 01 02 01 01 02 03 1F CA DB C4 00",
            // FF FF FF FF
            "77 4C 02 00 05 00 01 01 01 04 FF FF FF FF",
            "77 4C 02 00 05 00 01 01 01 08 FF FF FF FF FF FF FF FF",
            // the decoder shifts out nothing for the predictor 0 and a 0
            "77 4C 02 00 05 00 01 01 01 02 01 01",
            "77 4C 02 00 13 01 02 01 01 03 00 1F CA 01",
        ],
    );
    // longer than the encoder makes them, yet of n + 1 bytes at most
    let zero = Ok(Decoded { extent: [1; 3], samples: vec![0] });
    assert_eq!(both_decode(&bytes("77 4C 02 00 05 00 01 01 01 01 01"), 0), zero);
    // a segment that the level does not need is not looked at
    let seven = Ok(Decoded { extent: [1; 3], samples: vec![7] });
    assert_eq!(both_decode(&bytes("77 4C 02 00 13 01 02 01 01 02 01 1F CA 00"), 1), seven);
}

#[test]
fn predictors() {
    // The number is the top three bits: 7 for the low-pass part, all but 5 and 6 for wavelet coefficients.
    assert_rejected(
        Reject::Segment,
        &["77 4C 02 00 05 00 01 01 01 01 E0", "77 4C 02 00 05 00 01 01 01 01 FE"],
    );
    for first in ["", "20", "40", "60", "80", "E0"] {
        let length = if first.is_empty() { "00" } else { "01" };
        let hex = format!("77 4C 02 00 13 01 02 01 01 02 {length} 1F CA {first}");
        assert_rejected(Reject::Segment, &[&hex]);
    }
    for (first, number) in [("01", 0), ("20", 1), ("40", 2), ("60", 3), ("80", 4), ("C0", 6)] {
        let zero = Ok(Decoded { extent: [1; 3], samples: vec![0] });
        let one = bytes(&format!("77 4C 02 00 05 00 01 01 01 01 {first}"));
        assert_eq!(both_decode(&one, 0), zero, "predictor {number}");
    }
}

#[test]
fn samples_outside_their_type() {
    // -5 has the rank 10, of the share 32461 to 32493 of a unit 3FFF: low is 1FB2C0E0, and 1FB3 is within.
    assert_eq!(
        both_decode(&bytes("77 4C 02 00 05 00 01 01 01 02 1F B3"), 0),
        Ok(Decoded { extent: [1; 3], samples: vec![-5] })
    );
    for unsigned in ["00", "02"] {
        assert_rejected(Reject::Sample, &[&format!("77 4C 02 00 {unsigned} 00 01 01 01 02 1F B3")]);
    }
    // -5 as the only coefficient of the low-pass part is no sample: level 1 has it, level 0 has two
    let slice = bytes("77 4C 02 00 10 01 02 01 01 02 01 1F B3 C0");
    assert_eq!(both_decode(&slice, 1), Ok(Decoded { extent: [1; 3], samples: vec![-5] }));
    assert_eq!(both_decode(&slice, 0), Err(Reject::Sample));
}

#[test]
fn trailing_bytes() {
    let mut longer = bytes(SOUND);
    longer.push(0);
    assert_eq!(both_decode(&longer, 0), Err(Reject::TrailingBytes));
    assert_eq!(both_decode(&longer, 1), Err(Reject::TrailingBytes));
    assert_rejected(
        Reject::TrailingBytes,
        &["77 4C 02 80 00 00 02 01 01 02 00 00 00", "77 4C 02 00 05 00 01 01 01 00 00"],
    );
}
