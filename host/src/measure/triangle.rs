//! The point of a triangle that is closest to a given one.

use crate::mesh::Point;

/// Three corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle(pub [Point; 3]);

/// A point of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The point.
    pub point: Point,
    /// Its barycentric coordinates. They sum to 1 but for rounding, and those of corners that do not matter are exactly 0:
    /// two zeros tell that the point is a corner, one that it is on a side.
    pub weights: [f64; 3],
}

impl Triangle {
    /// The closest point to `point`. Triangles without area are taken for the sides that they consist of.
    ///
    /// Source: Ericson, *Real-Time Collision Detection*, 2005, §5.1.5 (Voronoi regions by signs of areas).
    pub fn nearest(&self, point: Point) -> Nearest {
        let [a, b, c] = self.0;
        let (ab, ac, ap) = (b - a, c - a, point - a);
        let (d1, d2) = (ab.dot(ap), ac.dot(ap));
        if d1 <= 0.0 && d2 <= 0.0 {
            return self.at([1.0, 0.0, 0.0]);
        }
        let bp = point - b;
        let (d3, d4) = (ab.dot(bp), ac.dot(bp));
        if d3 >= 0.0 && d4 <= d3 {
            return self.at([0.0, 1.0, 0.0]);
        }
        let cp = point - c;
        let (d5, d6) = (ab.dot(cp), ac.dot(cp));
        if d6 >= 0.0 && d5 <= d6 {
            return self.at([0.0, 0.0, 1.0]);
        }
        let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
        let area = va + vb + vc;
        if area <= 0.0 || area.is_nan() {
            return self.nearest_of_sides(point);
        }
        if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
            return self.on_side(0, d1 / (d1 - d3));
        }
        if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
            return self.on_side(2, d6 / (d6 - d2));
        }
        let (from_b, from_c) = (d4 - d3, d5 - d6);
        if va <= 0.0 && from_b >= 0.0 && from_c >= 0.0 {
            return self.on_side(1, from_b / (from_b + from_c));
        }
        let (v, w) = (vb / area, vc / area);
        Nearest { point: a + ab * v + ac * w, weights: [1.0 - v - w, v, w] }
    }

    /// The closest point of the outline.
    fn nearest_of_sides(&self, point: Point) -> Nearest {
        let sides = [0, 1, 2].map(|side| {
            let [from, to] = [self.0[side], self.0[(side + 1) % 3]];
            let along = (point - from).dot(to - from) / (to - from).length_squared();
            // A side without length has one point, its beginning.
            self.on_side(side, if along.is_nan() { 0.0 } else { along.clamp(0.0, 1.0) })
        });
        let distance = |nearest: &Nearest| nearest.point.distance_squared(point);
        let closer =
            |best: Nearest, side: Nearest| if distance(&side) < distance(&best) { side } else { best };
        closer(closer(sides[0], sides[1]), sides[2])
    }

    /// Side `side` runs from its corner to the next one.
    fn on_side(&self, side: usize, along: f64) -> Nearest {
        let next = (side + 1) % 3;
        let mut weights = [0.0; 3];
        weights[side] = 1.0 - along;
        weights[next] = along;
        Nearest { point: self.0[side] + (self.0[next] - self.0[side]) * along, weights }
    }

    fn at(&self, weights: [f64; 3]) -> Nearest {
        let corner = weights.iter().position(|&weight| weight == 1.0).unwrap_or(0);
        Nearest { point: self.0[corner], weights }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: Triangle =
        Triangle([Point::new(0.0, 0.0, 0.0), Point::new(4.0, 0.0, 0.0), Point::new(0.0, 3.0, 0.0)]);

    /// The closest of many points of the triangle.
    fn by_search(triangle: &Triangle, point: Point) -> f64 {
        let [a, b, c] = triangle.0;
        let steps = 300;
        let all = (0..=steps).flat_map(|i| (0..=steps - i).map(move |j| (i, j)));
        let distances = all.map(|(i, j)| {
            let [v, w] = [i, j].map(|step| f64::from(step) / f64::from(steps));
            (a + (b - a) * v + (c - a) * w).distance(point)
        });
        distances.fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn every_region_has_its_closest_point() {
        let nearest = |x, y, z| TRIANGLE.nearest(Point::new(x, y, z));
        assert_eq!(nearest(1.0, 1.0, 5.0).point, Point::new(1.0, 1.0, 0.0));
        assert_eq!(nearest(-1.0, -1.0, 1.0).weights, [1.0, 0.0, 0.0]);
        assert_eq!(nearest(6.0, -1.0, 1.0).weights, [0.0, 1.0, 0.0]);
        assert_eq!(nearest(-1.0, 6.0, 1.0).weights, [0.0, 0.0, 1.0]);
        assert_eq!(nearest(1.0, -2.0, 1.0).weights, [0.75, 0.25, 0.0]);
        assert_eq!(nearest(-2.0, 1.5, 1.0).weights, [0.5, 0.0, 0.5]);
        assert_eq!(nearest(2.0 + 3.0, 1.5 + 4.0, 1.0).weights, [0.0, 0.5, 0.5]);
    }

    #[test]
    fn no_point_of_the_triangle_is_closer() {
        let thin = Triangle([Point::ZERO, Point::new(10.0, 0.01, 0.0), Point::new(5.0, 0.02, 0.0)]);
        let flat = Triangle([Point::ZERO, Point::X, Point::X * 3.0]);
        let dot = Triangle([Point::ONE; 3]);
        let folded = Triangle([Point::ZERO, Point::ZERO, Point::X]);
        for triangle in [TRIANGLE, thin, flat, dot, folded] {
            for seed in 0..200 {
                let random =
                    |salt: u32| f64::from((seed * 3 + salt).wrapping_mul(2_654_435_761) >> 16) / 8192.0 - 4.0;
                let point = Point::new(random(1), random(2), random(3));
                let nearest = triangle.nearest(point);
                let distance = nearest.point.distance(point);
                let searched = by_search(&triangle, point);
                assert!(distance <= searched + 1e-12, "{triangle:?} {point}: {distance} {searched}");
                assert!(distance >= searched - 0.02, "{triangle:?} {point}: {distance} {searched}");
                assert!(nearest.weights.iter().all(|&weight| weight >= -1e-12));
                assert!((nearest.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            }
        }
    }
}
