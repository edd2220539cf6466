//! How far two volumes are apart.

use super::real::is_within;
use super::{FiniteRange, Real, samples_of};
use crate::volume::ElementType;

/// What a comparison of samples found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// The largest |a - b|, rounded to double precision; infinite where one that is not finite has changed.
    pub largest: f64,
    /// The first sample that is further off than allowed.
    pub beyond: Option<usize>,
}

impl Deviation {
    /// Compares little-endian samples of `element`, as many as both have, with each other: |a - b| <= `error` in exact
    /// arithmetic. Samples of equal bits are never apart, NaNs and infinities included.
    pub fn of(element: ElementType, a: &[u8], b: &[u8], error: f64) -> Self {
        match element {
            ElementType::F32 => Self::of_reals::<f32>(a, b, error),
            ElementType::F64 => Self::of_reals::<f64>(a, b, error),
            _ => Self::of_integers(element, a, b, error),
        }
    }

    fn of_reals<R: Real>(a: &[u8], b: &[u8], error: f64) -> Self {
        let mut deviation = Self::default();
        let pairs = samples_of::<R>(a).zip(samples_of::<R>(b)).enumerate();
        for (position, (a, b)) in pairs.filter(|(_, (a, b))| a.bits() != b.bits()) {
            let (a, b) = (a.to_f64(), b.to_f64());
            let is_finite = a.is_finite() && b.is_finite();
            let distance = if is_finite { (a - b).abs() } else { f64::INFINITY };
            deviation.add(position, distance, is_within(a, b, error));
        }
        deviation
    }

    fn of_integers(element: ElementType, a: &[u8], b: &[u8], error: f64) -> Self {
        let mut deviation = Self::default();
        let (size, is_signed) = (element.bytes(), element.is_signed_integer());
        let pairs = a.chunks_exact(size).zip(b.chunks_exact(size)).enumerate();
        for (position, (a, b)) in pairs.filter(|(_, (a, b))| a != b) {
            let distance = integer(a, is_signed).abs_diff(integer(b, is_signed));
            deviation.add(position, distance as f64, distance <= error as u128);
        }
        deviation
    }

    fn add(&mut self, position: usize, distance: f64, is_within: bool) {
        self.largest = self.largest.max(distance);
        if !is_within && self.beyond.is_none() {
            self.beyond = Some(position);
        }
    }
}

/// The range of the finite values among little-endian samples of `element`. Of integers, its width is exact but for one
/// rounding, and its place is not told: it begins at 0.
pub fn range(element: ElementType, bytes: &[u8]) -> FiniteRange {
    match element {
        ElementType::F32 => FiniteRange::of(samples_of::<f32>(bytes)),
        ElementType::F64 => FiniteRange::of(samples_of::<f64>(bytes)),
        _ => {
            let is_signed = element.is_signed_integer();
            let samples = || bytes.chunks_exact(element.bytes()).map(|sample| integer(sample, is_signed));
            let width = samples().max().unwrap_or(0) - samples().min().unwrap_or(0);
            FiniteRange { min: 0.0, max: width as f64 }
        }
    }
}

/// The value of a little-endian integer of up to 8 bytes.
fn integer(bytes: &[u8], is_signed: bool) -> i128 {
    let is_negative = is_signed && bytes.last() >= Some(&0x80);
    let mut wide = [if is_negative { 0xFF } else { 0 }; 16];
    wide[..bytes.len()].copy_from_slice(bytes);
    i128::from_le_bytes(wide)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes<const N: usize, const B: usize>(samples: [[u8; B]; N]) -> Vec<u8> {
        samples.concat()
    }

    #[test]
    fn integers_are_compared_as_such() {
        let a = bytes([i64::MIN, i64::MAX, -1].map(i64::to_le_bytes));
        let b = bytes([i64::MIN, i64::MAX - 7, 1].map(i64::to_le_bytes));
        let deviation = Deviation::of(ElementType::I64, &a, &b, 6.9);
        assert_eq!(deviation, Deviation { largest: 7.0, beyond: Some(1) });
        assert_eq!(Deviation::of(ElementType::I64, &a, &b, 7.0).beyond, None);
        assert_eq!(Deviation::of(ElementType::U64, &a, &b, 7.0).beyond, Some(2));
        assert_eq!(range(ElementType::I64, &a), FiniteRange { min: 0.0, max: u64::MAX as f64 });
        assert_eq!(range(ElementType::I8, &[0x80, 0x7F]), FiniteRange { min: 0.0, max: 255.0 });
    }

    #[test]
    fn floats_are_compared_exactly() {
        let a = bytes([f32::NAN, 1.0, f32::INFINITY].map(f32::to_le_bytes));
        assert_eq!(Deviation::of(ElementType::F32, &a, &a, 0.0), Deviation::default());
        let b = bytes([f32::NAN, 1.5, f32::MAX].map(f32::to_le_bytes));
        let deviation = Deviation::of(ElementType::F32, &a, &b, 0.5);
        assert_eq!(deviation, Deviation { largest: f64::INFINITY, beyond: Some(2) });
        assert_eq!(Deviation::of(ElementType::F32, &a, &b, 0.49).beyond, Some(1));
        assert_eq!(range(ElementType::F32, &b), FiniteRange { min: 1.5, max: f32::MAX.into() });
    }
}
