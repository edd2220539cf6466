//! Generalized lifting of points on one step of subdivision.
//!
//! Source: Diss eq. (4.12) and (4.13), the forms in which corners read the edges as they are after the lift; the three
//! rules of Vis2000 §3.4. Sums run over edges and faces in their order, so that a result is always the same.

use super::basis::{Kind, Lift};
use crate::mesh::Point;
use crate::subdivision::{EdgeRule, Step, VertexRule};

/// The vertices of a finer mesh by what they come from.
struct Parts<'a> {
    old: &'a mut [Point],
    edges: &'a mut [Point],
    faces: &'a mut [Point],
}

impl<'a> Parts<'a> {
    fn new(step: &Step, points: &'a mut [Point]) -> Self {
        let (old, added) = points.split_at_mut(step.split.coarser_vertices());
        let (edges, faces) = added.split_at_mut(step.split.edges.len());
        Self { old, edges, faces }
    }
}

/// Applies a lift to the points of the finer mesh of a step.
///
/// # Panics
/// If there is not one point a vertex of the finer mesh.
pub(super) fn lift(step: &Step, points: &mut [Point], lift: Lift) {
    assert_eq!(points.len(), step.split.finer_vertices(), "one point a vertex of the finer mesh");
    let parts = &mut Parts::new(step, points);
    let Lift { kind, a, b } = lift;
    match kind {
        Kind::S => {
            edges_from_faces(step, parts, |edge, sum| edge * b + sum * a);
            let sums = sums_at_old(step, parts, a);
            old_from(step, parts, &sums, |old, b_squared, average| old * b_squared + average, b);
        }
        Kind::W => {
            edges_from_old(step, parts, |edge, sum| edge * b + sum * a);
            faces_from(step, parts, a, |face, average| face * (b * b) + average);
        }
    }
}

/// Undoes [`lift`].
///
/// # Panics
/// If there is not one point a vertex of the finer mesh.
pub(super) fn unlift(step: &Step, points: &mut [Point], lift: Lift) {
    assert_eq!(points.len(), step.split.finer_vertices(), "one point a vertex of the finer mesh");
    let parts = &mut Parts::new(step, points);
    let Lift { kind, a, b } = lift;
    match kind {
        Kind::S => {
            let sums = sums_at_old(step, parts, a);
            old_from(step, parts, &sums, |old, b_squared, average| (old - average) / b_squared, b);
            edges_from_faces(step, parts, |edge, sum| (edge - sum * a) / b);
        }
        Kind::W => {
            faces_from(step, parts, a, |face, average| (face - average) / (b * b));
            edges_from_old(step, parts, |edge, sum| (edge - sum * a) / b);
        }
    }
}

/// Moves edges by the sum over the two faces beside each, 2 f̄_e; the first rule of Vis2000 §3.4 leaves some alone.
fn edges_from_faces(step: &Step, parts: &mut Parts<'_>, moved: impl Fn(Point, Point) -> Point) {
    let sides = step.split.edge_faces.iter().zip(&step.rules.edges);
    for (edge, (faces, rule)) in parts.edges.iter_mut().zip(sides) {
        if let ([Some(one), Some(other)], EdgeRule::Smooth) = (*faces, rule) {
            *edge = moved(*edge, parts.faces[one as usize] + parts.faces[other as usize]);
        }
    }
}

/// Moves edges by the sum of their ends, 2 v̄_e.
fn edges_from_old(step: &Step, parts: &mut Parts<'_>, moved: impl Fn(Point, Point) -> Point) {
    for (edge, [from, to]) in parts.edges.iter_mut().zip(&step.split.edges) {
        *edge = moved(*edge, parts.old[*from as usize] + parts.old[*to as usize]);
    }
}

/// For every old vertex of valence n, n (4a ē_v - 4a² f̄_v); on a crease of n sharp edges, n 2a ē_v over those.
fn sums_at_old(step: &Step, parts: &Parts<'_>, a: f64) -> Vec<Point> {
    let mut sums = vec![Point::ZERO; parts.old.len()];
    let rules = &step.rules;
    for ((&edge, ends), rule) in parts.edges.iter().zip(&step.split.edges).zip(&rules.edges) {
        for end in ends.map(|end| end as usize) {
            match rules.vertices[end] {
                VertexRule::Smooth => sums[end] += edge * (4.0 * a),
                VertexRule::Crease if *rule == EdgeRule::Sharp => sums[end] += edge * (2.0 * a),
                _ => {}
            }
        }
    }
    let middle = step.split.face_vertex(0);
    for quad in &step.split.quads {
        let corner = quad[0] as usize;
        if rules.vertices[corner] == VertexRule::Smooth {
            sums[corner] -= parts.faces[(quad[2] - middle) as usize] * (4.0 * a * a);
        }
    }
    sums
}

/// Moves old vertices, by b² where they are smooth and by b on a crease; the second and third rule of Vis2000 §3.4.
fn old_from(
    step: &Step,
    parts: &mut Parts<'_>,
    sums: &[Point],
    moved: impl Fn(Point, f64, Point) -> Point,
    b: f64,
) {
    let rules = step.rules.vertices.iter().zip(&step.rules.movers);
    for ((old, &sum), (rule, &movers)) in parts.old.iter_mut().zip(sums).zip(rules) {
        let average = sum / f64::from(movers);
        match rule {
            VertexRule::Smooth => *old = moved(*old, b * b, average),
            VertexRule::Crease => *old = moved(*old, b, average),
            VertexRule::Fixed => {}
        }
    }
}

/// Moves vertices in faces by 4a ē_f - 4a² v̄_f.
fn faces_from(step: &Step, parts: &mut Parts<'_>, a: f64, moved: impl Fn(Point, Point) -> Point) {
    let mut first = 0;
    let quads = step.split.quads.chunk_by(|one, next| one[2] == next[2]);
    for (face, quads) in parts.faces.iter_mut().zip(quads) {
        let sides = &step.split.side_edges[first..first + quads.len()];
        first += quads.len();
        let corners: Point = quads.iter().map(|quad| parts.old[quad[0] as usize]).sum();
        let edges: Point = sides.iter().map(|&edge| parts.edges[edge as usize]).sum();
        let sum = edges * (4.0 * a) - corners * (4.0 * a * a);
        *face = moved(*face, sum / quads.len() as f64);
    }
}
