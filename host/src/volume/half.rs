//! Floats of 16 bits, which are read as floats of 32: each of these has the value of one of those.
//!
//! Source: IEEE 754-2019, section 3.6, as the crate half knows it.

use std::path::PathBuf;

use half::f16;

use super::{ElementType, Header, ReadError, Source};

/// Little-endian floats of 32 bits with the values of little-endian floats of 16.
pub(super) fn widened(halves: &[u8]) -> Vec<u8> {
    halves
        .as_chunks::<2>()
        .0
        .iter()
        .flat_map(|bytes| f16::from_le_bytes(*bytes).to_f32().to_le_bytes())
        .collect()
}

/// A source of floats of 32 bits, whose values come as the bits of floats of 16.
pub(super) struct Widened {
    inner: Box<dyn Source>,
    header: Header,
}

impl Widened {
    /// The values of `inner`, of which those of `u16` are the bits of floats.
    pub(super) fn new(inner: Box<dyn Source>) -> Self {
        let header = Header { element: ElementType::F32, ..inner.header().clone() };
        Self { inner, header }
    }
}

impl Source for Widened {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        let mut halves = vec![0; out.len() / 2];
        self.inner.read(&mut halves)?;
        out.copy_from_slice(&widened(&halves));
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.inner.seek(position / 2)
    }

    fn is_random(&self) -> bool {
        self.inner.is_random()
    }

    fn hold_at_most(&mut self, bytes: u64) -> u64 {
        self.inner.hold_at_most(bytes)
    }

    fn files(&self) -> Vec<PathBuf> {
        self.inner.files()
    }
}
