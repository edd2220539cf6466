//! Lifting with any parameters: s-lift(a, b) and w-lift(a, b) on one line.
//!
//! With b other than ±1 a step scales up as it goes, and so keeps the precision that the six [wavelets](super::Wavelet)
//! round away: psi_3 whose last step is s-lift(3/8, 2), psi_5 with s-lift(5/8, 4), for coarse levels.
//! Such a step has an exact inverse only while nothing wraps, so sums are exact here and a result beyond `i32` is an
//! error, found before anything is written: what was accepted is restored bit for bit.
//!
//! A line is given as its halves, `low` = x\[0\], x\[2\], … and `high` = x\[1\], x\[3\], …, so `high` is as long as `low` or
//! one shorter. A missing neighbour is the nearest one of its kind (whole-sample reflection); one sample is left alone.
//!
//! Source: M. Bertram, *Multiresolution Modeling for Scientific Visualization*, dissertation, UC Davis 2000,
//! eq. (3.45), (3.46), §3.4.3.

use core::num::NonZeroI32;

pub use fixed::types::I16F16;

use crate::error::exactly;
use crate::{LengthError, LiftError, Slice};

/// c_i <- b c_i + \[a (d_{i-1} + d_i)\].
///
/// The sum is exact and rounded once, \[r\] = floor(r + 1/2). Two passes over the line.
///
/// ```
/// # use core::num::NonZeroI32;
/// use wavelift_kernel::lifting::generalized::{I16F16, inverse_s_lift, s_lift};
///
/// let (mut low, high) = ([10, 20, 30], [4, 7]);
/// let (a, b) = (I16F16::lit("0.375"), const { NonZeroI32::new(2).unwrap() });
/// s_lift(&mut low, &high, a, b)?;
/// assert_eq!(low, [23, 44, 65]); // 20 + [3], 40 + [33/8], 60 + [21/4]
/// inverse_s_lift(&mut low, &high, a, b)?;
/// assert_eq!(low, [10, 20, 30]);
/// # Ok::<(), wavelift_kernel::LiftError>(())
/// ```
///
/// # Errors
/// [`LiftError::Length`] if the halves are not those of a line, [`LiftError::Overflow`] if a result is not an `i32`;
/// nothing is written then.
pub fn s_lift(low: &mut [i32], high: &[i32], a: I16F16, b: NonZeroI32) -> Result<(), LiftError> {
    check(low, high)?;
    update(low, Slice::Low, around_low(high, a), scaled_up(b.get().into()))
}

/// d_i <- b d_i + \[a (c_i + c_{i+1})\]: [`s_lift`] with the halves changed over.
///
/// # Errors
/// As [`s_lift`].
pub fn w_lift(low: &[i32], high: &mut [i32], a: I16F16, b: NonZeroI32) -> Result<(), LiftError> {
    check(low, high)?;
    update(high, Slice::High, around_high(low, a), scaled_up(b.get().into()))
}

/// c_i <- (c_i - \[a (d_{i-1} + d_i)\]) / b: undoes [`s_lift`].
///
/// # Errors
/// As [`s_lift`], and [`LiftError::NotDivisible`] if a division by b leaves a remainder, as it does for no result of
/// [`s_lift`] with these parameters; nothing is written then.
pub fn inverse_s_lift(low: &mut [i32], high: &[i32], a: I16F16, b: NonZeroI32) -> Result<(), LiftError> {
    check(low, high)?;
    update(low, Slice::Low, around_low(high, a), scaled_down(b.get().into()))
}

/// d_i <- (d_i - \[a (c_i + c_{i+1})\]) / b: undoes [`w_lift`].
///
/// # Errors
/// As [`inverse_s_lift`].
pub fn inverse_w_lift(low: &[i32], high: &mut [i32], a: I16F16, b: NonZeroI32) -> Result<(), LiftError> {
    check(low, high)?;
    update(high, Slice::High, around_high(low, a), scaled_down(b.get().into()))
}

fn check(low: &[i32], high: &[i32]) -> Result<(), LengthError> {
    let expected = high.len().clamp(low.len().saturating_sub(1), low.len());
    exactly(Slice::High, expected, high.len())
}

