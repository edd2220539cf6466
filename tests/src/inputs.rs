//! Inputs of golden vectors: small generators in integer arithmetic, the same on every machine, and crops of
//! the data files of `vectors/`.
//!
//! A generator is never changed once a vector uses it; a different input is a new generator.

use serde::Deserialize;
use wavelift_kernel::{Extent, SampleType};

/// A generator and its arguments. Values are formed in `i64` and keep their low 32 bits, so that `u32` samples
/// travel as the kernel wants them; a value outside the sample type is an error of the encoder.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(tag = "generator", rename_all = "lowercase", deny_unknown_fields)]
pub enum Input {
    /// The same value everywhere.
    Constant {
        /// The value.
        value: i64,
    },
    /// `start + x step[0] + y step[1] + z step[2]`.
    Ramp {
        /// Value at the origin.
        start: i64,
        /// Difference of neighbours along each axis.
        step: [i64; 3],
    },
    /// `offset + amplitude (w(x) + w(y) + w(z) + w(x) w(y) - w(y) w(z)) / 3`, rounded down, where `w` is a wave
    /// between -1 and 1 of the period of its axis; a smooth field with structure along the diagonals.
    Waves {
        /// Samples in a period along each axis.
        periods: [u32; 3],
        /// Largest distance from the offset.
        amplitude: i64,
        /// Value in the middle.
        offset: i64,
    },
    /// `offset` plus the topmost `bits` bits of a [`random`] number.
    Noise {
        /// From 1 to 32.
        bits: u32,
        /// Smallest value.
        offset: i64,
        /// First state of the random numbers.
        seed: u64,
    },
    /// `offset + height floor((x + y + z) / width)`: plateaus with sharp edges.
    Steps {
        /// Samples on a plateau.
        width: u32,
        /// Difference of neighbouring plateaus.
        height: i64,
        /// Value of the first plateau.
        offset: i64,
    },
    /// Zero, but for about one sample in `one_in`, which has `bits` random bits.
    Sparse {
        /// Samples for each that is not zero.
        one_in: u64,
        /// From 1 to 32.
        bits: u32,
        /// First state of the random numbers.
        seed: u64,
    },
    /// `low` where x + y + z is even, `high` where it is odd.
    Checker {
        /// Value at the origin.
        low: i64,
        /// Value beside it.
        high: i64,
    },
    /// At random `low`, `low + 1`, their middle rounded down, `high - 1` or `high`: the ends of a type, next to
    /// each other.
    Extremes {
        /// Smallest value.
        low: i64,
        /// Largest value.
        high: i64,
        /// First state of the random numbers.
        seed: u64,
    },
    /// A crop of a data file of `vectors/`.
    File {
        /// Identifier of its `[[data]]` entry.
        data: String,
        /// Position of the crop's first sample: x, y, z.
        corner: [u32; 3],
    },
}

impl Input {
    /// Kinds that [`Input::of_kind`] knows.
    pub const KINDS: u32 = 8;

    /// An input within a type; `amount`, 0 to 255, says how rough, dense or high it is.
    #[must_use]
    pub fn of_kind(kind: u32, sample_type: SampleType, amount: u8, seed: u64) -> Self {
        let (low, high) = match sample_type {
            SampleType::U32 => (0, u32::MAX.into()),
            narrow => (i64::from(*narrow.range().start()), i64::from(*narrow.range().end())),
        };
        let width = 8 * sample_type.bytes() as u32;
        let (span, share) = (high - low, i64::from(amount) + 1);
        let (middle, bits) = (low + span / 2, 1 + u32::from(amount) % width);
        let period = 2 + u32::from(amount);
        match kind {
            0 => Self::Noise { bits: width, offset: low, seed },
            1 => Self::Extremes { low, high, seed },
            2 => Self::Noise { bits, offset: low, seed },
            3 => Self::Waves {
                periods: [period, period / 2 + 1, 20],
                amplitude: span / 2 * share / 256,
                offset: middle,
            },
            4 => Self::Sparse { one_in: 1 + u64::from(amount), bits: bits.min(width - 1), seed },
            5 => Self::Steps { width: period, height: span / 301, offset: low },
            6 => {
                Self::Checker { low: middle - span / 2 * share / 256, high: middle + span / 2 * share / 256 }
            }
            _ => Self::Constant { value: low + span * share / 256 },
        }
    }

    /// The samples over `extent`, x fastest. `None` for [`Input::File`], whose samples come from elsewhere.
    #[must_use]
    pub fn generate(&self, extent: Extent) -> Option<Vec<i32>> {
        if let Self::File { .. } = self {
            return None;
        }
        let positions = positions(extent);
        Some(
            positions
                .enumerate()
                .map(|(index, position)| low_bits(self.value(index as u64, position)))
                .collect(),
        )
    }

