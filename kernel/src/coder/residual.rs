//! Residual <-> symbols.
//!
//! Where small ones are expected a residual is one symbol: 0, 1, -1, 2, -2, … with the side to which the prediction
//! leans first. Where large ones are expected it is zero or a step, two steps to the expected octave or so; the place
//! within the step and the sign follow as they are. What lies beyond the last symbol has an exponent of its own.

use super::context::{Class, Expected, FRACTIONS, LARGE_CLASSES, SMALL_CLASSES};
use super::distribution::{Distribution, SYMBOLS};
use super::{Coder, low_bits, priors};
use crate::extent::to_usize;

/// The symbol of all residuals that have none of their own.
const ESCAPE: u32 = 15;

/// Kinds of escapes: from small classes, from large ones.
pub(super) const ESCAPES: usize = 2;

/// The adaptive distributions of a codestream: the state of the coder beside the interval, of fixed size.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Models {
    small: [[Distribution; FRACTIONS]; SMALL_CLASSES],
    large: [Distribution; LARGE_CLASSES],
    exponents: [Distribution; ESCAPES],
    /// Exponents of predictors' weights.
    weights: Distribution,
}

impl Models {
    /// Memory for models that are reset before they are used.
    #[cfg(any(feature = "adaptive", test))]
    #[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
    pub(super) const BLANK: Self = {
        let blank = Distribution::new([0; SYMBOLS]);
        Self {
            small: [[blank; FRACTIONS]; SMALL_CLASSES],
            large: [blank; LARGE_CLASSES],
            exponents: [blank; ESCAPES],
            weights: blank,
        }
    };

    /// Makes `self` what it is at first.
    #[cfg_attr(
        not(any(feature = "adaptive", test)),
        expect(dead_code, reason = "no build without adapts them")
    )]
    pub(crate) fn reset(&mut self) {
        self.small = priors::SMALL;
        self.large.fill(priors::LARGE);
        self.exponents = priors::EXPONENTS;
        self.weights = priors::WEIGHT;
    }

    /// Codes one residual.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn code<C: Coder + ?Sized>(
        &mut self,
        coder: &mut C,
        energy: i32,
        expected: Expected,
        residual: i32,
    ) -> i32 {
        let [small_exponents, large_exponents] = &mut self.exponents;
        match Class::of(energy) {
            Class::Small(class) => {
                let distributions = self.small.get_mut(class);
                let Some(distribution) = distributions.and_then(|all| all.get_mut(expected.fraction()))
                else {
                    return 0;
                };
                let leaning = |value: i32| if expected.offset < 0 { value.wrapping_neg() } else { value };
                leaning(code_small(coder, distribution, small_exponents, leaning(residual)))
            }
            Class::Large { class, step_bits } => {
                let Some(distribution) = self.large.get_mut(class) else { return 0 };
                code_step(coder, distribution, large_exponents, residual, step_bits)
            }
        }
    }

    /// Codes one weight of a predictor.
    pub(super) fn code_weight<C: Coder + ?Sized>(&mut self, coder: &mut C, weight: i16) -> i16 {
        let number = rank(weight.into()).wrapping_add(1);
        let coded = of_rank(code_number(coder, &mut self.weights, number).wrapping_sub(1));
        i16::try_from(coded).unwrap_or(i16::MAX)
    }
}

/// 0, 1, 2, 3, 4, … for 0, 1, -1, 2, -2, …
#[inline(always)]
fn rank(value: i32) -> u32 {
    let negated = value.wrapping_neg();
    ((negated << 1) ^ (negated >> 31)).cast_unsigned()
}

/// The value of that [`rank`].
#[inline(always)]
fn of_rank(rank: u32) -> i32 {
    let negated = (rank >> 1) ^ (rank & 1).wrapping_neg();
    negated.cast_signed().wrapping_neg()
}

/// Codes a small residual as its rank.
#[inline(always)]
pub(super) fn code_small<C: Coder + ?Sized>(
    coder: &mut C,
    distribution: &mut Distribution,
    exponents: &mut Distribution,
    residual: i32,
) -> i32 {
    of_rank(code_rank(coder, distribution, exponents, rank(residual)))
}

