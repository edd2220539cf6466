//! Repeatable noise for tests: the SplitMix64 generator of Steele, Lea and Flood, *Fast Splittable Pseudorandom
//! Number Generators*, 2014.

/// A generator; equal seeds give equal sequences.
#[derive(Debug, Clone)]
pub struct Noise(u64);

impl Noise {
    /// A generator that starts from `seed`.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub const fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// `count` values from all of `i32`, one in eight of them an extreme one.
    pub fn full_range(&mut self, count: usize) -> Vec<i32> {
        (0..count)
            .map(|_| match self.bits() % 16 {
                0 => i32::MIN,
                1 => i32::MAX,
                _ => (self.bits() >> 32) as i32,
            })
            .collect()
    }

    /// `count` values from `-limit..=limit`; `limit` is not negative.
    pub fn within(&mut self, limit: i32, count: usize) -> Vec<i32> {
        let span = 2 * i128::from(limit) + 1;
        (0..count).map(|_| (i128::from(self.bits()) % span - i128::from(limit)) as i32).collect()
    }
}
