//! Floating-point types of samples.

/// A type of floating-point samples: `f32` or `f64`.
pub trait Real: Copy + PartialEq + sealed::Sealed {
    /// Half the distance of 1 to the next larger number: what rounding moves a number of magnitude 1 at most.
    const ROUNDING: f64;

    /// The same number in double precision.
    fn to_f64(self) -> f64;

    /// The nearest number of this type, ties to even.
    fn nearest(value: f64) -> Self;

    /// The bits, in the low half for `f32`.
    fn bits(self) -> u64;

    /// The inverse of [`Real::bits`]; what is above the bits of the type does not matter.
    fn of_bits(bits: u64) -> Self;

    /// Whether this is -0.0.
    fn is_negative_zero(self) -> bool {
        self.bits() == Self::nearest(-0.0).bits()
    }
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

impl Real for f32 {
    const ROUNDING: f64 = Self::EPSILON as f64 / 2.0;

    fn to_f64(self) -> f64 {
        self.into()
    }

    fn nearest(value: f64) -> Self {
        value as Self
    }

    fn bits(self) -> u64 {
        self.to_bits().into()
    }

    fn of_bits(bits: u64) -> Self {
        Self::from_bits(bits as u32)
    }
}

impl Real for f64 {
    const ROUNDING: f64 = Self::EPSILON / 2.0;

    fn to_f64(self) -> f64 {
        self
    }

    fn nearest(value: f64) -> Self {
        value
    }

    fn bits(self) -> u64 {
        self.to_bits()
    }

    fn of_bits(bits: u64) -> Self {
        Self::from_bits(bits)
    }
}

/// The samples that little-endian bytes stand for.
pub fn samples_of<R: Real>(bytes: &[u8]) -> impl ExactSizeIterator<Item = R> + Clone {
    bytes.chunks_exact(size_of::<R>()).map(|sample| {
        let mut bits = [0; 8];
        bits[..sample.len()].copy_from_slice(sample);
        R::of_bits(u64::from_le_bytes(bits))
    })
}

/// The inverse of [`samples_of`]: appends the bytes of each sample.
pub fn extend_bytes<R: Real>(bytes: &mut Vec<u8>, samples: impl IntoIterator<Item = R>) {
    for sample in samples {
        bytes.extend_from_slice(&sample.bits().to_le_bytes()[..size_of::<R>()]);
    }
}

/// Whether |a - b| <= `error` for the real numbers themselves, without any rounding. False if a or b is not finite.
///
/// The rounded difference and what rounding left out are both known (D. E. Knuth, The Art of Computer Programming,
/// volume 2, 4.2.2, theorem B). Rounding keeps the order, so only a difference that rounds to `error` itself needs
/// the second.
pub(super) fn is_within(a: f64, b: f64, error: f64) -> bool {
    let difference = a - b;
    let magnitude = difference.abs();
    if magnitude != error {
        return magnitude < error;
    }
    let of_b = a - difference;
    let of_a = difference + of_b;
    let left_out = (a - of_a) + (of_b - b);
    if difference < 0.0 { left_out >= 0.0 } else { left_out <= 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_compared_exactly() {
        assert!(is_within(1.0, 0.0, 1.0) && is_within(0.0, 1.0, 1.0));
        let tiny = f64::from_bits(1);
        // 1 + tiny rounds to 1, but is more.
        assert!(!is_within(1.0, -tiny, 1.0) && !is_within(-tiny, 1.0, 1.0));
        assert!(is_within(1.0, tiny, 1.0) && is_within(tiny, 1.0, 1.0));
        assert!(!is_within(1.0, -2.0_f64.powi(-60), 1.0) && is_within(1.0, 2.0_f64.powi(-60), 1.0));
        assert!(is_within(tiny, 0.0, tiny) && !is_within(tiny, -tiny, tiny));
    }

    #[test]
    fn what_is_not_finite_is_never_within() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!is_within(value, 0.0, f64::MAX) && !is_within(0.0, value, f64::MAX));
            assert!(!is_within(value, value, f64::MAX));
        }
        assert!(!is_within(f64::MAX, -f64::MAX, f64::MAX));
    }

    #[test]
    fn bytes_come_back() {
        let bytes: Vec<u8> = (0..=255).collect();
        let (mut singles, mut doubles) = (Vec::new(), Vec::new());
        extend_bytes(&mut singles, samples_of::<f32>(&bytes));
        extend_bytes(&mut doubles, samples_of::<f64>(&bytes));
        assert_eq!([&singles, &doubles], [&bytes, &bytes]);
        assert!(samples_of::<f64>(&1.5_f64.to_le_bytes()).eq([1.5]));
    }

    #[test]
    fn only_negative_zero_is_negative_zero() {
        assert!((-0.0_f32).is_negative_zero() && (-0.0_f64).is_negative_zero());
        for value in [0.0, -f32::from_bits(1), -1.0, f32::NAN] {
            assert!(!value.is_negative_zero());
        }
    }
}
