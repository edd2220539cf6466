//! Files, pipes and devices that are read, with a watch on how many bytes are left.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::ReadError;
use super::spool::Spool;

trait ReadSeek: Read + Seek + Send {}

impl<T: Read + Seek + Send> ReadSeek for T {}

/// A file being read, which knows where it is and how many of its bytes are left.
pub(super) struct Input {
    reader: BufReader<Box<dyn ReadSeek>>,
    path: PathBuf,
    position: u64,
    /// Bytes of the file, unless it is a pipe or a device.
    bytes: Option<u64>,
}

impl Input {
    /// Opens a file, which is not empty, a FIFO or a device.
    pub(super) fn open(path: &Path) -> Result<Self, ReadError> {
        let open = || {
            let file = File::open(path)?;
            if file.metadata()?.is_dir() {
                return Err(io::ErrorKind::IsADirectory.into());
            }
            Ok(file)
        };
        let input =
            Self::of_file(open().map_err(|cause| ReadError::Io { path: path.to_owned(), cause })?, path)?;
        if input.bytes == Some(0) { Err(ReadError::Empty { path: path.to_owned() }) } else { Ok(input) }
    }

    /// Takes an open file from where it stands, which is its beginning; errors will name it `path`.
    pub(super) fn of_file(file: File, path: &Path) -> Result<Self, ReadError> {
        let wrap = || {
            let metadata = file.metadata()?;
            let bytes = metadata.is_file().then_some(metadata.len());
            let reader: Box<dyn ReadSeek> = match bytes {
                Some(_) => Box::new(file),
                None => Box::new(Spool::new(file)?),
            };
            Ok(Self { reader: BufReader::new(reader), path: path.to_owned(), position: 0, bytes })
        };
        wrap().map_err(|cause| ReadError::Io { path: path.to_owned(), cause })
    }

    /// Reads from memory as from a regular file.
    #[cfg(test)]
    pub(super) fn from_bytes(bytes: &[u8]) -> Self {
        let reader: Box<dyn ReadSeek> = Box::new(io::Cursor::new(bytes.to_vec()));
        let bytes = Some(bytes.len() as u64);
        Self { reader: BufReader::new(reader), path: "memory".into(), position: 0, bytes }
    }

    /// Path given to [`open`](Self::open).
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Bytes not yet read, unless this is a FIFO or a device.
    pub(super) fn left(&self) -> Option<u64> {
        self.bytes.map(|bytes| bytes.saturating_sub(self.position))
    }

    /// Bytes before the next one.
    pub(super) const fn position(&self) -> u64 {
        self.position
    }

    /// Goes to a byte of the file; in a pipe too, of which there is a copy.
    pub(super) fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.go_to(position).map_err(|cause| self.io(cause))
    }

    fn go_to(&mut self, position: u64) -> io::Result<()> {
        let by = i64::try_from(position).ok().zip(i64::try_from(self.position).ok()).map(|(to, at)| to - at);
        self.reader.seek_relative(by.ok_or(io::ErrorKind::InvalidInput)?)?;
        self.position = position;
        Ok(())
    }

    /// The bytes to come, as many as are read at once; none is consumed.
    pub(super) fn first_bytes(&mut self) -> Result<&[u8], ReadError> {
        let Self { reader, path, .. } = self;
        reader.fill_buf().map_err(|cause| ReadError::Io { path: path.clone(), cause })
    }

    /// Whether the bytes to come begin with `magic`; none is consumed.
    pub(super) fn starts_with(&mut self, magic: &[u8]) -> Result<bool, ReadError> {
        Ok(self.first_bytes()?.starts_with(magic))
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
}

impl Read for Input {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(out)?;
        self.position += count as u64;
        Ok(count)
    }
}

/// For decoders that go to and fro in a file. The end of a pipe is not known.
impl Seek for Input {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let target = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::Current(by) => self.position.checked_add_signed(by),
            SeekFrom::End(by) => self.bytes.ok_or(io::ErrorKind::Unsupported)?.checked_add_signed(by),
        };
        self.go_to(target.ok_or(io::ErrorKind::InvalidInput)?)?;
        Ok(self.position)
    }
}

impl BufRead for Input {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.reader.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.reader.consume(count);
        self.position += count as u64;
    }
}
