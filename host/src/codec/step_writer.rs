//! A compressed file whose values are pushed into it, as a simulation or an instrument makes them.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::compress::{Compressor, head, refuse_others, resumed};
use super::content::{Head, Step};
use super::file::at;
use super::supply::Gathered;
use super::writer::Writer;
use super::{CompressError, CompressOptions, Container, Label, Progress, Region, Report};
use crate::array::little_endian;
use crate::atomic::AtomicFile;
use crate::volume::{Header, Sample};

/// A compressed file that is written a piece at a time, and may get any number of time steps.
///
/// Values come in the order of [`Header`]: component fastest, then x, y, z, time step; or, within a time step, brick by
/// brick in any order ([`StepWriter::write_region`]). Those of a time step are kept, in memory or in a temporary file,
/// until all are there, as they are looked through before they are coded; then the step is compressed, on all cores,
/// before the call returns. The file appears when it is finished, or not at all; its bytes are those of
/// [`compress_file`](super::compress_file) of the same values.
///
/// ```
/// use wavelift_host::codec::{CompressOptions, Container, StepWriter};
/// use wavelift_host::progress::ignore;
/// use wavelift_host::volume::{ElementType, Header, Metadata};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("run.wlift");
/// let (extent, options) = ([16, 8, 4], CompressOptions::default());
/// let header = Header::scalar(extent, ElementType::F32, Metadata::default());
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
    /// The regions of the current step that were written, unless its values come in order.
    regions: Vec<Region>,
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
        refuse_others(container.head(), header).map_err(|error| at(path.as_ref(), error))?;
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
            let (regions, steps) = (Vec::new(), Vec::new());
            Ok(Open { compressor, writer, progress, gathered, regions, label: None, first, steps })
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
        self.go_on(|open| open.take(&open.bytes_of(values)?))
    }

    /// Takes the values of a region of the current time step, component fastest, then x, y, z: such as a [`Brick`] of a
    /// [`Grid`], in any order. Compresses the time step when every sample of it is there.
    ///
    /// ```
    /// use wavelift_host::codec::{CompressOptions, Container, Grid, StepWriter};
    /// use wavelift_host::progress::ignore;
    /// use wavelift_host::volume::{ElementType, Header, Metadata};
    ///
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("bricks.wlift");
    /// let (extent, options) = ([50, 40, 30], CompressOptions::default());
    /// let header = Header::scalar(extent, ElementType::U16, Metadata::default());
    /// let mut file = StepWriter::create(&path, &header, &options, &ignore)?;
    /// for brick in Grid::new(extent, [16; 3]).ok_or("too large")?.iter() {
    ///     let values = vec![brick.origin[0] as u16; brick.samples() as usize];
    ///     file.write_region(brick, &values)?;
    /// }
    /// file.finish()?;
    /// assert_eq!(Container::open(&path)?.to_array::<u16>()?[[29, 39, 49]], 48);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`StepWriter::write`]; a region that is not inside the volume, meets one that was written in this step, or has
    /// another number of samples; a step whose values were begun to be written in order.
    ///
    /// Cost: a look at every region of the step that was written before.
    ///
    /// [`Brick`]: super::Brick
    /// [`Grid`]: super::Grid
    pub fn write_region<T: Sample>(
        &mut self,
        region: impl Into<Region>,
        values: &[T],
    ) -> Result<(), CompressError> {
        let region = region.into();
        self.go_on(|open| open.put(region, &open.bytes_of(values)?))
    }

    fn go_on(
        &mut self,
        work: impl FnOnce(&mut Open<'a>) -> Result<(), CompressError>,
    ) -> Result<(), CompressError> {
        let mut open = self.open.take().ok_or(CompressError::AfterError)?;
        work(&mut open).map_err(|error| at(&self.path, error))?;
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
    /// The bytes of values that are of the right type, little-endian.
    fn bytes_of<'v, T: Sample>(&self, values: &'v [T]) -> Result<Cow<'v, [u8]>, CompressError> {
        let expected = self.compressor.head.element;
        if T::ELEMENT != expected {
            return Err(CompressError::WrongType { expected, given: T::ELEMENT });
        }
        Ok(little_endian(values))
    }

    fn put(&mut self, region: Region, bytes: &[u8]) -> Result<(), CompressError> {
        let layout = self.compressor.layout();
        let extent = layout.extent;
        let within = region.within(extent).ok_or(CompressError::OutsideVolume { region, extent })?;
        if self.regions.is_empty() && self.gathered.found() > 0 {
            return Err(CompressError::MixedOrder);
        }
        if self.regions.iter().any(|written| written.meets(&within)) {
            return Err(CompressError::WrittenBefore { region: within });
        }
        let (expected, found) =
            (layout.sample() * within.sides().iter().product::<u64>(), bytes.len() as u64);
        if expected != found {
            return Err(CompressError::SampleBytes { expected, actual: found });
        }
        self.gathered.put(&layout.stretches(within.from, within.sides()), bytes)?;
        self.regions.push(within);
        if self.gathered.missing() == 0 { self.end_step() } else { Ok(()) }
    }

    fn take(&mut self, mut bytes: &[u8]) -> Result<(), CompressError> {
        if !self.regions.is_empty() && !bytes.is_empty() {
            return Err(CompressError::MixedOrder);
        }
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
        self.regions.clear();
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
