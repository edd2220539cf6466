//! Nearest points of triangles, eight at a time.
//!
//! Each lane of a vector is computed as if it were alone, with the same roundings on every machine.

use wide::f32x8;

/// How many numbers are computed on at a time.
pub(super) const LANES: usize = 8;

/// A point for each lane, axis by axis.
pub(super) type Points = [f32x8; 3];

/// A triangle for each lane, in a plane of its own: the first corner is at zero, the second on the first axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangles {
    /// The first corner.
    pub(super) corner: Points,
    /// The axes of the plane: perpendicular, of length 1.
    pub(super) axes: [Points; 2],
    /// The second corner.
    pub(super) second: f32x8,
    /// The third corner; its second coordinate is not negative.
    pub(super) third: [f32x8; 2],
}

/// The nearest points of the triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Feet {
    /// Squared distances.
    pub(super) squared: f32x8,
    /// From the nearest points to the points that they are nearest to.
    pub(super) offsets: Points,
    /// How far the points are beyond the line of each side that their nearest points lie on, squared, with its sign; less
    /// than any number for other sides. Side n runs from corner n to the next.
    beyond: [f32x8; 3],
}

/// The nearest point of a side, in the plane of its triangle.
#[derive(Clone, Copy)]
struct Side {
    /// From it to the point.
    offset: [f32x8; 2],
    squared: f32x8,
    /// How far the point is beyond the side's line, squared, with its sign.
    beyond: f32x8,
}

/// How much farther than the nearest side another side may be, squared, and still have the nearest point, a corner.
const SAME: f32 = 1.0001;

impl Triangles {
    /// The nearest points to `from`.
    ///
    /// That is the foot of the perpendicular if it lies in the triangle, else the nearest of the points that are nearest on
    /// the sides. There is no branch. Everything is relative to the first corner.
    #[inline(always)]
    pub(super) fn feet(&self, from: &Points) -> Feet {
        let point = minus(from, &self.corner);
        // What is left of the point after each axis: rounding errors of one do not grow with the next.
        let x = dot(&point, &self.axes[0]);
        let rest = less(&point, x, &self.axes[0]);
        let y = dot(&rest, &self.axes[1]);
        let rest = less(&rest, y, &self.axes[1]);
        let zero = f32x8::ZERO;
        let (second, [third_x, third_y]) = (self.second, self.third);
        let from_second = x - second;
        // Where the point is relative to the lines of the second and the third side, times their lengths.
        let to_second = second * third_y - x * third_y - y * (second - third_x);
        let to_third = x * third_y - y * third_x;
        let inside = y.simd_gt(zero) & to_second.simd_gt(zero) & to_third.simd_gt(zero);
        let along = x - atleast(x, 0.0).fast_min(second);
        let sides = [
            Side { offset: [along, y], squared: along * along + y * y, beyond: -y * y.abs() },
            side([from_second, y], [third_x - second, third_y], to_second),
            side([x, y], [third_x, third_y], to_third),
        ];
        let least = sides[0].squared.fast_min(sides[1].squared.fast_min(sides[2].squared));
        let [first, last] = [0, 1].map(|side: usize| sides[side].squared.simd_eq(least));
        let offset: [f32x8; 2] = std::array::from_fn(|axis| {
            let [a, b, c] = [sides[0].offset[axis], sides[1].offset[axis], sides[2].offset[axis]];
            inside.select(zero, first.select(a, last.select(b, c)))
        });
        let outside = f32x8::splat(f32::NEG_INFINITY);
        let near = inside.select(outside, least * SAME);
        let beyond = |side: &Side| side.squared.simd_le(near).select(side.beyond, outside);
        Feet {
            squared: dot(&rest, &rest) + inside.select(zero, least),
            offsets: std::array::from_fn(|axis| {
                rest[axis] + offset[0] * self.axes[0][axis] + offset[1] * self.axes[1][axis]
            }),
            beyond: [beyond(&sides[0]), beyond(&sides[1]), beyond(&sides[2])],
        }
    }
}

/// The nearest point of a side along a vector from its start, from where the point is seen at an offset; and how far within
/// the side's line that is, times its length.
#[inline(always)]
fn side(offset: [f32x8; 2], along: [f32x8; 2], within: f32x8) -> Side {
    let per_square = f32x8::ONE / atleast(along[0] * along[0] + along[1] * along[1], f32::MIN_POSITIVE);
    let share = (offset[0] * along[0] + offset[1] * along[1]) * per_square;
    let share = atleast(share, 0.0).fast_min(f32x8::ONE);
    let offset = [offset[0] - share * along[0], offset[1] - share * along[1]];
    Side {
        offset,
        squared: offset[0] * offset[0] + offset[1] * offset[1],
        beyond: -within * within.abs() * per_square,
    }
}

