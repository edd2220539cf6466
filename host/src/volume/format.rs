//! The formats of files, and how one is known.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

#[cfg(feature = "hdf5")]
use super::hdf5;
use super::input::Input;
#[cfg(feature = "zarr")]
use super::zarr;
use super::{
    Created, Header, ReadError, Source, WriteError, WriteOptions, dicom, metaimage, mgh, mrc, nifti, npy,
    nrrd, png, pnm, tiff, vtk,
};

/// File formats of volumes. New ones go to the end: their places are in compressed files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FileFormat {
    /// Samples only.
    Raw,
    /// NRRD, header attached or detached.
    Nrrd,
    /// NumPy's array file.
    Npy,
    /// MetaImage, header attached or detached.
    MetaImage,
    /// NIfTI, one file or a pair.
    Nifti,
    /// TIFF, of one page or many.
    Tiff,
    /// PNG, one slice a file.
    Png,
    /// Netpbm's pictures, PGM and PPM, and PFM, one slice a file.
    Pgm,
    /// DICOM, a file or a series of them.
    Dicom,
    /// VTK's legacy file of a regular grid.
    VtkLegacy,
    /// VTK's XML file of a regular grid.
    VtkXml,
    /// A folder of Zarr: an array or an image.
    Zarr,
    /// HDF5 or NetCDF, which are read only.
    Hdf5,
    /// MRC, and maps of CCP4.
    Mrc,
    /// FreeSurfer's volumes, which are read only.
    Mgh,
}

impl FileFormat {
    /// Format that a file of this name is written in: by its extension in any case, raw for every unknown one.
    pub fn of_path(path: &Path) -> Self {
        of_path(path).map_or(Self::Raw, Format::format)
    }

    /// Name in messages: `raw`, `NRRD`, `.npy`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Nrrd => "NRRD",
            Self::Npy => ".npy",
            Self::MetaImage => "MetaImage",
            Self::Nifti => "NIfTI",
            Self::Tiff => "TIFF",
            Self::Png => "PNG",
            Self::Pgm => "PGM, PPM or PFM",
            Self::Dicom => "DICOM",
            Self::VtkLegacy => ".vtk",
            Self::VtkXml => ".vti",
            Self::Zarr => "Zarr",
            Self::Hdf5 => "HDF5 or NetCDF",
            Self::Mrc => "MRC",
            Self::Mgh => "FreeSurfer's",
        }
    }
}

/// What is to be known of a format: how to tell it, how to read it, how to write it.
pub(super) trait Format: Sync {
    /// Which one it is.
    fn format(&self) -> FileFormat;

    /// Whether a path is that of such a file, folder or pattern of files.
    fn has_name(&self, path: &Path) -> bool;

    /// Whether a folder or pattern with such a name is one file to this format, and no stack of slices.
    fn takes_folders(&self) -> bool {
        false
    }

    /// Whether a file that begins with these bytes, some thousand if it has so many, is such a file beyond doubt.
    fn begins(&self, _first: &[u8]) -> bool {
        false
    }

    /// Whether samples can be compressed, as [`WriteOptions::gzip`] asks, in a file of this name.
    fn compresses(&self, _path: &Path) -> bool {
        false
    }

    /// Opens a file by its path.
    fn open(&self, path: &Path) -> Result<Box<dyn Source>, ReadError> {
        self.open_input(Input::open(path)?)
    }

    /// Opens a file that was known by its first bytes, none of which is consumed.
    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError>;

    /// The files that are written where one is made at a path, or may be.
    fn writes(&self, path: &Path) -> Vec<PathBuf> {
        vec![path.to_owned()]
    }

    /// Begins a file.
    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError>;
}

/// Every format that has a name or first bytes to be known by.
const FORMATS: &[&dyn Format] = &[
    &nrrd::Nrrd,
    &npy::Npy,
    &npy::Npz,
    &metaimage::MetaImage,
    &mgh::Mgh,
    &mrc::Mrc,
    &nifti::Nifti,
    &tiff::Tiff,
    &png::Png,
    &pnm::Pnm,
    &dicom::Dicom,
    &vtk::VtkLegacy,
    &vtk::VtkXml,
    #[cfg(feature = "zarr")]
    &zarr::Zarr,
    #[cfg(feature = "hdf5")]
    &hdf5::Hdf5,
];

/// The format of a path.
pub(super) fn of_path(path: &Path) -> Option<&'static dyn Format> {
    FORMATS.iter().copied().find(|format| format.has_name(path))
}

/// The format that the first bytes of a file are those of.
pub(super) fn of_first_bytes(input: &mut Input) -> Result<Option<&'static dyn Format>, ReadError> {
    let first = input.first_bytes()?;
    Ok(FORMATS.iter().copied().find(|format| format.begins(first)))
}

/// Whether a path ends in one of these extensions, in any case; `gz` and the like may stand behind one as in `nii.gz`.
pub(super) fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    extensions.iter().any(|extension| name.strip_suffix(extension).is_some_and(|stem| stem.ends_with('.')))
}

/// Parts the path of a file with one of these extensions from the name of an array behind it, as in
/// `flow.vti#pressure`, unless a file has just that name.
pub(super) fn array_of(path: &Path, extensions: &[&str]) -> (PathBuf, Option<String>) {
    let whole = || (path.to_owned(), None);
    let Some((file, name)) = path.to_str().and_then(|text| text.rsplit_once('#')) else { return whole() };
    let is_known = has_extension(Path::new(file), extensions);
    if is_known && !path.exists() { (file.into(), Some(name.to_owned())) } else { whole() }
}

/// Extensions of formats that are not known here, what such a file is, and what to do with one.
const FOREIGN: [(&[&str], &str, &str); 4] = [
    (
        &["h5", "hdf5", "hdf", "nc", "nc4", "cdf", "mat", "ims"],
        "HDF5 or NetCDF",
        "build with the feature hdf5",
    ),
    (&["zip", "tar", "tgz", "7z"], "an archive", "unpack it first"),
    (
        &["rec", "gipl", "mnc", "nd2", "czi", "lif", "oib", "oif", "fits", "fit", "fts"],
        "a file of this kind",
        "save it as .tif, .nrrd or .nii with the program that it comes from",
    ),
    (
        &["jpg", "jpeg", "jp2", "j2k", "jls", "jxl", "bmp", "gif", "webp", "pbm", "pam", "exr", "heic"],
        "a picture of this kind",
        "save it as .png or .tif",
    ),
];

fn foreign(path: &Path) -> Option<[&'static str; 2]> {
    let found = FOREIGN.iter().find(|(extensions, ..)| has_extension(path, extensions));
    found.map(|&(_, what, advice)| [what, advice])
}

/// What to do with a file of no format known here.
pub(super) fn unknown(path: &Path) -> String {
    match foreign(path) {
        Some([what, advice]) => {
            format!("{what} is not read: {advice}; or, if it is a raw file, give its layout")
        }
        None => "a raw file does not say its extent and type, and neither name nor first bytes are those of a format that \
                 is read: give its layout"
            .to_owned(),
    }
}

/// What a file would be taken for that is written with such a name, if that is not what it is.
pub(super) fn mistaken(path: &Path) -> Option<&'static str> {
    foreign(path).map(|[what, _]| what)
}
