//! Attraction: a vertex moves along a line to the nearest zero of the distance field where it rises.
//!
//! Source: Vis2000 §4.2 and Dataflow §3: a line along the normal of the mesh, the nearest place on it where the field is zero
//! and its gradient agrees with the normal, found by bisection with attempts of Newton and Raphson of five steps each. A
//! distance has no zero nearer than itself, so that the search for a bracket walks by it.

use crate::field::ScalarField;
use crate::mesh::Point;

/// Steps of one attempt.
const NEWTON_STEPS: usize = 5;
/// Bisections of one bracket: enough for the whole precision of `f32` values.
const BISECTIONS: usize = 24;
/// Steps of a walk for a bracket, whatever it comes to.
const WALK_STEPS: usize = 64;
/// Least step of a walk, in cells. Structures thinner than this may be stepped over.
const LEAST_STEP: f64 = 0.2;
/// A value that is zero, in cells.
pub(super) const ZERO: f64 = 1e-5;

/// A field along a line.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    pub(super) field: &'a ScalarField,
    pub(super) from: Point,
    /// A unit vector, roughly along the gradient.
    pub(super) direction: Point,
    /// Length of a cell's edge.
    pub(super) cell: f64,
}

impl Line<'_> {
    fn value(&self, at: f64) -> f64 {
        self.field.sample_clamped(self.from + at * self.direction)
    }

    /// Value and slope along the line.
    fn look(&self, at: f64) -> [f64; 2] {
        let (value, gradient) = self.field.sample_clamped_with_gradient(self.from + at * self.direction);
        [value, gradient.dot(self.direction)]
    }

    /// Where the field is zero and rises along the direction, nearest to the start and at most `reach` from it.
    pub(super) fn nearest_zero(&self, reach: f64) -> Option<f64> {
        let value = self.value(0.0);
        let close = reach.min(1.5 * value.abs() + ZERO * self.cell);
        if let Some(zero) = self.newton(0.0, [-close, close]) {
            return Some(zero);
        }
        let [back, ahead] = [-1.0, 1.0].map(|side| self.zero_towards(side, value, reach));
        match (back, ahead) {
            (Some(back), Some(ahead)) => Some(if -back <= ahead { back } else { ahead }),
            (back, ahead) => back.or(ahead),
        }
    }

    /// The first rising zero on one side.
    fn zero_towards(&self, side: f64, value: f64, reach: f64) -> Option<f64> {
        let (mut at, mut value) = (0.0, value);
        for _ in 0..WALK_STEPS {
            if at >= reach {
                return None;
            }
            let next = (at + value.abs().max(LEAST_STEP * self.cell)).min(reach);
            let there = self.value(side * next);
            // Along the direction the field rises from negative to positive.
            if value * side < 0.0 && there * side >= 0.0 {
                let [low, high] = if side > 0.0 { [at, next] } else { [-next, -at] };
                return Some(self.bisect([low, high]));
            }
            (at, value) = (next, there);
        }
        None
    }

    /// Newton's method from a place, if it gets to a rising zero within bounds.
    fn newton(&self, from: f64, [low, high]: [f64; 2]) -> Option<f64> {
        let mut at = from;
        for _ in 0..NEWTON_STEPS {
            let [value, slope] = self.look(at);
            if slope > 0.0 && value.abs() <= ZERO * self.cell {
                return Some(at);
            }
            at -= value / slope;
            if slope <= 0.0 || !(low..=high).contains(&at) {
                return None;
            }
        }
        None
    }

    /// A zero between a place where the field is negative and a later one where it is not.
    fn bisect(&self, [mut low, mut high]: [f64; 2]) -> f64 {
        for _ in 0..BISECTIONS {
            let middle = f64::midpoint(low, high);
            if let Some(zero) = self.newton(middle, [low, high]) {
                return zero;
            }
            *if self.value(middle) < 0.0 { &mut low } else { &mut high } = middle;
        }
        f64::midpoint(low, high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Grid;

    fn along_x(function: impl Fn(f64) -> f64) -> ScalarField {
        ScalarField::from_function(Grid::unit([33, 2, 2]), |point| function(point.x))
    }

    fn zero_from(field: &ScalarField, from: f64, direction: Point, reach: f64) -> Option<f64> {
        let line = Line { field, from: Point::new(from, 0.5, 0.5), direction, cell: 1.0 };
        line.nearest_zero(reach).map(|at| (line.from + at * direction).x)
    }

    #[test]
    fn the_nearest_agreeing_zero_is_found() {
        // A sheet from 10.3 to 14.6: its outside is x < 10.3 and x > 14.6.
        let sheet = along_x(|x| (x - 12.45).abs() - 2.15);
        let found = |from, direction, reach| zero_from(&sheet, from, direction, reach);
        let near = |found: Option<f64>, place: f64| (found.unwrap() - place).abs() < 1e-3;
        assert!(near(found(16.0, Point::X, 4.0), 14.6));
        assert!(near(found(13.0, Point::X, 4.0), 14.6));
        assert!(near(found(13.0, Point::NEG_X, 4.0), 10.3));
        // Past the other side of the sheet, and still not mistaken.
        assert!(near(found(9.5, Point::X, 6.0), 14.6));
        assert_eq!(found(9.5, Point::X, 4.0), None);
        assert_eq!(found(25.0, Point::X, 4.0), None);
    }

    #[test]
    fn kinks_and_plateaus_are_bisected() {
        let kinked = along_x(|x| if x < 16.0 { (x - 16.0) * 0.01 - 0.2 } else { (x - 16.0) * 3.0 - 0.2 });
        let found = zero_from(&kinked, 13.0, Point::X, 5.0).unwrap();
        assert!((found - (16.0 + 0.2 / 3.0)).abs() < 1e-4, "{found}");
        assert_eq!(zero_from(&along_x(|_| 0.0), 5.0, Point::X, 5.0), None);
    }
}
