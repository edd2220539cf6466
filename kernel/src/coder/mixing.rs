//! Chances of binary decisions, learnt by counters and mixed in the logistic domain.
//!
//! A *chance* is that of true, in 1/65536; its *odds* are the natural logarithm of chance / (1 - chance), in 1/256.
//! Several counters, each of its own context, say what they expect of a decision; a mixer adds their odds with weights
//! that it learns by gradient descent on the cost in bits. Source: Mahoney, Adaptive Weighing of Context Models for
//! Lossless Data Compression, 2005.

use crate::extent::to_usize;

/// Odds are told apart within ± this.
const LARGEST_ODDS: i32 = 3071;

/// The odds of the first knot, -12.
const FIRST_ODDS: i32 = -3072;

/// Bits of the odds from one knot to the next.
const KNOT_BITS: u32 = 6;

/// Knots from the first odds to their opposite, and unused places that make it a power of two.
const KNOTS: usize = 128;

/// The chances at the knots.
static SQUASHED: [u16; KNOTS] = squashed();

/// The odds of chances in 1/4096, of the middle of each cell.
static STRETCHED: [i16; 1 << 12] = stretched();

/// The chance, 1 to 65535, whose odds are given; those beyond [`LARGEST_ODDS`] count as it. Straight between knots.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn squash(odds: i32) -> u32 {
    let place = odds.clamp(-LARGEST_ODDS, LARGEST_ODDS).wrapping_sub(FIRST_ODDS).cast_unsigned();
    let knot = to_usize(place >> KNOT_BITS);
    let at = |knot: usize| SQUASHED.get(knot & (KNOTS - 1)).copied().map_or(0, u32::from);
    between(at(knot), at(knot.wrapping_add(1)), place & ((1 << KNOT_BITS) - 1))
}

/// What lies `part` of 2^[`KNOT_BITS`] of the way between two chances.
#[cfg_attr(not(feature = "small"), inline(always))]
const fn between(below: u32, above: u32, part: u32) -> u32 {
    let sum =
        below.wrapping_mul((1_u32 << KNOT_BITS).wrapping_sub(part)).wrapping_add(above.wrapping_mul(part));
    sum.wrapping_add(1 << (KNOT_BITS - 1)) >> KNOT_BITS
}

#[expect(
    clippy::as_conversions,
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects,
    reason = "evaluated by the compiler"
)]
const fn squashed() -> [u16; KNOTS] {
    let mut chances = [0; KNOTS];
    let mut knot = 0;
    while knot <= 96 {
        chances[knot] = chance_of(knot as i32 * (1 << KNOT_BITS) + FIRST_ODDS) as u16;
        knot += 1;
    }
    chances
}

/// 65536 / (1 + e^(-odds / 256)), rounded down above 1/2 and up below.
#[expect(clippy::as_conversions, clippy::arithmetic_side_effects, reason = "evaluated by the compiler")]
const fn chance_of(odds: i32) -> u32 {
    const BITS: u32 = 40;
    /// e^(-1/256)
    const STEP: u128 = 1_095_226_199_139;
    let mut power: u128 = 1 << BITS;
    let mut n = 0;
    while n < odds.unsigned_abs() {
        power = (power * STEP) >> BITS;
        n += 1;
    }
    let chance = (((1 << (2 * BITS)) / ((1 << BITS) + power)) >> (BITS - 16)) as u32;
    let chance = if odds < 0 { 65_536 - chance } else { chance };
    if chance > 65_535 { 65_535 } else { chance }
}

/// The inverse of [`squash`]: the least odds whose chance is not below the middle of each cell.
#[expect(
    clippy::as_conversions,
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects,
    clippy::large_stack_arrays,
    clippy::large_stack_frames,
    reason = "evaluated by the compiler"
)]
const fn stretched() -> [i16; 1 << 12] {
    let chances = squashed();
    let mut table = [0; 1 << 12];
    let mut odds = FIRST_ODDS;
    let mut cell = 0;
    while cell < table.len() {
        while odds < LARGEST_ODDS {
            let place = (odds - FIRST_ODDS) as usize;
            let (knot, part) = (place >> KNOT_BITS, place % (1 << KNOT_BITS));
            if between(chances[knot] as u32, chances[knot + 1] as u32, part as u32) >= cell as u32 * 16 + 8 {
                break;
            }
            odds += 1;
        }
        table[cell] = odds as i16;
        cell += 1;
    }
    table
}

/// How far, in 1/8192, a counter used n times goes to what it is shown: 1 / (n + 3/2).
static RATES: [u16; 256] = rates();

#[expect(
    clippy::as_conversions,
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects,
    reason = "evaluated by the compiler"
)]
const fn rates() -> [u16; 256] {
    let mut rates = [0; 256];
    let mut seen = 0;
    while seen < rates.len() {
        rates[seen] = (16_384 / (2 * seen + 3)) as u16;
        seen += 1;
    }
    rates
}

