//! What a decoder must reject, row by row of the table, in codestreams made by hand.

use conformance::oracle::coder::{Decoded, Reject};

use super::both_decode;

/// A sound codestream of a line of two samples and one level; see `by_hand`.
const SOUND: &str = "77 4C 01 00 13 01 02 01 01 01 01 B6 A7";

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
    for len in 0..12 {
        assert_eq!(both_decode(&sound[..len], 1), Err(Reject::Truncated), "{len} bytes for level 1");
    }
    for len in 12..=sound.len() {
        assert_eq!(both_decode(&sound[..len], 1), Ok(Decoded { extent: [1; 3], samples: vec![7] }));
    }
}

#[test]
fn magic_and_version() {
    assert_rejected(Reject::NotACodestream, &["00", "4C 77", "77 00", "77 4D 02", "78 4C 01 00"]);
    for found in (0..=255).filter(|&found| found != 1) {
        assert_eq!(both_decode(&[0x77, 0x4C, found, 0xFF], 0), Err(Reject::UnsupportedVersion { found }));
    }
}

#[test]
fn reserved_values() {
    for storage in (0..=255).filter(|storage| !matches!(storage, 0..=5 | 0x80)) {
        assert_eq!(both_decode(&[0x77, 0x4C, 1, storage], 0), Err(Reject::Reserved), "storage {storage:02X}");
    }
    for kind in (0..=255).filter(|kind| kind & 0x0F > 5 || kind >> 4 > 6) {
        assert_eq!(both_decode(&[0x77, 0x4C, 1, 0, kind], 0), Err(Reject::Reserved), "type {kind:02X}");
    }
}

#[test]
fn numbers() {
    assert_rejected(
        Reject::Number,
        &[
            // a byte too long: 0, 1, 2^28
            "77 4C 01 00 05 00 80 00",
            "77 4C 01 00 05 00 81 00",
            "77 4C 01 00 05 00 80 80 80 80 81 00",
            "77 4C 01 00 05 00 01 01 01 81 00 00",
            // 2^32, a sixth byte
            "77 4C 01 00 05 00 80 80 80 80 10",
            "77 4C 01 00 05 00 FF FF FF FF FF",
            "77 4C 01 00 05 00 01 01 01 80 80 80 80 10",
            // before the extent and the levels
            "77 4C 01 00 05 09 00 01 80 00",
        ],
    );
    // 2^32 - 1 is a number, and so many bytes are not here
    assert_rejected(Reject::Truncated, &["77 4C 01 00 05 00 01 01 01 FF FF FF FF 0F"]);
}

#[test]
fn extents() {
    assert_rejected(
        Reject::Extent,
        &[
            "77 4C 01 00 05 00 00 01 01 00",
            "77 4C 01 00 05 00 01 00 01 00",
            "77 4C 01 00 05 00 01 01 00 00",
            // 2^31; 2^11 by 2^10 by 2^10; three times 2^32 - 1
            "77 4C 01 00 05 00 80 80 80 80 08 01 01 00",
            "77 4C 01 00 05 00 80 10 80 08 80 08 00",
            "77 4C 01 00 05 00 FF FF FF FF 0F FF FF FF FF 0F FF FF FF FF 0F 00",
            // before the levels
            "77 4C 01 00 15 09 01 00 01",
        ],
    );
    // 2^31 - 1 samples are an extent
    assert_rejected(Reject::Truncated, &["77 4C 01 00 05 00 FF FF FF FF 07 01 01"]);
}

#[test]
fn levels() {
    assert_rejected(
        Reject::Levels,
        &[
            // more than the extent allows: one sample, 2, 5, 2^31 - 1
            "77 4C 01 00 15 01 01 01 01",
            "77 4C 01 00 15 02 02 01 01",
            "77 4C 01 80 65 04 01 05 04",
            "77 4C 01 00 15 20 01 01 FF FF FF FF 07",
            "77 4C 01 00 15 FF 02 02 02",
            // levels without a wavelet, a wavelet without levels
            "77 4C 01 00 05 01 02 01 01",
            "77 4C 01 80 15 00 02 01 01",
        ],
    );
    assert_rejected(
        Reject::Truncated,
        &["77 4C 01 00 15 1F 01 01 FF FF FF FF 07", "77 4C 01 80 65 03 01 05 04"],
    );
}

