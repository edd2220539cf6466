//! The parser of the header is total: for every input it returns, and what it has said of a beginning it says of
//! everything that begins so.
//!
//! It takes byte after byte and stops at the first that settles the matter, so that only beginnings that it calls
//! truncated have to be followed further. Every one of 5 bytes is; for those that follow, which are levels and numbers
//! of seven bits to a byte, by one byte of each kind that the parser tells apart.

use super::Header;
use crate::DecodeError;

/// Bytes of a beginning of which all values are tried.
const ALL: usize = 5;

/// Bytes of the longest beginning.
const LONGEST: usize = 10;

/// No bits, one, some, all; and the same where a number goes on.
const KINDS: [u8; 8] = [0x00, 0x01, 0x05, 0x7F, 0x80, 0x81, 0x85, 0xFF];

/// What follows the beginning of `len` bytes; returns how many beginnings were settled, and how many are headers.
fn follow(bytes: &mut [u8; LONGEST + 2], len: usize) -> [usize; 2] {
    match Header::parse(&bytes[..len]) {
        Err(DecodeError::Truncated) if len == LONGEST => [0, 0],
        Err(DecodeError::Truncated) => {
            let every = (0..=u8::MAX).filter(|byte| len < ALL || KINDS.contains(byte));
            every.fold([0, 0], |[settled, headers], byte| {
                bytes[len] = byte;
                let [more, found] = follow(bytes, len + 1);
                [settled + more, headers + found]
            })
        }
        settled => {
            for next in [0x00, 0xFF] {
                bytes[len..].fill(next);
                assert_eq!(Header::parse(bytes), settled, "{:02x?}, then {next:02x}", &bytes[..len]);
            }
            let Ok(header) = settled else { return [1, 0] };
            let mut written = [0; LONGEST];
            header.write(&mut written);
            assert_eq!((&written[..len], header.header_len()), (&bytes[..len], len), "written again");
            [1, 1]
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "many values through code without addresses")]
fn every_beginning_is_settled_and_what_is_read_is_written_again() {
    let [settled, headers] = follow(&mut [0; LONGEST + 2], 0);
    // Five wrong bytes settle it: 255 each for the first three, 252 storages, and what is no type or wavelet.
    assert!(settled > 3 * 255 + 252 + 4 * (256 - 42), "{settled} beginnings");
    assert!(headers > 1000, "{headers} headers of {settled} beginnings");
}
