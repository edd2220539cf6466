//! Where a surface is seen from.

use crate::measure::Bounds;
use crate::mesh::Point;

/// A direction to look from. The distance is chosen so that the surface fills the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// From the middle of the surface to the eye.
    pub towards: Point,
    /// What is up in the picture, roughly; not along `towards`.
    pub up: Point,
    /// Tangent of half the angle of view.
    pub half_width: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self { towards: Point::new(0.5, 0.35, 1.0), up: Point::Y, half_width: 0.25 }
    }
}

/// A camera at its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    eye: Point,
    /// Right, up, and towards the eye.
    axes: [Point; 3],
    /// Samples a unit at distance 1.
    scale: f64,
    middle: [f64; 2],
}

/// Share of the picture that stays free at each border.
const BORDER: f64 = 0.03;

impl Camera {
    /// Directions that are none, or along each other, are replaced by others.
    fn axes(&self) -> [Point; 3] {
        let towards = self.towards.try_normalize().unwrap_or(Point::Z);
        let right =
            self.up.cross(towards).try_normalize().unwrap_or_else(|| towards.any_orthonormal_vector());
        [right, towards.cross(right), towards]
    }

    /// Moves the camera to where all points just fit into a picture of so many samples.
    pub(super) fn framing(&self, points: &[Point], samples: [usize; 2]) -> View {
        let axes = self.axes();
        let bounds = Bounds::around(points.iter().copied());
        let centre = if points.is_empty() { Point::ZERO } else { bounds.centre() };
        let [width, height] = samples.map(|side| side as f64);
        let scale = width.min(height) * (0.5 - BORDER) / self.half_width;
        let reach = [width, height].map(|side| side * (0.5 - BORDER) / scale);
        // The eye lies at a height above the middle of the points such that no point is beyond the reach at its depth:
        // for each of the four sides, the farthest plane of that slope that touches the points.
        let farthest = |axis: usize, sign: f64| {
            let touching = points.iter().map(|&point| {
                sign * axes[axis].dot(point - centre) + reach[axis] * axes[2].dot(point - centre)
            });
            touching.fold(f64::NEG_INFINITY, f64::max)
        };
        let mut eye = centre;
        let mut distance = bounds.diagonal().max(f64::MIN_POSITIVE) * 0.01;
        for axis in 0..2 {
            let [low, high] = [farthest(axis, -1.0), farthest(axis, 1.0)];
            if points.is_empty() {
                continue;
            }
            eye += axes[axis] * ((high - low) * 0.5);
            distance = distance.max((high + low) * 0.5 / reach[axis]);
        }
        let nearest = points.iter().map(|&point| axes[2].dot(point - centre)).fold(0.0, f64::max);
        eye += axes[2] * distance.max(nearest + bounds.diagonal() * 0.01);
        View { eye, axes, scale, middle: [width * 0.5, height * 0.5] }
    }
}

impl View {
    /// Place in the picture, x to the right and y down, and one over the depth.
    pub(super) fn project(&self, point: Point) -> [f64; 3] {
        let from_eye = point - self.eye;
        let inverse = -1.0 / self.axes[2].dot(from_eye);
        [
            self.middle[0] + self.axes[0].dot(from_eye) * inverse * self.scale,
            self.middle[1] - self.axes[1].dot(from_eye) * inverse * self.scale,
            inverse,
        ]
    }

    /// Direction from a point to the eye.
    pub(super) fn towards_eye(&self, point: Point) -> Point {
        (self.eye - point).normalize_or_zero()
    }

    /// A direction right, up and towards the eye.
    pub(super) fn direction_of(&self, relative: Point) -> Point {
        self.axes[0] * relative.x + self.axes[1] * relative.y + self.axes[2] * relative.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_fill_the_picture_and_stay_inside() {
        let points: Vec<Point> = (0..8)
            .map(|corner| {
                Point::new(f64::from(corner & 1) * 3.0, f64::from(corner >> 1 & 1), f64::from(corner >> 2))
                    - 50.0
            })
            .collect();
        for samples in [[200, 200], [300, 100], [100, 300]] {
            let view = Camera::default().framing(&points, samples);
            let places: Vec<[f64; 3]> = points.iter().map(|&point| view.project(point)).collect();
            let spans = [0, 1].map(|axis| {
                let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max]
                    .map(|choose| places.iter().map(|place| place[axis]).reduce(choose).unwrap());
                assert!(low >= 0.0 && high <= samples[axis] as f64, "{places:?}");
                (high - low) / (samples[axis] as f64 * (1.0 - 2.0 * BORDER))
            });
            assert!((spans[0].max(spans[1]) - 1.0).abs() < 1e-9, "{spans:?}");
            assert!(places.iter().all(|place| place[2] > 0.0));
        }
    }

    #[test]
    fn useless_directions_are_replaced() {
        for (towards, up) in [(Point::ZERO, Point::Y), (Point::Y, Point::Y), (Point::X, Point::ZERO)] {
            let camera = Camera { towards, up, ..Camera::default() };
            let [right, up, towards] = camera.axes();
            assert!((right.cross(up) - towards).length() < 1e-12);
        }
        let view = Camera::default().framing(&[], [10, 10]);
        assert!(view.project(Point::new(1.0, 2.0, -3.0)).iter().all(|value| value.is_finite()));
    }
}
