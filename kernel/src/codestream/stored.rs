//! Samples as they are: what a codestream holds where coding would not make it shorter.

use super::header::Header;
use crate::memory::copy;
use crate::{EncodeError, Plan, SampleType};

/// A codestream of samples as they are, which bounds the length of every other; or none, where they would not fit the
/// format.
pub(super) struct Stored(Option<Header>);

impl Stored {
    pub(super) fn new(plan: &Plan, sample_type: SampleType) -> Self {
        Self(Header::stored(plan, sample_type))
    }

    /// The part of `out` in which a coded codestream is shorter.
    pub(super) fn room<'a>(&self, out: &'a mut [u8]) -> &'a mut [u8] {
        let shorter = self.0.as_ref().map_or(out.len(), |header| header.total_len().saturating_sub(1));
        let room = out.len().min(shorter);
        out.get_mut(..room).unwrap_or(&mut [])
    }

    /// Writes `samples` to the beginning of `out`, little-endian, and returns the length of the codestream.
    pub(super) fn write(&self, samples: &[i32], out: &mut [u8]) -> Result<usize, EncodeError> {
        let header = self.0.as_ref().filter(|header| header.total_len() <= out.len());
        let header = header.ok_or(EncodeError::OutputFull)?;
        header.write(out);
        let payload = out.get_mut(header.header_len()..).unwrap_or(&mut []);
        let size = header.sample_type().bytes();
        for (bytes, sample) in payload.chunks_exact_mut(size.max(1)).zip(samples) {
            copy(&sample.to_le_bytes(), bytes);
        }
        Ok(header.total_len())
    }
}

/// Reads samples that are stored as they are.
pub(super) fn restore(sample_type: SampleType, payload: &[u8], samples: &mut [i32]) {
    for (sample, bytes) in samples.iter_mut().zip(payload.chunks_exact(sample_type.bytes())) {
        *sample = match (sample_type, bytes) {
            (SampleType::I8, &[byte]) => i8::from_le_bytes([byte]).into(),
            (SampleType::U8, &[byte]) => byte.into(),
            (SampleType::I16, &[a, b]) => i16::from_le_bytes([a, b]).into(),
            (SampleType::U16, &[a, b]) => u16::from_le_bytes([a, b]).into(),
            (_, &[a, b, c, d]) => i32::from_le_bytes([a, b, c, d]),
            _ => 0,
        };
    }
}
