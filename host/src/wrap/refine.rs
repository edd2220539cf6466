//! Positions of a finer mesh by the rules of Catmull and Clark.
//!
//! Source: E. Catmull, J. Clark, Recursively generated B-spline surfaces on arbitrary topological meshes, 1978; sharp edges
//! and boundaries as cubic B-spline curves (Vis2000 §3.4).

use rayon::prelude::*;

use super::rings::{Kind, Rings};
use crate::mesh::{Faces, Features, Point};
use crate::subdivision::Split;

/// Positions of the vertices that a split gives, in its numbering. Cost: three passes, on all threads.
pub(super) fn refine(
    faces: &Faces,
    features: &Features,
    rings: &Rings,
    split: &Split,
    positions: &[Point],
) -> Vec<Point> {
    let at = |vertex: u32| positions[vertex as usize];
    let centres: Vec<Point> = faces.iter().map(|face| mean(face.iter().map(|&corner| at(corner)))).collect();
    let sums = sums_of_faces(faces, &centres, positions.len());
    let old = (0..positions.len()).into_par_iter().map(|vertex| match rings.kind(vertex) {
        Kind::Fixed => positions[vertex],
        Kind::Crease([before, after]) => (at(before) + at(after) + 6.0 * positions[vertex]) / 8.0,
        Kind::Smooth => smooth_vertex(rings, vertex, positions, sums[vertex]),
    });
    let in_edges = split.edges.par_iter().zip(&split.edge_faces).map(|(&[from, to], sides)| match *sides {
        [Some(left), Some(right)] if !is_sharp(features, from, to) => {
            (at(from) + at(to) + centres[left as usize] + centres[right as usize]) / 4.0
        }
        _ => at(from).midpoint(at(to)),
    });
    old.chain(in_edges).chain(centres.par_iter().copied()).collect()
}

fn mean(points: impl ExactSizeIterator<Item = Point>) -> Point {
    let count = points.len() as f64;
    points.sum::<Point>() / count
}

/// For each vertex the sum of the centres of its faces.
fn sums_of_faces(faces: &Faces, centres: &[Point], vertices: usize) -> Vec<Point> {
    let mut sums = vec![Point::ZERO; vertices];
    for (face, &centre) in faces.iter().zip(centres) {
        face.iter().for_each(|&corner| sums[corner as usize] += centre);
    }
    sums
}

/// (Q + 2 R + (n - 3) p) / n with Q the mean of the faces' centres and R that of the edges' midpoints.
fn smooth_vertex(rings: &Rings, vertex: usize, positions: &[Point], faces: Point) -> Point {
    let neighbours = rings.neighbours(vertex);
    let (valence, place) = (neighbours.len() as f64, positions[vertex]);
    let ends: Point = neighbours.iter().map(|&end| positions[end as usize]).sum();
    let edges = (ends / valence + place) / 2.0;
    (faces / valence + 2.0 * edges + (valence - 3.0) * place) / valence
}

fn is_sharp(features: &Features, from: u32, to: u32) -> bool {
    !features.edges.is_empty() && features.edges.binary_search(&[from.min(to), from.max(to)]).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUBE: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

    fn refined(faces: &Faces, features: &Features, positions: &[Point]) -> Vec<Point> {
        let rings = Rings::new(positions.len(), faces, features).unwrap();
        let split = Split::new(positions.len(), faces);
        refine(faces, features, &rings, &split, positions)
    }

    fn cube() -> (Faces, Vec<Point>) {
        let corner =
            |index: u32| Point::from_array([0, 1, 2].map(|axis| f64::from(index >> axis & 1) * 2.0 - 1.0));
        (CUBE.iter().map(<[u32; 4]>::as_slice).collect(), (0..8).map(corner).collect())
    }

    #[test]
    fn a_cube_becomes_round() {
        let (faces, positions) = cube();
        let finer = refined(&faces, &Features::default(), &positions);
        assert_eq!(finer.len(), 26);
        // Corner: (Q + 2 R) / 3 with Q = 1/3 and R = 2/3 of the corner.
        assert!((finer[7] - Point::splat(5.0 / 9.0)).length() < 1e-12);
        assert!(finer[8..20].iter().all(|edge| (edge.length() - 0.75 * 2_f64.sqrt()).abs() < 1e-12));
        assert!(finer[20..].iter().all(|face| face.length() == 1.0));
    }

    #[test]
    fn sharp_edges_are_curves_and_boundaries_too() {
        let (faces, positions) = cube();
        let features = Features { edges: vec![[0, 1], [0, 2], [1, 3], [2, 3]], vertices: vec![3] };
        let finer = refined(&faces, &features, &positions);
        assert_eq!(finer[3], positions[3]);
        assert_eq!(finer[0], Point::new(-0.75, -0.75, -1.0));
        let open: Faces = CUBE[..5].iter().map(<[u32; 4]>::as_slice).collect();
        assert_eq!(refined(&open, &Features::default(), &positions)[7], Point::new(1.0, 0.75, 0.75));
    }
}
