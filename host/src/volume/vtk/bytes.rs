//! The bytes of an array as they lie in an XML file: as they are, or in base64 (RFC 4648).

use std::io::{self, BufRead, Read};
use std::path::Path;

use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use super::body::damaged;
use crate::volume::ReadError;
use crate::volume::input::Input;

/// Characters that are decoded at a time.
const PIECE_BYTES: usize = 1 << 12;

const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// Bytes from a place in a file on.
///
/// In base64 several texts may follow each other, each padded for itself, as a table of blocks and the blocks do;
/// the bytes are those of all. They end at the first tag.
pub(super) struct Bytes {
    input: Input,
    start: u64,
    at: u64,
    base64: Option<Decoded>,
}

/// What was decoded and not yet taken.
#[derive(Default)]
struct Decoded {
    text: Vec<u8>,
    bytes: Vec<u8>,
    taken: usize,
}

impl Bytes {
    /// Bytes from byte `start` of the file on.
    pub(super) fn new(mut input: Input, start: u64, is_base64: bool) -> Result<Self, ReadError> {
        input.seek(start)?;
        Ok(Self { input, start, at: 0, base64: is_base64.then(Decoded::default) })
    }

    pub(super) fn path(&self) -> &Path {
        self.input.path()
    }

    /// The file, standing behind the bytes read so far; behind more of them in base64.
    pub(super) fn into_input(self) -> Input {
        self.input
    }

    /// Whether going back costs little.
    pub(super) fn is_random(&self) -> bool {
        self.base64.is_none()
    }

    /// Goes to a byte. In base64 all before it is decoded, if it lies before the present one.
    pub(super) fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        if self.base64.is_none() {
            self.input.seek(self.start.saturating_add(position))?;
        } else {
            if position < self.at {
                self.input.seek(self.start)?;
                (self.at, self.base64) = (0, Some(Decoded::default()));
            }
            let missing = position - self.at;
            let skipped = io::copy(&mut self.by_ref().take(missing), &mut io::sink());
            skipped.map_err(|cause| damaged(self.input.path(), cause))?;
        }
        self.at = position;
        Ok(())
    }
}

impl Read for Bytes {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let count = match &mut self.base64 {
            None => self.input.read(out)?,
            Some(decoded) => decoded.read(&mut self.input, out)?,
        };
        self.at += count as u64;
        Ok(count)
    }
}

impl Decoded {
    fn read(&mut self, input: &mut Input, out: &mut [u8]) -> io::Result<usize> {
        if self.taken == self.bytes.len() {
            self.decode(input)?;
        }
        let ready = &self.bytes[self.taken..];
        let count = ready.len().min(out.len());
        out[..count].copy_from_slice(&ready[..count]);
        self.taken += count;
        Ok(count)
    }

    /// Decodes a piece, which ends with a padded group if there is one.
    fn decode(&mut self, input: &mut Input) -> io::Result<()> {
        self.text.clear();
        while self.text.len() < PIECE_BYTES {
            let found = input.fill_buf()?;
            let mut used = 0;
            let mut at_end = found.is_empty();
            for &byte in found {
                let group_ends = self.text.len().is_multiple_of(4);
                if byte == b'<' || group_ends && (self.text.len() == PIECE_BYTES || self.text.ends_with(b"="))
                {
                    at_end = true;
                    break;
                }
                used += 1;
                if !byte.is_ascii_whitespace() {
                    self.text.push(byte);
                }
            }
            input.consume(used);
            if at_end {
                break;
            }
        }
        self.bytes.clear();
        self.taken = 0;
        let decoded = BASE64.decode_vec(&self.text, &mut self.bytes);
        decoded.map_err(|cause| io::Error::new(io::ErrorKind::InvalidData, cause))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(bytes: &[u8]) -> String {
        BASE64.encode(bytes)
    }

    #[test]
    fn texts_that_follow_each_other_are_one_run_of_bytes() {
        let bytes: Vec<u8> = (0..20_000_u32).map(|n| (n ^ n >> 8) as u8).collect();
        for split in [0, 1, 2, 3, 8, 3072, 10_000] {
            let text = format!("_ {} \n{}</a>abcd", encoded(&bytes[..split]), encoded(&bytes[split..]));
            let mut decoded = Bytes::new(Input::from_bytes(text.as_bytes()), 1, true).unwrap();
            let mut found = Vec::new();
            decoded.read_to_end(&mut found).unwrap();
            assert!(found == bytes, "{split}");
            for position in [19_000, 5, 4000] {
                decoded.seek(position).unwrap();
                let mut part = [0; 100];
                decoded.read_exact(&mut part).unwrap();
                assert_eq!(part, bytes[position as usize..][..100]);
            }
        }
    }

    #[test]
    fn what_is_no_base64_is_an_error() {
        for text in ["!!!!", "AAAAA", "A", "=AAA"] {
            let mut bytes = Bytes::new(Input::from_bytes(text.as_bytes()), 0, true).unwrap();
            let error = io::copy(&mut bytes, &mut io::sink()).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::InvalidData, "{text}");
        }
    }
}
