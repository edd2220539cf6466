//! Codestreams to and from `embedded_io` writers and readers (feature `embedded-io`).
//!
//! The codec itself works on memory; these adapters carry whole codestreams between memory and a device, and streams
//! of rows or slabs ([`crate::stream`]) sample by sample.

use core::fmt;

#[cfg(feature = "slabs")]
mod stream;

pub use embedded_io;
use embedded_io::{Read, Write};

#[cfg(feature = "stream")]
pub use stream::read_row_plan;
#[cfg(feature = "slabs")]
pub use stream::{
    SampleReader, SampleWriteError, SampleWriter, StreamDecoder, StreamEncoder, read_slab_plan,
};

use crate::{DecodeError, Header};

/// Why [`write()`] gave up. Some of the codestream may have been written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum WriteError<E> {
    /// The writer took no byte: it is full, or closed.
    Full,
    /// The writer failed.
    Io(E),
}

/// Why [`read`] gave up. What the reader has delivered is gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReadError<E> {
    /// What the reader delivers is not a codestream, or ends before the codestream does.
    Decode(DecodeError),
    /// The codestream is longer than the buffer.
    BufferTooSmall {
        /// Bytes of the codestream; if the buffer cannot even hold the header, one more than the buffer has.
        needed: u64,
    },
    /// The reader failed.
    Io(E),
}

/// Writes all of `codestream`, in as many pieces as the writer likes. Does not flush.
///
/// # Errors
/// [`WriteError::Full`] if the writer takes no byte, [`WriteError::Io`] if it fails.
pub fn write<W: Write>(codestream: &[u8], writer: &mut W) -> Result<(), WriteError<W::Error>> {
    let mut rest = codestream;
    while !rest.is_empty() {
        match writer.write(rest).map_err(WriteError::Io)? {
            0 => return Err(WriteError::Full),
            written => rest = rest.get(written..).unwrap_or(&[]),
        }
    }
    Ok(())
}

/// Reads exactly one codestream into the beginning of `buffer` and returns it; the next byte of the reader is the one
/// after.
///
/// The header (at most [`Header::MAX_BYTES`]) is read byte by byte and checked as it comes, the rest in as many pieces as the reader
/// likes; it is checked when it is decoded.
///
/// # Errors
/// [`ReadError::Decode`] if the header is wrong or the reader ends early ([`DecodeError::Truncated`]),
/// [`ReadError::BufferTooSmall`], [`ReadError::Io`] if the reader fails. After an error `buffer` is meaningless.
pub fn read<'b, R: Read>(reader: &mut R, buffer: &'b mut [u8]) -> Result<&'b [u8], ReadError<R::Error>> {
    let mut filled = 0_usize;
    let header = loop {
        match Header::parse(buffer.get(..filled).unwrap_or(&[])) {
            Ok(header) => break header,
            Err(DecodeError::Truncated) => {}
            Err(error) => return Err(ReadError::Decode(error)),
        }
        let end = filled.saturating_add(1);
        let byte = buffer.get_mut(filled..end).ok_or_else(|| too_small(end))?;
        fill(reader, byte)?;
        filled = end;
    };
    let needed = header.encoded_bytes();
    let codestream = usize::try_from(needed).ok().and_then(|end| buffer.get_mut(..end));
    let codestream = codestream.ok_or(ReadError::BufferTooSmall { needed })?;
    fill(reader, codestream.get_mut(filled..).unwrap_or(&mut []))?;
    Ok(codestream)
}

fn too_small<E>(needed: usize) -> ReadError<E> {
    ReadError::BufferTooSmall { needed: needed.try_into().unwrap_or(u64::MAX) }
}

/// Fills `bytes` in as many pieces as the reader likes.
fn fill<R: Read>(reader: &mut R, bytes: &mut [u8]) -> Result<(), ReadError<R::Error>> {
    let mut rest = bytes;
    while !rest.is_empty() {
        match reader.read(rest).map_err(ReadError::Io)? {
            0 => return Err(ReadError::Decode(DecodeError::Truncated)),
            read => rest = rest.get_mut(read..).unwrap_or(&mut []),
        }
    }
    Ok(())
}

impl<E: fmt::Display> fmt::Display for WriteError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Full => f.write_str("the writer takes no more bytes"),
            Self::Io(error) => error.fmt(f),
        }
    }
}

impl<E: fmt::Display> fmt::Display for ReadError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Decode(error) => error.fmt(f),
            Self::BufferTooSmall { needed } => write!(f, "the codestream takes at least {needed} bytes"),
            Self::Io(error) => error.fmt(f),
        }
    }
}

impl<E: fmt::Debug + fmt::Display> core::error::Error for WriteError<E> {}
impl<E: fmt::Debug + fmt::Display> core::error::Error for ReadError<E> {}

#[cfg(test)]
mod tests {
    use embedded_io::{ErrorKind, ErrorType};

    use super::*;
    use crate::{Codec, Effort, Extent, Plan, SampleType, Wavelet};

