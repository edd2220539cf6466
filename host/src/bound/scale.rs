//! The integers that samples are written as.

use serde::{Deserialize, Serialize};

use super::real::is_within;
use super::{Exceptions, Profile, Real};

/// Magnitude of the integers at most: some bits are left for prediction.
const LARGEST: i32 = 1 << 27;

/// Slacks to choose from, best first: the finer the integers, the better they are predicted, and the smaller the range.
const SLACKS: [u32; 4] = [7, 3, 1, 0];

/// Decimal fractions that natural scales are looked for among: integers, tenths, and so on.
pub(super) const DECIMALS: [f64; 7] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6];

/// A natural scale is taken if its steps are not narrower than this part of those that the bound allows.
const NATURAL_STEP: f64 = 0.98;

/// Samples as multiples of a unit: X = round(x * density), and x' = X' / density wherever |X - X'| <= slack.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "(f64, u32)", into = "(f64, u32)")]
pub struct Scale {
    density: f64,
    slack: u32,
}

/// The density is a number.
impl Eq for Scale {}

impl From<Scale> for (f64, u32) {
    fn from(scale: Scale) -> Self {
        (scale.density, scale.slack)
    }
}

impl TryFrom<(f64, u32)> for Scale {
    type Error = &'static str;

    fn try_from((density, slack): (f64, u32)) -> Result<Self, Self::Error> {
        let is_sound = density.is_finite() && density > 0.0 && slack <= LARGEST.unsigned_abs();
        is_sound.then_some(Self { density, slack }).ok_or("a scale that no sample is written in")
    }
}

impl Scale {
    /// The scale for the samples of a volume and the bound `error`: a natural one if its steps are as wide, or else one
    /// made for the bound. `None` where nearly all samples would be exceptions, because the bound is finer than an
    /// `i32` can tell; these are to be coded exactly.
    ///
    /// `most_slack` is how far whatever codes the integers may move them.
    pub fn choose(profile: &Profile, error: f64, most_slack: u32) -> Option<Self> {
        let natural = Self::natural(profile, error, most_slack);
        let is_wide = |scale: &Self| scale.step() >= NATURAL_STEP * 2.0 * error;
        natural.filter(is_wide).or_else(|| {
            SLACKS
                .into_iter()
                .filter(|&slack| slack <= most_slack)
                .filter_map(|slack| Self::for_bound(profile, error, slack))
                .find(|&scale| profile.is_reached(scale))
        })
    }

    /// The scale on which nearly all samples lie already: multiples of a power of two, or decimals of up to six
    /// places, kept as floats. Its slack is what `error` allows, up to `most_slack`: 0, which means exactly, for errors
    /// below the unit.
    pub fn natural(profile: &Profile, error: f64, most_slack: u32) -> Option<Self> {
        // In reach, every sample is a multiple of the lowest bit.
        let binary = profile.binary_density().map(Self::exact).filter(|&scale| profile.is_reached(scale));
        let scale = binary.or_else(|| profile.decimal_density().map(Self::exact))?;
        let largest = profile.largest_reached(scale);
        // Decimals are rounded twice, there and back.
        let rounding =
            if scale.density.log2().fract() == 0.0 { 0.0 } else { 2.0 * profile.rounding() * largest };
        let slack = ((error - rounding).max(0.0) * scale.density).floor();
        Some(Self { slack: slack.min(f64::from(LARGEST)).min(f64::from(most_slack)) as u32, ..scale })
    }

    /// The scale on which moving an integer by `slack`, and rounding, stays within `error`.
    fn for_bound(profile: &Profile, error: f64, slack: u32) -> Option<Self> {
        let widest = Self::of_width(error, slack)?;
        // Once to the type of the sample, and in double precision before, there and back.
        let rounding = (profile.rounding() + 4.0 * f64::ROUNDING) * profile.largest_reached(widest);
        // Where rounding takes most of the bound there is no use in making room for it.
        let room = if rounding < error / 2.0 { error - rounding } else { error };
        Self::of_width(room, slack)
    }

    /// The scale of so many integers to 1, none of which may be moved.
    pub(super) const fn exact(density: f64) -> Self {
        Self { density, slack: 0 }
    }

    /// The scale whose half a step, slack and a half, is `half_width`.
    fn of_width(half_width: f64, slack: u32) -> Option<Self> {
        Self::try_from(((f64::from(slack) + 0.5) / half_width, slack)).ok()
    }

    /// How far an integer may be moved.
    pub const fn slack(self) -> u32 {
        self.slack
    }

    /// Integers per 1.
    pub const fn density(self) -> f64 {
        self.density
    }

