//! How far a collapse takes the surface away from where it was: position and error of the merged vertex.
//!
//! Source: Vis2000 §4.1, equations (4.1) to (4.3), Diss (4.23) to (4.25), with three changes.
//!
//! The text puts the merged vertex in the middle of the edge and names volume preservation (Lindstrom and Turk, *Fast and
//! memory efficient polygonal simplification*, 1998) as something to test. Here the middle is moved along the normal of the
//! ring so that the enclosed volume stays. The text's distance, half the edge along a new normal, becomes that of both ends
//! from the new planes, which is the same in the middle and holds for other places too; along curves the distance from the
//! curve's new edges counts as well. And the factor for shape has the power 4 instead of 16. At 2 % of the vertices of the
//! horse the root mean square distance is 0.76 mean edges by the text, 0.31 with the volume kept, 0.21 with the fourth power
//! too, and 0.27 with the quadrics of meshoptimizer, whose triangles are less regular; on turbulence it is 1.02, 0.68, 0.40
//! and 0.33 cells.

use super::legality::{MOST, Place};
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
    /// Total error (4.3), in units of `1 / per_unit`.
    pub(super) error: f64,
}

/// A triangle at the merged vertex: its normal of twice its area, and the length of that.
type Sector = (Point, f64);

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
    let mut sectors = [(Point::ZERO, 0.0); MOST as usize];
    let distance = turn(surface, star, ends, position, &mut sectors)?;
    let along = ends.iter().all(|end| end.kind != Kind::Smooth);
    let aside = if along { curve_distance(surface, side, position) } else { 0.0 };
    let distance = distance.max(aside) * per_unit;
    let accumulated = f64::from(ends[0].accumulated.max(ends[1].accumulated));
    let error = accumulated + distance.max(LEAST) * shape(&sectors[..star.wings().len()]);
    Some(Candidate { position, error })
}

/// Finds the new triangles and the larger distance of the ends from their planes (4.1); nothing where one turns over.
fn turn(
    surface: &Surface,
    star: &Star,
    ends: [&Vertex; 2],
    position: Point,
    sectors: &mut [Sector],
) -> Option<f64> {
    let offsets = ends.map(|end| end.position - position);
    let mut distance = 0.0_f64;
    for (wing, sector) in star.wings().iter().zip(sectors) {
        let [from, to] = wing.rim.map(|vertex| surface.vertex(vertex).position - position);
        let normal = from.cross(to);
        let before = (from - offsets[wing.end]).cross(to - offsets[wing.end]);
        let (square, agreement) = (normal.length_squared(), normal.dot(before));
        // Written so that a triangle without area is none that agrees.
        let agrees =
            agreement > 0.0 && agreement * agreement > TURN * TURN * square * before.length_squared();
        if !agrees {
            return None;
        }
        let length = square.sqrt();
        let farthest = offsets[0].dot(normal).abs().max(offsets[1].dot(normal).abs());
        distance = distance.max(farthest / length);
        *sector = (normal, length);
    }
    Some(distance)
}

/// The factor of (4.2): 1 for a flat ring of equal triangles, large for skewed and tangled ones.
fn shape(sectors: &[Sector]) -> f64 {
    let normal: Point = sectors.iter().map(|&(normal, length)| normal / length).sum();
    let normal = normal.normalize_or_zero();
    let least = sectors.iter().map(|(cross, _)| cross.dot(normal)).fold(f64::INFINITY, f64::min);
    let most = sectors.iter().map(|&(_, length)| length).fold(f64::MIN_POSITIVE, f64::max);
    let factor = 2.0 - least.min(most) / most;
    (factor * factor) * (factor * factor)
}

/// The middle of an edge, moved along the ring's normal so that the volume stays; on curves just the middle.
fn between(surface: &Surface, [first, second]: [&Vertex; 2], star: &Star) -> Point {
    let middle = first.position.midpoint(second.position);
    if first.kind != Kind::Smooth {
        return middle;
    }
    let local = |vertex: u32| surface.vertex(vertex).position - middle;
    let ends = [first.position - middle, second.position - middle];
    let edge = ends[0].cross(ends[1]);
    let mut volume = edge.dot(local(star.across[0])) - edge.dot(local(star.across[1]));
    let mut area = Point::ZERO;
    for wing in star.wings() {
        let cross = local(wing.rim[0]).cross(local(wing.rim[1]));
        area += cross;
        volume += ends[wing.end].dot(cross);
    }
    let shift = area * (volume / area.length_squared().max(f64::MIN_POSITIVE));
    middle + shift.clamp_length_max(ends[0].length())
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
