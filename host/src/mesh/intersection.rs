//! Where a surface meets itself.

use std::ops::ControlFlow;

use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::{Point, TriangleMesh};
use crate::measure::{Bounds, Bvh};

/// Triangles that are examined before it is seen whether enough pairs are found.
const RUN: usize = 1 << 16;

/// Pairs of triangles that have more in common than the vertices or the edge that they share, the smaller index first, in
/// ascending order: the first `most` of them.
///
/// Touching counts. Whether points lie on a side or not is decided exactly (Shewchuk, *Adaptive Precision Floating-Point
/// Arithmetic and Fast Robust Geometric Predicates*, 1997). Triangles with a vertex twice are passed over.
///
/// Cost: a tree of boxes, and a test for each pair whose boxes meet; in parallel.
pub fn self_intersections(mesh: &TriangleMesh, tree: &Bvh, most: usize) -> Vec<[u32; 2]> {
    let mut found = Vec::new();
    for start in (0..mesh.triangles.len()).step_by(RUN) {
        let run: Vec<usize> = (start..mesh.triangles.len().min(start + RUN)).collect();
        let pairs = run.par_iter().flat_map_iter(|&index| meeting(mesh, tree, index as u32, most));
        found.extend(pairs.collect::<Vec<_>>());
        if found.len() >= most {
            break;
        }
    }
    found.truncate(most);
    found
}

