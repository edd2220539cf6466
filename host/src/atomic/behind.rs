//! Making the storage keep a file while the rest of it is still to come, so that little is left to wait for at its end.

use std::fs::File;
use std::io;
use std::thread::{Builder, JoinHandle};

/// Bytes that are written before the storage is asked to keep them.
const PIECE_BYTES: u64 = 1 << 25;

/// What is written and not yet known to be kept.
#[derive(Debug, Default)]
pub(super) struct Behind {
    bytes: u64,
    keeping: Option<JoinHandle<io::Result<()>>>,
}

impl Behind {
    /// So many bytes more were written. Where they are many by now, and those before are kept, a thread has the storage
    /// keep them.
    ///
    /// # Errors
    ///
    /// When those before could not be kept.
    pub(super) fn written(&mut self, file: &File, bytes: usize) -> io::Result<()> {
        self.bytes += bytes as u64;
        if self.bytes < PIECE_BYTES || self.keeping.as_ref().is_some_and(|keeping| !keeping.is_finished()) {
            return Ok(());
        }
        self.wait()?;
        let file = file.try_clone()?;
        self.bytes = 0;
        // Without a thread all is kept at the end.
        self.keeping = Builder::new().spawn(move || file.sync_data()).ok();
        Ok(())
    }

    /// Waits for the thread. The system tells an error once, so that it has to be asked for before the end.
    ///
    /// # Errors
    ///
    /// When something could not be kept.
    pub(super) fn wait(&mut self) -> io::Result<()> {
        match self.keeping.take().map(JoinHandle::join) {
            None => Ok(()),
            Some(kept) => kept.unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn pieces_are_kept_and_errors_told() {
        let mut file = tempfile::tempfile().unwrap();
        let mut behind = Behind::default();
        file.write_all(b"some").unwrap();
        behind.written(&file, 4).unwrap();
        assert!(behind.keeping.is_none());
        behind.written(&file, PIECE_BYTES as usize).unwrap();
        assert!(behind.keeping.is_some() && behind.bytes == 0);
        behind.wait().unwrap();
        behind.keeping = Some(std::thread::spawn(|| Err(io::ErrorKind::StorageFull.into())));
        assert_eq!(behind.wait().unwrap_err().kind(), io::ErrorKind::StorageFull);
        behind.wait().unwrap();
    }
}
