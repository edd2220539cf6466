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

use wide::f64x8;

use super::legality::{MOST, Place};
use super::star::Star;
use super::surface::{Kind, Surface, Vertex};
use crate::mesh::Point;

/// Smallest error of a collapse, so that shapes of triangles decide where all is flat.
const LEAST: f64 = 1e-8;
/// Least cosine between the normals of a triangle before and after.
const TURN: f64 = 0.25;

/// Most triangles of a star.
const LANES: usize = MOST as usize;

/// What an edge would collapse to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) position: Point,
    /// Total error (4.3), in units of `1 / per_unit`.
    pub(super) error: f64,
}

/// A number for each triangle of a star.
type Lanes = f64x8;

/// A vector for each triangle of a star.
type Vectors = [Lanes; 3];

/// The triangles of a star as vectors from the first end of the edge, all at a time. Lanes beyond the last triangle hold the
/// first one again.
struct Ring {
    /// 1 for each triangle, 0 beyond the last.
    there: Lanes,
    /// 1 for each triangle at the second end.
    second: Lanes,
    /// From one rim vertex to the other.
    rims: Vectors,
    /// Cross product of the vectors to both rim vertices: twice the area where the first end is the third vertex.
    crosses: Vectors,
    /// The second end.
    edge: Point,
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
    let ring = Ring::new(surface, star, ends);
    let offset = match place {
        Place::End(0) => Point::ZERO,
        Place::End(_) => ring.edge,
        Place::Between if ends[0].kind == Kind::Smooth => ring.between(),
        Place::Between => 0.5 * ring.edge,
    };
    let (distance, shape) = ring.deviation(offset)?;
    let position = match place {
        Place::End(end) => ends[end].position,
        Place::Between => ends[0].position + offset,
    };
    let along = ends[0].kind != Kind::Smooth && ends[1].kind != Kind::Smooth;
    let aside = if along { curve_distance(surface, side, position) } else { 0.0 };
    let distance = distance.max(aside) * per_unit;
    let accumulated = f64::from(ends[0].accumulated.max(ends[1].accumulated));
    Some(Candidate { position, error: accumulated + distance.max(LEAST) * shape })
}

impl Ring {
    #[inline]
    fn new(surface: &Surface, star: &Star, ends: [&Vertex; 2]) -> Self {
        let origin = ends[0].position;
        let wings = star.wings();
        let mut at = [[[0.0; LANES]; 3]; 2];
        for lane in 0..LANES {
            let wing = &wings[if lane < wings.len() { lane } else { 0 }];
            for (at, &vertex) in at.iter_mut().zip(&wing.rim) {
                let way = surface.vertex(vertex).position - origin;
                (at[0][lane], at[1][lane], at[2][lane]) = (way.x, way.y, way.z);
            }
        }
        let [from, to] = at.map(|axes| axes.map(Lanes::new));
        let share = |from: usize| {
            let lanes: [f64; LANES] =
                std::array::from_fn(|lane| f64::from(u8::from(lane >= from && lane < wings.len())));
            Lanes::new(lanes)
        };
        Self {
            there: share(0),
            second: share(star.split),
            rims: minus(&to, &from),
            crosses: cross(&from, &to),
            edge: ends[1].position - origin,
        }
    }

    /// The middle of the edge, moved along the ring's normal so that the volume stays.
    fn between(&self) -> Point {
        let [area, second] = [self.there, self.second].map(|share| sum(&self.crosses, share));
        let middle = 0.5 * self.edge;
        // Six times the volumes between the ring and the first end: before, and less that of the middle.
        let volume = self.edge.dot(second) - middle.dot(area);
        let shift = area * (volume / area.length_squared().max(f64::MIN_POSITIVE));
        middle + shift.clamp_length_max(middle.length())
    }

    /// The larger distance of the ends from the planes of the new triangles (4.1), and the factor of (4.2), which is 1 for a
    /// flat ring of equal triangles and large for skewed and tangled ones; nothing where a triangle turns over.
    fn deviation(&self, offset: Point) -> Option<(f64, f64)> {
        let splat = |vector: Point| vector.to_array().map(Lanes::splat);
        let (rest, offset, edge) = (splat(self.edge - offset), splat(offset), splat(self.edge));
        let normals = minus(&self.crosses, &cross(&offset, &self.rims));
        let moved = cross(&edge, &self.rims);
        let before: Vectors = std::array::from_fn(|axis| self.crosses[axis] - self.second * moved[axis]);
        let (squares, agreement) = (dot(&normals, &normals), dot(&normals, &before));
        let least = squares * Lanes::splat(TURN * TURN) * dot(&before, &before);
        // Written so that a triangle without area is none that agrees.
        let agrees = agreement.simd_gt(Lanes::ZERO) & (agreement * agreement).simd_gt(least);
        if !agrees.all() {
            return None;
        }
        let inverse = Lanes::ONE / squares.sqrt();
        let distances = dot(&offset, &normals).abs().fast_max(dot(&rest, &normals).abs()) * inverse;
        let sum = sum(&normals, inverse * self.there);
        let least = -greatest(-dot(&normals, &splat(sum)));
        let scale = (sum.length_squared() * greatest(squares)).max(f64::MIN_POSITIVE).sqrt();
        let factor = 2.0 - least.min(scale) / scale;
        Some((greatest(distances), (factor * factor) * (factor * factor)))
    }
}

/// The sum of vectors, with a weight for each, in order.
#[inline(always)]
fn sum(vectors: &Vectors, weights: Lanes) -> Point {
    Point::from_array(vectors.each_ref().map(|lanes| (*lanes * weights).to_array().iter().sum()))
}

/// The greatest of all lanes.
#[inline(always)]
fn greatest(lanes: Lanes) -> f64 {
    lanes.to_array().into_iter().fold(f64::NEG_INFINITY, |most, lane| if lane > most { lane } else { most })
}

#[inline(always)]
fn minus(a: &Vectors, b: &Vectors) -> Vectors {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

#[inline(always)]
fn dot(a: &Vectors, b: &Vectors) -> Lanes {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: &Vectors, b: &Vectors) -> Vectors {
    let across = |y: usize, z: usize| a[y] * b[z] - a[z] * b[y];
    [across(1, 2), across(2, 0), across(0, 1)]
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
            let along = offset.dot(edge) / edge.length_squared().max(f64::MIN_POSITIVE);
            (offset - along.clamp(0.0, 1.0) * edge).length()
        })
    });
    distances[0].max(distances[1])
}
