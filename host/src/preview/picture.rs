//! Values of a picture, and its PNG file.

use std::io;
use std::path::{Path, PathBuf};

use super::Window;
use crate::atomic::AtomicFile;
use crate::volume::{ElementType, in_words};

/// Pixels with the values of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels to the right and down.
    pub size: [u32; 2],
    /// Values of a pixel: 1, or 3 for red, green and blue.
    pub channels: usize,
    /// Type of the samples.
    pub element: ElementType,
    /// Row by row from the top, the values of a pixel together.
    pub values: Vec<f64>,
    /// Width and height of a pixel in one unit, if they are known.
    pub pixel: Option<[f64; 2]>,
}

/// Bits of a channel of a PNG file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depth {
    /// 256 shades.
    #[default]
    Eight,
    /// 65,536 shades.
    Sixteen,
}

/// Why a picture could not be written. Nothing has changed at its path then.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot write: {}", path.display(), in_words(cause))]
pub struct PreviewError {
    /// File in question.
    pub path: PathBuf,
    /// What the system said.
    pub cause: io::Error,
}

impl Picture {
    /// The window that shows most pictures well: colors of 8 bits as they are, all else by percentiles.
    pub fn usual_window(&self) -> Window {
        match (self.channels, self.element) {
            (3, ElementType::U8) => Window::Values(0.0, 255.0),
            _ => Window::default(),
        }
    }

    /// The picture with black and white at the ends of a window, as samples of a PNG file; NaN is black.
    pub fn shades(&self, window: Window, depth: Depth) -> Vec<u8> {
        let [low, high] = window.ends(&self.values);
        let share = |value: f64| {
            if value >= high && high > low || value > high {
                1.0
            } else if value > low {
                (value - low) / (high - low)
            } else {
                0.0
            }
        };
        let shares = self.values.iter().map(|&value| share(value));
        match depth {
            Depth::Eight => shares.map(|share| (share * 255.0).round() as u8).collect(),
            Depth::Sixteen => {
                shares.flat_map(|share| ((share * 65535.0).round() as u16).to_be_bytes()).collect()
            }
        }
    }

    /// Writes a PNG file; programs that know of it show pixels in the shape that they have.
    ///
    /// # Errors
    /// As the system says.
    pub fn write_png(&self, path: &Path, window: Window, depth: Depth) -> Result<(), PreviewError> {
        let written = AtomicFile::create(path).and_then(|mut file| {
            let mut encoder = png::Encoder::new(&mut file, self.size[0], self.size[1]);
            encoder.set_color(if self.channels == 3 {
                png::ColorType::Rgb
            } else {
                png::ColorType::Grayscale
            });
            encoder.set_depth(match depth {
                Depth::Eight => png::BitDepth::Eight,
                Depth::Sixteen => png::BitDepth::Sixteen,
            });
            encoder.set_pixel_dims(self.pixel.and_then(dimensions));
            let mut writer = encoder.write_header()?;
            writer.write_image_data(&self.shades(window, depth))?;
            writer.finish()?;
            file.commit()
        });
        written.map_err(|cause| PreviewError { path: path.to_owned(), cause })
    }
}

/// The shape of pixels: how many of them there are per unit.
fn dimensions(pixel: [f64; 2]) -> Option<png::PixelDimensions> {
    let smaller = pixel[0].min(pixel[1]);
    let per_unit = pixel.map(|side| (smaller / side * 10_000.0).round());
    let is_shape = pixel[0] != pixel[1] && per_unit.iter().all(|count| *count >= 1.0 && *count <= 10_000.0);
    is_shape.then(|| png::PixelDimensions {
        xppu: per_unit[0] as u32,
        yppu: per_unit[1] as u32,
        unit: png::Unit::Unspecified,
    })
}
