//! On which side of a surface a node lies.

use rayon::prelude::*;

use super::block::SEED;
use super::propagate::Propagation;
use super::seed::Seeding;
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
    /// The nearest feature decides at seeds; other nodes are where the seed of their point is.
    Mesh {
        normals: Normals<'a>,
        /// Whether the node of each site is inside.
        inside: Vec<bool>,
    },
}

impl<'a> Signs<'a> {
    /// Finds out for the seeds of a mesh.
    pub(super) fn of_mesh(
        seeding: &Seeding<'a>,
        neighbours: &'a Neighbours,
        propagation: &Propagation,
    ) -> Self {
        let normals = Normals::new(seeding.surface, neighbours);
        let blocks = propagation.blocks.par_iter().map(|block| {
            let seeds = block.sites.iter().enumerate().filter(|(_, site)| *site & SEED != 0);
            let inside = seeds.filter_map(|(at, &word)| {
                let node = propagation.layout.node(block.place, at);
                let triangle = propagation.triangle(word)?;
                let position = seeding.position(node);
                Some(normals.inside(&neighbours.slide(seeding.surface, position, triangle)))
            });
            inside.collect::<Vec<bool>>()
        });
        let inside = blocks.collect::<Vec<_>>().concat();
        Self::Mesh { normals, inside }
    }

    /// Whether a node is inside, given its number, its point on the surface, and the word of its site.
    pub(super) fn inside(&self, node: usize, foot: &Foot, word: u32) -> bool {
        match self {
            Self::Field { values, isovalue } => values[node] > *isovalue,
            Self::Mesh { normals, .. } if word & SEED != 0 => normals.inside(foot),
            Self::Mesh { inside, .. } => inside[Propagation::site(word)],
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
    fn new(surface: &'a Surface<'a>, neighbours: &'a Neighbours) -> Self {
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
