//! Sharp edges and boundaries of a mesh as lines in space, which the creases of a surface are attracted to.

use std::collections::HashMap;

use crate::measure::Bvh;
use crate::mesh::{Features, Point, TriangleMesh};

/// Least cosine between a crease and the line that it goes to.
const LEAST_AGREEMENT: f64 = 0.5;

/// Straight pieces of lines, to find the closest of.
#[derive(Clone, Debug)]
pub struct Lines {
    pieces: Vec<[Point; 2]>,
    /// Each piece as a triangle without area.
    tree: Bvh,
}

impl Lines {
    /// Lines of some pieces, all of whose ends are finite. Cost: as [`Bvh::new`].
    pub fn new(pieces: Vec<[Point; 2]>) -> Self {
        let positions = pieces.iter().flatten().copied().collect();
        let triangles =
            (0..pieces.len() as u32).map(|piece| [2 * piece, 2 * piece + 1, 2 * piece + 1]).collect();
        let tree = Bvh::new(&TriangleMesh { positions, triangles });
        Self { pieces, tree }
    }

    /// The sharp edges of a mesh, and its boundary.
    pub fn of_mesh(mesh: &TriangleMesh, features: &Features) -> Self {
        let mut sides = HashMap::new();
        for [a, b, c] in &mesh.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *sides.entry([*from.min(to), *from.max(to)]).or_insert(0) += 1;
            }
        }
        let mut edges: Vec<[u32; 2]> =
            sides.into_iter().filter(|&(_, count)| count == 1).map(|(edge, _)| edge).collect();
        edges.extend(&features.edges);
        edges.sort_unstable();
        edges.dedup();
        let piece = |edge: [u32; 2]| edge.map(|end| mesh.positions[end as usize]);
        Self::new(edges.into_iter().map(piece).collect())
    }

    /// The closest point to `point` at most `reach` away, if its line runs along `direction`, either way.
    pub(super) fn closest(&self, point: Point, direction: Point, reach: f64) -> Option<Point> {
        let closest = self.tree.closest_within(point, reach * reach)?;
        let [from, to] = self.pieces[closest.triangle as usize];
        let along = (to - from).normalize_or_zero().dot(direction.normalize_or_zero());
        (along.abs() >= LEAST_AGREEMENT).then_some(closest.point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn creases_find_lines_that_run_their_way() {
        let positions = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]].map(|[x, y]| Point::new(x, y, 0.0));
        let mesh = TriangleMesh { positions: positions.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]] };
        let lines = Lines::of_mesh(&mesh, &Features { edges: vec![[0, 2]], vertices: Vec::new() });
        assert_eq!(lines.pieces.len(), 5);
        let at = Point::new(2.0, 0.5, 0.25);
        assert_eq!(lines.closest(at, Point::X, 1.0), Some(Point::new(2.0, 0.0, 0.0)));
        assert_eq!(lines.closest(at, Point::Y, 1.0), None);
        assert_eq!(lines.closest(at, Point::X, 0.5), None);
        assert!(lines.closest(Point::new(2.0, 1.5, 0.0), Point::new(1.0, 1.0, 0.0), 1.0).is_some());
    }
}
