//! Triangles into samples.

use rayon::prelude::*;

use super::camera::View;
use super::{Color, Image};
use crate::mesh::{Surface, Triangulation};

/// Rows of samples that one thread fills.
const BAND: usize = 32;

/// What is seen in a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fragment {
    /// One over its depth: 0 is as far as can be.
    inverse_depth: f32,
    /// Distance from the closest side of its face, in samples.
    pub(super) to_side: f32,
    /// Nothing where the background is seen.
    pub(super) triangle: Option<u32>,
    pub(super) is_back: bool,
}

const NOTHING: Fragment =
    Fragment { inverse_depth: 0.0, to_side: f32::INFINITY, triangle: None, is_back: false };

/// A triangle in the picture.
#[derive(Clone, Copy, Debug)]
struct Flat {
    index: u32,
    is_back: bool,
    corners: [[f64; 3]; 3],
    /// Whether each side, from a corner to the next, is one of the face and not a cut.
    sides: [bool; 3],
}

/// Triangles in bands of rows.
#[derive(Debug)]
pub(super) struct Raster {
    size: [usize; 2],
    flats: Vec<Flat>,
    /// Places in `flats`, in order, of those that reach into each band.
    bands: Vec<Vec<u32>>,
}

impl Raster {
    pub(super) fn new(surface: &impl Surface, cut: &Triangulation, view: &View, size: [usize; 2]) -> Self {
        let places: Vec<[f64; 3]> = surface.points().par_iter().map(|&point| view.project(point)).collect();
        let mut flats = Vec::with_capacity(cut.triangles.len());
        let mut bands = vec![Vec::new(); size[1].div_ceil(BAND)];
        let mut next = 0;
        for (face, corners) in surface.polygons().enumerate() {
            let triangles = corners.len() - 2;
            for (step, triangle) in cut.triangles[next..next + triangles].iter().enumerate() {
                let sides = [step == 0, true, step + 1 == triangles];
                let found = triangle.map(|corner| places[corner as usize]);
                debug_assert_eq!(cut.faces[next + step] as usize, face);
                let Some(flat) = Flat::new((next + step) as u32, found, sides) else { continue };
                let [low, high] = flat.rows(size[1]);
                let last = high.div_ceil(BAND).max(low / BAND);
                bands[low / BAND..last].iter_mut().for_each(|band| band.push(flats.len() as u32));
                flats.push(flat);
            }
            next += triangles;
        }
        Self { size, flats, bands }
    }

    /// Colors the samples, and averages as many along x and y into a pixel.
    pub(super) fn image(&self, samples: usize, color: impl Fn(&Fragment) -> Color + Sync) -> Image {
        let [width, height] = self.size.map(|side| side / samples);
        let mut pixels = vec![0; 3 * width * height];
        pixels.par_chunks_mut(3 * width * (BAND / samples)).enumerate().for_each(|(band, pixels)| {
            let mut fragments = vec![NOTHING; self.size[0] * BAND];
            for &flat in &self.bands[band] {
                self.flats[flat as usize].fill(&mut fragments, self.size[0], band * BAND);
            }
            for (row, pixels) in pixels.chunks_exact_mut(3 * width).enumerate() {
                for (column, pixel) in pixels.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                    let mut sums = [0_u32; 3];
                    for sample in 0..samples * samples {
                        let (x, y) = (column * samples + sample % samples, row * samples + sample / samples);
                        let Color(channels) = color(&fragments[y * self.size[0] + x]);
                        sums.iter_mut().zip(channels).for_each(|(sum, channel)| *sum += u32::from(channel));
                    }
                    let count = (samples * samples) as u32;
                    *pixel = sums.map(|sum| ((sum + count / 2) / count) as u8);
                }
            }
        });
        Image { size: [width as u32, height as u32], pixels }
    }
}

impl Flat {
    /// Nothing if the triangle has no area in the picture.
    fn new(index: u32, mut corners: [[f64; 3]; 3], mut sides: [bool; 3]) -> Option<Self> {
        let area = turn(corners[0], corners[1], corners[2]);
        if area == 0.0 || !area.is_finite() {
            return None;
        }
        // With y down, what looks at the eye runs clockwise in numbers.
        let is_back = area > 0.0;
        if !is_back {
            corners.swap(1, 2);
            sides.swap(0, 2);
        }
        Some(Self { index, is_back, corners, sides })
    }

    /// Rows of samples that it may cover: from the first up to the last, that excluded.
    fn rows(&self, height: usize) -> [usize; 2] {
        self.span(1, height)
    }

