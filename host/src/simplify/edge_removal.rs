//! Edge removal: triangles become polygons of up to five sides, so that faces and vertices have about four.
//!
//! Source: Vis2000 §4.1, Diss §4.1.5: eligible edges, and what makes one better than another. The text gives no formula for
//! the priority; here it is how much closer to four the sides of faces and the edges of vertices come, how well the normals
//! agree, and how right the angles of the new face are; faces of four sides are made before those of five. Faces that would
//! not be convex are not made, nor those that bring faces and vertices farther from four.

use super::corners::NONE;
use super::priority::{BucketQueue, rank};
use crate::mesh::{Faces, Point, PolygonMesh};
use crate::subdivision::Split;

/// Most sides of a face.
const SIDES: u32 = 5;
/// Fewest edges of a vertex that may lose one.
const VALENCE: u32 = 4;
/// Advantage of faces of four sides.
const QUADS_FIRST: f64 = 8.0;
/// Least cosine between the normals of faces that become one.
const AGREEMENT: f64 = 0.5;
/// Least sine at a corner of a new face, seen along its normal.
const CONVEX: f64 = 0.1;

/// Removes edges of a mesh, the best first, until none may go. Vertices, topology and sharp edges stay.
///
/// No edge may be shared by more than two faces.
///
/// Cost: a microsecond or two an edge.
pub fn remove_edges(mesh: &PolygonMesh) -> PolygonMesh {
    let mut removal = Removal::new(mesh);
    removal.run();
    let mut merged = PolygonMesh::new(mesh.positions.clone(), removal.faces());
    merged.features = mesh.features.clone();
    merged
}

/// A side of a face.
#[derive(Clone, Copy)]
struct Side {
    /// Where it begins; [`NONE`] once its edge is gone.
    from: u32,
    next: u32,
    previous: u32,
    /// The side across, or [`NONE`].
    twin: u32,
}

struct Removal<'a> {
    positions: &'a [Point],
    sides: Vec<Side>,
    /// How many edges each vertex has.
    valences: Vec<u32>,
    /// How many it should have: four, and three on the boundary.
    ideals: Vec<u32>,
    /// Whether the edge of each side is sharp.
    sharp: Vec<bool>,
    queue: BucketQueue,
}

impl<'a> Removal<'a> {
    fn new(mesh: &'a PolygonMesh) -> Self {
        let split = Split::new(mesh.positions.len(), mesh.faces());
        let mut removal = Self {
            positions: &mesh.positions,
            sides: rings(mesh.faces()),
            valences: vec![0; mesh.positions.len()],
            ideals: vec![4; mesh.positions.len()],
            sharp: Vec::with_capacity(split.side_edges.len()),
            queue: BucketQueue::new(split.side_edges.len() as u32),
        };
        let mut first = vec![NONE; split.edges.len()];
        for (side, &edge) in split.side_edges.iter().enumerate() {
            let ends = split.edges[edge as usize];
            let ends = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            removal.sharp.push(mesh.features.edges.binary_search(&ends).is_ok());
            let twin = std::mem::replace(&mut first[edge as usize], side as u32);
            removal.sides[side].twin = twin;
            if twin != NONE {
                removal.sides[twin as usize].twin = side as u32;
            }
        }
        for (ends, faces) in split.edges.iter().zip(&split.edge_faces) {
            for end in ends.map(|end| end as usize) {
                removal.valences[end] += 1;
                if faces[1].is_none() {
                    removal.ideals[end] = 3;
                }
            }
        }
        removal
    }

    fn run(&mut self) {
        for side in 0..self.sides.len() as u32 {
            self.offer(side);
        }
        while let Some((side, first_rank)) = self.queue.pop() {
            match self.cost(side) {
                Some(cost) if rank(cost) > first_rank => self.queue.push(side, rank(cost)),
                Some(_) => self.remove(side),
                None => (),
            }
        }
    }

    fn offer(&mut self, side: u32) {
        if let Some(cost) = self.cost(side) {
            self.queue.push(side, rank(cost));
        }
    }

    fn side(&self, side: u32) -> Side {
        self.sides[side as usize]
    }

    /// Sides of the face of a side, from that one on.
    fn ring(&self, side: u32) -> impl Iterator<Item = u32> {
        std::iter::successors(Some(side), move |&this| {
            let next = self.side(this).next;
            (next != side).then_some(next)
        })
    }

    /// How bad it is to remove the edge of a side, the first of the edge's two, if that may be done.
    fn cost(&self, side: u32) -> Option<f64> {
        let Side { from, next, twin, .. } = self.side(side);
        if from == NONE || twin == NONE || twin < side || self.sharp[side as usize] {
            return None;
        }
        let ends = [from, self.side(next).from];
        let sides = [side, twin].map(|side| self.ring(side).count() as u32);
        let merged = sides[0] + sides[1] - 2;
        let valences = ends.map(|end| self.valences[end as usize]);
        if merged > SIDES || valences.iter().any(|&valence| valence < VALENCE) {
            return None;
        }
        let corners = self.merged_corners(side)?;
        let normals = [side, twin].map(|side| self.normal(side));
        let agreement = normals[0].normalize_or_zero().dot(normals[1].normalize_or_zero());
        let skew = skew(&corners[..merged as usize], (normals[0] + normals[1]).normalize_or_zero())?;
        let off = |count: u32, ideal: u32| f64::from(count.abs_diff(ideal)).powi(2);
        let before = off(sides[0], 4) + off(sides[1], 4);
        let at_ends: f64 = ends
            .iter()
            .zip(valences)
            .map(|(&end, valence)| {
                let ideal = self.ideals[end as usize];
                off(valence, ideal) - off(valence - 1, ideal)
            })
            .sum();
        let gain = at_ends + before - off(merged, 4);
        let first = if merged == 4 { QUADS_FIRST } else { 0.0 };
        let score = first + 4.0 + gain + 2.0 * agreement - 4.0 * skew;
        (agreement >= AGREEMENT && gain >= 0.0).then(|| 1.0 / score.max(0.01))
    }

