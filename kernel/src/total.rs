//! The parsers of headers are total: for every input they return, and what they have said of a beginning they say of
//! everything that begins so.
//!
//! They take byte after byte and stop at the first that settles the matter, so that only beginnings that are called
//! truncated have to be followed further. Every one of 5 bytes is; for those that follow, which are levels and numbers
//! of seven bits to a byte, by one byte of each kind that parsers tell apart.

use heapless::Vec;

use crate::DecodeError;

/// Bytes of a beginning of which all values are tried.
const ALL: usize = 5;

/// Bytes of the longest beginning.
const LONGEST: usize = 10;

/// No bits, one, some, all; and the same where a number goes on.
const KINDS: [u8; 8] = [0x00, 0x01, 0x05, 0x7F, 0x80, 0x81, 0x85, 0xFF];

/// A header that was read, written again.
pub(crate) type Written = Vec<u8, 32>;

/// Follows every beginning; returns how many were settled, and how many of them are headers.
///
/// # Panics
/// If a parser does, if it says something else where more bytes follow, or if a header is not written as it was read.
pub(crate) fn follow(parse: fn(&[u8]) -> Result<Written, DecodeError>) -> [usize; 2] {
    follow_from(parse, &mut [0; LONGEST + 2], 0)
}

/// Follows a beginning of `len` bytes.
fn follow_from(
    parse: fn(&[u8]) -> Result<Written, DecodeError>,
    bytes: &mut [u8; LONGEST + 2],
    len: usize,
) -> [usize; 2] {
    match parse(&bytes[..len]) {
        Err(DecodeError::Truncated) if len == LONGEST => [0, 0],
        Err(DecodeError::Truncated) => {
            let every = (0..=u8::MAX).filter(|byte| len < ALL || KINDS.contains(byte));
            every.fold([0, 0], |[settled, headers], byte| {
                bytes[len] = byte;
                let [more, found] = follow_from(parse, bytes, len + 1);
                [settled + more, headers + found]
            })
        }
        settled => {
            for next in [0x00, 0xFF] {
                bytes[len..].fill(next);
                assert_eq!(parse(bytes), settled, "{:02x?}, then {next:02x}", &bytes[..len]);
            }
            let Ok(written) = settled else { return [1, 0] };
            assert_eq!(written, bytes[..len], "written again");
            [1, 1]
        }
    }
}
