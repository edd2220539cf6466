//! The models of residuals, and how one is coded.

use super::super::Coder;
use super::super::distribution::Distribution;
use super::super::mixing::{Counter, squash};
use super::super::priors;
use crate::extent::to_usize;

/// Classes of the magnitudes around a sample: 0 to 5, then two an octave.
const CLASSES: usize = 24;

/// The class of the coarsest lattice.
const COARSEST_CLASS: usize = 12;

/// Passes of levels 0, 1 and all above, and the coarsest lattice.
const BANDS: usize = 10;

/// Patterns of six neighbours, three values each.
const PATTERNS: usize = 729;

/// Lengths of a magnitude: bits after the leading one.
const LENGTHS: usize = 32;

/// What is known of a sample before its residual.
#[derive(Clone, Copy, Debug)]
pub(super) struct Context {
    /// Magnitudes around, weighted.
    pub(super) energy: i32,
    pub(super) magnitudes: usize,
    pub(super) signs: usize,
}

impl Context {
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn class(self) -> usize {
        let energy = self.energy.cast_unsigned();
        if energy < 6 {
            return to_usize(energy);
        }
        let octave = energy.ilog2();
        let upper_half = (energy >> octave.wrapping_sub(1)) & 1;
        to_usize(octave.wrapping_mul(2).wrapping_add(upper_half)).min(CLASSES - 1)
    }
}

/// Which models a pass uses.
pub(super) fn band(level: u8, axis: usize) -> usize {
    usize::from(level.min(2)).wrapping_mul(3).wrapping_add(axis)
}

/// Decisions mixed of two chances: zero or not, sign, one or more.
const DECISIONS: usize = 3;

/// The weights that two odds have in the beginning, in 1/65536.
const FIRST_WEIGHTS: [i32; 2] = [40_960; 2];

/// The largest weight, in 1/65536.
const LARGEST_WEIGHT: i32 = 1 << 18;

/// No mixed chance is smaller, nor that of false.
const LEAST_CHANCE: u32 = 24;

/// How fast the weights learn.
const MIXING_BITS: u32 = 11;

/// All that is learnt of residuals.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Models {
    by_class: [[[Counter; DECISIONS]; CLASSES]; BANDS],
    by_pattern: [[Counter; DECISIONS]; PATTERNS],
    weights: [[[i32; 2]; DECISIONS]; BANDS],
    lengths: [[Distribution; CLASSES]; BANDS],
    /// Of the second bit, and of the third after either.
    mantissas: [[Counter; 3]; LENGTHS],
    pub(super) tap: Distribution,
}

impl Models {
    #[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
    pub(super) const NEW: Self = Self {
        by_class: [[[Counter::NEW; DECISIONS]; CLASSES]; BANDS],
        by_pattern: [[Counter::NEW; DECISIONS]; PATTERNS],
        weights: [[FIRST_WEIGHTS; DECISIONS]; BANDS],
        lengths: [[priors::HALVING; CLASSES]; BANDS],
        mantissas: [[Counter::NEW; 3]; LENGTHS],
        tap: priors::HALVING,
    };

    /// Makes `self` equal to [`Models::NEW`].
    pub(super) fn reset(&mut self) {
        self.by_class.as_flattened_mut().as_flattened_mut().fill(Counter::NEW);
        self.by_pattern.as_flattened_mut().fill(Counter::NEW);
        self.weights.as_flattened_mut().fill(FIRST_WEIGHTS);
        self.lengths.as_flattened_mut().fill(priors::HALVING);
        self.mantissas.as_flattened_mut().fill(Counter::NEW);
        self.tap = priors::HALVING;
    }

    /// Codes a residual of the coarsest lattice, of which nothing is known.
    pub(super) fn code_coarsest<C: Coder>(&mut self, coder: &mut C, residual: i32) -> i32 {
        let place = Place { class: COARSEST_CLASS, magnitudes: 0, signs: 0 };
        self.code_at(coder, residual, place, BANDS - 1).unwrap_or(0)
    }