/// An adaptive chance and how often it was used, up to 255 times, in three bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Counter {
    /// Little-endian.
    chance: [u8; 2],
    seen: u8,
}

impl Counter {
    /// One that has seen nothing, and expects both alike.
    pub(super) const NEW: Self = Self::expecting(1 << 15, 0);

    /// One that expects true with a `chance`, and counts as used `seen` times.
    pub(super) const fn expecting(chance: u16, seen: u8) -> Self {
        Self { chance: chance.to_le_bytes(), seen }
    }

    /// The odds of true.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn odds(self) -> i32 {
        STRETCHED.get(usize::from(u16::from_le_bytes(self.chance) >> 4)).copied().map_or(0, i32::from)
    }

    /// The chance of true.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn chance(self) -> u32 {
        u16::from_le_bytes(self.chance).into()
    }

    /// Learns what was decided.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn learn(&mut self, bit: bool) {
        let rate = RATES.get(usize::from(self.seen)).copied().map_or(0, i32::from);
        let chance = i32::from(u16::from_le_bytes(self.chance));
        let goal: i32 = if bit { 0xFFFF } else { 0 };
        let step = goal.wrapping_sub(chance).wrapping_mul(rate).wrapping_add(1 << 12) >> 13;
        let [low, high, ..] = chance.wrapping_add(step).to_le_bytes();
        self.chance = [low, high];
        self.seen = self.seen.saturating_add(1);
    }
}

/// How fast weights are learnt.
const MIXING_RATE: i32 = 6;

/// No chance of a mixer is smaller, nor that of false.
const LEAST_CHANCE: u32 = 32;

/// No weight of a [bounded](Mixer::bound) mixer is larger in magnitude: 8.
const LARGEST_WEIGHT: i32 = 1 << 19;

/// Weights of the odds of `N` counters, in 1/65536.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Mixer<const N: usize>([i32; N]);

impl<const N: usize> Mixer<N> {
    /// All weights alike.
    pub(super) const fn new(weight: i32) -> Self {
        Self([weight; N])
    }

    /// The chance that these odds make together.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn chance(&self, odds: &[i32; N]) -> u32 {
        let parts = self.0.iter().zip(odds).map(|(weight, odds)| weight.wrapping_mul(*odds) >> 4);
        squash(parts.fold(0, i32::wrapping_add) >> 12).clamp(LEAST_CHANCE, (1 << 16) - LEAST_CHANCE)
    }

    /// Whether `chance` is as far from even as a mixer says, and `bit` is what it expects: then there is nothing to learn.
    #[inline(always)]
    pub(super) const fn is_sure(chance: u32, bit: bool) -> bool {
        if bit { chance >= (1 << 16) - LEAST_CHANCE } else { chance <= LEAST_CHANCE }
    }

    /// Keeps weights so small that their products with odds do not overflow.
    #[inline(always)]
    pub(super) fn bound(&mut self) {
        for weight in &mut self.0 {
            *weight = (*weight).clamp(-LARGEST_WEIGHT, LARGEST_WEIGHT);
        }
    }

    /// Learns what was decided when these odds made `chance`.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn learn(&mut self, odds: &[i32; N], chance: u32, bit: bool) {
        let error = (u32::from(bit) << 16).wrapping_sub(chance).cast_signed().wrapping_mul(MIXING_RATE) >> 8;
        for (weight, odds) in self.0.iter_mut().zip(odds) {
            *weight = weight.wrapping_add(odds.wrapping_mul(error).wrapping_add(1 << 9) >> 10);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretch_undoes_squash() {
        assert_eq!(squash(0), 32_768);
        assert_eq!([squash(i32::MIN), squash(i32::MAX)], [1, 65_535]);
        for odds in -1500..1500 {
            let cell = usize::try_from(squash(odds) >> 4).unwrap();
            assert!((i32::from(STRETCHED[cell]) - odds).abs() <= 30, "{odds}");
        }
    }

    #[test]
    fn counters_learn() {
        let mut counter = Counter::NEW;
        for _ in 0..2000 {
            counter.learn(true);
        }
        assert!(counter.chance() > 65_000 && counter.odds() > 1500);
        for _ in 0..2000 {
            counter.learn(false);
        }
        assert!(counter.chance() < 500);
    }

    #[test]
    fn mixers_trust_who_is_right() {
        let mut mixer = Mixer::new(1 << 14);
        for turn in 0..4000 {
            let bit = turn % 3 == 0;
            let odds = [if bit { 500 } else { -500 }, if turn % 2 == 0 { 500 } else { -500 }];
            let chance = mixer.chance(&odds);
            mixer.learn(&odds, chance, bit);
        }
        assert!(mixer.chance(&[500, -500]) > 60_000);
        assert!(mixer.chance(&[-500, 500]) < 5_000);
    }
}
