//! Reading of samples with a watch on how many there are.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use super::{Found, ReadError};

/// Most bytes that one byte of deflate data can stand for: two bits at least give 258 bytes at most (RFC 1951).
const DEFLATE_EXPANSION: u64 = 4 * 258;

/// A file being read, which knows how many of its bytes are left.
pub(super) struct Input {
    reader: Box<dyn BufRead>,
    path: PathBuf,
    left: Option<u64>,
}

impl Input {
    /// Opens a file, FIFO or device.
    pub(super) fn open(path: &Path) -> Result<Self, ReadError> {
        let open = || {
            let file = File::open(path)?;
            let metadata = file.metadata()?;
            if metadata.is_dir() {
                return Err(io::ErrorKind::IsADirectory.into());
            }
            let left = metadata.is_file().then_some(metadata.len());
            Ok(Self { reader: Box::new(BufReader::new(file)), path: path.to_owned(), left })
        };
        open().map_err(|cause| ReadError::Io { path: path.to_owned(), cause })
    }

    /// Reads from memory as from a regular file.
    #[cfg(test)]
    pub(super) fn from_bytes(bytes: &[u8]) -> Self {
        let left = Some(bytes.len() as u64);
        Self { reader: Box::new(io::Cursor::new(bytes.to_vec())), path: "memory".into(), left }
    }

    /// Path given to [`open`](Self::open).
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Bytes not yet read, unless this is a FIFO or a device.
    pub(super) fn left(&self) -> Option<u64> {
        self.left
    }

    /// Whether the bytes to come begin with `magic`; none is consumed.
    pub(super) fn starts_with(&mut self, magic: &[u8]) -> Result<bool, ReadError> {
        match self.reader.fill_buf() {
            Ok(bytes) => Ok(bytes.starts_with(magic)),
            Err(cause) => Err(self.io(cause)),
        }
    }

    /// Reads all that is left: exactly `expected` bytes.
    ///
    /// Memory is taken in one piece if the file has these bytes, else as they arrive; at most `expected` + 1 are read.
    ///
    /// # Errors
    ///
    /// [`ReadError::SampleBytes`] if there are fewer or more, [`ReadError::TooLarge`] if memory does not hold them.
    pub(super) fn samples(&mut self, expected: u64) -> Result<Vec<u8>, ReadError> {
        if let Some(left) = self.left
            && left != expected
        {
            return Err(self.sample_bytes(expected, Found::Exactly(left)));
        }
        let mut samples = Vec::new();
        if self.left.is_some() {
            let bytes = usize::try_from(expected).map_err(|_| self.too_large(expected))?;
            samples.try_reserve_exact(bytes).map_err(|_| self.too_large(expected))?;
        }
        read_at_most(&mut *self, expected.saturating_add(1), &mut samples).map_err(|cause| self.io(cause))?;
        self.check_count(samples, expected)
    }

    /// Decompresses all that is left, passes over `skip` bytes of that, and returns the `expected` ones that follow.
    ///
    /// Memory is taken as the bytes arrive, and at most `expected` + 1 are kept, whatever the file expands to;
    /// where the file is too short to expand to that many, nothing is read.
    ///
    /// # Errors
    ///
    /// As [`samples`](Self::samples), and [`ReadError::Gzip`].
    pub(super) fn gzip_samples(&mut self, skip: u64, expected: u64) -> Result<Vec<u8>, ReadError> {
        usize::try_from(expected).map_err(|_| self.too_large(expected))?;
        let most = self.left.map_or(u64::MAX, |left| left.saturating_mul(DEFLATE_EXPANSION));
        if expected > most {
            return Err(self.sample_bytes(expected, Found::AtMost(most)));
        }
        let mut samples = Vec::new();
        let mut decoder = flate2::bufread::MultiGzDecoder::new(&mut *self);
        let done = skip_bytes(&mut decoder, skip)
            .and_then(|_| read_at_most(&mut decoder, expected.saturating_add(1), &mut samples));
        done.map_err(|cause| match cause.raw_os_error() {
            Some(_) => self.io(cause),
            None => ReadError::Gzip { path: self.path.clone(), cause },
        })?;
        self.check_count(samples, expected)
    }

    /// Passes over bytes; fewer if the file ends before.
    pub(super) fn skip_bytes(&mut self, count: u64) -> Result<(), ReadError> {
        skip_bytes(&mut *self, count).map_err(|cause| self.io(cause))?;
        Ok(())
    }

    /// Passes over lines, each up to its newline; fewer if the file ends before.
    pub(super) fn skip_lines(&mut self, count: u64) -> Result<(), ReadError> {
        for _ in 0..count {
            if self.skip_until(b'\n').map_err(|cause| self.io(cause))? == 0 {
                break;
            }
        }
        Ok(())
    }

    /// Names this file as the place of an error of the system.
    pub(super) fn io(&self, cause: io::Error) -> ReadError {
        ReadError::Io { path: self.path.clone(), cause }
    }

    fn check_count(&self, samples: Vec<u8>, expected: u64) -> Result<Vec<u8>, ReadError> {
        let found = samples.len() as u64;
        match found {
            _ if found == expected => Ok(samples),
            _ if found > expected => Err(self.sample_bytes(expected, Found::MoreThan(expected))),
            _ => Err(self.sample_bytes(expected, Found::Exactly(found))),
        }
    }

    fn sample_bytes(&self, expected: u64, found: Found) -> ReadError {
        ReadError::SampleBytes { path: self.path.clone(), expected, found }
    }

    fn too_large(&self, bytes: u64) -> ReadError {
        ReadError::TooLarge { path: self.path.clone(), bytes }
    }
}

impl Read for Input {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(out)?;
        self.left = self.left.map(|left| left.saturating_sub(count as u64));
        Ok(count)
    }
}

impl BufRead for Input {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.reader.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.reader.consume(count);
        self.left = self.left.map(|left| left.saturating_sub(count as u64));
    }
}

fn read_at_most(reader: impl Read, limit: u64, out: &mut Vec<u8>) -> io::Result<usize> {
    reader.take(limit).read_to_end(out)
}

fn skip_bytes(reader: impl Read, count: u64) -> io::Result<u64> {
    io::copy(&mut reader.take(count), &mut io::sink())
}
