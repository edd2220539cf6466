//! DICOM files: a folder of one series, sorted by position, or one file of one frame or many.
//!
//! Sources: DICOM PS3.3, sections C.7.6.2 (image plane) and C.7.6.3 (image pixel); PS3.5, annex G (run lengths).
//! Stored values are kept: no rescaling, no inversion of MONOCHROME1, no palette.

mod dataset;
mod elements;
mod frame;
mod series;
#[cfg(test)]
mod tests;
mod write;

use std::path::{Path, PathBuf};

use dataset::{DataSet, Tag};
use series::Series;

use super::format::{Format, has_extension};
use super::input::Input;
use super::planes::{PlaneSource, Planes};
use super::slices::Pattern;
use super::{Created, FileFormat, Header, ReadError, Source, WriteError, WriteOptions};

/// Position of the first sample of a frame (Image Position (Patient)).
const POSITION: Tag = 0x0020_0032;

/// What keeps files from being read as a volume. Texts from files are quoted and shortened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DicomError {
    /// The first bytes are others.
    #[error("no DICOM file: DICM does not stand behind its first 128 bytes")]
    Magic,
    /// A file that ends early, or that says what cannot be.
    #[error("{what} is damaged or cut short")]
    Damaged {
        /// What part.
        what: &'static str,
    },
    /// A report, a plan, a directory.
    #[error("it has no pixels")]
    NoPixels,
    /// A transfer syntax that is not read.
    #[error(
        "the transfer syntax {uid} ({name}) is not read: decompress it with `{}`",
        if *name == "JPEG-LS" { "dcmdjpls" } else { "gdcmconv --raw" }
    )]
    Syntax {
        /// Its identifier.
        uid: String,
        /// Its name.
        name: &'static str,
    },
    /// A file that is deflated could not be decompressed.
    #[error("cannot use a temporary file: {cause}")]
    Temporary {
        /// What the system said.
        cause: String,
    },
    /// Pixels of a kind that is not read.
    #[error("its pixels have {what}, which is not read")]
    Pixels {
        /// What they have.
        what: String,
    },
    /// More or fewer bytes of pixels than its extent says.
    #[error("its pixels take {found} bytes, where {expected} are needed: it is damaged")]
    PixelBytes {
        /// Bytes or frames that are there.
        found: u64,
        /// Those that are needed.
        expected: u64,
    },
    /// More or fewer frames than it says.
    #[error(
        "it has {found} frames or parts of them, and says {expected}: frames of several parts are not read"
    )]
    Frames {
        /// Those that are there.
        found: u64,
        /// Those that it says.
        expected: u64,
    },
    /// A frame of JPEG that cannot be decoded, or is another one.
    #[error(
        "a frame of JPEG is not what it should be: {cause}: decompress it with `dcmdjpeg` or `gdcmconv --raw`"
    )]
    Jpeg {
        /// What is wrong with it.
        cause: String,
    },
    /// Files of several series.
    #[error("holds several series; give one as FOLDER/SERIES:{list}")]
    SeveralSeries {
        /// A line for each: identifier, number of files, description.
        list: String,
    },
    /// No file of such a series.
    #[error("there is no DICOM file with pixels of this name, in this folder or series")]
    NoFiles,
    /// A file unlike the first.
    #[error(
        "{file:?} has {found}, {first:?} has {expected}: they make no volume; move one of them elsewhere"
    )]
    Differs {
        /// The file.
        file: String,
        /// What it has.
        found: String,
        /// The first file.
        first: String,
        /// What that one has.
        expected: String,
    },
    /// Slices in the same place, but not as many in each.
    #[error(
        "{before:?} and {after:?} are {found} mm apart, others {usual} mm: a copy, or a time step or echo that does not \
         have all slices; move it elsewhere"
    )]
    Crowded {
        /// A file.
        before: String,
        /// The one behind it.
        after: String,
        /// Their distance.
        found: String,
        /// The distance of most.
        usual: String,
    },
    /// Slices that do not follow each other.
    #[error("a slice is missing: {before:?} and {after:?} are {found} mm apart, others {usual} mm")]
    Gap {
        /// A file.
        before: String,
        /// The one behind it.
        after: String,
        /// Their distance.
        found: String,
        /// The distance of most.
        usual: String,
    },
}

/// Digital Imaging and Communications in Medicine.
pub(super) struct Dicom;

