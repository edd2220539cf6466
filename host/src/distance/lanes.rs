//! Nearest points of triangles, eight at a time.
//!
//! Each lane of a vector is computed as if it were alone, with the same roundings on every machine.

use wide::f32x8;

/// How many numbers are computed on at a time.
pub(super) const LANES: usize = 8;

/// A point for each lane, axis by axis.
pub(super) type Points = [f32x8; 3];

/// Triangles whose squared area is less than this share of that of the square over two sides are taken for their sides.
const FLAT: f32 = 1e-6;

/// A triangle for each lane: a corner, and the way from there to the second and the third.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangles {
    pub(super) corner: Points,
    pub(super) sides: [Points; 2],
}

/// The nearest points of the triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Feet {
    /// From the nearest points to the points that they are nearest to.
    pub(super) offsets: Points,
    /// How far the points are beyond the line of each side that their nearest points lie on, squared, with its sign; less
    /// than any number for other sides. Side n runs from corner n to the next.
    beyond: [f32x8; 3],
}

impl Triangles {
    /// The nearest points to `from`.
    ///
    /// That is the foot of the perpendicular if it lies in the triangle, else the nearest of the points that are nearest on
    /// the sides. There is no branch. Everything is relative to the first corner.
    #[inline(always)]
    pub(super) fn feet(&self, from: &Points) -> Feet {
        let [ab, ac] = self.sides;
        let point = minus(from, &self.corner);
        let (along_ab, along_ac) = (dot(&ab, &point), dot(&ac, &point));
        let (ab_ab, ac_ac, ab_ac) = (dot(&ab, &ab), dot(&ac, &ac), dot(&ab, &ac));
        let bc_bc = ab_ab + ac_ac - ab_ac - ab_ac;
        let along_bc = along_ac - along_ab + ab_ab - ab_ac;
        // Barycentric coordinates, times `area`.
        let area = ab_ab * ac_ac - ab_ac * ab_ac;
        let v = ac_ac * along_ab - ab_ac * along_ac;
        let w = ab_ab * along_ac - ab_ac * along_ab;
        let u = area - v - w;
        let zero = f32x8::ZERO;
        let inside = area.simd_gt(ab_ab * ac_ac * FLAT) & u.simd_ge(zero) & v.simd_ge(zero) & w.simd_ge(zero);
        // How far along each side its nearest point is, and that point's squared distance less that of the first corner.
        let per = |length| f32x8::ONE / atleast(length, f32::MIN_POSITIVE);
        let (per_ab, per_bc, per_ac) = (per(ab_ab), per(bc_bc), per(ac_ac));
        let (on_ab, on_bc, on_ac) =
            (share(along_ab * per_ab), share(along_bc * per_bc), share(along_ac * per_ac));
        let to_ab = on_ab * (on_ab * ab_ab - along_ab - along_ab);
        let to_ac = on_ac * (on_ac * ac_ac - along_ac - along_ac);
        let to_bc = ab_ab - along_ab - along_ab + on_bc * (on_bc * bc_bc - along_bc - along_bc);
        let first = to_ab.simd_le(to_ac);
        let last = to_bc.simd_lt(first.select(to_ab, to_ac));
        let to_b = last.select(f32x8::ONE - on_bc, first.select(on_ab, zero));
        let to_c = last.select(on_bc, first.select(zero, on_ac));
        let per_area = f32x8::ONE / atleast(area, f32::MIN_POSITIVE);
        let to_b = inside.select(v * per_area, to_b);
        let to_c = inside.select(w * per_area, to_c);
        let offsets = std::array::from_fn(|axis| point[axis] - to_b * ab[axis] - to_c * ac[axis]);
        let one = f32x8::ONE;
        let outside = f32x8::splat(f32::NEG_INFINITY);
        let beyond = |lies: f32x8, area: f32x8, per: f32x8| {
            inside.select(outside, lies.select(-area * area.abs() * per, outside))
        };
        let beyond = [
            beyond(to_c.simd_eq(zero), w, per_ab),
            beyond(last | to_b.simd_eq(one) | to_c.simd_eq(one), u, per_bc),
            beyond(to_b.simd_eq(zero), v, per_ac),
        ];
        Feet { offsets, beyond }
    }
}

impl Feet {
    /// Squared distances.
    #[inline(always)]
    pub(super) fn squared(&self) -> f32x8 {
        dot(&self.offsets, &self.offsets)
    }

