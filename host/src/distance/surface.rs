//! Triangles to be distant from, and nearest points on them.

use super::DistanceError;
use crate::field::Grid;
use crate::mesh::{Point, TriangleMesh};

/// A mesh whose indices are in range, relative to the origin of a grid.
#[derive(Debug)]
pub(super) struct Surface<'a> {
    pub(super) positions: Vec<Point>,
    pub(super) triangles: &'a [[u32; 3]],
}

/// Where on a triangle a point lies. Edge n runs from corner n to the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Feature {
    Face,
    Edge(u8),
    Corner(u8),
}

/// The point of a triangle that is nearest to a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub(super) triangle: u32,
    pub(super) feature: Feature,
    pub(super) point: Point,
    /// From the foot to the node.
    pub(super) offset: Point,
    /// Squared length of the offset.
    pub(super) squared: f64,
}

impl<'a> Surface<'a> {
    /// Checks a mesh.
    pub(super) fn new(mesh: &'a TriangleMesh, grid: &Grid) -> Result<Self, DistanceError> {
        let vertices = mesh.positions.len();
        let missing = |triangle: &[u32; 3]| triangle.iter().any(|&corner| corner as usize >= vertices);
        if let Some(triangle) = mesh.triangles.iter().position(missing) {
            return Err(DistanceError::NoSuchVertex { triangle });
        }
        if let Some(vertex) = mesh.positions.iter().position(|point| !point.is_finite()) {
            return Err(DistanceError::NotFinite { vertex });
        }
        let positions = mesh.positions.iter().map(|&point| point - grid.origin).collect();
        Ok(Self { positions, triangles: &mesh.triangles })
    }

    /// Corners of a triangle.
    pub(super) fn corners(&self, triangle: u32) -> [Point; 3] {
        self.triangles[triangle as usize].map(|corner| self.positions[corner as usize])
    }

    /// The nearest point of a triangle.
    pub(super) fn foot(&self, triangle: u32, from: Point) -> Foot {
        let (point, feature) = nearest(self.corners(triangle), from);
        let offset = from - point;
        Foot { triangle, feature, point, offset, squared: offset.length_squared() }
    }
}

/// The point of a triangle nearest to `p`, by the Voronoi regions of its features (Ericson 2005, §5.1.5).
pub(super) fn nearest([a, b, c]: [Point; 3], p: Point) -> (Point, Feature) {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Feature::Corner(0));
    }
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Feature::Corner(1));
    }
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Feature::Corner(2));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * (d1 / (d1 - d3)), Feature::Edge(0));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * (d2 / (d2 - d6)), Feature::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return (b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), Feature::Edge(1));
    }
    let all = va + vb + vc;
    (a + ab * (vb / all) + ac * (vc / all), Feature::Face)
}