/// \[a (d_{i-1} + d_i)\] for every c_i.
fn around_low(high: &[i32], a: I16F16) -> impl Iterator<Item = i128> + Clone {
    let left = high.first().into_iter().chain(high);
    let right = high.iter().chain(high.last());
    left.zip(right).map(move |(&left, &right)| term(a, left, right))
}

/// \[a (c_i + c_{i+1})\] for every d_i.
fn around_high(low: &[i32], a: I16F16) -> impl Iterator<Item = i128> + Clone {
    let right = low.iter().skip(1).chain(low.last());
    low.iter().zip(right).map(move |(&left, &right)| term(a, left, right))
}

/// \[a (left + right)\].
fn term(a: I16F16, left: i32, right: i32) -> i128 {
    const HALF: i64 = 1 << (I16F16::FRAC_NBITS - 1);
    let sum = i64::from(left).wrapping_add(right.into());
    // The whole part of a and the rest, which is not negative: neither product reaches 2^49.
    let whole = sum.wrapping_mul(a.int().to_num());
    let rest = sum.wrapping_mul(a.frac().to_bits().into()).wrapping_add(HALF) >> I16F16::FRAC_NBITS;
    whole.wrapping_add(rest).into()
}

/// Why one result cannot be had.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Fault {
    Overflow,
    NotDivisible,
}

/// b c + term, for |b| below 2^63 and |term| below 2^126.
pub(crate) fn scaled_up(b: i128) -> impl Fn(i32, i128) -> Result<i32, Fault> {
    move |c, term| {
        let sum = b.wrapping_mul(c.into()).wrapping_add(term);
        i32::try_from(sum).map_err(|_| Fault::Overflow)
    }
}

/// (c - term) / b, for |term| below 2^126.
pub(crate) fn scaled_down(b: i128) -> impl Fn(i32, i128) -> Result<i32, Fault> {
    move |c, term| {
        let difference = i128::from(c).wrapping_sub(term);
        match (difference.checked_div(b), difference.checked_rem(b)) {
            (Some(quotient), Some(0)) => i32::try_from(quotient).map_err(|_| Fault::Overflow),
            _ => Err(Fault::NotDivisible),
        }
    }
}

