//! How far a collapse takes the surface away from where it was: position and error of the merged vertex.
//!
//! Source: Vis2000 §4.1, equations (4.1) to (4.3), Diss (4.23) to (4.25). The text takes the middle of the edge, whose
//! distance from a plane through the ends is half the edge's. Here the distances of both ends from the new planes are
//! taken, which is the same in the middle and holds for other places too.

use super::legality::Place;
use super::star::Star;
use super::surface::{Kind, Surface, Vertex};
use crate::mesh::Point;

/// Smallest error of a collapse, so that shapes of triangles decide where all is flat.
const LEAST: f64 = 1e-8;
/// Least cosine between the normals of a triangle before and after.
const TURN: f64 = 0.25;

/// What an edge would collapse to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) position: Point,
    /// Total error of the text, in units of `1 / per_unit`.
    pub(super) error: f64,
}

/// Position and error of the collapse of a side's edge, or nothing where a triangle would turn over.
pub(super) fn candidate(
    surface: &Surface,
    side: u32,
    place: Place,
    star: &Star,
    per_unit: f64,
) -> Option<Candidate> {
    let ends = surface.corners.ends(side).map(|vertex| surface.vertex(vertex));
    let position = match place {
        Place::End(end) => ends[end].position,
        Place::Between => between(surface, ends, star),
    };
    let offsets = ends.map(|end| end.position - position);
    let mut rings = [(Point::ZERO, 0.0); super::legality::MOST as usize];
    let mut distance = 0.0_f64;
    for (wing, ring) in star.wings().iter().zip(&mut rings) {
        let [from, to] = wing.rim.map(|vertex| surface.vertex(vertex).position - position);
        let normal = from.cross(to);
        let end = offsets[wing.end];
        let before = (from - end).cross(to - end);
        let [length, agreement] = [normal.length_squared(), normal.dot(before)];
        if !(agreement > 0.0 && agreement * agreement > TURN * TURN * length * before.length_squared()) {
            return None;
        }
        let length = length.sqrt();
        let farthest = offsets.map(|end| end.dot(normal).abs());
        distance = distance.max(farthest[0].max(farthest[1]) / length);
        *ring = (normal, length);
    }
    let rings = &rings[..star.wings().len()];
    if place_is_on_curve(ends) {
        distance = distance.max(curve_distance(surface, side, position));
    }
    let accumulated = f64::from(ends[0].accumulated.max(ends[1].accumulated));
    let error = accumulated + (distance * per_unit).max(LEAST) * shape(rings);
    Some(Candidate { position, error })
}

/// The factor of (4.2): near 1 for a flat ring of equal triangles, large for skewed and tangled ones.
fn shape(ring: &[(Point, f64)]) -> f64 {
    let normal: Point = ring.iter().map(|&(normal, length)| normal / length).sum();
    let normal = normal.normalize_or_zero();
    let least = ring.iter().map(|(cross, _)| cross.dot(normal)).fold(f64::INFINITY, f64::min);
    let most = ring.iter().map(|&(_, length)| length).fold(0.0, f64::max);
    let factor = 2.0 - least / most;
    let second = factor * factor;
    let fourth = second * second;
    let eighth = fourth * fourth;
    eighth * eighth
}

fn between(_surface: &Surface, [first, second]: [&Vertex; 2], _star: &Star) -> Point {
    first.position.midpoint(second.position)
}

fn place_is_on_curve(ends: [&Vertex; 2]) -> bool {
    ends.iter().all(|end| end.kind != Kind::Smooth)
}

/// How far the ends of an edge of a curve are from the curve's new edges.
fn curve_distance(surface: &Surface, side: u32, position: Point) -> f64 {
    let ends = surface.corners.ends(side);
    let distances = [[0, 1], [1, 0]].map(|[this, other]| {
        let end = surface.vertex(ends[this]);
        let offset = end.position - position;
        let before = surface.along(ends[this], ends[other]).filter(|_| end.kind == Kind::Curve);
        before.map_or(0.0, |before| {
            let edge = before - position;
            edge.cross(offset).length() / edge.length().max(f64::MIN_POSITIVE)
        })
    });
    distances[0].max(distances[1])
}
