//! An adaptive probability.

/// The chance that a decision is `false`, as the mean of two estimates that forget at different rates.
///
/// Each moves by 1/2^rate of the way to what was seen. Both rates start at 2 and grow with the number of decisions
/// seen, as in counting, until the fast estimate stays at 4 and the slow one at 7.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Probability {
    /// In 1/65536, between 1 and 65535.
    fast: u16,
    slow: u16,
    /// Decisions seen, up to [`SETTLED`].
    seen: u8,
}

const FAST_RATE: u32 = 4;
const SLOW_RATE: u32 = 7;

/// Decisions after which no rate changes any more: the rate after n of them is log2(n + 2) + 1, rounded down.
const SETTLED: u8 = (1 << (SLOW_RATE - 1)) - 2;

impl Probability {
    pub(crate) const NEW: Self = Self { fast: 1 << 15, slow: 1 << 15, seen: 0 };

    /// The chance of `false` in 1/65536.
    #[inline(always)]
    pub(crate) fn of_false(self) -> u32 {
        u32::from(self.fast).wrapping_add(u32::from(self.slow)) >> 1
    }

    /// Learns one decision.
    #[inline(always)]
    pub(crate) fn learn(&mut self, bit: bool) {
        let rate = u32::from(self.seen).wrapping_add(2).ilog2().wrapping_add(1);
        self.fast = moved(self.fast, bit, rate.min(FAST_RATE));
        self.slow = moved(self.slow, bit, rate);
        self.seen = self.seen.wrapping_add(u8::from(self.seen < SETTLED));
    }
}

/// `estimate` moved by 1/2^rate of the way towards 0 (after `true`) or 65535 (after `false`).
#[inline(always)]
const fn moved(estimate: u16, bit: bool, rate: u32) -> u16 {
    if bit { estimate.wrapping_sub(estimate >> rate) } else { estimate.wrapping_add(!estimate >> rate) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimates_stay_inside_the_interval() {
        for bit in [false, true] {
            let mut probability = Probability::NEW;
            for _ in 0..10_000 {
                probability.learn(bit);
                assert!((1..=65535).contains(&probability.of_false()));
            }
            assert_eq!(probability.seen, SETTLED);
            assert!(if bit { probability.of_false() < 80 } else { probability.of_false() > 65535 - 80 });
        }
    }

    #[test]
    fn first_decisions_count_most() {
        let mut probability = Probability::NEW;
        probability.learn(false);
        assert_eq!(probability.of_false(), 32768 + (32767 >> 2));
        probability.learn(true);
        assert_eq!(probability.of_false(), 40959 - (40959 >> 2));
    }
}
