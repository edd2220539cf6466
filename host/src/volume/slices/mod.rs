//! Stacks of files, each of which holds one slice or a few: `scan_%04d.png`, `scan_*.tif`, a folder.
//!
//! The files follow each other along z, in the order of the numbers in their names. Any format can be stacked, raw
//! samples of a layout too.

mod axes;
mod names;

use std::path::{Path, PathBuf};

pub(super) use names::Pattern;

use super::format::Format;
use super::{
    Created, FileFormat, Header, Metadata, ReadError, Sink, Source, WriteError, WriteOptions, format,
};
use crate::atomic::AtomicFolder;

/// What keeps files from being the slices of one data set.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SlicesError {
    /// A folder or pattern without files.
    #[error(
        "there are no slices (files of DICOM, or such as .png, .pgm and .tif) of this name or in this folder; folders in it are not looked at"
    )]
    NoFiles,
    /// Files of several formats in a folder.
    #[error(
        "holds files of several formats, {one:?} and {other:?}: name those of one with a pattern, as in \"*.png\""
    )]
    Mixed {
        /// One file.
        one: String,
        /// A file of another format.
        other: String,
    },
    /// A number is missing.
    #[error("the slice {missing:?} is missing between {before:?} and {after:?}")]
    Gap {
        /// Name that the file would have.
        missing: String,
        /// Name of the file before it.
        before: String,
        /// Name of the file behind it.
        after: String,
    },
    /// Two files have the same number.
    #[error("{one:?} and {other:?} have the same number: move one of them away")]
    Twice {
        /// One file.
        one: String,
        /// The other.
        other: String,
    },
    /// A slice that is not like the first one.
    #[error("{file:?} has {found}, but {first:?} has {expected}: slices of a stack are alike")]
    Differs {
        /// The file.
        file: String,
        /// What it has.
        found: String,
        /// Name of the first file.
        first: String,
        /// What that one has.
        expected: String,
    },
}

impl SlicesError {
    fn of(self, path: &Path) -> ReadError {
        ReadError::Slices { path: path.to_owned(), cause: self }
    }
}

/// Opens a file of a stack.
type Opener = Box<dyn Fn(&Path) -> Result<Box<dyn Source>, ReadError> + Send>;

/// The files that a path stands for, if it is a folder or a pattern; `None` if it is a file.
///
/// In a folder those files count that have the name of a format of planes, or all if `is_any`.
///
/// # Errors
/// [`ReadError::Slices`]: there are none, or some are missing or too many.
pub(super) fn files(path: &Path, is_any: bool) -> Result<Option<Vec<PathBuf>>, ReadError> {
    if let Some(pattern) = Pattern::of_path(path) {
        return pattern.files(path).map(Some);
    }
    if !path.is_dir() {
        return Ok(None);
    }
    let format_of = |file: &Path| match format::of_path(file).map(Format::format) {
        _ if is_any => Some(FileFormat::Raw),
        found @ Some(FileFormat::Png | FileFormat::Pgm | FileFormat::Tiff) => found,
        _ => None,
    };
    names::files_in(path, &format_of).map(Some)
}

/// Opens a stack of files, each with `open`.
///
/// # Errors
/// [`ReadError`]: a file cannot be read, or is not like the first one.
///
/// Cost: that of opening every file. One is open at a time.
pub(super) fn open(path: &Path, files: Vec<PathBuf>, open: Opener) -> Result<Box<dyn Source>, ReadError> {
    let slice = open(&files[0])?.header().clone();
    let too_large = || ReadError::TooLarge { path: path.to_owned(), bytes: u64::MAX };
    let depth = slice.extent[2].checked_mul(files.len() as u64).ok_or_else(too_large)?;
    let metadata = axes::stacked(&slice.metadata);
    let header = Header { extent: [slice.extent[0], slice.extent[1], depth], metadata, ..slice.clone() };
    let file_bytes = slice.bytes().ok_or_else(too_large)?;
    let bytes = header.bytes().ok_or_else(too_large)?;
    let path = path.to_owned();
    let mut stack = Stack { header, slice, path, files, open, current: None, file_bytes, bytes, at: 0 };
    if stack.slice.steps > 1 {
        return Err(stack.differs(0, format!("{} time steps", stack.slice.steps), "one volume".to_owned()));
    }
    for index in 1..stack.files.len() {
        stack.enter(index)?;
    }
    Ok(Box::new(stack))
}

/// Files as slices of one data set.
struct Stack {
    header: Header,
    /// Header of each file.
    slice: Header,
    path: PathBuf,
    files: Vec<PathBuf>,
    open: Opener,
    /// The file that is open.
    current: Option<(usize, Box<dyn Source>)>,
    file_bytes: u64,
    bytes: u64,
    at: u64,
}

impl Stack {
    /// Opens file `index`, which has to be like the first one, unless it is open.
    fn enter(&mut self, index: usize) -> Result<&mut Box<dyn Source>, ReadError> {
        if self.current.as_ref().is_none_or(|(current, _)| *current != index) {
            self.current = None;
            let source = (self.open)(&self.files[index])?;
            let [found, expected] = [source.header(), &self.slice].map(shape);
            if found != expected {
                return Err(self.differs(index, found, expected));
            }
            self.current = Some((index, source));
        }
        let (_, source) = self.current.as_mut().expect("it was opened above");
        Ok(source)
    }

    fn differs(&self, index: usize, found: String, expected: String) -> ReadError {
        let [file, first] = [index, 0].map(|index| {
            let name = self.files[index].file_name().unwrap_or_default();
            name.to_string_lossy().into_owned()
        });
        SlicesError::Differs { file, found, first, expected }.of(&self.path)
    }
}

