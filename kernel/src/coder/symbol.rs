//! Coefficient <-> binary decisions.
//!
//! Is it zero? Its sign, then the exponent e = floor(log2 |v|) in unary (is it above 0? above 1? …), then the e bits of |v|
//! below its leading one: the first two under adaptive probabilities, the rest raw.

use super::context::{CLASSES, Context, SIGN_CONTEXTS};
use super::model::Probability;
use super::{BinaryCoder, low_bits};
use crate::extent::to_usize;

/// Unary exponent decisions with probabilities of their own; larger exponents share the last.
const EXPONENTS: usize = 20;

/// The adaptive probabilities of a codestream: the state of the coder beside the interval, of fixed size.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Models {
    /// Is the coefficient other than zero? By class.
    nonzero: [Probability; CLASSES],
    /// Is it negative? By the signs of its neighbours.
    negative: [Probability; SIGN_CONTEXTS],
    /// Is the exponent above k? By class and k.
    above: [[Probability; EXPONENTS]; CLASSES],
    /// The two bits below the leading one, by exponent: the first, the second after a 0, the second after a 1.
    mantissa: [[Probability; 3]; EXPONENTS],
}

impl Models {
    #[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
    pub(crate) const NEW: Self = Self {
        nonzero: [Probability::NEW; CLASSES],
        negative: [Probability::NEW; SIGN_CONTEXTS],
        above: [[Probability::NEW; EXPONENTS]; CLASSES],
        mantissa: [[Probability::NEW; 3]; EXPONENTS],
    };

    /// Makes `self` equal to [`Models::NEW`].
    pub(crate) fn reset(&mut self) {
        self.nonzero.fill(Probability::NEW);
        self.negative.fill(Probability::NEW);
        self.above.as_flattened_mut().fill(Probability::NEW);
        self.mantissa.as_flattened_mut().fill(Probability::NEW);
    }

    /// Codes one value.
    #[inline(always)]
    pub(super) fn code<C: BinaryCoder>(&mut self, coder: &mut C, context: Context, value: i32) -> i32 {
        let (Some(nonzero), Some(negative), Some(above)) = (
            self.nonzero.get_mut(context.class),
            self.negative.get_mut(context.signs),
            self.above.get_mut(context.class),
        ) else {
            return 0;
        };
        if !coder.decide(value != 0, nonzero) {
            return 0;
        }
        let negative = coder.decide(value < 0, negative);
        let magnitude = value.unsigned_abs();
        let exponent = code_exponent(coder, above, magnitude.checked_ilog2().unwrap_or(0));
        let mantissa = self.mantissa.get_mut(to_usize(exponent).min(EXPONENTS - 1));
        let value =
            mantissa.map_or(0, |models| code_mantissa(coder, models, exponent, magnitude)).cast_signed();
        if negative { value.wrapping_neg() } else { value }
    }
}

/// Codes `exponent` (at most 31) in unary.
#[inline(always)]
fn code_exponent<C: BinaryCoder>(coder: &mut C, above: &mut [Probability; EXPONENTS], exponent: u32) -> u32 {
    let mut coded = 0;
    while coded < 31 {
        let Some(model) = above.get_mut(to_usize(coded).min(EXPONENTS - 1)) else { break };
        if !coder.decide(exponent > coded, model) {
            break;
        }
        coded = coded.wrapping_add(1);
    }
    coded
}

/// Codes the `exponent` bits of `magnitude` below its leading one, and returns it whole.
#[inline(always)]
fn code_mantissa<C: BinaryCoder>(
    coder: &mut C,
    [first, after_0, after_1]: &mut [Probability; 3],
    exponent: u32,
    magnitude: u32,
) -> u32 {
    let is_set = |position: u32| (magnitude >> position) & 1 == 1;
    let Some(position) = exponent.checked_sub(1) else { return 1 };
    let upper = coder.decide(is_set(position), first);
    let coded = 0b10 | u32::from(upper);
    let Some(position) = exponent.checked_sub(2) else { return coded };
    let lower = coder.decide(is_set(position), if upper { after_1 } else { after_0 });
    let coded = (coded << 1) | u32::from(lower);
    (coded << position) | coder.raw(magnitude & low_bits(position), position)
}

#[cfg(test)]
mod tests {
    use super::super::{Decoder, Encoder};
    use super::*;

    fn context(i: usize) -> Context {
        Context { class: i % CLASSES, signs: i % SIGN_CONTEXTS }
    }

    #[test]
    fn every_magnitude_comes_back() {
        let powers = (0..32).map(|exponent| 1_i32 << exponent);
        let values = powers
            .flat_map(|p| [p, p.wrapping_sub(1), p.wrapping_add(1), p.wrapping_mul(3), p.wrapping_neg()]);
        let values: heapless::Vec<i32, 160> = values.collect();
        let (mut models, mut bytes) = (Models::NEW, [0; 1000]);
        let mut encoder = Encoder::new(&mut bytes);
        for (i, &value) in values.iter().enumerate() {
            models.code(&mut encoder, context(i), value);
        }
        let len = encoder.finish().unwrap();
        models.reset();
        assert_eq!(models, Models::NEW);
        let mut decoder = Decoder::new(&bytes[..len]).unwrap();
        for (i, &value) in values.iter().enumerate() {
            assert_eq!(models.code(&mut decoder, context(i), 0), value);
        }
        assert!(decoder.is_consumed());
    }
}
