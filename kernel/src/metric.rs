//! What the tables of the dissertation list for coefficients, and how far two sets of samples are apart.
//!
//! Figures for people, never a part of a codestream: the only place of the kernel with floating-point numbers. Code
//! lengths are exact integer sums all the same, so that they are the same on every machine.
//!
//! Source: M. Bertram, *Multiresolution Modeling for Scientific Visualization*, dissertation, UC Davis 2000, §3.5.

#![expect(clippy::float_arithmetic, reason = "percentages and rates for people to read")]

use fixed::types::{U48F16, U64F0, U128F0};
use micromath::F32Ext;

use crate::error::exactly;
use crate::{LengthError, Slice};

/// What [`measure`] finds: a row of Diss Tables 3.5 and 3.6.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Measure {
    /// How many coefficients there are.
    pub samples: usize,
    /// How many of them are zero.
    pub zeros: usize,
    /// The smallest; 0 if there are none.
    pub min: i32,
    /// The largest; 0 if there are none.
    pub max: i32,
    /// Order-0 code length in 1/65536 bits.
    code: u64,
}

/// Measures `coefficients`, in any order; sorts them in place.
///
/// The code length is what arithmetic coding with the exact histogram takes, the histogram not counted (Diss eq. 3.71).
/// It is exact to 2^-16 bits and a relative 2^-50.
/// Cost: a sort without further memory, and one logarithm (at most 56 multiplications) per distinct value.
pub fn measure(coefficients: &mut [i32]) -> Measure {
    coefficients.sort_unstable();
    let total = to_u64(coefficients.len());
    let log2_total = log2(total);
    let mut zeros = 0;
    let mut code = 0_u128;
    for run in coefficients.chunk_by(|a, b| a == b) {
        let times = to_u64(run.len());
        // n occurrences of p = n / total take n log2(1 / p) = n (log2 total - log2 n) bits.
        let each = log2_total.saturating_sub(log2(times));
        code = code.saturating_add(u128::from(times).saturating_mul(u128::from(each)));
        if run.first() == Some(&0) {
            zeros = run.len();
        }
    }
    Measure {
        samples: coefficients.len(),
        zeros,
        min: coefficients.first().copied().unwrap_or(0),
        max: coefficients.last().copied().unwrap_or(0),
        code: u64::try_from(code >> (LOG2_FRACTION - U48F16::FRAC_NBITS)).unwrap_or(u64::MAX),
    }
}

impl Measure {
    /// The order-0 code length in bits.
    #[must_use]
    pub fn code_bits(&self) -> f32 {
        U48F16::from_bits(self.code).to_num()
    }

    /// The order-0 code length in bytes, rounded up.
    #[must_use]
    pub const fn code_bytes(&self) -> u64 {
        self.code.div_ceil(8 << U48F16::FRAC_NBITS)
    }

    /// The code length in percent of `raw_bytes`, the size of the uncompressed samples.
    #[must_use]
    pub fn percent_of(&self, raw_bytes: u64) -> f32 {
        100.0 * self.code_bits() / (8.0 * to_f32(raw_bytes))
    }

    /// The compression rate: `raw_bytes` divided by the code length. Infinite if all coefficients are equal.
    #[must_use]
    pub fn rate(&self, raw_bytes: u64) -> f32 {
        8.0 * to_f32(raw_bytes) / self.code_bits()
    }

    /// Zeros in percent of all coefficients.
    #[must_use]
    pub fn zeros_percent(&self) -> f32 {
        100.0 * to_f32(to_u64(self.zeros)) / to_f32(to_u64(self.samples))
    }
}

/// The largest difference between samples of equal position: the L-infinity error.
///
/// # Errors
/// [`LengthError`] if `b` is not as long as `a`.
pub fn max_error(a: &[i32], b: &[i32]) -> Result<u32, LengthError> {
    exactly(Slice::Samples, a.len(), b.len())?;
    Ok(a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0))
}

/// The root of the mean square of the differences between samples of equal position: the L2 error; 0 for no samples.
///
/// The sum of squares is exact; the root is within a relative 1e-6.
///
/// # Errors
/// [`LengthError`] if `b` is not as long as `a`.
pub fn rms_error(a: &[i32], b: &[i32]) -> Result<f32, LengthError> {
    exactly(Slice::Samples, a.len(), b.len())?;
    let squares = a.iter().zip(b).map(|(a, b)| u128::from(a.abs_diff(*b)).saturating_pow(2));
    let sum = squares.fold(0, u128::saturating_add);
    if sum == 0 {
        return Ok(0.0);
    }
    Ok(sqrt(U128F0::from_bits(sum).to_num::<f32>() / to_f32(to_u64(a.len()))))
}

/// The square root of a positive number: micromath's is within some percent, and each of Heron's steps squares that.
fn sqrt(x: f32) -> f32 {
    (0..3).fold(F32Ext::sqrt(x), |root, _| 0.5 * (root + x / root))
}

fn to_u64(n: usize) -> u64 {
    u64::try_from(n).unwrap_or(u64::MAX)
}

fn to_f32(n: u64) -> f32 {
    U64F0::from_bits(n).to_num()
}