    /// Whichever of three numbers belongs to the side that the nearest point lies on; of two, that whose line the point is
    /// farther beyond. Those that are `not` wanted or no numbers do not count; where none is left, the result is no number.
    #[inline(always)]
    pub(super) fn across(&self, sides: [f32x8; 3], not: f32x8) -> f32x8 {
        let mut best = (f32x8::splat(f32::NEG_INFINITY), f32x8::splat(f32::NAN));
        for (&side, &beyond) in sides.iter().zip(&self.beyond) {
            let better = beyond.simd_gt(best.0) & side.simd_eq(side) & side.simd_ne(not);
            best = (better.select(beyond, best.0), better.select(side, best.1));
        }
        best.1
    }
}

/// `number`, but `least` where it is less or not a number.
#[inline(always)]
fn atleast(number: f32x8, least: f32) -> f32x8 {
    let least = f32x8::splat(least);
    number.simd_gt(least).select(number, least)
}

/// `number` between 0 and 1; 0 where it is not a number.
#[inline(always)]
fn share(number: f32x8) -> f32x8 {
    let number = atleast(number, 0.0);
    number.simd_lt(f32x8::ONE).select(number, f32x8::ONE)
}

/// The difference of points.
#[inline(always)]
pub(super) fn minus(a: &Points, b: &Points) -> Points {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

/// The product of vectors.
#[inline(always)]
pub(super) fn dot(a: &Points, b: &Points) -> f32x8 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Triangle;
    use crate::mesh::Point;

    /// A number from -1 to 1.
    fn random(seed: &mut u32) -> f32 {
        *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (*seed >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    #[test]
    fn feet_are_those_of_one_triangle_at_a_time() {
        let mut seed = 7;
        for round in 0..2000 {
            let mut points = || [(); 3].map(|()| f32x8::new([(); LANES].map(|()| random(&mut seed))));
            let (mut triangles, from) =
                (Triangles { corner: points(), sides: [points(), points()] }, points());
            if round % 4 == 0 {
                // Without area.
                triangles.sides[1] = triangles.sides[0].map(|side| side * (round % 3) as f32);
            }
            let feet = triangles.feet(&from);
            let across = feet.across([1.0, 2.0, 3.0].map(f32x8::splat), f32x8::ZERO);
            for lane in 0..LANES {
                let at = |points: &Points| {
                    Point::from_array([0, 1, 2].map(|axis: usize| f64::from(points[axis].as_array()[lane])))
                };
                let corner = at(&triangles.corner);
                let [b, c] = triangles.sides.each_ref().map(|side| corner + at(side));
                let nearest = Triangle([corner, b, c]).nearest(at(&from));
                let exact = at(&from).distance(nearest.point);
                let squared = f64::from(feet.squared().as_array()[lane]);
                assert!((squared.sqrt() - exact).abs() < 3e-4, "{} for {exact}", squared.sqrt());
                assert!((at(&feet.offsets).length_squared() - squared).abs() < 1e-5);
                let inside = nearest.weights.iter().all(|&weight| weight > 1e-3);
                assert!(!inside || across.as_array()[lane].is_nan());
            }
        }
    }

    #[test]
    fn the_way_leads_across_the_side_of_the_nearest_point() {
        let wide = |point: [f32; 3]| point.map(f32x8::splat);
        let sides = [wide([2.0, 0.0, 0.0]), wide([0.0, 2.0, 0.0])];
        let triangles = Triangles { corner: wide([0.0; 3]), sides };
        let across = |x, y, not: f32| {
            let feet = triangles.feet(&wide([x, y, 1.0]));
            feet.across([0.0, 1.0, 2.0].map(f32x8::splat), f32x8::splat(not)).as_array()[3]
        };
        assert_eq!([across(0.5, -1.0, 3.0), across(1.5, 1.5, 3.0), across(-1.0, 0.5, 3.0)], [0.0, 1.0, 2.0]);
        assert_eq!([across(-1.0, -2.0, 3.0), across(-2.0, -1.0, 3.0)], [0.0, 2.0]);
        assert_eq!([across(-1.0, -2.0, 0.0), across(-2.0, -1.0, 2.0)], [2.0, 0.0]);
        assert!(across(0.5, 0.5, 3.0).is_nan() && across(0.5, -1.0, 0.0).is_nan());
    }

    #[test]
    fn what_is_not_finite_is_near_nothing() {
        let wide = |at: f32| [f32x8::splat(at); 3];
        let triangles = Triangles { corner: wide(f32::INFINITY), sides: [wide(f32::NAN), wide(1.0)] };
        assert_eq!(triangles.feet(&wide(0.0)).squared().simd_lt(f32x8::splat(1e30)).to_bitmask(), 0);
    }
}
