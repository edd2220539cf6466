//! Volumes made by integer arithmetic alone: the same bytes on every machine, for tests, examples and measurements.
//!
//! Each kind is a function of position and seed with values in 64 bits, spread over that whole range; a sample is its
//! uppermost bits. Signed types are centred at zero. Floats are in 0 ≤ v < 1, in steps of 2^-24 or 2^-53.

use std::str::FromStr;

use super::{ElementType, FileFormat, Metadata, Volume};

/// What a synthetic volume shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One value everywhere.
    Constant,
    /// A sum of four waves of 44 to 147 samples along each axis, made of parabolas: smooth.
    Waves,
    /// Blocks of 7 x 5 x 3 samples, each of one of 16 values: flat with sharp borders.
    Steps,
    /// Zero but for eight balls that are brightest in their middle: sparse.
    Blobs,
    /// Independent bits: nothing to compress.
    Noise,
}

impl Kind {
    /// Every kind, in the order of declaration.
    pub const ALL: [Self; 5] = [Self::Constant, Self::Waves, Self::Steps, Self::Blobs, Self::Noise];

    /// Name in lower case: `constant`, `waves`, `steps`, `blobs`, `noise`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Waves => "waves",
            Self::Steps => "steps",
            Self::Blobs => "blobs",
            Self::Noise => "noise",
        }
    }
}

/// The text names no kind.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{text:?} is no synthetic volume: give constant, waves, steps, blobs or noise")]
pub struct UnknownKind {
    text: String,
}

impl FromStr for Kind {
    type Err = UnknownKind;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == text);
        found.ok_or_else(|| UnknownKind { text: text.to_owned() })
    }
}

/// Makes a volume of `extent` samples (x, y, z), equal for equal arguments.
///
/// # Panics
///
/// If the samples do not fit into memory.
///
/// ```
/// use wavelift_host::volume::{ElementType, synthetic::{Kind, generate}};
///
/// let noise = generate(Kind::Noise, [4, 1, 1], ElementType::U8, 0);
/// assert_eq!(noise.samples, [0xe2, 0x6e, 0x06, 0xf8]);
/// ```
pub fn generate(kind: Kind, extent: [u64; 3], element: ElementType, seed: u64) -> Volume {
    let [nx, ny, nz] = extent;
    let mut samples = Vec::new();
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let index = x + nx * (y + ny * z);
                let value = match kind {
                    Kind::Constant => mix(seed),
                    Kind::Waves => waves([x, y, z], seed),
                    Kind::Steps => mix(seed ^ mix((x / 7) << 42 | (y / 5) << 21 | (z / 3))) >> 60 << 60,
                    Kind::Blobs => blobs([x, y, z], extent, seed),
                    Kind::Noise => mix(seed.wrapping_add(index)),
                };
                push(&mut samples, element, value);
            }
        }
    }
    let metadata = Metadata::plain(rank(extent), FileFormat::Raw);
    Volume { extent, element, samples, metadata }
}

fn rank([_, ny, nz]: [u64; 3]) -> u8 {
    if nz > 1 {
        3
    } else if ny > 1 {
        2
    } else {
        1
    }
}

/// Output `n` of the generator SplitMix64 (Steele, Lea, Flood: *Fast splittable pseudorandom number generators*, 2014).
fn mix(n: u64) -> u64 {
    let a = n.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let b = (a ^ a >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let c = (b ^ b >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    c ^ c >> 31
}

fn waves(at: [u64; 3], seed: u64) -> u64 {
    let sum: i64 = (0..4).map(|number| wave(at, mix(seed.wrapping_add(number)))).sum();
    // Four waves within ±2^28 each: shifted to 0 ≤ sum ≤ 2^31, then to the upper bits.
    ((sum + (1 << 30)).min((1 << 31) - 1) as u64) << 33
}

/// A wave of period 2^16 in its phase, two parabolas within ±2^28, in a direction that `bits` choose.
fn wave(at: [u64; 3], bits: u64) -> i64 {
    let step = |axis: u32| (bits >> (16 * axis)) % 1024 + 447;
    let phase = at
        .into_iter()
        .zip(0..)
        .fold(bits >> 48, |sum, (n, axis)| sum.wrapping_add(n.wrapping_mul(step(axis))));
    let half = (phase % (1 << 15)) as i64;
    let height = half * ((1 << 15) - half);
    if phase & (1 << 15) == 0 { height } else { -height }
}

fn blobs(at: [u64; 3], extent: [u64; 3], seed: u64) -> u64 {
    let longest = extent.into_iter().max().unwrap_or(1);
    let radius_squared = u128::from(longest / 8 + 1).pow(2);
    let height = |number: u64| {
        let distance_squared: u128 = (0..3)
            .map(|axis| {
                let centre = mix(seed.wrapping_add(number * 3 + axis as u64)) % extent[axis];
                u128::from(at[axis].abs_diff(centre)).pow(2)
            })
            .sum();
        (radius_squared.saturating_sub(distance_squared) * u128::from(u64::MAX) / radius_squared) as u64
    };
    (0..8).map(height).max().unwrap_or(0)
}

/// Appends the sample that `value`, a fraction of 2^64, stands for.
fn push(samples: &mut Vec<u8>, element: ElementType, value: u64) {
    let bits = 8 * element.bytes() as u32;
    let integer = if element.is_signed_integer() { value ^ 1 << 63 } else { value } >> (64 - bits);
    match element {
        ElementType::F32 => samples.extend(((value >> 40) as f32 / (1_u32 << 24) as f32).to_le_bytes()),
        ElementType::F64 => samples.extend(((value >> 11) as f64 / (1_u64 << 53) as f64).to_le_bytes()),
        _ => samples.extend_from_slice(&integer.to_le_bytes()[..element.bytes()]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_and_type_has_its_bytes_and_repeats() {
        for kind in Kind::ALL {
            assert_eq!(kind.name().parse(), Ok(kind));
            for element in ElementType::ALL {
                let volume = generate(kind, [9, 5, 4], element, 7);
                assert_eq!(volume.samples.len(), 180 * element.bytes());
                assert_eq!(volume, generate(kind, [9, 5, 4], element, 7));
            }
        }
        assert!("wave".parse::<Kind>().is_err());
    }

    #[test]
    fn kinds_are_what_they_say() {
        let volume = |kind| generate(kind, [32, 32, 32], ElementType::U8, 1).samples;
        let zeros = |samples: &[u8]| samples.iter().filter(|sample| **sample == 0).count();
        let steepest = |samples: &[u8]| {
            samples.chunks(32).flat_map(|line| line.windows(2).map(|w| w[0].abs_diff(w[1]))).max()
        };
        assert!(volume(Kind::Constant).windows(2).all(|pair| pair[0] == pair[1]));
        assert!(steepest(&volume(Kind::Waves)).unwrap() <= 24);
        assert!(volume(Kind::Steps).iter().all(|sample| sample % 16 == 0));
        assert!(zeros(&volume(Kind::Blobs)) > 28_000);
        assert!(volume(Kind::Blobs).contains(&255));
        assert!(zeros(&volume(Kind::Noise)) < 300);
    }

    #[test]
    fn floats_are_fractions() {
        let samples = generate(Kind::Noise, [1000, 1, 1], ElementType::F32, 3).samples;
        let values = samples.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        assert!(values.clone().all(|value| (0.0..1.0).contains(&value)));
        assert!(values.clone().any(|value| value < 0.01) && values.clone().any(|value| value > 0.99));
    }
}