/// Pairs of a triangle with later ones.
fn meeting(mesh: &TriangleMesh, tree: &Bvh, index: u32, most: usize) -> Vec<[u32; 2]> {
    let triangle = mesh.triangles[index as usize];
    let mut pairs = Vec::new();
    let corners = |triangle: [u32; 3]| triangle.map(|corner| mesh.positions[corner as usize]);
    let bounds = Bounds::around(corners(triangle));
    tree.near(&bounds, |other| {
        let later = mesh.triangles[other as usize];
        if other > index && Bounds::around(corners(later)).overlaps(&bounds) && meet(mesh, triangle, later) {
            pairs.push([index, other]);
        }
        if pairs.len() < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    pairs.sort_unstable();
    pairs
}

fn has_vertex_twice([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// Whether two triangles meet elsewhere than in what they share.
fn meet(mesh: &TriangleMesh, first: [u32; 3], second: [u32; 3]) -> bool {
    if has_vertex_twice(first) || has_vertex_twice(second) {
        return false;
    }
    let at = |corner: u32| mesh.positions[corner as usize];
    let [a, b] = [first, second].map(|triangle| triangle.map(at));
    let side = |triangle: [u32; 3], skipped: usize| {
        [triangle[(skipped + 1) % 3], triangle[(skipped + 2) % 3]].map(at)
    };
    // Turned so that shared vertices come first.
    let shared: Vec<[usize; 2]> =
        (0..9).map(|pair| [pair / 3, pair % 3]).filter(|&[i, j]| first[i] == second[j]).collect();
    match shared[..] {
        [] => (0..3).any(|skipped| crosses(side(first, skipped), b) || crosses(side(second, skipped), a)),
        // What goes on beyond a shared vertex leaves one triangle through the side opposite it.
        [[i, j]] => crosses(side(first, i), b) || crosses(side(second, j), a),
        [[i, j], [k, l]] => {
            let (tip, other_tip) = (a[3 - i - k], b[3 - j - l]);
            lies_on_one_side([a[i], a[k]], tip, other_tip)
        }
        _ => true,
    }
}

fn turn(a: Point, b: Point, c: Point, d: Point) -> f64 {
    let [a, b, c, d] = [a, b, c, d].map(|point| Coord3D { x: point.x, y: point.y, z: point.z });
    orient3d(a, b, c, d)
}

/// Whether two triangles over an edge are folded flat onto each other.
fn lies_on_one_side([from, to]: [Point; 2], tip: Point, other_tip: Point) -> bool {
    turn(from, to, tip, other_tip) == 0.0 && {
        let plane = Plane::of([from, to, tip]);
        plane.turn(from, to, tip) * plane.turn(from, to, other_tip) > 0.0
    }
}

/// Whether a segment and a triangle have a point in common.
fn crosses([from, to]: [Point; 2], triangle: [Point; 3]) -> bool {
    let [a, b, c] = triangle;
    let heights = [turn(a, b, c, from), turn(a, b, c, to)];
    if heights == [0.0; 2] {
        return Plane::of(triangle).crosses([from, to], triangle);
    }
    if heights[0] * heights[1] > 0.0 {
        return false;
    }
    let turns = [turn(from, to, a, b), turn(from, to, b, c), turn(from, to, c, a)];
    turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
}

/// The two axes along which a triangle is seen largest.
struct Plane([usize; 2]);

impl Plane {
    fn of([a, b, c]: [Point; 3]) -> Self {
        let normal = (b - a).cross(c - a).abs();
        Self(if normal.x >= normal.y && normal.x >= normal.z {
            [1, 2]
        } else if normal.y >= normal.z {
            [2, 0]
        } else {
            [0, 1]
        })
    }

    fn turn(&self, a: Point, b: Point, c: Point) -> f64 {
        let [a, b, c] = [a, b, c].map(|point| Coord { x: point[self.0[0]], y: point[self.0[1]] });
        orient2d(a, b, c)
    }

    /// Whether a segment in the plane of a triangle meets it.
    fn crosses(&self, segment: [Point; 2], triangle: [Point; 3]) -> bool {
        let inside = |point| {
            let turns = [0, 1, 2].map(|side| self.turn(triangle[side], triangle[(side + 1) % 3], point));
            turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
        };
        inside(segment[0])
            || (0..3).any(|side| self.segments_cross(segment, [triangle[side], triangle[(side + 1) % 3]]))
    }

    fn segments_cross(&self, [a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
        let apart = |p: f64, q: f64| p * q > 0.0;
        let turns = [self.turn(a, b, c), self.turn(a, b, d), self.turn(c, d, a), self.turn(c, d, b)];
        if turns == [0.0; 4] {
            return Bounds::around([a, b]).overlaps(&Bounds::around([c, d]));
        }
        !apart(turns[0], turns[1]) && !apart(turns[2], turns[3])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(corners: &[[f64; 3]], triangles: &[[u32; 3]]) -> usize {
        let positions = corners.iter().map(|&corner| Point::from_array(corner)).collect();
        let mesh = TriangleMesh { positions, triangles: triangles.to_vec() };
        self_intersections(&mesh, &Bvh::new(&mesh), 100).len()
    }

    const BASE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    fn apart(second: [[f64; 3]; 3]) -> usize {
        found(&[BASE, second].concat(), &[[0, 1, 2], [3, 4, 5]])
    }

    #[test]
    fn triangles_that_share_nothing() {
        assert_eq!(apart([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]]), 1);
        assert_eq!(apart([[1.0, 1.0, 1.0], [1.0, 1.0, 2.0], [9.0, 9.0, 1.0]]), 0);
        assert_eq!(apart([[1.0, 1.0, 0.0], [1.0, 1.0, 2.0], [9.0, 9.0, 1.0]]), 1);
        assert_eq!(apart([[3.0, 3.0, -1.0], [3.0, 3.0, 1.0], [9.0, 9.0, 1.0]]), 0);
        // In one plane: inside, overlapping, apart.
        assert_eq!(apart([[0.5, 0.5, 0.0], [1.0, 0.5, 0.0], [0.5, 1.0, 0.0]]), 1);
        assert_eq!(apart([[-1.0, 1.0, 0.0], [5.0, 1.0, 0.0], [5.0, 1.5, 0.0]]), 1);
        assert_eq!(apart([[3.0, 3.0, 0.0], [4.0, 3.0, 0.0], [3.0, 4.0, 0.0]]), 0);
    }

    #[test]
    fn neighbours_meet_only_when_they_pass_through_each_other() {
        let corners = |tips: &[[f64; 3]]| [&BASE[..], tips].concat();
        let at_vertex = [[0, 1, 2], [0, 3, 4]];
        assert_eq!(found(&corners(&[[1.0, 1.0, 1.0], [1.0, 1.0, -1.0]]), &at_vertex), 1);
        assert_eq!(found(&corners(&[[-1.0, 1.0, 1.0], [-1.0, 1.0, -1.0]]), &at_vertex), 0);
        assert_eq!(found(&corners(&[[1.0, 1.0, 0.0], [2.0, 1.0, 0.0]]), &at_vertex), 1);
        let at_edge = [[0, 1, 2], [1, 0, 3]];
        assert_eq!(found(&corners(&[[0.0, -1.0, 0.0]]), &at_edge), 0);
        assert_eq!(found(&corners(&[[0.0, 1.0, 0.0]]), &at_edge), 1);
        assert_eq!(found(&corners(&[[0.0, 1.0, 1e-9]]), &at_edge), 0);
        assert_eq!(found(&BASE, &[[0, 1, 2], [2, 1, 0]]), 1);
    }

    #[test]
    fn no_more_pairs_than_wanted_are_told() {
        let mesh =
            TriangleMesh { positions: BASE.map(Point::from_array).to_vec(), triangles: vec![[0, 1, 2]; 200] };
        let pairs = self_intersections(&mesh, &Bvh::new(&mesh), 3);
        assert_eq!(pairs.len(), 3);
        assert!(pairs.iter().all(|[a, b]| a < b));
    }
}
