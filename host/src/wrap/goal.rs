//! The surface that vertices are moved to, once they are near it.

use super::attract::ZERO;
use super::level::Space;
use crate::field::ScalarField;
use crate::measure::Bvh;
use crate::mesh::Point;

/// Steps down the gradient. More than a few are of use only where the field has kinks.
const STEPS: usize = 4;
/// Longest step, in cells.
const LONGEST_STEP: f64 = 0.5;

/// What the finest vertices shall lie on.
#[derive(Clone, Copy, Debug, Default)]
pub enum Target<'a> {
    /// The zeros of the distance field.
    #[default]
    Distance,
    /// The points where a field, on the grid of the distance field, has a value: the isosurface that the distances were made
    /// from, which their zeros differ from by a fraction of a cell (Vis2000 §4.2).
    Isosurface(&'a ScalarField, f64),
    /// A mesh of triangles, which the distances were made from.
    Triangles(&'a Bvh),
}

/// A target, ready to be looked into.
#[derive(Clone, Copy)]
pub(super) enum Goal<'a> {
    /// Where a field has a value.
    Field(&'a ScalarField, f64),
    /// Where triangles are.
    Triangles(&'a Bvh),
}

impl<'a> Goal<'a> {
    /// What a target asks for.
    pub(super) fn new(target: Target<'a>, space: &Space<'a>) -> Self {
        match target {
            Target::Distance => Self::Field(space.distance, 0.0),
            Target::Isosurface(field, value) => Self::Field(field, value),
            Target::Triangles(triangles) => Self::Triangles(triangles),
        }
    }

    /// A point of the surface near a point, or a point nearer to it, at most `reach` away.
    pub(super) fn approach(&self, point: Point, reach: f64, cell: f64) -> Point {
        match self {
            Self::Field(field, value) => descend(field, *value, point, reach, cell),
            Self::Triangles(triangles) => {
                triangles.closest_within(point, reach * reach).map_or(point, |closest| closest.point)
            }
        }
    }
}

/// Newton's method along the gradient, in short steps.
fn descend(field: &ScalarField, value: f64, from: Point, reach: f64, cell: f64) -> Point {
    let mut place = from;
    for _ in 0..STEPS {
        let (found, gradient) = field.sample_clamped_with_gradient(place);
        let (excess, steepness) = (found - value, gradient.length());
        // In units of the field, what a step of the precision wanted changes.
        if excess.abs() <= ZERO * cell * steepness || steepness == 0.0 {
            break;
        }
        let step = (excess.abs() / steepness).min(LONGEST_STEP * cell) * excess.signum();
        let next = place - step * gradient / steepness;
        if next.distance_squared(from) > reach * reach {
            break;
        }
        place = next;
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Grid;

    #[test]
    fn points_go_down_to_the_value() {
        let field = ScalarField::from_function(Grid::unit([9, 9, 9]), |point| 3.0 * point.x + 4.0 * point.y);
        let goal = Goal::Field(&field, 25.0);
        let found = goal.approach(Point::new(3.0, 4.5, 2.0), 1.0, 1.0);
        assert!((3.0 * found.x + 4.0 * found.y - 25.0).abs() < 1e-4 && found.z == 2.0, "{found}");
        let far = Point::new(1.0, 1.0, 2.0);
        assert!(goal.approach(far, 0.3, 1.0).distance(far) <= 0.3);
    }
}
