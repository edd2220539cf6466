//! Samples in blocks that are compressed one by one.
//!
//! Source: class `vtkXMLDataParser` of VTK. A table stands before the blocks: their number, the bytes of a block and
//! of the last one before compression (0 if it is as long as the others), and the bytes of each after it.

use std::io::{self, Cursor, Read};

use flate2::read::ZlibDecoder;

use super::VtkError;
use super::body::{Body, damaged};
use super::bytes::Bytes;
use crate::volume::{ByteOrder, FileFormat, ReadError};

/// Words before the bytes of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Words {
    pub(super) byte_order: ByteOrder,
    /// Whether they have 64 bits, not 32.
    pub(super) is_wide: bool,
}

impl Words {
    /// Bytes of a word.
    pub(super) const fn bytes(self) -> u64 {
        if self.is_wide { 8 } else { 4 }
    }

    /// Reads a word.
    pub(super) fn read(self, from: &mut dyn Read) -> io::Result<u64> {
        let mut word = [0; 8];
        let bytes = &mut word[..self.bytes() as usize];
        from.read_exact(bytes)?;
        if self.byte_order == ByteOrder::Big {
            bytes.reverse();
        }
        Ok(u64::from_le_bytes(word))
    }
}

/// What compresses blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compressor {
    /// zlib.
    Zlib,
    /// LZ4, blocks without a frame.
    Lz4,
}

impl Compressor {
    /// The class of VTK that a file names.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Zlib => "vtkZLibDataCompressor",
            Self::Lz4 => "vtkLZ4DataCompressor",
        }
    }

    /// The compressor of that name.
    pub(super) fn named(name: &str) -> Option<Self> {
        [Self::Zlib, Self::Lz4].into_iter().find(|found| found.name() == name)
    }
}

/// A byte of LZ4 stands for at most so many.
const LZ4_RATIO: u64 = 255;

/// The bytes of a block.
enum Decoder {
    Zlib(ZlibDecoder<io::Take<Bytes>>),
    /// Decompressed as a whole.
    Lz4(Bytes, Cursor<Vec<u8>>),
}

impl Decoder {
    /// Begins with the next `stored` bytes, which make a block of `full`.
    fn new(mut bytes: Bytes, compressor: Compressor, stored: u64, full: u64) -> (Self, io::Result<()>) {
        match compressor {
            Compressor::Zlib => (Self::Zlib(ZlibDecoder::new(bytes.take(stored))), Ok(())),
            Compressor::Lz4 => match lz4(&mut bytes, stored, full) {
                Ok(block) => (Self::Lz4(bytes, Cursor::new(block)), Ok(())),
                Err(cause) => (Self::Lz4(bytes, Cursor::default()), Err(cause)),
            },
        }
    }

    fn inner(&self) -> &Bytes {
        match self {
            Self::Zlib(decoder) => decoder.get_ref().get_ref(),
            Self::Lz4(bytes, _) => bytes,
        }
    }

    fn into_bytes(self) -> Bytes {
        match self {
            Self::Zlib(decoder) => decoder.into_inner().into_inner(),
            Self::Lz4(bytes, _) => bytes,
        }
    }
}

/// Decompresses a block; memory is taken as its bytes arrive, and for no more than they can stand for.
fn lz4(bytes: &mut Bytes, stored: u64, full: u64) -> io::Result<Vec<u8>> {
    let mut compressed = Vec::new();
    bytes.take(stored).read_to_end(&mut compressed)?;
    let fault = |cause: String| io::Error::new(io::ErrorKind::InvalidData, cause);
    if compressed.len() as u64 != stored {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    if full > stored.saturating_mul(LZ4_RATIO) {
        return Err(fault("a block is shorter than its table says".to_owned()));
    }
    let mut block = vec![0; full as usize];
    match lz4_flex::block::decompress_into(&compressed, &mut block) {
        Ok(found) if found as u64 == full => Ok(block),
        Ok(_) => Err(fault("a block is shorter than its table says".to_owned())),
        Err(cause) => Err(fault(cause.to_string())),
    }
}

impl Read for Decoder {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Zlib(decoder) => decoder.read(out),
            Self::Lz4(_, block) => block.read(out),
        }
    }
}

/// Compressed blocks of one array.
pub(super) struct Blocks {
    /// Taken out only while it is made anew.
    decoder: Option<Decoder>,
    compressor: Compressor,
    /// Where the blocks end in the bytes of the array; each begins where the last one ends.
    ends: Vec<u64>,
    /// Where the first begins.
    start: u64,
    /// Bytes of a block when decompressed.
    block_bytes: u64,
    /// Bytes of all.
    total: u64,
    at: u64,
}

