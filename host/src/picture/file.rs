//! PNG files of pictures.

use std::io;
use std::path::{Path, PathBuf};

use super::Image;
use crate::atomic::AtomicFile;
use crate::volume::in_words;

/// Why a picture could not be written. Nothing has changed at its path then.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot write: {}", path.display(), in_words(cause))]
pub struct PictureError {
    /// File in question.
    pub path: PathBuf,
    /// What the system said.
    pub cause: io::Error,
}

impl Image {
    /// Writes a PNG file of 8 bits a channel.
    ///
    /// # Errors
    /// As the system says.
    pub fn write_png(&self, path: &Path) -> Result<(), PictureError> {
        let written = AtomicFile::create(path).and_then(|mut file| {
            let mut encoder = png::Encoder::new(&mut file, self.size[0], self.size[1]);
            encoder.set_color(png::ColorType::Rgb);
            encoder.set_depth(png::BitDepth::Eight);
            let mut writer = encoder.write_header()?;
            writer.write_image_data(&self.pixels)?;
            writer.finish()?;
            file.commit()
        });
        written.map_err(|cause| PictureError { path: path.to_owned(), cause })
    }
}
