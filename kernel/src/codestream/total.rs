//! The parser of the header is total.

use super::Header;
use crate::DecodeError;
use crate::total::{Written, follow};

fn parse(bytes: &[u8]) -> Result<Written, DecodeError> {
    let header = Header::parse(bytes)?;
    let mut written = [0; Header::MAX_BYTES];
    header.write(&mut written);
    Ok(Written::from_slice(&written[..header.header_len()]).unwrap())
}

#[test]
#[cfg_attr(miri, ignore = "many values through code without addresses")]
fn every_beginning_is_settled_and_what_is_read_is_written_again() {
    let [settled, headers] = follow(parse);
    // Five wrong bytes settle it: 255 each for the first three, 252 storages, and what is no type or wavelet.
    assert!(settled > 3 * 255 + 252 + 4 * (256 - 42), "{settled} beginnings");
    assert!(headers > 1000, "{headers} headers of {settled} beginnings");
}
