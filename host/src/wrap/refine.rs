//! Positions of a finer mesh by the rules of Catmull and Clark.
//!
//! Source: E. Catmull, J. Clark, Recursively generated B-spline surfaces on arbitrary topological meshes, 1978; sharp edges
//! and boundaries as cubic B-spline curves (Vis2000 §3.4).
//!
//! These rules pull old vertices off the surface that they were attracted to, and a small closed mesh to a fraction of its
//! size. Here every vertex is pushed back by what the rules take from the old vertices around it, as Maillot and Stam do (A
//! unified subdivision scheme for polygonal modeling, 2001), so that old vertices stay and new ones are near the surface.

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
    // What the rules take from each old vertex, and is given back.
    let lost: Vec<Point> = (0..positions.len())
        .into_par_iter()
        .map(|vertex| match rings.kind(vertex) {
            Kind::Fixed => Point::ZERO,
            Kind::Crease([before, after]) => (2.0 * positions[vertex] - at(before) - at(after)) / 8.0,
            Kind::Smooth => positions[vertex] - smooth_vertex(rings, vertex, positions, sums[vertex]),
        })
        .collect();
    let in_edges = split.edges.par_iter().zip(&split.edge_faces).map(|(&[from, to], sides)| {
        let back = lost[from as usize].midpoint(lost[to as usize]);
        let [from_place, to_place] = [at(from), at(to)];
        back + match *sides {
            [Some(left), Some(right)] if !is_sharp(features, from, to) => {
                (from_place + to_place + centres[left as usize] + centres[right as usize]) / 4.0
            }
            _ => from_place.midpoint(to_place),
        }
    });
    let in_faces = (0..faces.len())
        .into_par_iter()
        .map(|face| centres[face] + mean(faces.get(face).iter().map(|&corner| lost[corner as usize])));
    positions.par_iter().copied().chain(in_edges).chain(in_faces).collect()
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
        assert_eq!(finer[..8], positions);
        // The rules leave a corner 5/9 of its coordinates, so that 4/9 are given back.
        let radius = (0.75 + 4.0 / 9.0) * 2_f64.sqrt();
        assert!(finer[8..20].iter().all(|edge| (edge.length() - radius).abs() < 1e-12));
        assert!(finer[20..].iter().all(|face| (face.length() - 13.0 / 9.0).abs() < 1e-12));
    }

    #[test]
    fn sharp_edges_are_curves_and_boundaries_too() {
        let (faces, positions) = cube();
        let features = Features { edges: vec![[0, 1], [0, 2], [1, 3], [2, 3]], vertices: vec![3] };
        let finer = refined(&faces, &features, &positions);
        // Between vertex 0, which a curve would take a quarter from along both edges, and vertex 1, from which as much.
        let edge =
            Split::new(8, &faces).edges.iter().position(|&ends| ends == [1, 0] || ends == [0, 1]).unwrap();
        assert_eq!(finer[8 + edge], Point::new(0.0, -1.25, -1.0));
        let open: Faces = CUBE[..5].iter().map(<[u32; 4]>::as_slice).collect();
        let edge =
            Split::new(8, &open).edges.iter().position(|&ends| ends == [3, 7] || ends == [7, 3]).unwrap();
        assert_eq!(refined(&open, &Features::default(), &positions)[8 + edge], Point::new(1.0, 1.25, 0.0));
    }
}
