//! VTK's images on regular grids: legacy files (`.vtk`, `STRUCTURED_POINTS`) and XML files (`.vti`, `ImageData`).
//!
//! Source: *VTK File Formats* (Kitware), and the classes `vtkDataReader`, `vtkXMLDataParser` and `vtkImageData` where
//! it is silent. An image may lie in pieces, also in several files that `.pvti` lists. A file has any number of arrays for points and for cells; a data set is one of them, which `#name`
//! behind the path names. Values of a point lie together and x varies fastest, as everywhere here.

mod array;
mod blocks;
mod body;
mod bytes;
mod error;
mod grid;
mod legacy;
mod parts;
mod sink;
mod text;
mod xml;

use std::path::{Path, PathBuf};

pub use error::VtkError;

use super::format::{Format, array_of, has_extension};
use super::input::Input;
use super::{Created, FileFormat, Header, ReadError, Source, WriteError, WriteOptions};

/// The format of lines of text with binary or decimal samples between them.
pub(super) struct VtkLegacy;

impl Format for VtkLegacy {
    fn format(&self) -> FileFormat {
        FileFormat::VtkLegacy
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(&split(path).0, &["vtk"])
    }

    fn begins(&self, first: &[u8]) -> bool {
        first.starts_with(legacy::MAGIC.as_bytes())
    }

    fn open(&self, path: &Path) -> Result<Box<dyn Source>, ReadError> {
        let (path, name) = split(path);
        legacy::open(Input::open(&path)?, name.as_deref())
    }

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        legacy::open(input, None)
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        one_step(path, self.format(), header)?;
        let (path, name) = split(path);
        legacy::create(&path, header, options, name.as_deref())
    }
}

/// The format of markup with samples in it, or behind it.
pub(super) struct VtkXml;

impl Format for VtkXml {
    fn format(&self) -> FileFormat {
        FileFormat::VtkXml
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(&split(path).0, &["vti", "pvti"])
    }

    fn begins(&self, first: &[u8]) -> bool {
        let text = String::from_utf8_lossy(first);
        let declared = text.strip_prefix("<?xml").and_then(|rest| rest.split_once("?>"));
        declared.map_or(&*text, |(_, rest)| rest.trim_start()).starts_with("<VTKFile")
    }

    fn compresses(&self, _: &Path) -> bool {
        true
    }

    fn open(&self, path: &Path) -> Result<Box<dyn Source>, ReadError> {
        let (path, name) = split(path);
        xml::open(Input::open(&path)?, name.as_deref())
    }

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        xml::open(input, None)
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        one_step(path, self.format(), header)?;
        let (path, name) = split(path);
        if has_extension(&path, &["pvti"]) {
            return Err(WriteError::Foreign { path, what: "a list of pieces (.pvti)" });
        }
        xml::create(&path, header, options, name.as_deref())
    }
}

/// Parts a path from the name of an array behind it.
fn split(path: &Path) -> (PathBuf, Option<String>) {
    array_of(path, &["vtk", "vti", "pvti"])
}

fn one_step(path: &Path, format: FileFormat, header: &Header) -> Result<(), WriteError> {
    if header.steps == 1 {
        return Ok(());
    }
    let what = format!("{} time steps: write each into a file of its own", header.steps);
    Err(WriteError::CannotHold { path: path.to_owned(), format, what })
}

#[cfg(test)]
mod tests;
