//! Distributions of symbols, and how they learn.

use super::first;

/// A distribution of the symbols 0 to 15.
#[derive(Debug, Clone, Copy)]
pub(super) struct Distribution {
    below: [i32; 16],
    seen: u32,
}

impl Distribution {
    const fn new(below: [i32; 16]) -> Self {
        Self { below, seen: 0 }
    }

    /// The chance of a symbol smaller than `s`, which may be 16, in 1/32768.
    pub(super) fn below(&self, s: usize) -> u64 {
        self.below.get(s).map_or(32768, |&below| below as u64)
    }

    /// Learns that the symbol was `s`.
    pub(super) fn learn(&mut self, s: usize) {
        let rate = (self.seen + 6).ilog2() + 1;
        for i in 0..16 {
            let goal = if i <= s { i as i32 } else { i as i32 + 32752 };
            self.below[i] += (goal - self.below[i]) >> rate;
        }
        self.seen = (self.seen + 1).min(58);
    }
}

/// All distributions of a codestream.
#[derive(Debug)]
pub(super) struct Models {
    pub(super) small: [[Distribution; 3]; 10],
    pub(super) large: [Distribution; 50],
    pub(super) exponent: [Distribution; 2],
    pub(super) weight: Distribution,
}

impl Models {
    pub(super) fn new() -> Self {
        Self {
            small: first::SMALL.map(|class| class.map(Distribution::new)),
            large: [Distribution::new(first::LARGE); 50],
            exponent: first::EXPONENT.map(Distribution::new),
            weight: Distribution::new(first::WEIGHT),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_symbol_keeps_a_share_whatever_is_learnt() {
        let models = Models::new();
        let all = models.small.iter().flatten().chain(&models.large).chain(&models.exponent);
        for start in all.chain([&models.weight]) {
            for often in 0..16 {
                let mut distribution = *start;
                for turn in 0..3000 {
                    distribution.learn(if turn % 500 == 499 { turn % 16 } else { often });
                    let shares = (0..16).map(|s| (distribution.below(s), distribution.below(s + 1)));
                    assert!(shares.into_iter().all(|(below, next)| below < next), "{distribution:?}");
                    assert_eq!(distribution.below(0), 0);
                }
            }
        }
    }
}