/// Changes each value by its term: all of them, or none if one cannot be had.
pub(crate) fn update(
    values: &mut [i32],
    slice: Slice,
    terms: impl Iterator<Item = i128> + Clone,
    change: impl Fn(i32, i128) -> Result<i32, Fault>,
) -> Result<(), LiftError> {
    for (index, (&value, term)) in values.iter().zip(terms.clone()).enumerate() {
        change(value, term).map_err(|fault| match fault {
            Fault::Overflow => LiftError::Overflow { slice, index },
            Fault::NotDivisible => LiftError::NotDivisible { slice, index },
        })?;
    }
    for (value, term) in values.iter_mut().zip(terms) {
        *value = change(*value, term).unwrap_or(*value);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Wavelet;
    use crate::lifting::Halves;

    const ONE: NonZeroI32 = NonZeroI32::new(1).unwrap();

    fn lit(numerator: i32, denominator: i32) -> I16F16 {
        I16F16::from_num(numerator) / denominator
    }

    /// psi_3 of 1, 4 keeping precision: c = 1 + [-8/4] = -1; d = 4 + 2 = 6; c = 2 (-1) + [36/8] = 3. The form scaled
    /// down has c = -1 + [36/16] = 1.
    #[test]
    fn cubic_that_keeps_precision() {
        let (mut low, mut high) = ([1], [4]);
        let two = NonZeroI32::new(2).unwrap();
        s_lift(&mut low, &high, lit(-1, 4), ONE).unwrap();
        w_lift(&low, &mut high, lit(-1, 1), ONE).unwrap();
        s_lift(&mut low, &high, lit(3, 8), two).unwrap();
        assert_eq!((low, high), ([3], [6]));
        inverse_s_lift(&mut low, &high, lit(3, 8), two).unwrap();
        inverse_w_lift(&low, &mut high, lit(-1, 1), ONE).unwrap();
        inverse_s_lift(&mut low, &high, lit(-1, 4), ONE).unwrap();
        assert_eq!((low, high), ([1], [4]));
    }

    #[test]
    fn reaches_the_linear_wavelet() {
        for n in 2..10 {
            let mut low = [3, -8, 21, 5, 13];
            let mut high = [-6, 9, 1, -17, 30];
            let (low, high) = (&mut low[..usize::div_ceil(n, 2)], &mut high[..n / 2]);
            let mut scratch = [0; 16];
            let mut expected = Halves::new(&mut scratch, 1, n, 1);
            for (expected_low, expected_high) in expected.groups() {
                expected_low.copy_from_slice(low);
                expected_high.copy_from_slice(high);
            }
            Wavelet::Linear.forward(&mut expected);
            w_lift(low, high, lit(-1, 2), ONE).unwrap();
            s_lift(low, high, lit(1, 4), ONE).unwrap();
            for (expected_low, expected_high) in expected.groups() {
                assert_eq!((&*low, &*high), (&*expected_low, &*expected_high));
            }
        }
    }

    #[test]
    fn terms_are_exact_at_the_ends_of_the_range() {
        assert_eq!(term(I16F16::MIN, i32::MIN, i32::MIN), 1 << 47);
        assert_eq!(term(I16F16::MAX, i32::MIN, i32::MIN), -(1 << 47) + (1 << 16));
        // a = -2^-16: [-1/2] = 0, [-3/2] = -1 after 2^15 and 3 * 2^15.
        assert_eq!(term(-I16F16::DELTA, 1 << 15, 0), 0);
        assert_eq!(term(-I16F16::DELTA, 1 << 15, 1 << 16), -1);
    }

    #[test]
    fn nothing_changes_after_an_error() {
        let (mut low, high) = ([1, i32::MAX, 2], [5, 5]);
        let two = NonZeroI32::new(2).unwrap();
        let error = LiftError::Overflow { slice: Slice::Low, index: 1 };
        assert_eq!(s_lift(&mut low, &high, I16F16::ONE, two), Err(error));
        assert_eq!(low, [1, i32::MAX, 2]);

        low = [10, 12, 13];
        let error = LiftError::NotDivisible { slice: Slice::Low, index: 2 };
        assert_eq!(inverse_s_lift(&mut low, &high, I16F16::ONE, two), Err(error));
        assert_eq!(low, [10, 12, 13]);

        let error = LengthError { slice: Slice::High, expected: 2, actual: 1 };
        assert_eq!(s_lift(&mut low, &high[..1], I16F16::ONE, two), Err(error.into()));
        let error = LengthError { slice: Slice::High, expected: 1, actual: 2 };
        assert_eq!(w_lift(&low[..1], &mut [0, 0], I16F16::ONE, two), Err(error.into()));
    }

    #[test]
    fn one_sample_is_left_alone() {
        let three = NonZeroI32::new(3).unwrap();
        let mut low = [7];
        s_lift(&mut low, &[], I16F16::ONE, three).unwrap();
        w_lift(&low, &mut [], I16F16::ONE, three).unwrap();
        assert_eq!(low, [7]);
        s_lift(&mut [], &[], I16F16::ONE, three).unwrap();
    }

    proptest! {
        #[test]
        fn what_is_accepted_is_restored(
            low in prop::array::uniform5(any::<i32>()), high in prop::array::uniform5(any::<i32>()),
            shift in 0_u32..32, n in 0_usize..10, a: i32, b in -6_i32..6,
        ) {
            let Some(b) = NonZeroI32::new(b) else { return Ok(()) };
            let (a, lows, highs) = (I16F16::from_bits(a >> shift), usize::div_ceil(n, 2), n / 2);
            let (low, high) = (low.map(|x| x >> shift), high.map(|x| x >> shift));
            let mut lifted = low;
            if s_lift(&mut lifted[..lows], &high[..highs], a, b).is_ok() {
                inverse_s_lift(&mut lifted[..lows], &high[..highs], a, b).unwrap();
            }
            prop_assert_eq!(lifted, low);
            let mut lifted = high;
            if w_lift(&low[..lows], &mut lifted[..highs], a, b).is_ok() {
                inverse_w_lift(&low[..lows], &mut lifted[..highs], a, b).unwrap();
            }
            prop_assert_eq!(lifted, high);
        }
    }
}
