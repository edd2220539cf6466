//! An adaptive distribution of a small alphabet.

use crate::extent::to_usize;

/// Symbols of an alphabet: 0 to 15.
pub(super) const SYMBOLS: usize = 16;

/// The sum of all chances, as a power of two.
pub(super) const TOTAL_BITS: u32 = 15;

/// The sum of all chances.
const TOTAL: i16 = i16::MAX;

/// How fast a distribution that has seen much follows what it sees: 1/2^7 of the way each time.
const SLOWEST: u32 = 7;

/// What a new distribution is taken to have seen.
const HEAD_START: u8 = 6;

/// Symbols after which the rate changes no more: after n of them it is log2(n + [`HEAD_START`]) + 1, rounded down.
const SETTLED: u8 = (1 << (SLOWEST - 1)) - HEAD_START;

/// Which symbols to expect, as cumulated chances in 1/32768, learnt from those seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Distribution {
    /// The chance of a smaller symbol, for each; strictly ascending from 0.
    below: [i16; SYMBOLS],
    /// Symbols seen, up to [`SETTLED`].
    seen: u8,
}

/// The part of the whole, in 1/32768, that stands for a symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Share {
    pub(super) below: u32,
    pub(super) size: u32,
}

impl Distribution {
    /// One that has seen nothing yet and expects the given cumulated chances: strictly ascending, the first 0.
    pub(super) const fn new(below: [i16; SYMBOLS]) -> Self {
        Self { below, seen: 0 }
    }

    /// The share of `symbol`.
    #[inline(always)]
    pub(super) fn share(&self, symbol: usize) -> Share {
        let below = |symbol: usize| self.below.get(symbol).copied().map_or(1 << TOTAL_BITS, unsigned);
        let start = below(symbol);
        Share { below: start, size: below(symbol.wrapping_add(1)).wrapping_sub(start) }
    }

    /// The symbol whose share holds `point`, of 0 to 32767.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn find(&self, point: i16) -> usize {
        let [_, second, ..] = self.below;
        // Where little is left to predict nearly every symbol is 0.
        if point < second {
            return 0;
        }
        if cfg!(feature = "small") {
            let above = self.below.iter().position(|&below| below > point);
            return above.unwrap_or(SYMBOLS).wrapping_sub(1);
        }
        let not_above = self.below.iter().map(|&below| i16::from(below <= point));
        let count: i16 = not_above.fold(0, i16::wrapping_add);
        to_usize(unsigned(count.wrapping_sub(1)))
    }

    /// Learns one symbol.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn learn(&mut self, symbol: usize) {
        let rate = u32::from(self.seen.wrapping_add(HEAD_START)).checked_ilog2().unwrap_or(0).wrapping_add(1);
        if cfg!(feature = "small") {
            self.approach_in_pairs(symbol, rate);
        } else {
            self.approach(symbol, rate);
        }
        self.seen = self.seen.wrapping_add(u8::from(self.seen < SETTLED));
    }

    /// Goes 1/2^`rate` of the way towards shares of one for all other symbols, and the rest for `symbol`.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn approach(&mut self, symbol: usize, rate: u32) {
        let symbol = i16::try_from(symbol).unwrap_or(0);
        for (below, lane) in self.below.iter_mut().zip(0_i16..) {
            let above = if lane > symbol { TOTAL - 15 } else { 0 };
            let goal = lane.wrapping_add(above);
            *below = below.wrapping_add(goal.wrapping_sub(*below) >> rate);
        }
    }

    /// As [`Distribution::approach`], for machines without vectors: two chances to a word.
    ///
    /// A difference and 2^15 are neither negative nor above 2^16, so that no half touches the other, and 2^15 goes
    /// through the shift without a remainder.
    fn approach_in_pairs(&mut self, symbol: usize, rate: u32) {
        const BOTH: u32 = 1 << 16 | 1;
        let [halves, offset] = [0xFFFF_u32 >> rate, 0x8000 >> rate].map(|half| half.wrapping_mul(BOTH));
        let goals = GOALS.get(SYMBOLS.wrapping_sub(symbol)..).unwrap_or(&[]).as_chunks::<2>().0;
        let mut lanes = 1_u32 << 16;
        for (pair, &goal) in self.below.as_chunks_mut::<2>().0.iter_mut().zip(goals) {
            let [first, second] = *pair;
            let below = word([first.cast_unsigned(), second.cast_unsigned()]);
            let difference = word(goal).wrapping_add(lanes).wrapping_sub(below);
            let moved = below.wrapping_add(difference >> rate & halves).wrapping_sub(offset);
            let [a, b, c, d] = moved.to_le_bytes();
            *pair = [i16::from_le_bytes([a, b]), i16::from_le_bytes([c, d])];
            lanes = lanes.wrapping_add(2 * BOTH);
        }
    }
}

