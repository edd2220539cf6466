//! A data set from one file to another, a piece at a time.

use super::{Fault, PIECE_BYTES, ReadError, Sink, Source, WriteError};
use crate::progress::{Progress, Stopped, tell};

/// Why a data set was not copied. There is no new file then, and an old one is as it was.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CopyError {
    /// It could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// It could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// It was stopped.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl CopyError {
    /// Whose fault it is.
    pub const fn kind(&self) -> Fault {
        match self {
            Self::Read(error) => error.kind(),
            Self::Write(error) => error.kind(),
            Self::Stopped(_) => Fault::Io,
        }
    }
}

/// Copies all values of `source`, from its first, to a sink that was made for the same header, and finishes it.
///
/// `progress` counts samples with all their components, over all time steps.
///
/// # Errors
/// [`CopyError`].
///
/// Cost: one pass over each; a few MiB of memory.
pub fn copy(
    source: &mut dyn Source,
    mut sink: Box<dyn Sink>,
    progress: Progress<'_>,
) -> Result<(), CopyError> {
    let header = source.header();
    let sample = u64::from(header.components) * header.element.bytes() as u64;
    let bytes = header.bytes().unwrap_or(u64::MAX);
    let mut piece = vec![0; bytes.min(PIECE_BYTES) as usize];
    let mut done = 0;
    source.seek(0)?;
    while done < bytes {
        let values = &mut piece[..PIECE_BYTES.min(bytes - done) as usize];
        source.read(values)?;
        sink.write(values)?;
        let end = done + values.len() as u64;
        tell(progress, end / sample - done / sample)?;
        done = end;
    }
    Ok(sink.finish()?)
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;
    use crate::progress::ignore;
    use crate::volume::synthetic::{Kind, generate};
    use crate::volume::{Created, ElementType, InMemory, WriteOptions, create, open, read};

    #[test]
    fn pieces_make_the_same_file_and_count_all_samples() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.nrrd");
        // More than one piece, the last one not full.
        let volume = generate(Kind::Noise, [130, 129, 127], ElementType::F32, 3);
        let Created { sink, .. } = create(&path, &volume.header(), &WriteOptions::default()).unwrap();
        let counted = AtomicU64::new(0);
        let count = |samples| {
            counted.fetch_add(samples, Ordering::Relaxed);
            ControlFlow::Continue(())
        };
        copy(&mut InMemory::new(&volume).unwrap(), sink, &count).unwrap();
        assert_eq!(counted.into_inner(), 130 * 129 * 127);
        assert!(read(&path, None).unwrap().samples == volume.samples);
    }

    #[test]
    fn a_source_is_copied_from_its_first_value() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a.npy", "b.npy"].map(|name| folder.path().join(name));
        let volume = generate(Kind::Waves, [9, 7, 5], ElementType::U16, 3);
        crate::volume::write(&volume, &a, &WriteOptions::default()).unwrap();
        let mut source = open(&a, None).unwrap();
        source.read(&mut [0; 100]).unwrap();
        let Created { sink, .. } = create(&b, source.header(), &WriteOptions::default()).unwrap();
        copy(source.as_mut(), sink, &ignore).unwrap();
        assert_eq!(std::fs::read(a).unwrap(), std::fs::read(b).unwrap());
    }

    #[test]
    fn a_stopped_copy_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.raw");
        let volume = generate(Kind::Waves, [9, 7, 5], ElementType::U16, 3);
        let Created { sink, .. } = create(&path, &volume.header(), &WriteOptions::default()).unwrap();
        let stopped = copy(&mut InMemory::new(&volume).unwrap(), sink, &|_| ControlFlow::Break(()));
        assert!(matches!(stopped, Err(CopyError::Stopped(Stopped))));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