    /// Codes one residual.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn code<C: Coder>(
        &mut self,
        coder: &mut C,
        residual: i32,
        context: Context,
        band: usize,
    ) -> i32 {
        let place = Place { class: context.class(), magnitudes: context.magnitudes, signs: context.signs };
        self.code_at(coder, residual, place, band).unwrap_or(0)
    }

    /// The residual; `None`, which cannot be, if a model is missing.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn code_at<C: Coder>(&mut self, coder: &mut C, residual: i32, place: Place, band: usize) -> Option<i32> {
        let [zero, sign, more] = self.by_class.get_mut(band)?.get_mut(place.class)?;
        let [zero_weights, sign_weights, more_weights] = self.weights.get_mut(band)?;
        let [other_zero, _, other_more] = self.by_pattern.get_mut(place.magnitudes)?;
        let magnitude = residual.unsigned_abs();
        if !decide(coder, residual != 0, [zero, other_zero], zero_weights) {
            return Some(0);
        }
        let has_more = decide(coder, magnitude > 1, [more, other_more], more_weights);
        let [_, other_sign, _] = self.by_pattern.get_mut(place.signs)?;
        let is_negative = decide(coder, residual < 0, [sign, other_sign], sign_weights);
        let mut value = 1;
        if has_more {
            let lengths = self.lengths.get_mut(band)?.get_mut(place.class)?;
            value = code_large(coder, magnitude, lengths, &mut self.mantissas)?;
        }
        let value = value.cast_signed();
        Some(if is_negative { value.wrapping_neg() } else { value })
    }
}

/// The models of a residual.
#[derive(Clone, Copy, Debug)]
struct Place {
    class: usize,
    magnitudes: usize,
    signs: usize,
}

/// Codes a magnitude above one: its length, the two bits after the leading one, and the rest as it is.
#[cfg_attr(not(feature = "small"), inline(always))]
fn code_large<C: Coder>(
    coder: &mut C,
    magnitude: u32,
    lengths: &mut Distribution,
    mantissas: &mut [[Counter; 3]; LENGTHS],
) -> Option<u32> {
    const ESCAPE: usize = 15;
    let length = magnitude.checked_ilog2().unwrap_or(0);
    let symbol = coder.symbol(to_usize(length.wrapping_sub(1)).min(ESCAPE), lengths);
    let length = if symbol == ESCAPE {
        coder.raw(length.wrapping_sub(16), 4).wrapping_add(16)
    } else {
        u32::try_from(symbol).unwrap_or(0).wrapping_add(1)
    };
    let [second, after_zero, after_one] = mantissas.get_mut(to_usize(length))?;
    let bit = |from_top: u32| (magnitude >> (length.wrapping_sub(from_top) & 31)) & 1 == 1;
    let first = learn(coder, bit(1), second);
    let mut value = 2 | u32::from(first);
    if length > 1 {
        let next = learn(coder, bit(2), if first { after_one } else { after_zero });
        value = value << 1 | u32::from(next);
    }
    let rest = length.saturating_sub(2);
    let low = coder.raw(magnitude & 1_u32.wrapping_shl(rest).wrapping_sub(1), rest);
    Some(value.wrapping_shl(rest) | low)
}

/// Codes a decision by one counter.
#[cfg_attr(not(feature = "small"), inline(always))]
fn learn<C: Coder>(coder: &mut C, bit: bool, counter: &mut Counter) -> bool {
    let bit = coder.decide(bit, counter.chance().clamp(LEAST_CHANCE, (1 << 16) - LEAST_CHANCE));
    counter.learn(bit);
    bit
}

/// Codes a decision by two counters whose odds are mixed.
#[cfg_attr(not(feature = "small"), inline(always))]
fn decide<C: Coder>(coder: &mut C, bit: bool, counters: [&mut Counter; 2], weights: &mut [i32; 2]) -> bool {
    let [first, second] = counters;
    let odds = [first.odds(), second.odds()];
    let parts = weights.iter().zip(odds).map(|(weight, odds)| (weight >> 4).wrapping_mul(odds));
    let mixed = squash(parts.fold(0, i32::wrapping_add) >> 12);
    let chance = mixed.clamp(LEAST_CHANCE, (1 << 16) - LEAST_CHANCE);
    let bit = coder.decide(bit, chance);
    let error = (u32::from(bit) << 16).wrapping_sub(chance).cast_signed();
    for (weight, odds) in weights.iter_mut().zip(odds) {
        *weight = weight
            .wrapping_add(odds.wrapping_mul(error) >> MIXING_BITS)
            .clamp(-LARGEST_WEIGHT, LARGEST_WEIGHT);
    }
    first.learn(bit);
    second.learn(bit);
    bit
}