impl Blocks {
    /// Reads the table. It takes memory as its words arrive.
    pub(super) fn new(
        mut bytes: Bytes,
        (words, compressor): (Words, Compressor),
        total: u64,
    ) -> Result<Self, ReadError> {
        let path = bytes.path().to_owned();
        let misfit = || {
            let cause = Box::new(VtkError::Blocks { expected: total });
            ReadError::Format { path: path.clone(), format: FileFormat::VtkXml, cause }
        };
        let mut next = || words.read(&mut bytes).map_err(|cause| damaged(&path, cause));
        let (count, block_bytes, last) = (next()?, next()?, next()?);
        let last = if last == 0 { block_bytes } else { last };
        let whole = count.checked_sub(1).and_then(|before| before.checked_mul(block_bytes));
        let fits = last <= block_bytes && whole.and_then(|whole| whole.checked_add(last)) == Some(total);
        if !fits || block_bytes == 0 {
            return Err(misfit());
        }
        let table = count.checked_add(3).and_then(|count| count.checked_mul(words.bytes()));
        let start = table.ok_or_else(misfit)?;
        let (mut ends, mut end) = (Vec::new(), start);
        for _ in 0..count {
            end = end.checked_add(next()?).ok_or_else(misfit)?;
            ends.push(end);
        }
        let decoder = Some(Decoder::Zlib(ZlibDecoder::new(bytes.take(0))));
        let mut blocks = Self { decoder, compressor, ends, start, block_bytes, total, at: 0 };
        blocks.begin(0)?;
        Ok(blocks)
    }

    fn decoder(&mut self) -> &mut Decoder {
        self.decoder.as_mut().expect("a decoder is missing only within `begin`")
    }

    /// Goes to the start of a block, if there is such a one.
    fn begin(&mut self, block: u64) -> Result<(), ReadError> {
        self.at = block.saturating_mul(self.block_bytes).min(self.total);
        let Some(&end) = self.ends.get(block as usize) else { return Ok(()) };
        let start = block.checked_sub(1).map_or(self.start, |before| self.ends[before as usize]);
        let decoder = self.decoder.take().expect("a decoder is missing only here");
        let mut bytes = decoder.into_bytes();
        let moved = bytes.seek(start);
        let (decoder, begun) = Decoder::new(bytes, self.compressor, end - start, self.left());
        self.decoder = Some(decoder);
        moved?;
        begun.map_err(|cause| self.fault(cause))
    }

    fn read(&mut self, out: &mut [u8]) -> io::Result<()> {
        self.decoder().read_exact(out)?;
        self.at += out.len() as u64;
        Ok(())
    }

    /// Lets the decoder see the end of a block, and so its checksum, and goes to the next one.
    fn end(&mut self) -> Result<(), ReadError> {
        let next = self.at.div_ceil(self.block_bytes);
        match self.decoder().read(&mut [0]) {
            Ok(0) => self.begin(next),
            Ok(_) => Err(self
                .fault(io::Error::new(io::ErrorKind::InvalidData, "a block is longer than its table says"))),
            Err(cause) => Err(self.fault(cause)),
        }
    }

    fn fault(&mut self, cause: io::Error) -> ReadError {
        let path = self.decoder().inner().path().to_owned();
        damaged(&path, cause)
    }

    /// Bytes to the end of the present block.
    fn left(&self) -> u64 {
        let end = (self.at / self.block_bytes + 1).saturating_mul(self.block_bytes);
        end.min(self.total) - self.at
    }
}

impl Body for Blocks {
    fn fill(&mut self, mut out: &mut [u8]) -> Result<(), ReadError> {
        while !out.is_empty() {
            let left = self.left();
            let count = usize::try_from(left).unwrap_or(usize::MAX).min(out.len());
            let (now, later) = out.split_at_mut(count);
            self.read(now).map_err(|cause| self.fault(cause))?;
            if count as u64 == left {
                self.end()?;
            }
            out = later;
        }
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        let position = position.min(self.total);
        if position < self.at || position - self.at >= self.left() {
            self.begin(position / self.block_bytes)?;
        }
        let mut between = self.decoder.as_mut().map(|decoder| decoder.take(position - self.at));
        let skipped = between.as_mut().map_or(Ok(0), |between| io::copy(between, &mut io::sink()));
        skipped.map_err(|cause| self.fault(cause))?;
        self.at = position;
        Ok(())
    }

    fn is_random(&self) -> bool {
        self.decoder.as_ref().is_some_and(|decoder| decoder.inner().is_random())
    }
}
