//! One lifting step, and the halves of a line that it works on.

use core::num::Wrapping;

/// The scaling coefficients c (`low`) and wavelet coefficients d (`high`) of `lanes` lines that are transformed
/// side by side: coefficient i of line k is at `i * lanes + k`.
///
/// Lines of n >= 2 samples have n.div_ceil(2) scaling and n / 2 wavelet coefficients.
#[derive(Debug)]
pub(crate) struct Halves<'a> {
    pub(super) low: &'a mut [i32],
    pub(super) high: &'a mut [i32],
    pub(super) lanes: usize,
}

impl<'a> Halves<'a> {
    pub(crate) const fn new(low: &'a mut [i32], high: &'a mut [i32], lanes: usize) -> Self {
        Self { low, high, lanes }
    }
}

/// A lifting step and its inverse.
#[derive(Debug)]
pub(crate) struct Step {
    pub(crate) forward: fn(&mut Halves<'_>),
    pub(crate) inverse: fn(&mut Halves<'_>),
}

/// \[numerator / D\], the nearest integer with ties toward +inf, for every `i32` numerator and D > 0.
#[inline(always)]
pub(super) fn nearest<const D: i32>(numerator: Wrapping<i32>) -> Wrapping<i32> {
    const { assert!(D > 0 && D < i32::MAX / 2) };
    let floor = numerator.0.div_euclid(D);
    let rest = numerator.0.wrapping_sub(floor.wrapping_mul(D));
    Wrapping(floor) + Wrapping(i32::from(rest.wrapping_add(rest) >= D))
}

/// Writes a step as the paper does: which coefficients change, the neighbours it reads, and the rounded term.
///
/// ```text
/// step!(low  += |left, right| term)         s-lift: c_i reads d_{i-1}, d_i, reflected at the ends
/// step!(high += |left, right| term)         w-lift: d_i reads c_i, c_{i+1}, reflected at the ends
/// step!(low  -= |left, right| term)         the same, subtracted
/// step!(low  -= |left, here, right| term)   c_i reads d_{i-1}, d_i, d_{i+1}, zero beyond the ends
/// step!(high  = |left, right| term, - high) d_i <- term - d_i, its own inverse
/// ```
macro_rules! step {
    (low += |$left:pat_param, $right:pat_param| $term:expr) => {
        step!(@lift reflected_low, |c, $left, $right| c + $term, c - $term)
    };
    (high += |$left:pat_param, $right:pat_param| $term:expr) => {
        step!(@lift reflected_high, |d, $left, $right| d + $term, d - $term)
    };
    (low -= |$left:pat_param, $right:pat_param| $term:expr) => {
        step!(@lift reflected_low, |c, $left, $right| c - $term, c + $term)
    };
    (low -= |$left:pat_param, $here:pat_param, $right:pat_param| $term:expr) => {
        step!(@lift zero_ended_low, |c, $left, $here, $right| c - $term, c + $term)
    };
    (high = |$left:pat_param, $right:pat_param| $term:expr, - high) => {
        step!(@lift reflected_high, |d, $left, $right| $term - d, $term - d)
    };
    (@lift $visit:ident, |$($argument:pat_param),*| $forward:expr, $inverse:expr) => {
        $crate::lifting::Step {
            forward: |halves| halves.$visit(|$($argument),*| $forward),
            inverse: |halves| halves.$visit(|$($argument),*| $inverse),
        }
    };
}
pub(super) use step;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_is_exact_for_every_numerator() {
        fn check<const D: i32>() {
            let edge = [i32::MIN, i32::MIN + 1, -5, -4, -3, -2, -1, 0, 1, 2, 3, 4, 5, i32::MAX - 1, i32::MAX];
            for numerator in edge.into_iter().chain(-200..200) {
                let expected = (2 * i64::from(numerator) + i64::from(D)).div_euclid(2 * i64::from(D));
                assert_eq!(i64::from(nearest::<D>(Wrapping(numerator)).0), expected, "[{numerator} / {D}]");
            }
        }
        check::<1>();
        check::<2>();
        check::<3>();
        check::<4>();
        check::<6>();
        check::<8>();
        check::<9>();
        check::<16>();
        check::<27>();
        check::<32>();
    }
}