/// Extent and type of a slice in words: `512x512 u16`, `640x480 u8 of 3 components`.
fn shape(header: &Header) -> String {
    let [x, y, z] = header.extent;
    let mut text = format!("{x}x{y}");
    if z > 1 {
        text += &format!("x{z}");
    }
    text += &format!(" {}", header.element);
    if header.components > 1 {
        text += &format!(" of {} components", header.components);
    }
    if header.steps > 1 {
        text += &format!(" in {} time steps", header.steps);
    }
    text
}

impl Source for Stack {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&mut self, mut out: &mut [u8]) -> Result<(), ReadError> {
        if out.len() as u64 > self.bytes.saturating_sub(self.at) {
            return Err(ReadError::BeyondEnd { path: self.path.clone() });
        }
        while !out.is_empty() {
            let (index, start) = (self.at / self.file_bytes, self.at % self.file_bytes);
            let count = (self.file_bytes - start).min(out.len() as u64);
            let (now, later) = out.split_at_mut(count as usize);
            let source = self.enter(index as usize)?;
            source.seek(start)?;
            source.read(now)?;
            self.at += count;
            out = later;
        }
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.at = position;
        Ok(())
    }

    fn is_random(&self) -> bool {
        true
    }

    fn files(&self) -> Vec<PathBuf> {
        self.files.clone()
    }
}

/// Begins a stack of files of one slice each, which appear together; in a new folder if that is not there yet.
///
/// # Errors
/// [`WriteError`]: the format cannot hold such slices, some of such a name are there already, or the system refuses.
pub(super) fn create(
    path: &Path,
    pattern: Pattern,
    format: &'static dyn Format,
    header: &Header,
    options: WriteOptions,
) -> Result<Created, WriteError> {
    if header.steps > 1 {
        let what = "time steps slice by slice: write one file, such as .tif or .nrrd".to_owned();
        return Err(WriteError::CannotHold { path: path.to_owned(), format: format.format(), what });
    }
    if let Some((count, first)) = pattern.found() {
        return Err(WriteError::SlicesExist { path: path.to_owned(), count, first });
    }
    let folder = AtomicFolder::create(pattern.folder())
        .map_err(|cause| WriteError::Io { path: path.to_owned(), cause })?;
    let (metadata, has_third) = axes::sliced(&header.metadata);
    let slice = Header { extent: [header.extent[0], header.extent[1], 1], metadata, ..header.clone() };
    let mut sink = Slices {
        pattern,
        format,
        metadata: header.metadata.clone(),
        slice_bytes: slice.bytes().unwrap_or(u64::MAX),
        slice,
        options,
        folder,
        path: path.to_owned(),
        count: header.extent[2],
        index: 0,
        filled: 0,
        current: None,
    };
    let mut losses = sink.begin()?;
    if has_third {
        losses.push("what is said of the axis z".to_owned());
    }
    Ok(Created { sink: Box::new(sink), losses })
}

/// A sink of slices into a file each.
struct Slices {
    pattern: Pattern,
    format: &'static dyn Format,
    /// Metadata of the whole.
    metadata: Metadata,
    /// Header of a slice.
    slice: Header,
    slice_bytes: u64,
    options: WriteOptions,
    folder: AtomicFolder,
    path: PathBuf,
    count: u64,
    /// Which slice is next, and how many of its bytes were written.
    index: u64,
    filled: u64,
    current: Option<Box<dyn Sink>>,
}

impl Slices {
    /// Begins slice `index` and tells what its format loses.
    fn begin(&mut self) -> Result<Vec<String>, WriteError> {
        let name = self.pattern.name(self.index, self.count);
        let of_slice = self.metadata.of_part([0, 0, self.index], 1);
        let slice = Header { metadata: axes::sliced(&of_slice).0, ..self.slice.clone() };
        let created = self.format.create(&self.folder.path().join(name), &slice, &self.options);
        let created = created.map_err(|error| error.at(&self.path))?;
        self.current = Some(created.sink);
        Ok(created.losses)
    }

    fn end(&mut self) -> Result<(), WriteError> {
        if let Some(current) = self.current.take() {
            current.finish().map_err(|error| error.at(&self.path))?;
        }
        self.index += 1;
        self.filled = 0;
        Ok(())
    }
}

impl Sink for Slices {
    fn write(&mut self, mut values: &[u8]) -> Result<(), WriteError> {
        while !values.is_empty() {
            if self.current.is_none() && self.index < self.count {
                self.begin()?;
            }
            let (now, later) =
                values.split_at((self.slice_bytes - self.filled).min(values.len() as u64) as usize);
            let Some(current) = &mut self.current else { return Err(self.wrong_count(values.len() as u64)) };
            current.write(now).map_err(|error| error.at(&self.path))?;
            self.filled += now.len() as u64;
            if self.filled == self.slice_bytes {
                self.end()?;
            }
            values = later;
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), WriteError> {
        if self.index < self.count {
            return Err(self.wrong_count(0));
        }
        let Self { folder, path, .. } = *self;
        folder.commit().map_err(|cause| WriteError::Io { path, cause })
    }
}

impl Slices {
    fn wrong_count(&self, more: u64) -> WriteError {
        let expected = self.slice_bytes.saturating_mul(self.count);
        let found = self.slice_bytes.saturating_mul(self.index) + self.filled + more;
        WriteError::SampleBytes { path: self.path.clone(), expected, found }
    }
}

#[cfg(test)]
mod tests;
