//! Zarr arrays of versions 2 and 3, and images of OME-Zarr 0.4 and 0.5, in folders; read and written through `zarrs`.
//!
//! Sources: *Zarr core specification* (Zarr community), versions 2 and 3; *OME-Zarr specification* (Open Microscopy
//! Environment). A path means the array that it leads to; an image stands for its full resolution, and another level
//! is named by its path, as in `cells.ome.zarr/2`.
//!
//! Written is version 3: an image of OME-Zarr 0.5 with one level where the name ends in `.ome.zarr`, else an array
//! with named axes. Either keeps every line of metadata, in the attribute `nrrd`.

mod bounded;
mod boxes;
mod error;
mod layout;
mod lines;
mod node;
mod ome;
mod sink;
mod source;
mod store;

use std::path::Path;

pub use error::ZarrError;

use super::format::{Format, has_extension};
use super::input::Input;
use super::{Created, FileFormat, Header, ReadError, Source, WriteError, WriteOptions};

/// Folders of chunks.
pub(super) struct Zarr;

impl Format for Zarr {
    fn format(&self) -> FileFormat {
        FileFormat::Zarr
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(path, &["zarr"]) || node::is_node(path)
    }

    fn takes_folders(&self) -> bool {
        true
    }

    fn compresses(&self, _: &Path) -> bool {
        true
    }

    fn open(&self, path: &Path) -> Result<Box<dyn Source>, ReadError> {
        source::open(path)
    }

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        source::open(input.path())
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        let sink = sink::create(path, header, options)?;
        Ok(Created { sink: Box::new(sink), losses: Vec::new() })
    }
}

#[cfg(test)]
mod tests;
