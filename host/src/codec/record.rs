//! Records, which a container is made of. Each is framed so that it can be told from anything else wherever it lies.

use std::io;

use serde::Serialize;
use serde::de::DeserializeOwned;

/// The first byte of every record.
pub(super) const MARKER: u8 = 0xB7;

/// Bytes of the checksum that ends a frame.
const CHECKSUM_BYTES: usize = 4;

/// Bytes of the longest frame around nothing: marker, kind, a length of 32 bits, checksum.
const MOST_AROUND: usize = 2 + 5 + CHECKSUM_BYTES;

/// Bytes of the longest record of a brick, without what follows it: 31 levels have two bytes each, and all else at most
/// 60.
pub(super) const MOST_BRICK_BYTES: usize = 128;

/// What a record is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Extent, components, type.
    Head,
    /// What the source said beside.
    Metadata,
    /// How the bricks of a time step are coded.
    Step,
    /// One brick; what is stored of it follows.
    Brick,
    /// What the samples of every brick are like.
    Statistics,
    /// Where all the others are.
    Index,
}

impl Kind {
    /// Every kind, in the order in which they first occur.
    pub const ALL: [Self; 6] =
        [Self::Head, Self::Metadata, Self::Step, Self::Brick, Self::Statistics, Self::Index];

    /// The second byte of such a record.
    const fn code(self) -> u8 {
        match self {
            Self::Head => b'H',
            Self::Metadata => b'M',
            Self::Step => b'T',
            Self::Brick => b'B',
            Self::Statistics => b'S',
            Self::Index => b'I',
        }
    }

    /// The name in messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Head => "head",
            Self::Metadata => "metadata",
            Self::Step => "time step",
            Self::Brick => "brick",
            Self::Statistics => "statistics",
            Self::Index => "index",
        }
    }
}

/// A record as bytes.
///
/// # Errors
/// If it has 4 GiB or more.
pub(super) fn to_bytes(kind: Kind, content: &impl Serialize) -> io::Result<Vec<u8>> {
    let content = postcard::to_allocvec(content).map_err(io::Error::other)?;
    let len = u32::try_from(content.len()).ok().filter(|&len| len < u32::MAX - MOST_AROUND as u32);
    let len = len.ok_or_else(|| io::Error::other("too many bricks for one file: make them larger"))?;
    let mut bytes = vec![MARKER, kind.code()];
    bytes.extend_from_slice(&postcard::to_allocvec(&len).map_err(io::Error::other)?);
    bytes.extend_from_slice(&content);
    bytes.extend_from_slice(&crc32fast::hash(&bytes).to_le_bytes());
    Ok(bytes)
}

/// The beginning of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Frame {
    pub(super) kind: Kind,
    /// Bytes before the content.
    start: usize,
    /// Bytes of the content.
    len: usize,
}

impl Frame {
    /// The frame that `bytes` begins with. `None` if that is none, or `bytes` ends within its length.
    pub(super) fn parse(bytes: &[u8]) -> Option<Self> {
        let [MARKER, code, rest @ ..] = bytes else { return None };
        let kind = Kind::ALL.into_iter().find(|kind| kind.code() == *code)?;
        let (len, after) = postcard::take_from_bytes::<u32>(rest).ok()?;
        Some(Self { kind, start: bytes.len() - after.len(), len: usize::try_from(len).ok()? })
    }

    /// Bytes of the record.
    pub(super) const fn bytes(&self) -> usize {
        self.start.saturating_add(self.len).saturating_add(CHECKSUM_BYTES)
    }

    /// The content of a record that `bytes` begins with. `None` if it contradicts its checksum, or `bytes` ends before.
    pub(super) fn content<'a>(&self, bytes: &'a [u8]) -> Option<&'a [u8]> {
        let (covered, checksum) = bytes.get(..self.bytes())?.split_last_chunk::<CHECKSUM_BYTES>()?;
        (crc32fast::hash(covered).to_le_bytes() == *checksum).then(|| &covered[self.start..])
    }
}

/// The record of that kind that `bytes` begins with, and its length. `None` if there is no such thing.
pub(super) fn from_bytes<T: DeserializeOwned>(kind: Kind, bytes: &[u8]) -> Option<(T, usize)> {
    let frame = Frame::parse(bytes).filter(|frame| frame.kind == kind)?;
    Some((parse(frame.content(bytes)?)?, frame.bytes()))
}

/// What a record holds. `None` unless that is all of its content.
pub(super) fn parse<T: DeserializeOwned>(content: &[u8]) -> Option<T> {
    match postcard::take_from_bytes(content) {
        Ok((found, [])) => Some(found),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_come_back() {
        for (kind, len) in Kind::ALL.into_iter().zip([0, 1, 127, 128, 300, 70_000]) {
            let bytes = to_bytes(kind, &vec![7_u8; len]).unwrap();
            assert_eq!(from_bytes::<Vec<u8>>(kind, &bytes), Some((vec![7; len], bytes.len())));
            assert_eq!(from_bytes::<Vec<u8>>(kind, &[&bytes[..], &[0]].concat()).unwrap().1, bytes.len());
            for other in Kind::ALL.into_iter().filter(|other| *other != kind) {
                assert_eq!(from_bytes::<Vec<u8>>(other, &bytes), None);
            }
        }
    }

    #[test]
    fn every_damaged_byte_is_noticed() {
        let bytes = to_bytes(Kind::Step, &vec![7_u8; 200]).unwrap();
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1 << (at % 8);
            assert_eq!(from_bytes::<Vec<u8>>(Kind::Step, &damaged), None, "{at}");
            assert_eq!(from_bytes::<Vec<u8>>(Kind::Step, &bytes[..at]), None, "{at}");
        }
    }

    #[test]
    fn content_must_fill_its_record() {
        let bytes = to_bytes(Kind::Head, &(1_u8, 2_u8)).unwrap();
        assert_eq!(from_bytes::<u8>(Kind::Head, &bytes), None);
        assert_eq!(from_bytes::<(u8, u8)>(Kind::Head, &bytes), Some(((1, 2), bytes.len())));
    }
}