impl Feet {
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

/// Places of the set bits, in ascending order.
#[inline(always)]
pub(super) fn ones(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (place < LANES).then_some(place)
    })
}

/// The difference of points.
#[inline(always)]
pub(super) fn minus(a: &Points, b: &Points) -> Points {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

/// A point less a vector along an axis.
#[inline(always)]
fn less(point: &Points, length: f32x8, axis: &Points) -> Points {
    std::array::from_fn(|n| point[n] - length * axis[n])
}

/// The product of vectors.
#[inline(always)]
pub(super) fn dot(a: &Points, b: &Points) -> f32x8 {
    a[0] * b[0] + (a[1] * b[1] + a[2] * b[2])
}

#[cfg(test)]
mod tests {
    use super::super::surface::Facet;
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
            let mut point = || Point::from_array([(); 3].map(|()| f64::from(random(&mut seed))));
            let corners = [(); LANES].map(|()| {
                let [a, b, c] = [point(), point(), point()];
                // Some without area.
                let share = f64::from(round % 3);
                if round % 4 == 0 { [a, b, a + (b - a) * share] } else { [a, b, c] }
            });
            let places = [(); LANES].map(|()| point());
            let from = [0, 1, 2].map(|axis: usize| f32x8::new(places.map(|place| place[axis] as f32)));
            let facets = corners.map(|corners| Facet::new(corners, [1, 2, 3]));
            let (triangles, sides) = Facet::gather(std::array::from_fn(|lane| &facets[lane]));
            let feet = triangles.feet(&from);
            let across = feet.across(sides, f32x8::ZERO);
            for lane in 0..LANES {
                let nearest = Triangle(corners[lane]).nearest(places[lane]);
                let exact = places[lane].distance(nearest.point);
                let squared = f64::from(feet.squared.as_array()[lane]);
                assert!((squared.sqrt() - exact).abs() < 3e-4, "{} for {exact}", squared.sqrt());
                let offset = Point::from_array(
                    [0, 1, 2].map(|axis: usize| f64::from(feet.offsets[axis].as_array()[lane])),
                );
                assert!((offset.length_squared() - squared).abs() < 1e-5);
                assert!(offset.distance(places[lane] - nearest.point) < 3e-3, "{offset}");
                let inside = nearest.weights.iter().all(|&weight| weight > 1e-3);
                assert!(!inside || across.as_array()[lane].is_nan());
                let outside = nearest.weights.contains(&0.0) && exact > 1e-3;
                assert!(!outside || round % 4 == 0 || !across.as_array()[lane].is_nan());
            }
        }
    }

    #[test]
    fn the_way_leads_across_the_side_of_the_nearest_point() {
        let facet = Facet::new([Point::ZERO, 2.0 * Point::X, 2.0 * Point::Y], [0, 1, 2]);
        let (triangles, sides) = Facet::gather([&facet; LANES]);
        let across = |x, y, not: u32| {
            let feet = triangles.feet(&[x, y, 1.0].map(f32x8::splat));
            let across = feet.across(sides, f32x8::splat(f32::from_bits(not))).as_array()[3];
            (!across.is_nan()).then_some(across.to_bits())
        };
        let some = |sides: [u32; 2]| sides.map(Some);
        assert_eq!([across(0.5, -1.0, 3), across(1.5, 1.5, 3)], some([0, 1]));
        assert_eq!(across(-1.0, 0.5, 3), Some(2));
        assert_eq!([across(-1.0, -2.0, 3), across(-2.0, -1.0, 3)], some([0, 2]));
        assert_eq!([across(-1.0, -2.0, 0), across(-2.0, -1.0, 2)], some([2, 0]));
        assert_eq!([across(0.5, 0.5, 3), across(0.5, -1.0, 0)], [None, None]);
    }

    #[test]
    fn what_is_not_finite_is_near_nothing() {
        let corners = [Point::splat(1e300), Point::ONE, Point::X];
        for turn in 0..3 {
            let facet = Facet::new([0, 1, 2].map(|corner| corners[(corner + turn) % 3]), [0; 3]);
            let (triangles, _) = Facet::gather([&facet; LANES]);
            let squared = triangles.feet(&[f32x8::ZERO; 3]).squared;
            assert_eq!(squared.simd_lt(f32x8::splat(0.5)).to_bitmask(), 0);
        }
    }
}
