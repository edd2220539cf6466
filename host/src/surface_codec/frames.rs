//! Local frames, from the coarser level.
//!
//! Encoder and decoder compute them from the same points by `+ - * /` and square roots, each rounded once as IEEE 754
//! says, so that they agree on every machine.

use crate::mesh::Point;
use crate::subdivision::Step;

/// Normal and two tangents, orthonormal.
pub(super) type Frame = [Point; 3];

/// Frames at the vertices that a step adds, edges first, given the points of the coarser mesh.
pub(super) fn frames(step: &Step, coarser: &[Point]) -> Vec<Frame> {
    let split = &step.split;
    let at = |vertex: u32| coarser[vertex as usize];
    let faces: Vec<Frame> = split
        .quads
        .chunk_by(|one, next| one[2] == next[2])
        .map(|quads| {
            let corners = |side: usize| at(quads[side % quads.len()][0]);
            let first = corners(0);
            let normal = (1..quads.len() - 1)
                .map(|side| (corners(side) - first).cross(corners(side + 1) - first))
                .sum();
            [normal, corners(1) - first, Point::ZERO]
        })
        .collect();
    let edges = split.edges.iter().zip(&split.edge_faces).map(|(ends, beside)| {
        let normal = beside.iter().flatten().map(|&face| faces[face as usize][0]).sum();
        orthonormal(normal, at(ends[1]) - at(ends[0]))
    });
    edges.chain(faces.iter().map(|&[normal, along, _]| orthonormal(normal, along))).collect()
}

fn orthonormal(normal: Point, along: Point) -> Frame {
    let normal = unit(normal, Point::Z);
    // A direction that is not that of the normal, where the given one is.
    let other = if normal.x.abs() < 0.75 { Point::X } else { Point::Y };
    let flat = |direction: Point| direction - normal * normal.dot(direction);
    let tangent = unit(flat(along), unit(flat(other), Point::X));
    [normal, tangent, normal.cross(tangent)]
}

fn unit(vector: Point, otherwise: Point) -> Point {
    let length = vector.dot(vector).sqrt();
    if length > 1e-150 && length < 1e150 { vector / length } else { otherwise }
}

/// A vector of the world in a frame.
pub(super) fn local(frame: &Frame, vector: Point) -> [f64; 3] {
    frame.map(|axis| axis.dot(vector))
}

/// The opposite of [`local`].
pub(super) fn world(frame: &Frame, [normal, first, second]: [f64; 3]) -> Point {
    frame[0] * normal + frame[1] * first + frame[2] * second
}
