//! Polygons as triangles over the same vertices.

use super::{Point, PolygonMesh, Surface, TriangleMesh};

/// Corners of a polygon that are tried as the common corner of its triangles.
const TRIED: usize = 16;

/// The triangles of a mesh, and the face that each is a part of.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Triangulation {
    /// Three vertices a triangle, in the order of the faces.
    pub triangles: Vec<[u32; 3]>,
    /// One face a triangle.
    pub faces: Vec<u32>,
}

impl Triangulation {
    /// Cuts every polygon into triangles that share one of its corners.
    ///
    /// A quad is cut along its shorter diagonal, the first if both are equal, unless only the other one keeps both
    /// triangles facing the same way. In polygons of more sides the first corner is taken from which all triangles face
    /// the way of the polygon. Polygons that have no such corner among the first 16 come out overlapping.
    ///
    /// Cost: one pass.
    pub fn new(surface: &impl Surface) -> Self {
        let points = surface.points();
        let mut all = Self::default();
        for (face, corners) in surface.polygons().enumerate() {
            let apex = apex(points, corners);
            let at = |step: usize| corners[(apex + step) % corners.len()];
            for step in 1..corners.len() - 1 {
                all.triangles.push([at(0), at(step), at(step + 1)]);
                all.faces.push(face as u32);
            }
        }
        all
    }
}

/// Place of the corner that all triangles of a polygon share.
fn apex(points: &[Point], corners: &[u32]) -> usize {
    let at = |place: usize| points[corners[place % corners.len()] as usize];
    match corners.len() {
        3 => 0,
        4 => {
            let faces_one_way = |from: usize| {
                let diagonal = at(from + 2) - at(from);
                let sides = [at(from + 1) - at(from), at(from + 3) - at(from)];
                sides[0].cross(diagonal).dot(diagonal.cross(sides[1])) > 0.0
            };
            let second_is_shorter = at(1).distance_squared(at(3)) < at(0).distance_squared(at(2));
            match (faces_one_way(0), faces_one_way(1)) {
                (true, false) => 0,
                (false, true) => 1,
                _ => usize::from(second_is_shorter),
            }
        }
        sides => {
            let normal = area_vector(points, corners);
            let is_fan = |from: &usize| {
                (1..sides - 1).all(|step| {
                    let [a, b] = [at(from + step) - at(*from), at(from + step + 1) - at(*from)];
                    a.cross(b).dot(normal) > 0.0
                })
            };
            (0..sides.min(TRIED)).find(is_fan).unwrap_or(0)
        }
    }
}

/// Normal of a polygon, as long as twice its area (Newell's method: the sum over its sides).
pub(super) fn area_vector(points: &[Point], corners: &[u32]) -> Point {
    let first = points[corners[0] as usize];
    let spokes = corners[1..].iter().map(|&corner| points[corner as usize] - first);
    spokes.clone().zip(spokes.skip(1)).map(|(a, b)| a.cross(b)).sum()
}

impl PolygonMesh {
    /// The polygons cut into triangles, as [`Triangulation`] does.
    pub fn triangulated(&self) -> TriangleMesh {
        TriangleMesh { positions: self.positions.clone(), triangles: Triangulation::new(self).triangles }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Faces;

    fn polygon(corners: &[(f64, f64)]) -> PolygonMesh {
        let positions = corners.iter().map(|&(x, y)| Point::new(x, y, 0.0)).collect();
        let face: Vec<u32> = (0..corners.len() as u32).collect();
        PolygonMesh::new(positions, Faces::from_iter([face.as_slice()]))
    }

    #[test]
    fn quads_are_cut_along_the_shorter_diagonal_that_is_inside() {
        let square = polygon(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
        assert_eq!(square.triangulated().triangles, [[0, 1, 2], [0, 2, 3]]);
        let leaning = polygon(&[(0.0, 0.0), (1.0, 0.0), (2.0, 1.0), (1.0, 1.0)]);
        assert_eq!(leaning.triangulated().triangles, [[1, 2, 3], [1, 3, 0]]);
        // An arrow head: the shorter diagonal, from 1 to 3, is outside.
        let arrow = polygon(&[(0.0, 0.0), (-1.0, -0.5), (3.0, 0.0), (-1.0, 0.5)]);
        assert_eq!(arrow.triangulated().triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn polygons_with_one_bay_are_covered_once() {
        let bay = polygon(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 1.0), (0.0, 4.0)]);
        let cut = Triangulation::new(&bay);
        assert_eq!(cut.triangles, [[3, 4, 0], [3, 0, 1], [3, 1, 2]]);
        assert_eq!(cut.faces, [0; 3]);
        assert_eq!(area_vector(&bay.positions, bay.faces().get(0)), Point::Z * 20.0);
    }
}
