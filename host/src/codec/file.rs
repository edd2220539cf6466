//! Compressed files as files: made, or made longer, in one call.

use std::path::Path;

use super::{CompressError, CompressOptions, Container, Progress, Report, append, compress_stream};
use crate::atomic::AtomicFile;
use crate::volume::{Source, WriteError};

/// Compresses all that `source` has into a file at `path`, which appears whole or not at all: [`compress_stream`] into an
/// [`AtomicFile`].
///
/// ```
/// use wavelift_host::codec::{CompressOptions, compress_file};
/// use wavelift_host::progress::ignore;
/// use wavelift_host::volume;
///
/// let folder = tempfile::tempdir()?;
/// # let scan = folder.path().join("scan.npy");
/// # let volume = volume::synthetic::generate(volume::synthetic::Kind::Waves, [9, 8, 7], volume::ElementType::U16, 1);
/// # volume::write(&volume, &scan, &volume::WriteOptions::default())?;
/// // A file of any format, or a folder of DICOM.
/// let mut source = volume::open(scan, None)?;
/// compress_file(folder.path().join("scan.wlift"), source.as_mut(), &CompressOptions::default(), &ignore)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`CompressError`]; an old file at the path is as it was then.
pub fn compress_file(
    path: impl AsRef<Path>,
    source: &mut dyn Source,
    options: &CompressOptions,
    progress: Progress<'_>,
) -> Result<Report, CompressError> {
    write(path.as_ref(), |file| compress_stream(source, options, file, progress))
}

/// Writes the time steps of `source` behind those of the compressed file at `path`, which is replaced when all is done:
/// [`append`] into an [`AtomicFile`].
///
/// # Errors
/// [`CompressError`]; the file is as it was then.
///
/// Cost: that of copying the file, beside that of compressing.
pub fn append_file(
    path: impl AsRef<Path>,
    source: &mut dyn Source,
    options: &CompressOptions,
    progress: Progress<'_>,
) -> Result<Report, CompressError> {
    let container = Container::open(&path)?;
    write(path.as_ref(), |file| append(&container, source, options, file, progress))
}

fn write(
    path: &Path,
    fill: impl FnOnce(&mut AtomicFile) -> Result<Report, CompressError>,
) -> Result<Report, CompressError> {
    let write = || {
        let mut file = AtomicFile::create(path)?;
        let report = fill(&mut file)?;
        file.commit()?;
        Ok(report)
    };
    write().map_err(|error| at(path, error))
}

/// Names the file that could not be written, or made longer.
pub(super) fn at(path: &Path, error: CompressError) -> CompressError {
    match error {
        CompressError::Io(cause) => WriteError::Io { path: path.to_owned(), cause }.into(),
        CompressError::OtherSteps { there, given, .. } => {
            CompressError::OtherSteps { file: path.display().to_string(), there, given }
        }
        other => other,
    }
}
