//! The volumes to measure, as `cargo xtask bench` lists them.

use std::error::Error;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use wavelift_host::volume::{self, RankedExtent, RawLayout, Volume};

/// A raw file, little-endian.
#[derive(Deserialize)]
pub(crate) struct Listed {
    pub(crate) name: String,
    path: PathBuf,
    extent: [u64; 3],
    #[serde(rename = "type")]
    element: String,
    /// Errors to allow, beside none.
    pub(crate) bounds: Vec<Bound>,
}

/// The largest error that a sample may have.
#[derive(Deserialize)]
pub(crate) struct Bound {
    /// What the record calls coding within it.
    pub(crate) task: String,
    pub(crate) absolute: f64,
}

pub(crate) fn read(path: &Path) -> Result<Vec<Listed>, Box<dyn Error>> {
    Ok(serde_json::from_str(&std::fs::read_to_string(path)?)?)
}

impl Listed {
    pub(crate) fn volume(&self) -> Result<Volume, Box<dyn Error>> {
        let [x, y, z] = self.extent;
        let extent: RankedExtent = format!("{x}x{y}x{z}").parse()?;
        let layout = RawLayout::new(extent, self.element.parse()?);
        Ok(volume::read(&self.path, Some(&layout))?)
    }
}