    /// Lets through `piece` bytes at a time, `left` in all, and then fails, or ends if there is no `error`.
    struct Drip<'a> {
        bytes: &'a mut [u8],
        at: usize,
        left: usize,
        piece: usize,
        error: Option<ErrorKind>,
    }

    impl Drip<'_> {
        fn next(&mut self, wanted: usize) -> Result<core::ops::Range<usize>, ErrorKind> {
            let step = wanted.min(self.piece).min(self.left);
            if let (0, Some(error)) = (step, self.error) {
                return Err(error);
            }
            self.left -= step;
            self.at += step;
            Ok(self.at - step..self.at)
        }
    }

    impl ErrorType for Drip<'_> {
        type Error = ErrorKind;
    }

    impl Read for Drip<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ErrorKind> {
            let range = self.next(buffer.len())?;
            buffer[..range.len()].copy_from_slice(&self.bytes[range.clone()]);
            Ok(range.len())
        }
    }

    impl Write for Drip<'_> {
        fn write(&mut self, buffer: &[u8]) -> Result<usize, ErrorKind> {
            let range = self.next(buffer.len())?;
            self.bytes[range.clone()].copy_from_slice(&buffer[..range.len()]);
            Ok(range.len())
        }

        fn flush(&mut self) -> Result<(), ErrorKind> {
            Ok(())
        }
    }

    const LEN: usize = 100;

    /// A codestream of 64 samples, and its length.
    fn codestream() -> ([u8; LEN], usize) {
        let plan = Plan::new(Wavelet::Linear, Extent::line(64).unwrap(), 3).unwrap();
        let (mut samples, mut bytes) = ([0; 64], [0; LEN]);
        let mut scratch =
            heapless::Vec::<_, 1024>::from_iter([0; 64].into_iter().cycle().take(plan.scratch_len()));
        for (i, sample) in (0..).zip(&mut samples) {
            *sample = i * i % 50;
        }
        let mut codec = Codec::NEW;
        let len = codec
            .encode(Effort::Fast, &plan, SampleType::U8, &mut samples, &mut scratch, &mut bytes)
            .unwrap();
        (bytes, len)
    }

    #[test]
    fn every_piece_size_carries_two_codestreams() {
        let (bytes, len) = codestream();
        for piece in [1, 2, 3, 7, 1000] {
            let mut device = [0; 2 * LEN];
            let mut writer = Drip { bytes: &mut device, at: 0, left: usize::MAX, piece, error: None };
            write(&bytes[..len], &mut writer).unwrap();
            write(&bytes[..len], &mut writer).unwrap();
            let mut reader = Drip { bytes: &mut device, at: 0, left: 2 * len, piece, error: None };
            let mut buffer = [0; LEN];
            assert_eq!(read(&mut reader, &mut buffer), Ok(&bytes[..len]));
            assert_eq!(read(&mut reader, &mut buffer), Ok(&bytes[..len]));
            assert_eq!(read(&mut reader, &mut buffer), Err(ReadError::Decode(DecodeError::Truncated)));
        }
    }

    #[test]
    fn a_device_that_ends_or_fails_early() {
        let (mut bytes, len) = codestream();
        let mut device = [0; LEN];
        for left in 0..len {
            let failure = Some(ErrorKind::TimedOut);
            let mut writer = Drip { bytes: &mut device, at: 0, left, piece: 5, error: None };
            assert_eq!(write(&bytes[..len], &mut writer), Err(WriteError::Full));
            let mut writer = Drip { bytes: &mut device, at: 0, left, piece: 5, error: failure };
            assert_eq!(write(&bytes[..len], &mut writer), Err(WriteError::Io(ErrorKind::TimedOut)));

            let mut buffer = [0; LEN];
            let mut reader = Drip { bytes: &mut bytes, at: 0, left, piece: 5, error: None };
            let truncated = Err(ReadError::Decode(DecodeError::Truncated));
            assert_eq!(read(&mut reader, &mut buffer), truncated);
            let mut reader = Drip { bytes: &mut bytes, at: 0, left, piece: 5, error: failure };
            assert_eq!(read(&mut reader, &mut buffer), Err(ReadError::Io(ErrorKind::TimedOut)));
        }
    }

    #[test]
    fn a_short_buffer_is_told_how_much_is_needed() {
        let (mut bytes, len) = codestream();
        let header = len - codestream_payload(&bytes[..len]);
        for room in 0..len {
            let mut buffer = [0; LEN];
            let mut reader = Drip { bytes: &mut bytes, at: 0, left: len, piece: 1, error: None };
            let needed = if room < header { room + 1 } else { len };
            let error = ReadError::BufferTooSmall { needed: needed.try_into().unwrap() };
            assert_eq!(read(&mut reader, &mut buffer[..room]), Err(error));
            assert_eq!(reader.at, room.min(header), "nothing is read in vain");
        }
    }

    fn codestream_payload(bytes: &[u8]) -> usize {
        let parses = |len: &usize| Header::parse(&bytes[..*len]).is_ok();
        bytes.len() - (0..=bytes.len()).find(parses).unwrap()
    }

    #[test]
    fn nothing_is_read_after_a_wrong_byte() {
        let (mut bytes, len) = codestream();
        bytes[1] ^= 1;
        let mut reader = Drip { bytes: &mut bytes, at: 0, left: len, piece: 99, error: None };
        let error = ReadError::Decode(DecodeError::NotACodestream);
        assert_eq!(read(&mut reader, &mut [0; LEN]), Err(error));
        assert_eq!(reader.at, 2);
    }
}
