//! Data sets that are decoded a piece at a time, of any place, each as long as suits them.

use std::path::{Path, PathBuf};

use super::{Header, ReadError, Source};

/// Pieces that can be had in any order.
pub(super) trait Pieces: Send {
    /// What all of them hold.
    fn header(&self) -> &Header;

    /// The file or folder that is read.
    fn path(&self) -> &Path;

    /// The piece that the value at a byte lies in, its values as [`Header`] orders them, and the byte that it begins at.
    fn piece(&mut self, position: u64) -> Result<(Vec<u8>, u64), ReadError>;

    /// As [`Source::hold_at_most`].
    fn hold_at_most(&mut self, bytes: u64) -> u64;

    /// As [`Source::files`].
    fn files(&self) -> Vec<PathBuf> {
        vec![self.path().to_owned()]
    }
}

/// A source of pieces, of which it holds one.
pub(super) struct PieceSource<P> {
    pieces: P,
    held: Vec<u8>,
    /// Where the one that is held begins.
    start: u64,
    at: u64,
}

impl<P: Pieces> PieceSource<P> {
    pub(super) fn new(pieces: P) -> Self {
        Self { pieces, held: Vec::new(), start: 0, at: 0 }
    }

    /// The values that are held from the current place on, at least one.
    fn ready(&mut self) -> Result<&[u8], ReadError> {
        if self.at < self.start || self.at - self.start >= self.held.len() as u64 {
            // Not beside the next one.
            self.held = Vec::new();
            (self.held, self.start) = self.pieces.piece(self.at)?;
        }
        Ok(&self.held[(self.at - self.start) as usize..])
    }
}

impl<P: Pieces> Source for PieceSource<P> {
    fn header(&self) -> &Header {
        self.pieces.header()
    }

    fn read(&mut self, mut out: &mut [u8]) -> Result<(), ReadError> {
        let left = self.header().bytes().unwrap_or(0).saturating_sub(self.at);
        if out.len() as u64 > left {
            return Err(ReadError::BeyondEnd { path: self.pieces.path().to_owned() });
        }
        while !out.is_empty() {
            let ready = self.ready()?;
            let count = ready.len().min(out.len());
            let (now, later) = out.split_at_mut(count);
            now.copy_from_slice(&ready[..count]);
            self.at += count as u64;
            out = later;
        }
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.at = position;
        Ok(())
    }

    fn is_random(&self) -> bool {
        true
    }

    fn hold_at_most(&mut self, bytes: u64) -> u64 {
        self.pieces.hold_at_most(bytes)
    }

    fn files(&self) -> Vec<PathBuf> {
        self.pieces.files()
    }
}
