//! Relaxation: every vertex moves towards its neighbours.
//!
//! Source: Dataflow §3: p' = (1 - alpha) p + alpha sum(r p) / sum(r) over the edge neighbours, r being the lengths of the
//! edges; and the correction that keeps curved places from shrinking: p' is put on the quadratic height map over the tangent
//! plane that passes through p and fits the neighbours best.

use glam::{DMat3, DVec2};

use super::rings::{Kind, Rings};
use crate::mesh::Point;

/// How much of a height map's normal equations is added to their diagonal. The mixed term is unknown where the neighbours
/// lie on two crossing lines; this makes it zero there.
const RIDGE: f64 = 1e-3;

/// Where a vertex moves to. On creases only the neighbours along the crease count; fixed vertices stay.
pub(super) fn relaxed(
    rings: &Rings,
    vertex: usize,
    positions: &[Point],
    alpha: f64,
    keep_height: bool,
) -> Point {
    let place = positions[vertex];
    match rings.kind(vertex) {
        Kind::Fixed => place,
        Kind::Crease(ends) => place + alpha * towards(place, ends.iter(), positions),
        Kind::Smooth => {
            let neighbours = rings.neighbours(vertex);
            let step = alpha * towards(place, neighbours.iter(), positions);
            let normal = rings.normal(vertex, positions).normalize_or_zero();
            if !keep_height || normal == Point::ZERO {
                return place + step;
            }
            let spokes = neighbours.iter().map(|&end| positions[end as usize] - place);
            place + on_height_map(spokes, normal, step)
        }
    }
}

/// From a place to the mean of its neighbours, weighted with their distances.
fn towards<'a>(place: Point, ends: impl Iterator<Item = &'a u32>, positions: &[Point]) -> Point {
    let (mut sum, mut weights) = (Point::ZERO, 0.0);
    for &end in ends {
        let spoke = positions[end as usize] - place;
        let length = spoke.length();
        sum += length * spoke;
        weights += length;
    }
    if weights > 0.0 { sum / weights } else { Point::ZERO }
}

/// A step, with its part along the normal replaced by the height over the tangent plane.
fn on_height_map(spokes: impl Iterator<Item = Point>, normal: Point, step: Point) -> Point {
    let (right, up) = normal.any_orthonormal_pair();
    let flat = |vector: Point| DVec2::new(vector.dot(right), vector.dot(up));
    let powers = |at: DVec2| Point::new(at.x * at.x, at.x * at.y, at.y * at.y);
    let (mut matrix, mut heights, mut size) = (DMat3::ZERO, Point::ZERO, 0.0);
    for spoke in spokes {
        let terms = powers(flat(spoke));
        matrix += DMat3::from_cols(terms * terms.x, terms * terms.y, terms * terms.z);
        heights += terms * spoke.dot(normal);
        size += spoke.length_squared();
    }
    let ridge = RIDGE * (matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z);
    matrix += DMat3::from_diagonal(Point::splat(ridge));
    // A determinant of sixth order in squared lengths.
    if matrix.determinant() <= f64::EPSILON * size.powi(6) * RIDGE.powi(3) {
        return step;
    }
    let along = flat(step);
    let height = powers(along).dot(matrix.inverse() * heights);
    along.x * right + along.y * up + height * normal
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Faces, Features};

    fn fan(tip: Point) -> (Rings, Vec<Point>) {
        let faces: Faces =
            [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]].iter().map(<[u32; 3]>::as_slice).collect();
        let ring = [Point::new(1.0, 1.0, 0.0), Point::new(-1.0, 1.0, 0.0), Point::new(-1.0, -1.0, 0.0)];
        let positions = [tip].into_iter().chain(ring).chain([Point::new(1.0, -1.0, 0.0)]).collect();
        (Rings::new(5, &faces, &Features::default()).unwrap(), positions)
    }

    #[test]
    fn vertices_move_towards_long_edges() {
        let (rings, positions) = fan(Point::new(0.5, 0.0, 0.0));
        let moved = relaxed(&rings, 0, &positions, 0.2, false);
        assert!(moved.x < 0.4 && moved.x > 0.3 && moved.y.abs() < 1e-12, "{moved}");
        // A boundary vertex heeds its two neighbours on the boundary alone.
        let along = relaxed(&rings, 1, &positions, 0.2, false);
        assert!((along - Point::new(0.8, 0.8, 0.0)).length() < 1e-12);
    }

    #[test]
    fn height_is_kept_where_asked() {
        let (rings, positions) = fan(Point::new(0.0, 0.0, 1.0));
        assert!((relaxed(&rings, 0, &positions, 0.2, false).z - 0.8).abs() < 1e-12);
        assert_eq!(relaxed(&rings, 0, &positions, 0.2, true).z, 1.0);
        // On a paraboloid the step follows it.
        let (rings, mut positions) = fan(Point::new(0.4, 0.1, 0.0));
        for place in &mut positions {
            place.z = -0.1 * (place.x * place.x + place.y * place.y);
        }
        let off = |keep_height| {
            let moved = relaxed(&rings, 0, &positions, 0.5, keep_height);
            (moved.z + 0.1 * (moved.x * moved.x + moved.y * moved.y)).abs()
        };
        assert!(off(true) < 0.02 && off(false) > 0.08, "{} {}", off(true), off(false));
    }

    #[test]
    fn degenerate_rings_do_not_break() {
        let (rings, positions) = fan(Point::ZERO);
        let line: Vec<Point> = (0..5).map(|index| Point::X * f64::from(index)).collect();
        let same = vec![Point::ONE; 5];
        for positions in [&line, &same, &positions] {
            assert!(relaxed(&rings, 0, positions, 0.2, true).is_finite());
        }
        assert_eq!(relaxed(&rings, 0, &same, 0.2, true), Point::ONE);
    }
}
