//! Boxes along the axes.

use crate::mesh::Point;

/// The points between two corners, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub low: Point,
    /// Largest coordinates.
    pub high: Point,
}

impl Bounds {
    /// No point at all: what any box is joined with first.
    pub const NONE: Self = Self { low: Point::INFINITY, high: Point::NEG_INFINITY };

    /// The smallest box around points.
    pub fn around(points: impl IntoIterator<Item = Point>) -> Self {
        points.into_iter().fold(Self::NONE, |bounds, point| Self {
            low: bounds.low.min(point),
            high: bounds.high.max(point),
        })
    }

    /// The smallest box around two boxes.
    pub fn joined(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Length from corner to corner; 0 if there is no point.
    pub fn diagonal(&self) -> f64 {
        (self.high - self.low).max(Point::ZERO).length()
    }

    /// The point in the middle.
    pub fn centre(&self) -> Point {
        (self.low + self.high) * 0.5
    }

    /// Whether two boxes have a point in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }

    /// Squared distance of a point; 0 inside.
    pub fn distance_squared(&self, point: Point) -> f64 {
        (self.low - point).max(point - self.high).max(Point::ZERO).length_squared()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_the_nearest_side_edge_or_corner() {
        let unit = Bounds::around([Point::ONE, Point::ZERO]);
        let distance = |x, y, z| unit.distance_squared(Point::new(x, y, z));
        assert_eq!(distance(0.5, 1.0, 0.0), 0.0);
        assert_eq!(distance(0.5, 3.0, 0.5), 4.0);
        assert_eq!(distance(-1.0, 3.0, 0.5), 5.0);
        assert_eq!(distance(-1.0, 3.0, 1.5), 5.25);
        assert_eq!(unit.diagonal(), 3.0_f64.sqrt());
        assert_eq!(Bounds::NONE.diagonal(), 0.0);
    }

    #[test]
    fn boxes_that_touch_overlap() {
        let unit = Bounds::around([Point::ONE, Point::ZERO]);
        let moved = |x| Bounds { low: unit.low + Point::X * x, high: unit.high + Point::X * x };
        assert!(unit.overlaps(&moved(1.0)));
        assert!(!unit.overlaps(&moved(1.5)));
        assert_eq!(unit.joined(moved(1.0)).high, Point::new(2.0, 1.0, 1.0));
        assert_eq!(unit.joined(Bounds::NONE), unit);
    }
}
