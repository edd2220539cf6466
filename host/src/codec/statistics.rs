//! What the samples of a brick are like.

use serde::{Deserialize, Serialize};

use super::planes;
use crate::bound::{Real, samples_of};
use crate::volume::ElementType;

/// The finite samples of a brick, as they are decoded: the smallest, the largest, and the mean.
///
/// The two ends are exact, the mean is the nearest of 65,536 places from one to the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Statistics {
    /// The smallest as an integer: the value, or, of a float, its bits in the order of the numbers.
    min: i64,
    /// How much larger the largest is, as such an integer.
    width: u64,
    /// The place of the mean between them.
    #[serde(with = "postcard::fixint::le")]
    mean: u16,
}

/// The number of the last place of a mean.
const LAST_PLACE: f64 = 65535.0;

/// The smallest, the largest, and the sum of the samples of little-endian bytes, as the integers that they are; the sum of
/// 2^28 of them fits its type.
macro_rules! of_integers {
    ($element:expr, $bytes:expr, $($variant:ident => $type:ty: $sum:ty),+) => {
        match $element {
            $(ElementType::$variant => {
                let samples = $bytes.as_chunks().0.iter().map(|&sample| <$type>::from_le_bytes(sample));
                let ends = samples.clone().fold((<$type>::MAX, <$type>::MIN), |(min, max), sample| {
                    (sample.min(min), sample.max(max))
                });
                let sum: $sum = samples.map(<$sum>::from).sum();
                (ends.0 as i128, ends.1 as i128, sum as i128)
            })+
            _ => (0, 0, 0),
        }
    };
}

impl Statistics {
    /// Those of little-endian samples. `None` if none is finite.
    pub fn of(element: ElementType, bytes: &[u8]) -> Option<Self> {
        match element {
            _ if bytes.len() < element.bytes() => None,
            ElementType::F32 => Self::of_reals::<f32>(element, bytes),
            ElementType::F64 => Self::of_reals::<f64>(element, bytes),
            _ => Some(Self::of_integers(element, bytes)),
        }
    }

    fn of_integers(element: ElementType, bytes: &[u8]) -> Self {
        let (min, max, sum): (i128, i128, i128) = of_integers!(element, bytes,
            U8 => u8: i64, I8 => i8: i64, U16 => u16: i64, I16 => i16: i64, U32 => u32: i64, I32 => i32: i64,
            U64 => u64: i128, I64 => i64: i128);
        let (count, width) = ((bytes.len() / element.bytes()) as i128, max - min);
        // At most 2^28 samples of 64 bits, times 2^17.
        let place =
            (2 * LAST_PLACE as i128 * (sum - min * count) + width * count) / (2 * (width * count).max(1));
        Self { min: min as i64, width: width as u64, mean: place as u16 }
    }

    fn of_reals<R: Real>(element: ElementType, bytes: &[u8]) -> Option<Self> {
        let finite = || samples_of::<R>(bytes).map(Real::to_f64).filter(|sample| sample.is_finite());
        let ends = finite().fold(None, |ends, sample| {
            let (min, max): (f64, f64) = ends.unwrap_or((sample, sample));
            Some((if sample < min { sample } else { min }, if sample > max { sample } else { max }))
        });
        // Both zeros are one end: 0.
        let (min, max) = ends.map(|(min, max)| (min + 0.0, max + 0.0))?;
        let count = finite().count() as f64;
        // In halves, and in parts where the sum is too large, so that nothing overflows.
        let sum: f64 = finite().sum();
        let mean = if sum.is_finite() { sum / count } else { finite().map(|sample| sample / count).sum() };
        let place = (mean / 2.0 - min / 2.0) / (max / 2.0 - min / 2.0) * LAST_PLACE;
        let [low, high] = [min, max].map(|end| order_of(element, end));
        Some(Self { min: low, width: high.wrapping_sub(low).cast_unsigned(), mean: place.round() as u16 })
    }

    /// The smallest sample; an integer of 64 bits that double precision does not hold is rounded down.
    pub fn min(&self, element: ElementType) -> f64 {
        match integer_of(element, self.min) {
            Some(integer) if (integer as f64) as i128 > integer => (integer as f64).next_down(),
            Some(integer) => integer as f64,
            None => real_of(element, self.min),
        }
    }

