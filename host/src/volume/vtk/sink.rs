//! Samples on their way into a VTK file: as they are, or in compressed blocks.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::read::ZlibEncoder;
use rayon::prelude::*;

use crate::atomic::AtomicFile;
use crate::volume::element::write_samples;
use crate::volume::{ByteOrder, ElementType, Header, Sink, WriteError};

/// Bytes of a block before compression, as VTK's own writers have it.
const BLOCK_BYTES: u64 = 1 << 15;

/// Bytes whose blocks are compressed at the same time.
const PIECE_BYTES: usize = 1 << 22;

/// A sink that puts a tail behind the samples.
pub(super) struct VtkSink {
    file: AtomicFile,
    path: PathBuf,
    element: ElementType,
    byte_order: ByteOrder,
    expected: u64,
    written: u64,
    /// For compressed samples.
    blocks: Option<Blocks>,
    tail: &'static str,
}

/// Blocks wait in a nameless temporary file, since the table of their lengths stands before them.
struct Blocks {
    waiting: BufWriter<File>,
    lengths: Vec<u64>,
    /// Bytes of a block that is not yet full.
    pending: Vec<u8>,
}

impl VtkSink {
    /// Samples go behind what is in `file`, and `tail` behind them.
    pub(super) fn new(
        file: AtomicFile,
        path: &Path,
        header: &Header,
        byte_order: ByteOrder,
        tail: &'static str,
    ) -> Self {
        let expected = header.bytes().unwrap_or(u64::MAX);
        let (path, element) = (path.to_owned(), header.element);
        Self { file, path, element, byte_order, expected, written: 0, blocks: None, tail }
    }

    /// Compresses the samples in blocks, and puts a table of 64-bit words before them.
    pub(super) fn in_blocks(self) -> io::Result<Self> {
        let waiting = BufWriter::new(tempfile::tempfile()?);
        Ok(Self { blocks: Some(Blocks { waiting, lengths: Vec::new(), pending: Vec::new() }), ..self })
    }

    fn take(&mut self, values: &[u8]) -> io::Result<()> {
        let Some(blocks) = &mut self.blocks else {
            return write_samples(&mut self.file, values, self.element, self.byte_order);
        };
        for piece in values.chunks(PIECE_BYTES) {
            write_samples(&mut blocks.pending, piece, self.element, self.byte_order)?;
            blocks.compress(false)?;
        }
        Ok(())
    }

    fn put(mut self) -> io::Result<()> {
        if let Some(mut blocks) = self.blocks.take() {
            blocks.compress(true)?;
            let table = [blocks.lengths.len() as u64, BLOCK_BYTES, self.expected % BLOCK_BYTES];
            for word in table.into_iter().chain(blocks.lengths) {
                self.file.write_all(&word_bytes(word, self.byte_order))?;
            }
            let mut waiting = blocks.waiting.into_inner().map_err(io::IntoInnerError::into_error)?;
            waiting.rewind()?;
            io::copy(&mut waiting, &mut self.file)?;
        }
        self.file.write_all(self.tail.as_bytes())?;
        self.file.commit()
    }
}

impl Blocks {
    /// Compresses all full blocks, or all there are.
    fn compress(&mut self, is_last: bool) -> io::Result<()> {
        let block = BLOCK_BYTES as usize;
        let ready = if is_last { self.pending.len() } else { self.pending.len() / block * block };
        let compressed = self.pending[..ready].par_chunks(block).map(|bytes| {
            let mut out = Vec::new();
            ZlibEncoder::new(bytes, Compression::default()).read_to_end(&mut out)?;
            Ok(out)
        });
        for bytes in compressed.collect::<io::Result<Vec<_>>>()? {
            self.lengths.push(bytes.len() as u64);
            self.waiting.write_all(&bytes)?;
        }
        self.pending.drain(..ready);
        Ok(())
    }
}

/// A word of 64 bits before the samples.
pub(super) fn word_bytes(word: u64, byte_order: ByteOrder) -> [u8; 8] {
    match byte_order {
        ByteOrder::Little => word.to_le_bytes(),
        ByteOrder::Big => word.to_be_bytes(),
    }
}

impl Sink for VtkSink {
    fn write(&mut self, values: &[u8]) -> Result<(), WriteError> {
        self.written += values.len() as u64;
        self.take(values).map_err(|cause| WriteError::Io { path: self.path.clone(), cause })
    }

    fn finish(self: Box<Self>) -> Result<(), WriteError> {
        let path = self.path.clone();
        if self.written != self.expected {
            return Err(WriteError::SampleBytes { path, expected: self.expected, found: self.written });
        }
        self.put().map_err(|cause| WriteError::Io { path, cause })
    }
}