#[test]
fn weights() {
    let nine = "00 01 02 03 04 05 06 07 08";
    assert_rejected(
        Reject::Weight,
        &[
            // 4097, 2^32 - 1, one of the second plane, in a file that ends there
            "77 4C 01 05 05 00 01 01 01 81 20",
            "77 4C 01 05 05 00 01 01 01 FF FF FF FF 0F",
            &format!("77 4C 01 05 05 00 01 01 02 {nine} 81 20"),
        ],
    );
    // the levels come first, and so does a weight before a number too long
    assert_rejected(Reject::Levels, &["77 4C 01 05 05 01 02 01 01 81 20"]);
    assert_rejected(
        Reject::Number,
        &["77 4C 01 05 05 00 01 01 01 81 A0 00", "77 4C 01 05 05 00 01 01 01 80 00"],
    );
    assert_rejected(Reject::Weight, &["77 4C 01 05 05 00 01 01 01 81 20 80 00"]);
    // the largest, 4096 for 2048 and 4095 for -2048, nine of them; the weight after them is a length
    let most = "80 20 FF 1F 80 20 FF 1F 80 20 FF 1F 80 20 FF 1F";
    let zero = Ok(Decoded { extent: [1; 3], samples: vec![0] });
    assert_eq!(both_decode(&bytes(&format!("77 4C 01 05 05 00 01 01 01 {most} 80 20 00")), 0), zero);
    assert_rejected(
        Reject::Truncated,
        &[
            &format!("77 4C 01 05 05 00 01 01 01 {most}"),
            &format!("77 4C 01 05 05 00 01 01 01 {most} 80 20"),
            // 4097 as a length
            &format!("77 4C 01 05 05 00 01 01 01 {most} 80 20 81 20"),
            &format!("77 4C 01 05 05 00 01 01 02 {nine} {nine} {nine} 00"),
        ],
    );
    assert_rejected(Reject::TrailingBytes, &[&format!("77 4C 01 05 05 00 01 01 01 {nine} 00 00")]);
    // nine weights where a level leaves one plane of two
    let level = Ok(Decoded { extent: [1; 3], samples: vec![0] });
    let two = bytes(&format!("77 4C 01 05 15 01 01 01 02 {nine} 00 00"));
    assert_eq!(both_decode(&two, 1), level);
    assert_eq!(both_decode(&two, 0), Ok(Decoded { extent: [1, 1, 2], samples: vec![0; 2] }));
    let three = bytes(&format!("77 4C 01 05 15 01 01 01 03 {nine} {nine} {nine} 00 00 00"));
    assert_eq!(both_decode(&three, 0), Ok(Decoded { extent: [1, 1, 3], samples: vec![0; 3] }));
}

#[test]
fn stored_lengths() {
    assert_rejected(
        Reject::StoredLength,
        &[
            "77 4C 01 80 00 00 02 01 01 00",
            "77 4C 01 80 00 00 02 01 01 03 00 00 00",
            "77 4C 01 80 03 00 02 01 01 02 00 00",
            "77 4C 01 80 04 00 02 01 01 04 00 00 00 00",
            "77 4C 01 80 14 01 02 01 01 FF FF FF FF 0F",
        ],
    );
}

#[test]
fn segments() {
    assert_rejected(
        Reject::Segment,
        &[
            // a zero byte at the end
            "77 4C 01 00 05 00 01 01 01 01 00",
            "77 4C 01 00 05 00 01 01 01 02 B2 00",
            "77 4C 01 00 13 01 02 01 01 01 02 B6 A7 00",
            // FF FF FF FF
            "77 4C 01 00 05 00 01 01 01 04 FF FF FF FF",
            "77 4C 01 00 05 00 01 01 01 08 FF FF FF FF FF FF FF FF",
            // the decoder shifts out nothing for a 0
            "77 4C 01 00 05 00 01 01 01 02 01 01",
            "77 4C 01 00 13 01 02 01 01 02 00 B6 01",
        ],
    );
    // longer than the encoder makes them, yet of n + 1 bytes at most
    let zero = Ok(Decoded { extent: [1; 3], samples: vec![0] });
    assert_eq!(both_decode(&bytes("77 4C 01 00 05 00 01 01 01 01 01"), 0), zero);
    // a segment that the level does not need is not looked at
    let seven = Ok(Decoded { extent: [1; 3], samples: vec![7] });
    assert_eq!(both_decode(&bytes("77 4C 01 00 13 01 02 01 01 01 01 B6 00"), 1), seven);
}

#[test]
fn samples_outside_their_type() {
    // The first value of `by_hand::signs`, after which low rises to F2000000.
    assert_eq!(
        both_decode(&bytes("77 4C 01 00 05 00 01 01 01 01 F2"), 0),
        Ok(Decoded { extent: [1; 3], samples: vec![-5] })
    );
    for unsigned in ["00", "02"] {
        assert_rejected(Reject::Sample, &[&format!("77 4C 01 00 {unsigned} 00 01 01 01 01 F2")]);
    }
    // -5 as the only coefficient of the low-pass part is no sample: level 1 has it, level 0 has two
    let slice = bytes("77 4C 01 00 10 01 02 01 01 01 00 F2");
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
        &["77 4C 01 80 00 00 02 01 01 02 00 00 00", "77 4C 01 00 05 00 01 01 01 00 00"],
    );
}
