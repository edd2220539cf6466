//! Pictures of surfaces, drawn without a screen: flat faces, a depth buffer, PNG files.

mod camera;
mod file;
mod image;
mod palette;
mod raster;

pub use camera::Camera;
pub use file::PictureError;
pub use image::Image;
pub use palette::{Color, patch_color};

use crate::mesh::{Point, Surface, Triangulation};
use raster::{Fragment, Raster};

/// Samples along each side of a pixel.
const SAMPLES: usize = 2;

/// What a picture shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels along x and y, each from 1 to 16384.
    pub size: [u32; 2],
    /// Where the surface is seen from.
    pub camera: Camera,
    /// Behind the surface.
    pub background: Color,
    /// Faces whose outside is seen, where they have no color of their own.
    pub front: Color,
    /// Faces whose inside is seen.
    pub back: Color,
    /// Width of the sides of faces in pixels; 0 to draw none.
    pub line_width: f64,
}

impl Default for Picture {
    fn default() -> Self {
        Self {
            size: [1024; 2],
            camera: Camera::default(),
            background: Color([255; 3]),
            front: Color([196, 202, 214]),
            back: Color([222, 120, 84]),
            line_width: 0.0,
        }
    }
}

impl Picture {
    /// Draws a surface that fills the picture, each face in its patch's color if `patches` has a number for each face.
    ///
    /// A face is lit from the camera and from above it, on both sides alike. Of faces at the same depth the first one
    /// is seen. Faces without area are not drawn. The same picture comes out for any number of threads.
    ///
    /// Cost: about 1.4 s a million triangles on a busy core or two, in parallel; 16 bytes a sample, of which a pixel has four.
    ///
    /// # Panics
    /// If the size is 0 or above 16384 along an axis, or there are patches for fewer or more faces.
    pub fn draw(&self, surface: &impl Surface, patches: Option<&[u32]>) -> Image {
        assert!(self.size.iter().all(|side| (1..=16384).contains(side)), "1 to 16384 pixels along x and y");
        assert!(patches.is_none_or(|patches| patches.len() == surface.polygons().len()), "one patch a face");
        let samples = self.size.map(|side| side as usize * SAMPLES);
        let view = self.camera.framing(surface.points(), samples);
        let cut = Triangulation::new(surface);
        let raster = Raster::new(surface, &cut, &view, samples);
        let colors: Vec<[Color; 2]> = surface
            .polygons()
            .enumerate()
            .map(|(face, corners)| {
                let front = patches.map_or(self.front, |patches| patch_color(patches[face]));
                let light = light(surface.points(), corners, &view);
                [front.scaled(light), self.back.scaled(light)]
            })
            .collect();
        let line = self.line_width * SAMPLES as f64 * 0.5;
        let color = |fragment: &Fragment| match fragment.triangle {
            None => self.background,
            Some(triangle) => {
                let face = cut.faces[triangle as usize] as usize;
                let color = colors[face][usize::from(fragment.is_back)];
                if f64::from(fragment.to_side) < line { color.scaled(0.35) } else { color }
            }
        };
        raster.image(SAMPLES, color)
    }
}

/// Brightness of a face, from 0.25 to 1: seen from the camera, with some light from above it.
fn light(points: &[Point], corners: &[u32], view: &camera::View) -> f64 {
    let first = points[corners[0] as usize];
    let spokes = || corners[1..].iter().map(|&corner| points[corner as usize] - first);
    let normal: Point = spokes().zip(spokes().skip(1)).map(|(a, b)| a.cross(b)).sum();
    let to_light = view.direction_of(Point::new(0.35, 0.6, 1.0)).normalize_or_zero();
    let towards = normal.normalize_or_zero();
    let head = towards.dot(view.towards_eye(first)).abs();
    let lamp =
        if towards.dot(view.towards_eye(first)) < 0.0 { -towards } else { towards }.dot(to_light).max(0.0);
    0.25 + 0.3 * head + 0.45 * lamp
}

#[cfg(test)]
mod tests;
