//! Value and slope of a trilinear field at a point, in one look at its cell.

use crate::field::{Grid, ScalarField};
use crate::mesh::Point;

/// A field to look into; points outside its grid are taken for the nearest ones of the border.
#[derive(Clone, Copy)]
pub(super) struct Probe<'a> {
    values: &'a [f32],
    grid: &'a Grid,
    /// Nodes from one to the next along y and z.
    strides: [usize; 2],
    inverse_spacing: Point,
    last_cell: Point,
}

/// What a field is at a point: its value, and its gradient within the cell (exact for the trilinear function).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    pub(super) value: f64,
    pub(super) gradient: Point,
}

impl<'a> Probe<'a> {
    /// A probe for a field of two nodes or more along every axis.
    pub(super) fn new(field: &'a ScalarField) -> Self {
        let grid = field.grid();
        let [width, height, _] = grid.extent;
        Self {
            values: field.values(),
            grid,
            strides: [width, width * height],
            inverse_spacing: grid.spacing.recip(),
            last_cell: Point::from_array(grid.extent.map(|nodes| nodes.saturating_sub(2) as f64)),
        }
    }

    /// The lower and the upper corner of the grid.
    pub(super) fn corners(&self) -> [Point; 2] {
        let last = self.grid.extent.map(|nodes| nodes - 1);
        [self.grid.origin, self.grid.position(last)]
    }

    /// Length of a cell's edge.
    pub(super) fn cell_edge(&self) -> f64 {
        self.grid.cell_edge()
    }

    /// The eight values around a point, x fastest, and where in the cell the point lies, in 0 to 1.
    fn cell(&self, point: Point) -> ([f64; 8], Point) {
        let local = (point - self.grid.origin) * self.inverse_spacing;
        let cell = local.floor().clamp(Point::ZERO, self.last_cell);
        let [row, slice] = self.strides;
        let first = cell.x as usize + cell.y as usize * row + cell.z as usize * slice;
        let places = [0, 1, row, row + 1, slice, slice + 1, slice + row, slice + row + 1];
        let values = places.map(|place| f64::from(self.values[first + place]));
        (values, (local - cell).clamp(Point::ZERO, Point::ONE))
    }

    /// Value and gradient at a point.
    pub(super) fn look(&self, point: Point) -> Look {
        let ([a, b, c, d, e, f, g, h], t) = self.cell(point);
        let mix = |from: f64, to: f64, part: f64| from + (to - from) * part;
        let edges = [mix(a, b, t.x), mix(c, d, t.x), mix(e, f, t.x), mix(g, h, t.x)];
        let faces = [mix(edges[0], edges[1], t.y), mix(edges[2], edges[3], t.y)];
        let along_x = mix(mix(b - a, d - c, t.y), mix(f - e, h - g, t.y), t.z);
        let along_y = mix(edges[1] - edges[0], edges[3] - edges[2], t.z);
        let slope = Point::new(along_x, along_y, faces[1] - faces[0]);
        Look { value: mix(faces[0], faces[1], t.z), gradient: slope * self.inverse_spacing }
    }

    /// Value at a point.
    pub(super) fn value(&self, point: Point) -> f64 {
        self.look(point).value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trilinear_functions_are_met_exactly() {
        let grid =
            Grid { extent: [4, 3, 5], origin: Point::splat(-1.0), spacing: Point::new(0.5, 1.0, 0.25) };
        let function = |p: Point| 1.0 + 2.0 * p.x - p.y + 3.0 * p.z + p.x * p.y * p.z;
        let field = ScalarField::from_function(grid, function);
        let probe = Probe::new(&field);
        for point in [Point::splat(-1.0), Point::new(0.1, 0.2, -0.3), Point::new(0.5, 1.0, 0.0)] {
            let look = probe.look(point);
            let slope = Point::new(
                2.0 + point.y * point.z,
                -1.0 + point.x * point.z,
                3.0 + point.x * point.y,
            );
            assert!((look.value - function(point)).abs() < 1e-6, "{look:?}");
            assert!((look.gradient - slope).length() < 1e-5, "{look:?}");
        }
    }

    #[test]
    fn outside_is_the_border() {
        let field = ScalarField::from_function(Grid::unit([3, 3, 3]), |point| point.x);
        let probe = Probe::new(&field);
        assert_eq!(probe.value(Point::new(7.0, 1.0, -5.0)), 2.0);
        assert_eq!(probe.value(Point::new(-7.0, 1.0, 9.0)), 0.0);
        assert_eq!(probe.corners(), [Point::ZERO, Point::splat(2.0)]);
    }
}