    /// Corners of the face that two faces would become, or nothing where it would meet itself.
    fn merged_corners(&self, side: u32) -> Option<[Point; SIDES as usize]> {
        let mut names = [NONE; SIDES as usize];
        let mut corners = [Point::ZERO; SIDES as usize];
        let first = self.ring(side).skip(1);
        let others = first.chain(self.ring(self.side(side).twin).skip(1));
        for (place, other) in others.enumerate() {
            let vertex = self.side(other).from;
            if names.contains(&vertex) {
                return None;
            }
            names[place] = vertex;
            corners[place] = self.positions[vertex as usize];
        }
        Some(corners)
    }

    /// Normal of a side's face, as long as twice the area.
    fn normal(&self, side: u32) -> Point {
        let position = |side: u32| self.positions[self.side(side).from as usize];
        let origin = position(side);
        self.ring(side)
            .map(|side| (position(side) - origin).cross(position(self.side(side).next) - origin))
            .sum()
    }

    fn remove(&mut self, side: u32) {
        let twin = self.side(side).twin;
        for [gone, across] in [[side, twin], [twin, side]] {
            let Side { previous, from, .. } = self.side(gone);
            let next = self.side(across).next;
            self.sides[previous as usize].next = next;
            self.sides[next as usize].previous = previous;
            self.valences[from as usize] -= 1;
        }
        let start = self.side(side).next;
        for gone in [side, twin] {
            self.sides[gone as usize].from = NONE;
        }
        let ring: Vec<u32> = self.ring(start).collect();
        for side in ring {
            self.offer(side.min(self.side(side).twin));
        }
    }

    /// Faces that are left, in the order of their first sides.
    fn faces(&self) -> Faces {
        let mut seen = vec![false; self.sides.len()];
        let mut faces = Faces::default();
        for side in 0..self.sides.len() as u32 {
            if self.side(side).from != NONE && !seen[side as usize] {
                let ring = self.ring(side).inspect(|&side| seen[side as usize] = true);
                let corners: Vec<u32> = ring.map(|side| self.side(side).from).collect();
                faces.push(&corners);
            }
        }
        faces
    }
}

/// Sides of faces, without what is across.
fn rings(faces: &Faces) -> Vec<Side> {
    let mut sides = Vec::with_capacity(faces.corners().len());
    for corners in faces.iter() {
        let [start, count] = [sides.len() as u32, corners.len() as u32];
        sides.extend((0..count).zip(corners).map(|(place, &from)| Side {
            from,
            next: start + (place + 1) % count,
            previous: start + (place + count - 1) % count,
            twin: NONE,
        }));
    }
    sides
}

/// Mean square cosine of the angles of a face, 0 for a rectangle; nothing where it is not convex.
fn skew(corners: &[Point], normal: Point) -> Option<f64> {
    let count = corners.len();
    let mut sum = 0.0;
    for place in 0..count {
        let corner = corners[place];
        let out = (corners[(place + 1) % count] - corner).normalize_or_zero();
        let back = (corners[(place + count - 1) % count] - corner).normalize_or_zero();
        if out.cross(back).dot(normal) < CONVEX {
            return None;
        }
        sum += out.dot(back) * out.dot(back);
    }
    Some(sum / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TriangleMesh;

    /// A flat grid of squares, each cut in two.
    fn grid(size: u32) -> PolygonMesh {
        let positions =
            (0..size * size).map(|node| Point::new(f64::from(node % size), f64::from(node / size), 0.0));
        let squares =
            (0..(size - 1) * (size - 1)).map(|square| square / (size - 1) * size + square % (size - 1));
        let triangles = squares
            .flat_map(|node| [[node, node + 1, node + size + 1], [node, node + size + 1, node + size]]);
        TriangleMesh { positions: positions.collect(), triangles: triangles.collect() }.into()
    }

    #[test]
    fn a_grid_of_halves_becomes_one_of_squares() {
        let merged = remove_edges(&grid(9));
        let quads = merged.faces().iter().filter(|face| face.len() == 4).count();
        // The corners where two halves meet have three edges only: their diagonals stay.
        assert_eq!([quads, merged.faces().len()], [62, 66]);
    }

    #[test]
    fn sharp_edges_stay() {
        let mut mesh = grid(4);
        mesh.features.edges = vec![[5, 10]];
        let merged = remove_edges(&mesh);
        let halves = merged.faces().iter().filter(|face| face.contains(&5) && face.contains(&10));
        assert_eq!(halves.count(), 2);
        assert_eq!(merged.features, mesh.features);
    }
}
