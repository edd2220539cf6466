//! The box that a field fills: nothing leaves it, and the boundary of a surface stays on its sides.

use crate::mesh::Point;

/// Sides of the box that a vertex is held to: bit 2 a is the lower side along axis a, bit 2 a + 1 the upper one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sides(u8);

/// A box with sides along the axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border {
    corners: [Point; 2],
    /// How near to a side is on it.
    near: f64,
}

impl Sides {
    /// The sides that the vertex in a boundary edge is held to: those that both ends are held to, or all of them where the
    /// edge cuts a corner between two sides off.
    pub(super) fn between(self, other: Self) -> Self {
        if self.0 & other.0 != 0 || self.0 == 0 || other.0 == 0 {
            Self(self.0 & other.0)
        } else {
            Self(self.0 | other.0)
        }
    }

    /// How many sides.
    pub(super) fn count(self) -> u32 {
        self.0.count_ones()
    }

    /// Whether a point held to these may not move along an axis.
    fn holds(self, axis: usize) -> bool {
        self.0 >> (2 * axis) & 3 != 0
    }

    /// The part of a direction in which a point held to these sides may move.
    pub(super) fn free_part(self, direction: Point) -> Point {
        let parts = direction.to_array();
        Point::from_array([0, 1, 2].map(|axis| if self.holds(axis) { 0.0 } else { parts[axis] }))
    }
}

impl Border {
    /// The box between two corners; what is nearer than `near` to a side is on it.
    pub(super) fn new(corners: [Point; 2], near: f64) -> Self {
        Self { corners, near }
    }

    /// The sides that a point is on.
    pub(super) fn sides(&self, point: Point) -> Sides {
        let [low, high] = self.corners.map(|corner| (point - corner).abs().to_array());
        let bits = (0..3).map(|axis| {
            u8::from(low[axis] <= self.near) << (2 * axis)
                | u8::from(high[axis] <= self.near) << (2 * axis + 1)
        });
        Sides(bits.sum())
    }

    /// The nearest point inside the box and on its sides.
    pub(super) fn hold(&self, sides: Sides, point: Point) -> Point {
        let [low, high] = self.corners.map(|corner| corner.to_array());
        let mut held = point.clamp(self.corners[0], self.corners[1]).to_array();
        for (axis, place) in held.iter_mut().enumerate() {
            match sides.0 >> (2 * axis) & 3 {
                0 => {}
                1 => *place = low[axis],
                _ => *place = high[axis],
            }
        }
        Point::from_array(held)
    }

    /// The longest side of the box.
    pub(super) fn longest_side(&self) -> f64 {
        (self.corners[1] - self.corners[0]).max_element()
    }

    /// How far outside the box a point is.
    pub(super) fn excess(&self, point: Point) -> f64 {
        point.distance(point.clamp(self.corners[0], self.corners[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Border = Border { corners: [Point::ZERO, Point::ONE], near: 1e-9 };

    #[test]
    fn points_are_held_to_their_sides() {
        let edge = UNIT.sides(Point::new(0.0, 1.0, 0.5));
        assert_eq!(edge.count(), 2);
        assert_eq!(UNIT.hold(edge, Point::new(0.2, 0.7, 2.0)), Point::new(0.0, 1.0, 1.0));
        assert_eq!(edge.free_part(Point::ONE), Point::Z);
        assert_eq!(UNIT.sides(Point::splat(0.5)), Sides::default());
        assert_eq!(UNIT.excess(Point::new(0.5, 3.0, 0.5)), 2.0);
    }

    #[test]
    fn an_edge_over_a_corner_is_held_to_both_sides() {
        let [left, front] =
            [Point::new(0.0, 0.5, 0.2), Point::new(0.5, 0.0, 0.2)].map(|point| UNIT.sides(point));
        let between = left.between(front);
        assert_eq!(UNIT.hold(between, Point::new(0.25, 0.25, 0.2)), Point::new(0.0, 0.0, 0.2));
        assert_eq!(left.between(between), left);
        assert_eq!(left.between(Sides::default()), Sides::default());
    }
}
