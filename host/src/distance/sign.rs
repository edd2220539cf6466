//! On which side of a surface a node lies.

use super::surface::{Facet, NONE, Surface};
use crate::field::Grid;
use crate::measure::Triangle;
use crate::mesh::Point;

/// Where signs come from.
#[derive(Debug)]
pub(super) enum Signs<'a> {
    /// Nodes with greater values are inside.
    Field {
        /// One a node.
        values: &'a [f32],
        isovalue: f32,
    },
    /// The nearest feature decides.
    Mesh(Normals<'a>),
}

impl Signs<'_> {
    /// Gives distances of a row of nodes their signs, given the number of the first node and the nearest triangle of each.
    /// Where a mesh has none near enough, the value is NaN.
    pub(super) fn mark(
        &self,
        surface: &Surface,
        node: [usize; 3],
        first: usize,
        triangles: &[u32],
        values: &mut [f32],
    ) {
        match self {
            Self::Field { values: samples, isovalue } => {
                for (value, sample) in values.iter_mut().zip(&samples[first..]) {
                    *value = if sample > isovalue { -*value } else { *value };
                }
            }
            Self::Mesh(normals) => {
                for (x, (value, &triangle)) in values.iter_mut().zip(triangles).enumerate() {
                    if triangle == NONE {
                        *value = f32::NAN;
                    } else if normals.inside(surface.node([x, node[1], node[2]]), triangle) {
                        *value = -*value;
                    }
                }
            }
        }
    }

    /// Gives nodes beyond the limit, whose values are NaN, the limit with a sign: that of the nodes around them.
    pub(super) fn fill(&self, grid: &Grid, values: &mut [f32], limit: f32) {
        if matches!(self, Self::Field { .. }) {
            return;
        }
        let mut stack = Vec::new();
        for start in 0..values.len() {
            if !values[start].is_nan() {
                stack.push(start);
            }
            while let Some(node) = stack.pop() {
                let value = limit.copysign(values[node]);
                for neighbour in
                    grid.neighbours(node).filter(|&next| values[next].is_nan()).collect::<Vec<_>>()
                {
                    values[neighbour] = value;
                    stack.push(neighbour);
                }
            }
        }
    }
}

/// Normals of faces, edges and vertices that tell the inside from the outside (Baerentzen, Aanaes 2005): the sum of those
/// of both faces for an edge, the sum of those of all faces weighted by their angles for a vertex.
#[derive(Debug)]
pub(super) struct Normals<'a> {
    surface: &'a Surface<'a>,
    facets: &'a [Facet],
    vertices: Vec<Point>,
}

impl<'a> Normals<'a> {
    pub(super) fn new(surface: &'a Surface<'a>, facets: &'a [Facet]) -> Self {
        let mut vertices = vec![Point::ZERO; surface.positions.len()];
        for (triangle, corners) in surface.triangles.iter().enumerate() {
            let points = surface.corners(triangle as u32);
            let normal = normal(points);
            for corner in 0..3 {
                let [before, after] = [2, 1].map(|step| points[(corner + step) % 3] - points[corner]);
                let angle = before.angle_between(after);
                // Sides of no length have no angle.
                vertices[corners[corner] as usize] +=
                    if angle.is_nan() { Point::ZERO } else { normal * angle };
            }
        }
        Self { surface, facets, vertices }
    }

    /// Whether a point is behind the nearest point of a triangle.
    fn inside(&self, at: Point, triangle: u32) -> bool {
        let face = |triangle: u32| normal(self.surface.corners(triangle));
        let nearest = Triangle(self.surface.corners(triangle)).nearest(at);
        let [u, v, w] = nearest.weights.map(|weight| weight != 0.0);
        let corner =
            |corner: usize| self.vertices[self.surface.triangles[triangle as usize][corner] as usize];
        let edge = |side: usize| {
            let other = self.facets[triangle as usize].across(side);
            face(triangle) + other.map_or(Point::ZERO, face)
        };
        let normal = match [u, v, w] {
            [true, false, false] => corner(0),
            [false, true, false] => corner(1),
            [false, false, true] => corner(2),
            [true, true, false] => edge(0),
            [false, true, true] => edge(1),
            [true, false, true] => edge(2),
            _ => face(triangle),
        };
        (at - nearest.point).dot(normal) < 0.0
    }
}

/// Unit normal of a triangle, zero if it has no area.
fn normal([a, b, c]: [Point; 3]) -> Point {
    (b - a).cross(c - a).normalize_or_zero()
}
