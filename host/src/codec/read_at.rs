//! Bytes that are read from any place, by several readers at once.

use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes that can be read from any place: a file, memory, a memory map.
///
/// Reading changes nothing, so that any number of threads read at once without waiting for each other.
pub trait ReadAt: Send + Sync {
    /// Bytes in all.
    fn bytes(&self) -> u64;

    /// Fills `out` with the bytes from `position` on.
    ///
    /// # Errors
    /// What the system says; [`io::ErrorKind::UnexpectedEof`] where `out` reaches beyond the end.
    fn read_at(&self, position: u64, out: &mut [u8]) -> io::Result<()>;
}

impl<T: AsRef<[u8]> + Send + Sync> ReadAt for T {
    fn bytes(&self) -> u64 {
        self.as_ref().len() as u64
    }

    fn read_at(&self, position: u64, out: &mut [u8]) -> io::Result<()> {
        let found =
            usize::try_from(position).ok().and_then(|start| self.as_ref().get(start..)?.get(..out.len()));
        out.copy_from_slice(found.ok_or(io::ErrorKind::UnexpectedEof)?);
        Ok(())
    }
}

/// A file that is read from any place; its length is that of when it was opened.
#[derive(Debug)]
pub struct FileAt {
    #[cfg(any(unix, windows))]
    file: File,
    #[cfg(not(any(unix, windows)))]
    file: std::sync::Mutex<File>,
    bytes: u64,
}

impl FileAt {
    /// Opens a regular file.
    ///
    /// # Errors
    /// What the system says; [`io::ErrorKind::NotSeekable`] for a pipe, which has no places.
    pub fn open(path: &Path) -> io::Result<Self> {
        let mut file = File::open(path)?;
        // Devices have a length too, though the system does not tell it with their names.
        let bytes = io::Seek::seek(&mut file, io::SeekFrom::End(0))?;
        #[cfg(not(any(unix, windows)))]
        let file = std::sync::Mutex::new(file);
        Ok(Self { file, bytes })
    }
}

impl ReadAt for FileAt {
    fn bytes(&self) -> u64 {
        self.bytes
    }

    #[cfg(unix)]
    fn read_at(&self, position: u64, out: &mut [u8]) -> io::Result<()> {
        std::os::unix::fs::FileExt::read_exact_at(&self.file, out, position)
    }

    #[cfg(windows)]
    fn read_at(&self, position: u64, out: &mut [u8]) -> io::Result<()> {
        let mut filled = 0;
        while filled < out.len() {
            let at = position.saturating_add(filled as u64);
            match std::os::windows::fs::FileExt::seek_read(&self.file, &mut out[filled..], at) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(count) => filled += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    #[cfg(not(any(unix, windows)))]
    fn read_at(&self, position: u64, out: &mut [u8]) -> io::Result<()> {
        use std::io::{Read, Seek, SeekFrom};
        let mut file = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        file.seek(SeekFrom::Start(position))?;
        file.read_exact(out)
    }
}

/// Bytes that count how many of them were read, and how often.
#[derive(Debug)]
pub struct Counted<R> {
    inner: R,
    count: Arc<Count>,
}

/// What [`Counted`] counts.
#[derive(Debug, Default)]
pub struct Count {
    bytes: AtomicU64,
    reads: AtomicU64,
}

impl Count {
    /// Bytes read so far.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    /// Reads so far.
    pub fn reads(&self) -> u64 {
        self.reads.load(Ordering::Relaxed)
    }
}

impl<R: ReadAt> Counted<R> {
    /// Counts what is read of `inner`.
    pub fn new(inner: R) -> Self {
        Self { inner, count: Arc::default() }
    }

    /// The count, which stays when this goes.
    pub fn count(&self) -> Arc<Count> {
        Arc::clone(&self.count)
    }
}

impl<R: ReadAt> ReadAt for Counted<R> {
    fn bytes(&self) -> u64 {
        self.inner.bytes()
    }

    fn read_at(&self, position: u64, out: &mut [u8]) -> io::Result<()> {
        self.count.bytes.fetch_add(out.len() as u64, Ordering::Relaxed);
        self.count.reads.fetch_add(1, Ordering::Relaxed);
        self.inner.read_at(position, out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_and_memory_are_read_from_any_place() {
        let content: Vec<u8> = (0..=255).collect();
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), &content).unwrap();
        let sources: [Box<dyn ReadAt>; 2] =
            [Box::new(FileAt::open(file.path()).unwrap()), Box::new(content.clone())];
        for source in sources {
            assert_eq!(source.bytes(), 256);
            let mut part = [0; 16];
            for position in [0, 100, 240] {
                source.read_at(position, &mut part).unwrap();
                assert_eq!(part, content[position as usize..][..16]);
            }
            for position in [241, 256, u64::MAX] {
                source.read_at(position, &mut part).unwrap_err();
            }
        }
    }

    #[test]
    fn what_is_read_is_counted() {
        let counted = Counted::new(vec![0_u8; 100]);
        let count = counted.count();
        counted.read_at(3, &mut [0; 7]).unwrap();
        counted.read_at(50, &mut [0; 50]).unwrap();
        drop(counted);
        assert_eq!((count.bytes(), count.reads()), (57, 2));
    }
}
