//! Samples in another form than one run of raw bytes, as a source.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::VtkError;
use super::bytes::Bytes;
use crate::volume::element::reorder;
use crate::volume::{ByteOrder, FileFormat, Header, ReadError, Source};

/// Samples of one array in the file's order of bytes.
pub(super) trait Body: Send {
    /// Reads the next bytes, whole values.
    fn fill(&mut self, out: &mut [u8]) -> Result<(), ReadError>;

    /// Goes to that byte of the samples.
    fn seek(&mut self, position: u64) -> Result<(), ReadError>;

    /// Whether going back costs little.
    fn is_random(&self) -> bool;
}

/// An array of a VTK file.
pub(super) struct VtkSource {
    pub(super) header: Header,
    pub(super) body: Box<dyn Body>,
    /// Order of the bytes that the body gives.
    pub(super) byte_order: ByteOrder,
    pub(super) path: PathBuf,
    /// Bytes read so far.
    pub(super) at: u64,
}

impl VtkSource {
    /// Lets an error speak of the format of the file.
    fn named(&self, error: ReadError) -> ReadError {
        let format = self.header.metadata.source.format;
        match error {
            ReadError::Format { path, cause, .. } => ReadError::Format { path, format, cause },
            other => other,
        }
    }
}

impl Source for VtkSource {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        let left = self.header.bytes().unwrap_or(0).saturating_sub(self.at);
        if out.len() as u64 > left {
            return Err(ReadError::BeyondEnd { path: self.path.clone() });
        }
        self.body.fill(out).map_err(|error| self.named(error))?;
        self.at += out.len() as u64;
        reorder(out, self.header.element, self.byte_order);
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.body.seek(position).map_err(|error| self.named(error))?;
        self.at = position;
        Ok(())
    }

    fn is_random(&self) -> bool {
        self.body.is_random()
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.path.clone()]
    }
}

/// Samples as they are behind a head, in base64.
pub(super) struct Plain {
    pub(super) bytes: Bytes,
    /// Bytes before the samples.
    pub(super) head: u64,
}

impl Body for Plain {
    fn fill(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        let filled = self.bytes.read_exact(out);
        filled.map_err(|cause| damaged(self.bytes.path(), cause))
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.bytes.seek(self.head.saturating_add(position))
    }

    fn is_random(&self) -> bool {
        self.bytes.is_random()
    }
}

/// An error of reading samples: the system's, or a fault of the file.
pub(super) fn damaged(path: &Path, cause: io::Error) -> ReadError {
    let path = path.to_owned();
    match cause.raw_os_error() {
        Some(_) => ReadError::Io { path, cause },
        None => {
            let cause = Box::new(VtkError::Samples(cause));
            ReadError::Format { path, format: FileFormat::VtkXml, cause }
        }
    }
}