    /// The distance of values that can be told apart after moving integers by up to the slack.
    fn step(self) -> f64 {
        f64::from(2 * self.slack + 1) / self.density
    }

    /// A bound of the magnitudes of the integers of samples.
    pub fn largest_integer(self, profile: &Profile) -> i32 {
        self.integer(profile.largest_reached(self))
    }

    /// Writes samples as integers, as many as there are of both. A sample that is not finite, or beyond the scale,
    /// repeats the integer before it.
    pub fn quantize<R: Real>(self, samples: impl Iterator<Item = R>, integers: &mut [i32]) {
        let mut before = 0;
        for (integer, sample) in integers.iter_mut().zip(samples) {
            if self.reaches(sample) {
                before = self.integer(sample);
            }
            *integer = before;
        }
    }

    /// What a decoder makes of an integer.
    pub fn restore<R: Real>(self, integer: i32) -> R {
        R::nearest(f64::from(integer) / self.density)
    }

    /// The samples that a decoder would not return within `error` (0 for exactly) of the truth, given the integers
    /// that it will get, and every -0.0 that it would not return as such.
    pub fn exceptions<R: Real>(
        self,
        samples: impl Iterator<Item = R>,
        integers: &[i32],
        error: f64,
    ) -> Exceptions {
        let pairs = samples.zip(integers).enumerate();
        Exceptions::collect(pairs.filter_map(|(position, (sample, &integer))| {
            let restored: R = self.restore(integer);
            let is_kept = is_within(sample.to_f64(), restored.to_f64(), error)
                && (restored.bits() == sample.bits() || !sample.is_negative_zero());
            (!is_kept).then_some((position, sample))
        }))
    }

    /// Whether the integer of a sample is in range.
    pub(super) fn reaches<R: Real>(self, sample: R) -> bool {
        (sample.to_f64() * self.density).abs() <= f64::from(LARGEST)
    }

    /// The magnitude of the samples that are just in reach, but for rounding.
    pub(super) fn reach(self) -> f64 {
        (f64::from(LARGEST) / self.density).min(f64::MAX)
    }

    /// Whether a sample comes back as it was, but for the sign of zero.
    pub(super) fn holds<R: Real>(self, sample: R) -> bool {
        self.reaches(sample) && self.restore::<R>(self.integer(sample)) == sample
    }

