//! On which side of a surface a node lies.

use super::slide::Neighbours;
use super::surface::{Feature, Foot, Surface};
use crate::field::Grid;
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
    /// Whether a node is inside, given its number and its point on the surface.
    pub(super) fn inside(&self, node: usize, foot: &Foot) -> bool {
        match self {
            Self::Field { values, isovalue } => values[node] > *isovalue,
            Self::Mesh(normals) => normals.inside(foot),
        }
    }

    /// Gives nodes beyond the limit, whose values are NaN, the limit with a sign: that of the nodes around them.
    pub(super) fn fill(&self, grid: &Grid, values: &mut [f32], limit: f32) {
        if let Self::Field { values: samples, isovalue } = self {
            let beyond = values.iter_mut().zip(*samples).filter(|(value, _)| value.is_nan());
            beyond.for_each(|(value, sample)| *value = if sample > isovalue { -limit } else { limit });
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
    neighbours: &'a Neighbours,
    vertices: Vec<Point>,
}

impl<'a> Normals<'a> {
    pub(super) fn new(surface: &'a Surface<'a>, neighbours: &'a Neighbours) -> Self {
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
        Self { surface, neighbours, vertices }
    }

    /// Whether a node is behind its foot.
    fn inside(&self, foot: &Foot) -> bool {
        let face = |triangle: u32| normal(self.surface.corners(triangle));
        let normal = match foot.feature {
            Feature::Face => face(foot.triangle),
            Feature::Edge(edge) => {
                let other = self.neighbours.across(foot.triangle, edge);
                face(foot.triangle) + other.map_or(Point::ZERO, face)
            }
            Feature::Corner(corner) => {
                self.vertices[self.surface.triangles[foot.triangle as usize][usize::from(corner)] as usize]
            }
        };
        foot.offset.dot(normal) < 0.0
    }
}

/// Unit normal of a triangle, zero if it has no area.
fn normal([a, b, c]: [Point; 3]) -> Point {
    (b - a).cross(c - a).normalize_or_zero()
}
