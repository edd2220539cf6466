//! The surface that vertices are moved to, once they are near it.

use rayon::prelude::*;

use super::attract::ZERO;
use super::border::Sides;
use super::level::Space;
use crate::field::ScalarField;
use crate::measure::Bvh;
use crate::mesh::Point;

/// Steps down the gradient. More than a few are of use only where the field has kinks.
const STEPS: usize = 4;
/// Longest step, in cells.
const LONGEST_STEP: f64 = 0.5;
/// Closest points, each followed by a step back to the border, for points on the border.
const RETURNS: usize = 4;
/// The longest way that [`ways`] goes, in cells.
const LONGEST_WAY: f64 = 2.0;
/// What is left of the way down where it has led to the surface, in cells.
const THERE: f64 = 1e-2;
/// The length of the gradient of the distance where a sheet of the surface is alone.
const STEEP: f64 = 0.9;
/// How much farther a triangle may be than the zero of the distance field, in cells.
const FARTHER: f64 = 1.0;

/// What the finest vertices shall lie on.
#[derive(Clone, Copy, Debug, Default)]
pub enum Target<'a> {
    /// The zeros of the distance field.
    #[default]
    Distance,
    /// The points where a field, on the grid of the distance field, has a value, larger ones being inside: the isosurface that the distances were made
    /// from, which their zeros differ from by a fraction of a cell (Vis2000 §4.2).
    Isosurface(&'a ScalarField, f64),
    /// A mesh of triangles, which the distances were made from.
    Triangles(&'a Bvh),
}

/// A target, ready to be looked into.
#[derive(Clone, Copy, Debug)]
pub(super) enum Goal<'a> {
    /// Where the distance is zero.
    Distance,
    /// Where a field has a value; larger ones are inside.
    Isosurface(&'a ScalarField, f64),
    /// Where triangles are.
    Triangles(&'a Bvh),
}

impl<'a> Goal<'a> {
    /// What a target asks for.
    pub(super) fn new(target: Target<'a>) -> Self {
        match target {
            Target::Distance => Self::Distance,
            Target::Isosurface(field, value) => Self::Isosurface(field, value),
            Target::Triangles(triangles) => Self::Triangles(triangles),
        }
    }

    /// The way down to a field's value.
    fn descent(&self, reach: f64, space: &Space<'a>) -> Option<Descent<'a>> {
        let (field, value) = match *self {
            Self::Distance => (space.distance, 0.0),
            Self::Isosurface(field, value) => (field, value),
            Self::Triangles(_) => return None,
        };
        Some(Descent { field, value, reach, cell: space.cell })
    }

    /// Which way the surface near a vertex of a mesh faces, whose normal is a unit vector: as the isosurface or the triangle
    /// does there, or else as the distance says ([`Space::outwards`]), which tells less where sheets are close.
    pub(super) fn outwards(&self, point: Point, normal: Point, space: &Space) -> Point {
        match self {
            Self::Isosurface(field, _) => {
                (-field.sample_clamped_with_gradient(point).1).try_normalize().unwrap_or(normal)
            }
            Self::Triangles(triangles) => {
                let gradient = space.distance.sample_clamped_with_gradient(point).1;
                if gradient.length() > STEEP {
                    return gradient;
                }
                let limit = self.limit(point, space);
                triangles.facing(point, limit * limit).unwrap_or(normal)
            }
            Self::Distance => space.outwards(point, normal),
        }
    }

    /// How far the surface is at most, as a length, by what the distance field says.
    fn limit(&self, point: Point, space: &Space) -> f64 {
        (space.distance_in_cells(point) + FARTHER) * space.cell
    }

    /// A point of the surface near a point, or a point nearer to it, at most `reach` away, and on the same sides of the box.
    pub(super) fn approach(&self, point: Point, sides: Sides, reach: f64, space: &Space<'a>) -> Point {
        if let Some(descent) = self.descent(reach, space) {
            return space.border.hold(sides, descent.from(point, sides));
        }
        let mut place = point;
        if let Self::Triangles(triangles) = self {
            for _ in 0..if sides.count() > 0 { RETURNS } else { 1 } {
                let limit = reach.min(self.limit(place, space));
                let closest = triangles.closest_within(place, limit * limit);
                place = space.border.hold(sides, closest.map_or(place, |closest| closest.point));
            }
        }
        place
    }

    /// How far a point is from the surface, in cells' edges: the way down to it, or, where that leads nowhere, what the
    /// distance field says.
    pub(super) fn distance_in_cells(&self, point: Point, space: &Space<'a>) -> f64 {
        let by_field = space.distance_in_cells(point);
        let way = match self {
            Self::Triangles(triangles) => {
                triangles.closest(point).map(|closest| closest.distance_squared.sqrt())
            }
            _ => {
                self.descent((by_field + FARTHER) * space.cell, space).and_then(|descent| descent.way(point))
            }
        };
        way.map_or(by_field, |way| way / space.cell)
    }
}

/// How far points are from where a field has a value, in cells' edges, going down its gradient; none where that does not
/// lead there within a few cells. It is no less than the distance, and little more nearby.
///
/// Cost: a few samples of the field for each point, on all threads.
pub fn ways(field: &ScalarField, value: f64, points: &[Point]) -> Vec<Option<f64>> {
    let cell = field.grid().cell_edge();
    let descent = Descent { field, value, reach: LONGEST_WAY * cell, cell };
    points.par_iter().map(|&point| Some(descent.way(point)? / cell)).collect()
}

/// A way down to where a field has a value.
struct Descent<'a> {
    field: &'a ScalarField,
    value: f64,
    reach: f64,
    cell: f64,
}

impl Descent<'_> {
    /// How far it is, if it leads to the value.
    fn way(&self, point: Point) -> Option<f64> {
        let place = self.from(point, Sides::default());
        let (found, gradient) = self.field.sample_clamped_with_gradient(place);
        let is_there = (found - self.value).abs() <= THERE * self.cell * gradient.length();
        is_there.then(|| place.distance(point))
    }

    /// Newton's method along the gradient, as far as the sides leave it free, in short steps.
    fn from(&self, point: Point, sides: Sides) -> Point {
        let mut place = point;
        for _ in 0..STEPS {
            let (found, gradient) = self.field.sample_clamped_with_gradient(place);
            let (excess, gradient) = (found - self.value, sides.free_part(gradient));
            let steepness = gradient.length();
            if excess.abs() <= ZERO * self.cell * steepness || steepness == 0.0 {
                break;
            }
            let step = (excess.abs() / steepness).min(LONGEST_STEP * self.cell) * excess.signum();
            let next = place - step * gradient / steepness;
            if next.distance_squared(point) > self.reach * self.reach {
                break;
            }
            place = next;
        }
        place
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Grid;
    use crate::mesh::TriangleMesh;

    #[test]
    fn points_go_down_to_the_value() {
        let field = ScalarField::from_function(Grid::unit([9, 9, 9]), |point| 3.0 * point.x + 4.0 * point.y);
        let (goal, space) = (Goal::Isosurface(&field, 25.0), Space::new(&field));
        let excess = |point: Point| 3.0 * point.x + 4.0 * point.y - 25.0;
        let found = goal.approach(Point::new(3.0, 4.5, 2.0), Sides::default(), 1.0, &space);
        assert!(excess(found).abs() < 1e-4 && found.z == 2.0, "{found}");
        let off = |point| goal.distance_in_cells(point, &space);
        assert!(off(found) < 1e-4 && (off(Point::new(3.0, 4.5, 2.0)) - 0.4).abs() < 1e-4);
        let far = Point::new(1.0, 1.0, 2.0);
        assert!(goal.approach(far, Sides::default(), 0.3, &space).distance(far) <= 0.3);
        let on_border = Point::new(0.0, 6.0, 2.0);
        let found = goal.approach(on_border, space.border.sides(on_border), 1.0, &space);
        assert!(excess(found).abs() < 1e-4 && found.x == 0.0, "{found}");
    }

    #[test]
    fn points_of_the_border_go_to_triangles_along_it() {
        let field = ScalarField::from_function(Grid::unit([9, 9, 9]), |point| 3.0 * point.x + 4.0 * point.y);
        let corner = |x: f64, y: f64, z: f64| Point::new(x, y, z);
        let positions = vec![corner(0.0, 5.0, 0.0), corner(0.0, 5.0, 8.0), corner(8.0, 7.0, 4.0)];
        let tree = Bvh::new(&TriangleMesh { positions, triangles: vec![[0, 1, 2]] });
        let (goal, space) = (Goal::Triangles(&tree), Space::new(&field));
        let from = Point::new(0.0, 5.5, 4.0);
        let found = goal.approach(from, space.border.sides(from), 2.0, &space);
        assert!(found.x == 0.0 && (found.y - 5.0).abs() < 0.01, "{found}");
        let off = |point| goal.distance_in_cells(point, &space);
        assert!(off(found) < 0.01 && off(from) > 0.3);
    }
}
