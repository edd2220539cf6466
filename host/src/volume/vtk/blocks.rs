//! Samples in blocks that are compressed one by one.
//!
//! Source: class `vtkXMLDataParser` of VTK. A table stands before the blocks: their number, the bytes of a block and
//! of the last one before compression (0 if it is as long as the others), and the bytes of each after it.

use std::io::{self, Read};

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

/// Compressed blocks of one array.
pub(super) struct Blocks {
    /// Taken out only while it is made anew.
    decoder: Option<ZlibDecoder<io::Take<Bytes>>>,
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
    pub(super) fn new(mut bytes: Bytes, words: Words, total: u64) -> Result<Self, ReadError> {
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
        let decoder = Some(ZlibDecoder::new(bytes.take(0)));
        let mut blocks = Self { decoder, ends, start, block_bytes, total, at: 0 };
        blocks.begin(0)?;
        Ok(blocks)
    }

    fn decoder(&mut self) -> &mut ZlibDecoder<io::Take<Bytes>> {
        self.decoder.as_mut().expect("a decoder is missing only within `begin`")
    }

    /// Goes to the start of a block, if there is such a one.
    fn begin(&mut self, block: u64) -> Result<(), ReadError> {
        self.at = block.saturating_mul(self.block_bytes).min(self.total);
        let Some(&end) = self.ends.get(block as usize) else { return Ok(()) };
        let start = block.checked_sub(1).map_or(self.start, |before| self.ends[before as usize]);
        let decoder = self.decoder.take().expect("a decoder is missing only here");
        let mut bytes = decoder.into_inner().into_inner();
        let moved = bytes.seek(start);
        self.decoder = Some(ZlibDecoder::new(bytes.take(end - start)));
        moved
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
        let path = self.decoder().get_ref().get_ref().path().to_owned();
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
        self.decoder.as_ref().is_some_and(|decoder| decoder.get_ref().get_ref().is_random())
    }
}