/// Bits after the binary point of [`log2`].
const LOG2_FRACTION: u32 = 56;

/// log2 n in 2^-56, at most three units too small; 0 for 0.
///
/// Bit by bit: squaring doubles the logarithm, so each square that reaches 2 is one more bit.
fn log2(n: u64) -> u64 {
    let Some(whole) = n.checked_ilog2() else { return 0 };
    // n / 2^whole, from 1 to below 2, in 2^-63.
    let mut mantissa = n << 63_u32.saturating_sub(whole);
    let mut log = u64::from(whole) << LOG2_FRACTION;
    for bit in (0..LOG2_FRACTION).rev() {
        if mantissa == 1 << 63 {
            break;
        }
        let square = u128::from(mantissa).saturating_mul(mantissa.into()) >> 63;
        let carry = square >> 64 != 0;
        log |= u64::from(carry) << bit;
        mantissa = u64::try_from(square >> u32::from(carry)).unwrap_or(u64::MAX);
    }
    log
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text's own example, Diss Figure 3.27: "ADBAAABC" takes 1.75 bits a symbol.
    #[test]
    fn code_length_of_the_figure() {
        let measure = measure(&mut [0, 3, 1, 0, 0, 0, 1, 2]);
        assert_eq!(measure.code_bits(), 14.0);
        assert_eq!(measure.code_bytes(), 2);
        assert_eq!((measure.samples, measure.zeros, measure.min, measure.max), (8, 4, 0, 3));
        assert_eq!((measure.percent_of(8), measure.rate(8)), (21.875, 64.0 / 14.0));
        assert_eq!(measure.zeros_percent(), 50.0);
    }

    #[test]
    fn equally_likely_values() {
        assert_eq!(measure(&mut [i32::MIN, -1, i32::MAX, 0]).code_bits(), 4.0 * 2.0);
        assert_eq!(measure(&mut [7; 100]).code_bits(), 0.0);
        assert_eq!(measure(&mut [7; 100]).rate(100), f32::INFINITY);
        // 3 log2 3 = 4.7548875021… = 311616.307… / 65536
        assert_eq!(measure(&mut [1, 2, 3]).code, 311_616);
    }

    #[test]
    fn nothing() {
        let measure = measure(&mut []);
        assert_eq!((measure.samples, measure.zeros, measure.min, measure.max, measure.code), (0, 0, 0, 0, 0));
    }

    /// Value k = 0 to 7 occurs 2^(7-k) times, value 8 once: chances 1/2, 1/4, …, 1/256, 1/256. The entropy of the
    /// chances 2^-1, …, 2^-m, 2^-m is 2 - 2^(1-m) bits, so the 256 values take 256 (2 - 2^-7) = 510.
    #[test]
    fn geometric_histogram() {
        let mut values = [8; 256];
        let mut rest = &mut values[..];
        for k in 0..8 {
            let (run, next) = rest.split_at_mut(128 >> k);
            run.fill(k);
            rest = next;
        }
        assert_eq!(measure(&mut values).code_bits(), 510.0);
    }

    /// One deviant among 256: 8 + 255 log2(256 / 255) = 9.4398736… bits, a difference of numbers a hundred times as
    /// large, in which an approximate logarithm would lose it.
    #[test]
    fn nearly_constant() {
        let mut values = [0; 256];
        values[100] = -5;
        assert!((measure(&mut values).code_bits() - 9.439_874).abs() < 2e-5);
    }

    /// log2(2^64 - 1) = 64 - 2^-64 / ln 2, and log2 10 = 3.32192809488736234787…
    #[test]
    fn logarithms() {
        assert_eq!([log2(0), log2(1), log2(2), log2(1 << 63)], [0, 0, 1 << 56, 63 << 56]);
        assert!((64 << 56) - log2(u64::MAX) <= 3);
        let ten = (3 << 56) + 23_197_363_970_797_099;
        assert!(ten - log2(10) <= 3);
    }

    #[test]
    fn differences() {
        assert_eq!(max_error(&[1, i32::MIN], &[3, i32::MAX]), Ok(u32::MAX));
        assert_eq!(rms_error(&[0, 0], &[0, 0]), Ok(0.0));
        assert_eq!(rms_error(&[], &[]), Ok(0.0));
        assert!((rms_error(&[0, 0], &[3, -4]).unwrap() / 3.535_534 - 1.0).abs() < 1e-6);
        assert!((rms_error(&[i32::MIN; 3], &[i32::MAX; 3]).unwrap() / 4_294_967_295.0 - 1.0).abs() < 1e-6);
        let short = LengthError { slice: Slice::Samples, expected: 2, actual: 1 };
        assert_eq!(max_error(&[0, 0], &[0]), Err(short));
        assert_eq!(rms_error(&[0, 0], &[0]), Err(short));
    }

    #[test]
    fn roots() {
        for scale in [1.0, 2.0, 1e-3, 3e4, 5e8] {
            for root in [1.0, 1.1, 1.25, 1.5, 1.75, 1.99].map(|root| root * scale) {
                assert!((sqrt(root * root) / root - 1.0).abs() < 1e-6, "{root}");
            }
        }
    }
}