/// What a symbol is to have before it, but for shares of one, and 2^15: from the 16th before the one that was coded.
#[rustfmt::skip]
const GOALS: [u16; 2 * SYMBOLS] = {
    const A: u16 = 1 << 15;
    const B: u16 = A + TOTAL.cast_unsigned() - 15;
    [
        A, A, A, A, A, A, A, A, A, A, A, A, A, A, A, A,
        A, B, B, B, B, B, B, B, B, B, B, B, B, B, B, B,
    ]
};

/// Two halves, the first low.
#[inline(always)]
fn word([low, high]: [u16; 2]) -> u32 {
    u32::from(high) << 16 | u32::from(low)
}

/// `value`, which is not negative.
#[inline(always)]
const fn unsigned(value: i16) -> u32 {
    let [a, b] = value.to_le_bytes();
    u32::from_le_bytes([a, b, 0, 0])
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVEN: Distribution = Distribution::new([
        0, 2048, 4096, 6144, 8192, 10240, 12288, 14336, 16384, 18432, 20480, 22528, 24576, 26624, 28672,
        30720,
    ]);

    /// Enough until nothing changes any more, but for where each memory access is looked at.
    const ROUNDS: usize = if cfg!(miri) { 1_000 } else { 10_000 };

    #[test]
    fn every_symbol_keeps_a_share() {
        for often in (0..SYMBOLS).step_by(if cfg!(miri) { SYMBOLS } else { 1 }) {
            let mut distribution = EVEN;
            for _ in 0..ROUNDS {
                distribution.learn(often);
                let shares = (0..SYMBOLS).map(|symbol| distribution.share(symbol).size);
                assert!(shares.clone().all(|size| size > 0) && shares.sum::<u32>() == 1 << TOTAL_BITS);
            }
            assert_eq!(distribution.seen, SETTLED);
            assert!(distribution.share(often).size > 32_000, "{often}");
        }
    }

    #[test]
    fn points_are_found_in_their_shares() {
        let mut distribution = EVEN;
        [3, 3, 15, 0, 7, 3].into_iter().for_each(|symbol| distribution.learn(symbol));
        for point in (0..=i16::MAX).step_by(if cfg!(miri) { 509 } else { 1 }) {
            let share = distribution.share(distribution.find(point));
            assert!((share.below..share.below + share.size).contains(&unsigned(point)));
        }
    }

    #[test]
    fn pairs_go_the_same_way() {
        let mut seed = 1_u32;
        for rate in 1..=SLOWEST {
            let (mut one_by_one, mut in_pairs) = (EVEN, EVEN);
            for _ in 0..if cfg!(miri) { 20 } else { 20_000 } {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                // Long runs of one symbol, and changes.
                let symbol = to_usize((seed >> 16) % 7 * ((seed >> 24) & 15) % 16);
                for _ in 0..seed >> 30 << 4 {
                    one_by_one.approach(symbol, rate);
                    in_pairs.approach_in_pairs(symbol, rate);
                }
                assert_eq!(one_by_one, in_pairs, "{symbol} at {rate}");
            }
        }
    }

    #[test]
    fn first_symbols_count_most() {
        let mut distribution = EVEN;
        distribution.learn(15);
        assert_eq!(distribution.share(15).size, 32768 - (30720 - 3839));
    }
}
