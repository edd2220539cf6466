//! Pipes that can be read again.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};

/// Bytes copied from a pipe at a time, at least.
const PIECE_BYTES: u64 = 1 << 16;

/// A pipe or a device, and a nameless temporary file of what has come out of it, so that one can go back in it.
///
/// Positions ahead of what has come are reached by copying; from the end none can be counted.
#[derive(Debug)]
pub(super) struct Spool {
    pipe: File,
    copy: File,
    /// Bytes in the copy.
    copied: u64,
    at: u64,
}

impl Spool {
    /// # Errors
    ///
    /// When no temporary file can be made.
    pub(super) fn new(pipe: File) -> io::Result<Self> {
        Ok(Self { pipe, copy: tempfile::tempfile()?, copied: 0, at: 0 })
    }

    /// Copies up to `count` bytes more.
    fn copy(&mut self, count: u64) -> io::Result<u64> {
        self.copy.seek(SeekFrom::Start(self.copied))?;
        let copied = io::copy(&mut (&mut self.pipe).take(count), &mut self.copy)?;
        self.copy.flush()?;
        self.copied += copied;
        Ok(copied)
    }
}

impl Read for Spool {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        while self.at >= self.copied {
            let missing = self.at - self.copied + out.len() as u64;
            if self.copy(missing.clamp(1, PIECE_BYTES))? == 0 {
                return Ok(0);
            }
        }
        let ready = usize::try_from(self.copied - self.at).unwrap_or(usize::MAX).min(out.len());
        self.copy.seek(SeekFrom::Start(self.at))?;
        let count = self.copy.read(&mut out[..ready])?;
        self.at += count as u64;
        Ok(count)
    }
}

impl Seek for Spool {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let target = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::Current(by) => self.at.checked_add_signed(by),
            SeekFrom::End(_) => None,
        };
        self.at = target.ok_or(io::ErrorKind::Unsupported)?;
        Ok(self.at)
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn what_came_out_of_a_pipe_can_be_read_again() {
        let bytes: Vec<u8> = (0..300_000_u32).map(|n| (n ^ n >> 7) as u8).collect();
        let (reader, mut writer) = io::pipe().unwrap();
        let sent = bytes.clone();
        let sender = std::thread::spawn(move || writer.write_all(&sent).unwrap());
        let mut spool = Spool::new(File::from(std::os::fd::OwnedFd::from(reader))).unwrap();
        let mut part = [0; 1000];
        spool.seek(SeekFrom::Start(200_000)).unwrap();
        spool.read_exact(&mut part).unwrap();
        assert_eq!(part, bytes[200_000..201_000]);
        spool.seek(SeekFrom::Start(0)).unwrap();
        let mut all = Vec::new();
        spool.read_to_end(&mut all).unwrap();
        assert!(all == bytes);
        spool.seek(SeekFrom::Start(300_001)).unwrap();
        assert_eq!(spool.read(&mut part).unwrap(), 0);
        spool.seek(SeekFrom::End(0)).unwrap_err();
        sender.join().unwrap();
    }
}