    fn span(&self, axis: usize, count: usize) -> [usize; 2] {
        let [a, b, c] = self.corners.map(|corner| corner[axis]);
        let [low, high] = [a.min(b).min(c) - 0.5, a.max(b).max(c) + 0.5];
        let limit = |value: f64| value.clamp(0.0, count as f64) as usize;
        let low = limit(low.ceil()).min(count - 1);
        [low, limit(high.floor()).max(low)]
    }

    /// Columns of a row that it may cover, of those from `left` to `right`: one more on both sides than its sides leave.
    fn columns(&self, row: usize, [left, right]: [usize; 2]) -> [usize; 2] {
        let [a, b, c] = self.corners;
        let (mut low, mut high) = (left as f64, right as f64);
        for [from, to] in [[b, c], [c, a], [a, b]] {
            let rise = to[1] - from[1];
            let crossing = from[0] + (to[0] - from[0]) * ((row as f64 + 0.5 - from[1]) / rise);
            // It lies to the left of sides that go down the screen, as it runs clockwise.
            if rise > 0.0 {
                high = high.min(crossing + 1.5);
            } else if rise < 0.0 {
                low = low.max(crossing - 1.5);
            }
        }
        // Numbers beyond all bounds are cut.
        let low = (low as usize).clamp(left, right);
        [low, (high as usize).clamp(low, right)]
    }

    /// Puts itself into the samples of a band that it covers and nothing is before it.
    fn fill(&self, fragments: &mut [Fragment], width: usize, first_row: usize) {
        let [a, b, c] = self.corners;
        let opposite = [[b, c], [c, a], [a, b]];
        let scale = 1.0 / turn(a, b, c);
        let lengths =
            opposite.map(|[from, to]| ((to[0] - from[0]).powi(2) + (to[1] - from[1]).powi(2)).sqrt());
        // Side `i` runs from corner i, and is opposite corner i + 2.
        let is_side = [self.sides[1], self.sides[2], self.sides[0]];
        let [low, high] = self.span(1, first_row + BAND);
        let [left, right] = self.span(0, width);
        for row in low.max(first_row)..high {
            let line = &mut fragments[(row - first_row) * width..][..width];
            let [left, right] = self.columns(row, [left, right]);
            for (column, fragment) in line[left..right].iter_mut().enumerate() {
                let sample = [(left + column) as f64 + 0.5, row as f64 + 0.5, 0.0];
                let turns = opposite.map(|[from, to]| turn(from, to, sample));
                if turns.iter().any(|&turn| turn < 0.0) {
                    continue;
                }
                let inverse_depth = (turns[0] * a[2] + turns[1] * b[2] + turns[2] * c[2]) * scale;
                if inverse_depth as f32 <= fragment.inverse_depth {
                    continue;
                }
                let distances = [0, 1, 2].map(|corner| {
                    if is_side[corner] { turns[corner] / lengths[corner] } else { f64::INFINITY }
                });
                *fragment = Fragment {
                    inverse_depth: inverse_depth as f32,
                    to_side: distances[0].min(distances[1]).min(distances[2]) as f32,
                    triangle: Some(self.index),
                    is_back: self.is_back,
                };
            }
        }
    }
}

/// Twice the area of a triangle, positive if it runs clockwise on the screen.
fn turn(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slivers_are_looked_for_along_themselves_only() {
        const SIDE: usize = 400;
        let corners = [[3.0, 2.0, 1.0], [390.0, 380.0, 1.0], [388.0, 390.0, 1.0]];
        let flat = Flat::new(0, corners, [true; 3]).expect("it has area");
        let [left, right] = flat.span(0, SIDE);
        let [low, high] = flat.rows(SIDE);
        let looked: usize = (low..high)
            .map(|row| {
                let [from, to] = flat.columns(row, [left, right]);
                to - from
            })
            .sum();
        assert!(looked < 10 * SIDE, "{looked} samples");
    }

    #[test]
    fn all_samples_inside_are_looked_at() {
        const SIDE: usize = 24;
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Halves, so that corners and sides meet samples.
            f64::from(state >> 26) * 0.5 - 4.0
        };
        for _ in 0..2000 {
            let corners = [0; 3].map(|_| [next(), next(), 1.0]);
            let Some(flat) = Flat::new(0, corners, [true; 3]) else { continue };
            let [a, b, c] = flat.corners;
            let span = flat.span(0, SIDE);
            for row in 0..SIDE {
                let [from, to] = flat.columns(row, span);
                for column in (span[0]..span[1]).filter(|column| !(from..to).contains(column)) {
                    let sample = [column as f64 + 0.5, row as f64 + 0.5, 0.0];
                    let turns = [[b, c], [c, a], [a, b]].map(|[from, to]| turn(from, to, sample));
                    assert!(turns.iter().any(|&turn| turn < 0.0), "{corners:?} {sample:?}");
                }
            }
        }
    }
}