    fn integer<R: Real>(self, sample: R) -> i32 {
        (sample.to_f64() * self.density).round() as i32
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// What comes back after integers were moved as far as they may be, to and fro.
    fn round_trip<R: Real>(samples: &[R], error: f64) -> Option<(Scale, Vec<R>, usize)> {
        let scale = Scale::choose(&Profile::of(samples.iter().copied()), error, u32::MAX)?;
        let mut integers = vec![0; samples.len()];
        scale.quantize(samples.iter().copied(), &mut integers);
        let slack = scale.slack().cast_signed();
        for (i, integer) in integers.iter_mut().enumerate() {
            *integer += [slack, -slack, 0][i % 3];
        }
        let exceptions = scale.exceptions(samples.iter().copied(), &integers, error);
        let mut back: Vec<R> = integers.iter().map(|&integer| scale.restore(integer)).collect();
        assert!(exceptions.apply(&mut back));
        Some((scale, back, exceptions.runs().len()))
    }

    fn holds<R: Real>(samples: &[R], back: &[R], error: f64) -> bool {
        samples.iter().zip(back).all(|(a, b)| {
            a.bits() == b.bits() || !a.is_negative_zero() && is_within(a.to_f64(), b.to_f64(), error)
        })
    }

    #[test]
    fn ordinary_samples_need_no_exceptions() {
        let samples: Vec<f32> = (0..5000).map(|i| (i as f32 * 0.01).sin() * 3.7).collect();
        for error in [0.5, 1e-2, 1e-3, 1e-4, 1e-5] {
            let (scale, back, exceptions) = round_trip(&samples, error).unwrap();
            assert_eq!((exceptions, scale.slack()), (0, 7), "{error}");
            assert!(holds(&samples, &back, error));
        }
        assert_eq!(Scale::choose(&Profile::of(samples.iter().copied()), 1e-12, u32::MAX), None);
        let doubles: Vec<f64> = samples.iter().map(|&sample| f64::from(sample) / 3.0).collect();
        assert_eq!(round_trip(&doubles, 1e-6).map(|(_, _, exceptions)| exceptions), Some(0));
    }

    #[test]
    fn integers_kept_as_floats_stay_integers() {
        let samples: Vec<f32> = (0..1000).map(|i| (i * 7 % 400) as f32).collect();
        for (error, density, slack) in [(0.3, 1.0, 0), (0.7, 7.5 / 0.7, 7), (1.3, 1.0, 1), (2.0, 1.0, 2)] {
            let (scale, back, exceptions) = round_trip(&samples, error).unwrap();
            assert!((scale.density() - density).abs() < 1e-3 * density, "{error}: {scale:?}");
            assert_eq!((scale.slack(), exceptions), (slack, 0), "{error}");
            assert!(holds(&samples, &back, error) && (slack > 0 || back == samples));
        }
    }

    #[test]
    fn decimals_are_exact() {
        let samples: Vec<f64> = (0..1000).map(|i| f64::from(i * 37 % 500) / 100.0).collect();
        let (scale, back, exceptions) = round_trip(&samples, 1e-3).unwrap();
        assert_eq!((scale.density(), scale.slack(), exceptions), (100.0, 0, 0));
        assert_eq!(back, samples);
        assert_eq!(Scale::natural(&Profile::of(samples.iter().copied()), 0.0, 0), Some(scale));
    }

    #[test]
    fn what_no_scale_holds_is_kept() {
        let odd =
            [f32::NAN, f32::from_bits(0xFFC0_1234), f32::INFINITY, f32::NEG_INFINITY, -0.0, 1e30, f32::MIN];
        let mut samples: Vec<f32> = (0..4000).map(|i| (i as f32 * 0.37).cos()).collect();
        for (sample, odd) in samples.iter_mut().step_by(500).zip(odd) {
            *sample = odd;
        }
        let (_, back, exceptions) = round_trip(&samples, 1e-3).unwrap();
        assert!(holds(&samples, &back, 1e-3));
        assert_eq!(exceptions, odd.len());
        samples[..2000].fill(f32::NAN);
        assert!(round_trip(&samples, 1e-3).is_some_and(|(_, back, _)| holds(&samples, &back, 1e-3)));
    }

    #[test]
    fn denormals_and_tiny_bounds() {
        let samples: Vec<f64> = (0..600_u64).map(|i| f64::from_bits(i * i + 1)).collect();
        for error in [f64::from_bits(1), f64::from_bits(3), f64::MIN_POSITIVE, 1e-300] {
            if let Some((_, back, _)) = round_trip(&samples, error) {
                assert!(holds(&samples, &back, error));
            }
        }
    }

    #[test]
    fn no_slack_where_none_is_given() {
        let samples: Vec<f32> = (0..1000).map(|i| (i * 7 % 400) as f32).collect();
        for (error, density) in [(0.3, 1.0), (0.5, 1.0), (2.0, 0.25)] {
            let scale = Scale::choose(&Profile::of(samples.iter().copied()), error, 0).unwrap();
            assert!((scale.density() - density).abs() < 1e-3 * density, "{error}: {scale:?}");
            assert_eq!(scale.slack(), 0);
            assert_eq!(
                scale.largest_integer(&Profile::of(samples.iter().copied())),
                (399.0 * scale.density()).round() as i32
            );
        }
    }

    #[test]
    fn scales_that_are_read_are_checked() {
        for density in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Scale::try_from((density, 0)).is_err());
        }
        assert!(Scale::try_from((1.0, u32::MAX)).is_err() && Scale::try_from((f64::MIN_POSITIVE, 7)).is_ok());
    }

    proptest! {
        #[test]
        fn any_bits_stay_within_any_bound(
            bits in prop::collection::vec(any::<u32>(), 1..600),
            exponent in -45_i32..38,
        ) {
            let samples: Vec<f32> = bits.into_iter().map(f32::from_bits).collect();
            let error = 10_f64.powi(exponent);
            if let Some((_, back, _)) = round_trip(&samples, error) {
                prop_assert!(holds(&samples, &back, error));
            }
        }

        #[test]
        fn any_doubles_stay_within_any_bound(
            samples in prop::collection::vec(prop::num::f64::ANY, 1..600),
            exponent in -320_i32..308,
        ) {
            let error = 10_f64.powi(exponent);
            prop_assume!(error > 0.0);
            if let Some((_, back, _)) = round_trip(&samples, error) {
                prop_assert!(holds(&samples, &back, error));
            }
        }

        #[test]
        fn samples_of_one_size_always_have_a_scale(
            samples in prop::collection::vec(-1e3_f32..1e3, 512..1500),
            exponent in -3_i32..3,
        ) {
            let error = 10_f64.powi(exponent);
            let (_, back, exceptions) = round_trip(&samples, error).unwrap();
            prop_assert!(holds(&samples, &back, error));
            prop_assert!(exceptions <= samples.len() / 256);
        }
    }
}
