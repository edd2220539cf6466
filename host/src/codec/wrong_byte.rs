//! One wrong byte among many that a CRC-32 covers: which it is, and what it was.
//!
//! A CRC is linear, so the difference of the checksum that is stored and the one of the bytes as they are depends on
//! what was done to them only: on the place of a wrong byte, counted from the end, and on the bits that are wrong in it.
//! Running the register of the checksum backwards from that difference, a byte at a time, gives the wrong bits as soon
//! as the place is reached; at nearly all other places the register holds what no single byte can have left there.
//!
//! Source: RFC 1952, section 8 (the polynomial and the table). The step back through the table is its inversion: the
//! high bytes of the table are all different.

/// A byte to be changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Change {
    /// Its place.
    pub(super) at: usize,
    /// The bits to be flipped.
    pub(super) by: u8,
}

/// The polynomial, lowest power in the highest bit.
const POLYNOMIAL: u32 = 0xEDB8_8320;

/// What the register becomes when a byte goes through it.
const TABLE: [u32; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut register = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            register = if register & 1 == 1 { register >> 1 ^ POLYNOMIAL } else { register >> 1 };
            bit += 1;
        }
        table[byte] = register;
        byte += 1;
    }
    table
};

/// The byte whose entry in the table has that high byte.
const BYTE_OF_HIGH: [u8; 256] = {
    let mut inverse = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        inverse[(TABLE[byte] >> 24) as usize] = byte as u8;
        byte += 1;
    }
    inverse
};

/// What the register was before a zero byte went through it.
const fn before(register: u32) -> u32 {
    let byte = BYTE_OF_HIGH[(register >> 24) as usize];
    (register ^ TABLE[byte as usize]) << 8 | byte as u32
}

/// Every change of one byte that gives `covered` that checksum; none if it has that already.
///
/// One pass. Of up to 145,212 bytes there is one at most (that is where two places are first alike, found by trying all);
/// of more there may be a second by chance.
pub(super) fn changes(covered: &[u8], checksum: u32) -> Vec<Change> {
    let mut register = crc32fast::hash(covered) ^ checksum;
    if register == 0 {
        return Vec::new();
    }
    let mut changes = Vec::new();
    for at in (0..covered.len()).rev() {
        register = before(register);
        if let Ok(by) = u8::try_from(register) {
            changes.push(Change { at, by });
        }
    }
    changes
}

/// As [`changes`], of bytes that end with their own checksum, which may have the wrong byte itself.
pub(super) fn changes_of_record(bytes: &[u8]) -> Vec<Change> {
    let Some((covered, checksum)) = bytes.split_last_chunk::<4>() else { return Vec::new() };
    let found = crc32fast::hash(covered).to_le_bytes();
    let wrong: Vec<usize> = (0..4).filter(|&byte| found[byte] != checksum[byte]).collect();
    match wrong[..] {
        [byte] => vec![Change { at: covered.len() + byte, by: found[byte] ^ checksum[byte] }],
        _ => changes(covered, u32::from_le_bytes(*checksum)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes without any order.
    fn noise(len: usize) -> Vec<u8> {
        let mut state = 3_u64;
        let next = |_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 56) as u8
        };
        (0..len).map(next).collect()
    }

    #[test]
    fn the_table_is_that_of_the_checksum() {
        for byte in 0..=255 {
            let register = crc32fast::hash(&[byte]) ^ crc32fast::hash(&[0]);
            assert_eq!(register, TABLE[usize::from(byte)] ^ TABLE[0]);
        }
        assert_eq!(before(TABLE[200]), 200);
    }

    #[test]
    fn every_wrong_byte_is_found() {
        let mut bytes = noise(300);
        let checksum = crc32fast::hash(&bytes);
        assert_eq!(changes(&bytes, checksum), []);
        for at in 0..bytes.len() {
            for by in 1..=255 {
                bytes[at] ^= by;
                assert_eq!(changes(&bytes, checksum), [Change { at, by }]);
                bytes[at] ^= by;
            }
        }
    }

    #[test]
    fn a_checksum_with_a_wrong_byte_is_found() {
        let mut record = noise(50);
        record.extend(crc32fast::hash(&record).to_le_bytes());
        for at in 0..record.len() {
            record[at] ^= 0x41;
            assert_eq!(changes_of_record(&record), [Change { at, by: 0x41 }]);
            record[at] ^= 0x41;
        }
        assert_eq!((changes_of_record(&record), changes_of_record(&record[..3])), (vec![], vec![]));
    }

    /// Two changes with the same effect differ by the distance of their places only, so all pairs are looked at.
    #[test]
    fn up_to_64_kib_there_is_one_change_at_most() {
        for by in 1..=255_u32 {
            let mut register = TABLE[by as usize];
            for distance in 1..1 << 16 {
                register = TABLE[(register & 255) as usize] ^ register >> 8;
                let is_single = u8::try_from(before(register)).is_ok();
                assert!(!is_single, "{by} and a byte {distance} further have the same effect");
            }
        }
    }
}
