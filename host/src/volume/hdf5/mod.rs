//! HDF5, and NetCDF, both the classic one and that which is built on HDF5; read through the crate `netcdf-reader`.
//!
//! Sources: *HDF5 File Format Specification* (The HDF Group); *NetCDF Classic Format Specification* (Unidata). A file has
//! any number of variables, and a data set is one of them: the only one of numbers that has the most axes, or that which
//! is named behind the path, as in `run.h5#fields/density`.

mod error;
mod filters;
mod places;
mod source;
mod variable;

use std::path::{Path, PathBuf};

pub use error::Hdf5Error;

use super::format::{Format, array_of, has_extension};
use super::input::Input;
use super::{Created, FileFormat, Header, ReadError, Source, WriteError, WriteOptions};

/// How HDF5 begins, unless a block of the user's stands before it.
const MAGIC: &[u8] = b"\x89HDF\r\n\x1a\n";

/// How classic NetCDF begins: in its first form, with long offsets, with long counts.
const CLASSIC: [&[u8]; 3] = [b"CDF\x01", b"CDF\x02", b"CDF\x05"];

/// Names of such files. Programs have their own for HDF5: MATLAB `.mat`, Imaris `.ims`.
const EXTENSIONS: [&str; 9] = ["h5", "hdf5", "hdf", "he5", "nc", "nc4", "cdf", "mat", "ims"];

/// The Hierarchical Data Format and the Network Common Data Form, which are read only.
pub(super) struct Hdf5;

impl Format for Hdf5 {
    fn format(&self) -> FileFormat {
        FileFormat::Hdf5
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(&split(path).0, &EXTENSIONS)
    }

    fn begins(&self, first: &[u8]) -> bool {
        first.starts_with(MAGIC) || CLASSIC.iter().any(|magic| first.starts_with(magic))
    }

    fn open(&self, path: &Path) -> Result<Box<dyn Source>, ReadError> {
        let (path, name) = split(path);
        source::open(&Input::open(&path)?, name.as_deref())
    }

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        source::open(&input, None)
    }

    fn create(&self, path: &Path, _: &Header, _: &WriteOptions) -> Result<Created, WriteError> {
        let what = "what wavelift writes, they are only read: write .zarr, .nrrd or .npy".to_owned();
        Err(WriteError::CannotHold { path: path.to_owned(), format: FileFormat::Hdf5, what })
    }
}

/// Parts a path from the name of a variable behind it.
fn split(path: &Path) -> (PathBuf, Option<String>) {
    array_of(path, &EXTENSIONS)
}

#[cfg(test)]
mod tests;