    /// The largest sample; an integer of 64 bits that double precision does not hold is rounded up.
    pub fn max(&self, element: ElementType) -> f64 {
        let max = self.min.wrapping_add_unsigned(self.width);
        match integer_of(element, max) {
            Some(integer) if ((integer as f64) as i128) < integer => (integer as f64).next_up(),
            Some(integer) => integer as f64,
            None => real_of(element, max),
        }
    }

    /// The mean of the samples, but for one part in 131,070 of the distance between the other two.
    pub fn mean(&self, element: ElementType) -> f64 {
        let place = f64::from(self.mean) / LAST_PLACE;
        self.min(element) * (1.0 - place) + self.max(element) * place
    }
}

/// The integer that stands for a float among all floats of its type, in their order.
fn order_of(element: ElementType, value: f64) -> i64 {
    match element {
        ElementType::F32 => planes::ordered32((value as f32).to_bits().cast_signed()).into(),
        _ => planes::ordered64(value.to_bits().cast_signed()),
    }
}

/// The inverse of [`order_of`].
fn real_of(element: ElementType, order: i64) -> f64 {
    match element {
        ElementType::F32 => f32::from_bits(planes::ordered32(order as i32).cast_unsigned()).into(),
        _ => f64::from_bits(planes::ordered64(order).cast_unsigned()),
    }
}

/// The integer of that type that these bits are; `None` for floats.
fn integer_of(element: ElementType, bits: i64) -> Option<i128> {
    match element {
        ElementType::F32 | ElementType::F64 => None,
        ElementType::U64 => Some(bits.cast_unsigned().into()),
        _ => Some(bits.into()),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ends(element: ElementType, bytes: &[u8]) -> Option<[f64; 3]> {
        let found = Statistics::of(element, bytes)?;
        let stored = postcard::to_allocvec(&found).unwrap();
        assert_eq!(postcard::from_bytes(&stored), Ok(found));
        Some([found.min(element), found.mean(element), found.max(element)])
    }

    #[test]
    fn integers_of_every_width() {
        let bytes = [1, 0, 0, 0, 0, 0, 0, 0x80, 3, 0, 0, 0, 0, 0, 0, 0x80];
        let [min, mean, max] = ends(ElementType::U8, &bytes[..8]).unwrap();
        assert!((min, max) == (0.0, 128.0) && (mean - 129.0 / 8.0).abs() <= 128.0 / 131_000.0);
        let [min, mean, max] = ends(ElementType::I8, &bytes[6..8]).unwrap();
        assert!((min, max) == (-128.0, 0.0) && (mean + 64.0).abs() <= 128.0 / 131_000.0);
        let [min, mean, max] = ends(ElementType::U64, &bytes).unwrap();
        assert!(min <= 2_f64.powi(63) && max >= 2_f64.powi(63) + 3.0 && mean >= min && mean <= max);
        let [min, _, max] = ends(ElementType::I64, &bytes).unwrap();
        assert!(min == -2_f64.powi(63) && max > -2_f64.powi(63));
    }

    #[test]
    fn what_is_not_finite_does_not_count() {
        let bytes: Vec<u8> =
            [f32::NAN, -0.0, f32::INFINITY, 4.0, 2.0, f32::NEG_INFINITY].map(f32::to_le_bytes).concat();
        let [min, mean, max] = ends(ElementType::F32, &bytes).unwrap();
        assert_eq!((min.to_bits(), max), (0, 4.0));
        assert!((mean - 2.0).abs() <= 4.0 / 131_070.0);
        assert_eq!(ends(ElementType::F32, &f32::NAN.to_le_bytes()), None);
        assert_eq!(ends(ElementType::U16, &[]), None);
        let widest: Vec<u8> = [f64::MAX, f64::MIN, f64::MAX].map(f64::to_le_bytes).concat();
        let [min, mean, max] = ends(ElementType::F64, &widest).unwrap();
        assert_eq!((min, max), (f64::MIN, f64::MAX));
        assert!((mean / f64::MAX - 1.0 / 3.0).abs() < 1e-4);
    }

    proptest! {
        #[test]
        fn means_are_near(samples in prop::collection::vec(-1e3_f64..1e3, 1..300)) {
            let bytes: Vec<u8> = samples.iter().flat_map(|sample| sample.to_le_bytes()).collect();
            let [min, mean, max] = ends(ElementType::F64, &bytes).unwrap();
            prop_assert!(samples.iter().all(|&sample| (min..=max).contains(&sample)));
            let exact = samples.iter().sum::<f64>() / samples.len() as f64;
            prop_assert!((mean - exact).abs() <= (max - min) / 131_000.0);
        }
    }
}