/// Codes a rank: the first have symbols of their own.
#[cfg_attr(not(feature = "small"), inline(always))]
fn code_rank<C: Coder + ?Sized>(
    coder: &mut C,
    distribution: &mut Distribution,
    exponents: &mut Distribution,
    rank: u32,
) -> u32 {
    let symbol = to_u32(coder.symbol(to_usize(rank.min(ESCAPE)), distribution));
    if symbol < ESCAPE {
        return symbol;
    }
    let beyond = code_number(coder, exponents, rank.wrapping_sub(ESCAPE - 1));
    beyond.wrapping_add(ESCAPE - 1)
}

/// Codes a residual as zero, or a step of 2^`step_bits` magnitudes, a place in it, and a sign.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn code_step<C: Coder + ?Sized>(
    coder: &mut C,
    distribution: &mut Distribution,
    exponents: &mut Distribution,
    residual: i32,
    step_bits: u32,
) -> i32 {
    // One less than the magnitude; for zero it does not matter.
    let above_one = residual.unsigned_abs().saturating_sub(1);
    let step = above_one >> step_bits;
    let symbol = if residual == 0 { 0 } else { step.saturating_add(1).min(ESCAPE) };
    let coded = to_u32(coder.symbol(to_usize(symbol), distribution));
    if coded == 0 {
        return 0;
    }
    let step = if coded < ESCAPE {
        coded.wrapping_sub(1)
    } else {
        code_number(coder, exponents, step.wrapping_sub(ESCAPE - 2)).wrapping_add(ESCAPE - 2)
    };
    let place = above_one & low_bits(step_bits);
    let bits = coder.raw(place << 1 | u32::from(residual < 0), step_bits.wrapping_add(1));
    let magnitude = (step << step_bits | bits >> 1).wrapping_add(1).cast_signed();
    if bits & 1 == 1 { magnitude.wrapping_neg() } else { magnitude }
}

/// Codes a number above 0: its exponent, then the bits below its leading one as they are.
fn code_number<C: Coder + ?Sized>(coder: &mut C, exponents: &mut Distribution, number: u32) -> u32 {
    const LAST: u32 = 15;
    let exponent = number.checked_ilog2().unwrap_or(0);
    let symbol = coder.symbol(to_usize(exponent.min(LAST)), exponents);
    let exponent = match to_u32(symbol) {
        LAST => coder.raw(exponent.wrapping_sub(LAST), 5).wrapping_add(LAST).min(31),
        exponent => exponent,
    };
    1 << exponent | coder.raw(number & low_bits(exponent), exponent)
}

/// A symbol as a number.
#[inline(always)]
fn to_u32(symbol: usize) -> u32 {
    u32::try_from(symbol).unwrap_or(0)
}

const _: () = assert!(SYMBOLS == 16);

#[cfg(test)]
mod tests {
    use super::super::{Decoder, Encoder};
    use super::*;

    #[test]
    fn ranks_go_outwards() {
        assert_eq!([0, 1, -1, 2, -2, i32::MAX, i32::MIN].map(rank), [0, 1, 2, 3, 4, u32::MAX - 2, u32::MAX]);
        for value in [0, 1, -1, 2, -2, 1000, -1000, i32::MAX, i32::MIN] {
            assert_eq!(of_rank(rank(value)), value);
        }
    }

    #[test]
    fn every_residual_comes_back_in_every_class() {
        let powers = (0..32).map(|exponent| 1_i32 << exponent);
        let residuals = powers.flat_map(|p| [0, p, p.wrapping_sub(1), p.wrapping_mul(3), p.wrapping_neg()]);
        let energies = [0, 1, 3, 4, 31, 32, 47, 1 << 10, 1 << 30, i32::MAX];
        let offsets = [-128, -40, 0, 40, 127];
        let all = || {
            let expected = offsets.map(|offset| Expected { value: 0, offset });
            residuals.clone().zip(energies.into_iter().cycle().zip(expected.into_iter().cycle().skip(1)))
        };
        let (mut models, mut bytes) = (Models::BLANK, [0; 1024]);
        models.reset();
        let mut encoder = Encoder::new(&mut bytes);
        for (residual, (energy, expected)) in all() {
            models.code(&mut encoder, energy, expected, residual);
        }
        let len = encoder.finish().unwrap();
        models.reset();
        let mut decoder = Decoder::new(&bytes[..len]).unwrap();
        for (residual, (energy, expected)) in all() {
            assert_eq!(models.code(&mut decoder, energy, expected, 0), residual, "{energy} {expected:?}");
        }
        assert!(decoder.is_consumed());
    }
}
