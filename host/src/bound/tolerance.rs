//! What was asked for: an absolute bound, or one relative to the range of the values.

use serde::{Deserialize, Serialize};

use super::{BoundError, Real};

/// How far a sample may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    bound: f64,
    is_relative: bool,
}

impl Tolerance {
    /// At most `error`, in the unit of the samples.
    ///
    /// # Errors
    /// [`BoundError`], unless `error` is finite and above 0.
    pub fn absolute(error: f64) -> Result<Self, BoundError> {
        Ok(Self { bound: checked(error)?, is_relative: false })
    }

    /// At most `fraction` of the range of the finite values of the whole volume.
    ///
    /// # Errors
    /// [`BoundError`], unless `fraction` is above 0 and below 1.
    pub fn relative(fraction: f64) -> Result<Self, BoundError> {
        match checked(fraction)? {
            bound if bound >= 1.0 => Err(BoundError::NoPart(bound)),
            bound => Ok(Self { bound, is_relative: true }),
        }
    }

    /// The bound for samples of that range, which is 0 where there is no room at all.
    pub fn within(self, range: FiniteRange) -> Bound {
        let relative = self.is_relative.then_some(self.bound);
        Bound { error: self.resolve(range).unwrap_or(0.0), relative }
    }

    /// The absolute bound for samples of that range, never above the exact product. `None` where it leaves no room at
    /// all, that is for a relative bound of samples that are all the same: these are to be kept exactly.
    pub fn resolve(self, range: FiniteRange) -> Option<f64> {
        if !self.is_relative {
            return Some(self.bound);
        }
        let FiniteRange { min, max } = range;
        let width = max - min;
        let error = if width.is_finite() { self.bound * width } else { self.bound * max - self.bound * min };
        // Three roundings, less than 2^-51 together.
        let error = error.min(f64::MAX) * (1.0 - 4.0 * f64::EPSILON);
        (error > 0.0).then_some(error)
    }
}

/// The bound of one volume.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bound {
    /// No sample may move further, in the unit of the samples; 0 for not at all.
    pub error: f64,
    /// The fraction of the range of the finite values that was asked for, if one was.
    pub relative: Option<f64>,
}

impl Bound {
    /// Whether a bound that was read makes sense.
    pub(crate) fn is_sound(self) -> bool {
        let is_positive = |number: f64| number > 0.0 && number.is_finite();
        (self.error == 0.0 || is_positive(self.error)) && self.relative.is_none_or(is_positive)
    }
}

fn checked(bound: f64) -> Result<f64, BoundError> {
    match bound {
        _ if bound.is_nan() => Err(BoundError::NotANumber),
        _ if bound <= 0.0 => Err(BoundError::NotPositive(bound)),
        f64::INFINITY => Err(BoundError::Infinite),
        _ => Ok(bound),
    }
}

/// The smallest and the largest finite value; both 0 where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiniteRange {
    /// The smallest.
    pub min: f64,
    /// The largest.
    pub max: f64,
}

impl FiniteRange {
    /// The range of `samples`, one pass.
    pub fn of<R: Real>(samples: impl IntoIterator<Item = R>) -> Self {
        let finite = samples.into_iter().map(Real::to_f64).filter(|value| value.is_finite());
        let widened = |range: Option<Self>, value: f64| {
            let Self { min, max } = range.unwrap_or(Self { min: value, max: value });
            Some(Self { min: min.min(value), max: max.max(value) })
        };
        finite.fold(None, widened).unwrap_or(Self { min: 0.0, max: 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_positive_and_finite() {
        for make in [Tolerance::absolute, Tolerance::relative] {
            assert!(matches!(make(f64::NAN), Err(BoundError::NotANumber)));
            assert_eq!(make(0.0), Err(BoundError::NotPositive(0.0)));
            assert_eq!(make(-1.0), Err(BoundError::NotPositive(-1.0)));
            assert_eq!(make(f64::NEG_INFINITY), Err(BoundError::NotPositive(f64::NEG_INFINITY)));
            assert_eq!(make(f64::INFINITY), Err(BoundError::Infinite));
            assert!(make(f64::from_bits(1)).is_ok());
        }
        assert_eq!(Tolerance::relative(1.0), Err(BoundError::NoPart(1.0)));
        assert!(Tolerance::absolute(1.0).is_ok());
    }

    #[test]
    fn relative_bounds_follow_the_finite_range() {
        let range = FiniteRange::of([f32::NAN, 3.0, f32::INFINITY, -5.0, f32::NEG_INFINITY]);
        assert_eq!(range, FiniteRange { min: -5.0, max: 3.0 });
        let error = Tolerance::relative(0.25).unwrap().resolve(range).unwrap();
        assert!(error <= 2.0 && error > 2.0 - 1e-14);
        assert_eq!(Tolerance::absolute(0.25).unwrap().resolve(range), Some(0.25));
    }

    #[test]
    fn no_range_and_all_of_it() {
        let relative = Tolerance::relative(1e-3).unwrap();
        assert_eq!(relative.resolve(FiniteRange::of([7.0_f64, 7.0])), None);
        assert_eq!(relative.resolve(FiniteRange::of::<f32>([])), None);
        assert_eq!(relative.resolve(FiniteRange::of([f32::NAN])), None);
        let widest = FiniteRange::of([f64::MAX, f64::MIN]);
        let error = relative.resolve(widest).unwrap();
        assert!(error.is_finite() && error > 1.9e-3 * f64::MAX);
        assert!(Tolerance::relative(0.99).unwrap().resolve(widest).unwrap().is_finite());
    }
}
