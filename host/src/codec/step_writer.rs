//! A compressed file whose values are pushed into it, as a simulation or an instrument makes them.

use std::path::{Path, PathBuf};

use bytemuck::cast_slice;

use super::compress::{Compressor, head, refuse_others, resumed};
use super::content::{Head, Step};
use super::file::at;
use super::supply::Gathered;
use super::writer::Writer;
use super::{CompressError, CompressOptions, Container, Label, Progress, Report};
use crate::atomic::AtomicFile;
use crate::volume::{Header, Sample};

/// A compressed file that is written a piece at a time, and may get any number of time steps.
///
/// Values come in the order of [`Header`]: component fastest, then x, y, z, time step. Those of a time step are kept, in
/// memory or in a temporary file, until all are there, as they are looked through before they are coded; then the step is
/// compressed, on all cores, before [`StepWriter::write`] returns. The file appears when it is finished, or not at all;
/// its bytes are those of [`compress_file`](super::compress_file) of the same values.
///
/// ```
/// use wavelift_host::codec::{CompressOptions, Container, StepWriter};
/// use wavelift_host::progress::ignore;
/// use wavelift_host::volume::{ElementType, FileFormat, Header, Metadata};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("run.wlift");
/// let (extent, options) = ([16, 8, 4], CompressOptions::default());
/// let header = Header::scalar(extent, ElementType::F32, Metadata::plain(3, FileFormat::Raw));
/// let mut file = StepWriter::create(&path, &header, &options, &ignore)?;
/// for step in 0..3 {
///     for z in 0..4 {
///         let plane: Vec<f32> = (0..16 * 8).map(|xy| (xy * step + z) as f32).collect();
///         file.write(&plane)?;
///     }
/// }
/// file.finish()?;
/// assert_eq!(Container::open(&path)?.steps(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct StepWriter<'a> {
    path: PathBuf,
    /// `None` after an error.
    open: Option<Open<'a>>,
}

/// What there is until an error.
struct Open<'a> {
    compressor: Compressor<'a>,
    writer: Writer<AtomicFile>,
    progress: Progress<'a>,
    gathered: Gathered,
    /// What the next step is called, if not as the options say.
    label: Option<Label>,
    /// The number of the first step that is written here, and those that are.
    first: u64,
    steps: Vec<Step>,
}

impl std::fmt::Debug for StepWriter<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StepWriter").field("path", &self.path).finish_non_exhaustive()
    }
}

impl<'a> StepWriter<'a> {
    /// Begins a file for time steps like those of `header`, which need not know how many there will be. `progress` counts
    /// values as they are coded, and may stop the work.
    ///
    /// # Errors
    /// [`CompressError`]: a header that is contradictory, a file that cannot be written.
    pub fn create(
        path: impl AsRef<Path>,
        header: &Header,
        options: &'a CompressOptions,
        progress: Progress<'a>,
    ) -> Result<Self, CompressError> {
        let head = head(header, options)?;
        let begin = |file| Writer::new(file, &head, &header.metadata).map_err(CompressError::from);
        Self::begin(path.as_ref(), &head, options, (progress, &begin))
    }

    /// Goes on behind the time steps of the compressed file at `path`, which is replaced by [`StepWriter::finish`].
    /// `header` says what the values are, and has to be like that of the file.
    ///
    /// # Errors
    /// As [`StepWriter::create`]; a file that cannot be read, or holds others.
    pub fn append(
        path: impl AsRef<Path>,
        header: &Header,
        options: &'a CompressOptions,
        progress: Progress<'a>,
    ) -> Result<Self, CompressError> {
        let container = Container::open(&path)?;
        refuse_others(container.head(), header)?;
        let begin = |file| resumed(&container, file);
        Self::begin(path.as_ref(), container.head(), options, (progress, &begin))
    }