impl Format for Dicom {
    fn format(&self) -> FileFormat {
        FileFormat::Dicom
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(path, &["dcm", "dicom", "ima"])
            || names_series(path)
            || path.is_dir() && holds_series(path)
    }

    fn takes_folders(&self) -> bool {
        true
    }

    fn begins(&self, first: &[u8]) -> bool {
        first.get(128..132) == Some(b"DICM".as_slice())
    }

    fn open(&self, path: &Path) -> Result<Box<dyn Source>, ReadError> {
        let (folder, uid) = match names_series(path) {
            true => (path.parent().unwrap_or(path), path.file_name().and_then(|name| name.to_str())),
            false => (path, None),
        };
        let files = match Pattern::of_path(folder) {
            Some(pattern) => pattern.all(path)?,
            None if folder.is_dir() => Pattern::any_in(folder).all(path)?,
            None => return self.open_input(Input::open(path)?),
        };
        open_series(path, files, uid)
    }

    fn open_input(&self, mut input: Input) -> Result<Box<dyn Source>, ReadError> {
        let path = input.path().to_owned();
        let set = DataSet::read(&mut input).map_err(|cause| fault(&path, cause))?;
        open_sets(&path, vec![(path.clone(), set)], Some(input))
    }

    fn create(&self, path: &Path, header: &Header, _: &WriteOptions) -> Result<Created, WriteError> {
        write::create(path, header)
    }
}

fn fault(path: &Path, cause: DicomError) -> ReadError {
    ReadError::Format { path: path.to_owned(), format: FileFormat::Dicom, cause: Box::new(cause) }
}

/// Whether a path is a folder and the identifier of a series in it.
fn names_series(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let is_uid = name.contains('.') && name.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    is_uid && !path.exists() && path.parent().is_some_and(Path::is_dir)
}

/// Whether one of the first files of a folder is a DICOM file.
fn holds_series(folder: &Path) -> bool {
    let files = Pattern::any_in(folder).all(folder).unwrap_or_default();
    files.iter().take(16).any(|file| is_dicom(file))
}

fn is_dicom(file: &Path) -> bool {
    let Ok(mut input) = Input::open(file) else { return false };
    input.left().is_some_and(|left| left > 132)
        && input.seek(128).is_ok()
        && input.starts_with(b"DICM").unwrap_or(false)
}

/// Opens those files that are of one series.
fn open_series(path: &Path, files: Vec<PathBuf>, uid: Option<&str>) -> Result<Box<dyn Source>, ReadError> {
    let mut sets = Vec::new();
    for file in files.into_iter().filter(|file| is_dicom(file)) {
        match DataSet::read(&mut Input::open(&file)?) {
            Ok(set) => sets.push((file, set)),
            // Directories and reports lie beside images.
            Err(DicomError::NoPixels) => {}
            Err(cause) => return Err(fault(&file, cause)),
        }
    }
    let sets = series::one_of(sets, uid).map_err(|cause| fault(path, cause))?;
    open_sets(path, sets, None)
}

fn open_sets(
    path: &Path,
    sets: Vec<(PathBuf, DataSet)>,
    input: Option<Input>,
) -> Result<Box<dyn Source>, ReadError> {
    let series = Series::of(sets).map_err(|cause| fault(path, cause))?;
    let header = series.header();
    let current = input.map(|input| (0, input));
    Ok(Box::new(PlaneSource::new(path, header, Stack { series, current })?))
}

/// Frames of a series.
struct Stack {
    series: Series,
    /// The file that is open.
    current: Option<(usize, Input)>,
}

impl Planes for Stack {
    fn read(&mut self, index: u64, out: &mut [u8]) -> Result<(), ReadError> {
        let (file, frame) = self.series.place(index);
        if self.current.as_ref().is_none_or(|(current, _)| *current != file) {
            let mut input = Input::open(self.series.path(file))?;
            if self.series.layout(file).is_deflated {
                let path = input.path().to_owned();
                DataSet::read(&mut input).map_err(|cause| fault(&path, cause))?;
            }
            self.current = Some((file, input));
        }
        let Some((_, input)) = &mut self.current else { return Ok(()) };
        let path = input.path().to_owned();
        self.series.layout(file).read(input, frame, out).map_err(|cause| fault(&path, cause))
    }

    fn files(&self) -> Option<Vec<PathBuf>> {
        Some(self.series.files())
    }
}