    /// The value of sample number `index`, at `position`.
    fn value(&self, index: u64, position: [u32; 3]) -> i64 {
        let [x, y, z] = position.map(i64::from);
        match *self {
            Self::Constant { value } => value,
            Self::Ramp { start, step } => start + x * step[0] + y * step[1] + z * step[2],
            Self::Waves { periods, amplitude, offset } => {
                offset + (amplitude * waves(position, periods)).div_euclid(3 * ONE)
            }
            Self::Noise { bits, offset, seed } => offset + random_bits(seed, index, bits),
            Self::Steps { width, height, offset } => offset + height * ((x + y + z) / i64::from(width)),
            Self::Sparse { one_in, bits, seed } => {
                let chosen = random(seed, 2 * index).is_multiple_of(one_in);
                if chosen { random_bits(seed, 2 * index + 1, bits) } else { 0 }
            }
            Self::Checker { low, high } => {
                if (x + y + z) % 2 == 0 {
                    low
                } else {
                    high
                }
            }
            Self::Extremes { low, high, seed } => {
                let middle = (low + high).div_euclid(2);
                [low, low + 1, middle, high - 1, high][(random(seed, index) % 5) as usize]
            }
            Self::File { .. } => 0,
        }
    }
}

/// All positions of an extent, x fastest.
pub fn positions(extent: Extent) -> impl Iterator<Item = [u32; 3]> {
    let [nx, ny, nz] = extent.axes();
    (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
}

/// Number `index` (from 0) of the SplitMix64 sequence that starts in state `seed`; Steele, Lea, Flood: *Fast
/// splittable pseudorandom number generators*, OOPSLA 2014.
#[must_use]
pub fn random(seed: u64, index: u64) -> u64 {
    let state = seed.wrapping_add(index.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let mixed = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    mixed ^ (mixed >> 31)
}

/// The topmost `bits` bits of a random number.
fn random_bits(seed: u64, index: u64, bits: u32) -> i64 {
    (random(seed, index) >> (64 - bits)).cast_signed()
}

/// One, of the waves.
const ONE: i64 = 1 << 15;

/// Waves and products of waves, added: linear in each wave, so between its values at the corners, -3 and 3 times
/// `ONE`.
fn waves(position: [u32; 3], periods: [u32; 3]) -> i64 {
    let [x, y, z] = [0, 1, 2].map(|axis| wave(position[axis], periods[axis]));
    x + y + z + x * y / ONE - y * z / ONE
}

/// Two parabolas a period that look like a sine, between -`ONE` and `ONE`.
fn wave(position: u32, period: u32) -> i64 {
    let phase = i64::from(position) * 2 * ONE / i64::from(period) % (2 * ONE) - ONE;
    (phase * (ONE - phase.abs())) >> 13
}

fn low_bits(value: i64) -> i32 {
    value as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn generate(input: Input, axes: [u32; 3]) -> Vec<i32> {
        input.generate(Extent::new(axes).unwrap()).unwrap()
    }

    #[test]
    fn x_varies_fastest() {
        let ramp = Input::Ramp { start: 5, step: [1, 10, 100] };
        assert_eq!(generate(ramp, [3, 2, 2]), [5, 6, 7, 15, 16, 17, 105, 106, 107, 115, 116, 117]);
        let steps = Input::Steps { width: 2, height: 7, offset: -1 };
        assert_eq!(generate(steps, [5, 1, 1]), [-1, -1, 6, 6, 13]);
        assert_eq!(generate(Input::Checker { low: 1, high: 2 }, [2, 2, 1]), [1, 2, 2, 1]);
    }

    #[test]
    fn random_numbers_are_those_of_the_published_sequence() {
        let first = [0, 1, 2].map(|index| random(1_234_567, index));
        assert_eq!(first, [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]);
    }

    #[test]
    fn waves_stay_within_their_amplitude() {
        let quarter = [0, 4, 8, 12].map(|position| wave(position, 16));
        assert_eq!(quarter, [0, -ONE, 0, ONE]);
        let waves = Input::Waves { periods: [16, 11, 7], amplitude: 100, offset: 100 };
        let samples = generate(waves, [32, 12, 9]);
        assert!(samples.iter().all(|sample| (0..=200).contains(sample)));
        assert!(samples.iter().any(|sample| *sample > 180) && samples.iter().any(|sample| *sample < 20));
    }

    #[test]
    fn extremes_reach_both_ends_of_every_type() {
        let extremes = Input::Extremes { low: 0, high: i64::from(u32::MAX), seed: 3 };
        let samples = generate(extremes, [64, 1, 1]);
        for value in [0, 1, i32::MAX, -2, -1] {
            assert!(samples.contains(&value), "{value}");
        }
    }
}