    fn begin(
        path: &Path,
        head: &Head,
        options: &'a CompressOptions,
        (progress, begin): (Progress<'a>, &dyn Fn(AtomicFile) -> Result<Writer<AtomicFile>, CompressError>),
    ) -> Result<Self, CompressError> {
        let open = || {
            let writer = begin(AtomicFile::create(path)?)?;
            let compressor = Compressor::new(head.clone(), options)?;
            let (gathered, first) = (compressor.room()?, writer.next_step());
            Ok(Open { compressor, writer, progress, gathered, label: None, first, steps: Vec::new() })
        };
        let open = open().map_err(|error| at(path, error))?;
        Ok(Self { path: path.to_owned(), open: Some(open) })
    }

    /// Says what the time step is called whose values are written next, in place of what
    /// [`CompressOptions::labels`] says.
    pub fn label(&mut self, label: Label) {
        if let Some(open) = &mut self.open {
            open.label = Some(label);
        }
    }

    /// Takes the next values, any number of them: of a row, a plane, several time steps. Compresses a time step when its
    /// last value is there.
    ///
    /// # Errors
    /// [`CompressError`]: values of another type than the header says, work that was stopped, no room. The file cannot be
    /// finished then.
    pub fn write<T: Sample>(&mut self, values: &[T]) -> Result<(), CompressError> {
        let mut open = self.open.take().ok_or(CompressError::AfterError)?;
        open.write(values).map_err(|error| at(&self.path, error))?;
        self.open = Some(open);
        Ok(())
    }

    /// Puts the file in its place. What came of it is of the time steps that were written here.
    ///
    /// # Errors
    /// [`CompressError`]: a time step that lacks values, no time step, an error before; a file that cannot be written.
    /// Nothing has changed at the path then.
    pub fn finish(self) -> Result<Report, CompressError> {
        let open = self.open.ok_or(CompressError::AfterError)?;
        open.finish().map_err(|error| at(&self.path, error))
    }
}

impl Open<'_> {
    fn write<T: Sample>(&mut self, values: &[T]) -> Result<(), CompressError> {
        let expected = self.compressor.head.element;
        if T::ELEMENT != expected {
            return Err(CompressError::WrongType { expected, given: T::ELEMENT });
        }
        if cfg!(target_endian = "little") {
            return self.take(cast_slice(values));
        }
        let values: Vec<T> = values.iter().copied().map(T::of_little).collect();
        self.take(cast_slice(&values))
    }

    fn take(&mut self, mut bytes: &[u8]) -> Result<(), CompressError> {
        while !bytes.is_empty() {
            let count = self.gathered.missing().min(bytes.len() as u64) as usize;
            self.gathered.push(&bytes[..count])?;
            bytes = &bytes[count..];
            if self.gathered.missing() == 0 {
                self.end_step()?;
            }
        }
        Ok(())
    }

    fn end_step(&mut self) -> Result<(), CompressError> {
        let gathered = std::mem::replace(&mut self.gathered, self.compressor.room()?);
        let number = self.first + self.steps.len() as u64;
        let label = self.label.take().unwrap_or_else(|| self.compressor.label(self.steps.len()));
        let mut supply = gathered.into_supply();
        let step = self.compressor.step(&mut supply, number, label, &mut self.writer, self.progress)?;
        self.steps.push(step);
        Ok(())
    }

    fn finish(self) -> Result<Report, CompressError> {
        let (found, missing) = (self.gathered.found(), self.gathered.missing());
        if found > 0 || self.steps.is_empty() {
            return Err(CompressError::UnfinishedStep { expected: found + missing, found });
        }
        let summaries = self.writer.summaries()[self.first as usize..].to_vec();
        let (container_bytes, file) = self.writer.finish()?;
        file.commit()?;
        let sample_bytes = missing.saturating_mul(self.steps.len() as u64);
        Ok(Report { sample_bytes, container_bytes, head: self.compressor.head, steps: self.steps, summaries })
    }
}
