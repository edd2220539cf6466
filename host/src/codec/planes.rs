//! Samples of any type as one or two planes of `i32`, which is what the kernel codes.
//!
//! Integers of up to 32 bits are one plane of their own type. Floating-point numbers are mapped to integers in the
//! same order, bit for bit and NaN included: the sign bit and the magnitude below it become two's complement.
//! Types of 64 bits are two planes, the high halves (signed, as they vary smoothly) and the low halves.

use wavelift_kernel::SampleType;

use crate::volume::ElementType;

/// The types of the planes of an element, high half first.
pub(crate) const fn sample_types(element: ElementType) -> &'static [SampleType] {
    match element {
        ElementType::U8 => &[SampleType::U8],
        ElementType::I8 => &[SampleType::I8],
        ElementType::U16 => &[SampleType::U16],
        ElementType::I16 => &[SampleType::I16],
        ElementType::U32 => &[SampleType::U32],
        ElementType::I32 | ElementType::F32 => &[SampleType::I32],
        ElementType::U64 | ElementType::I64 | ElementType::F64 => &[SampleType::I32, SampleType::U32],
    }
}

/// Converts little-endian samples to plane number `plane`, as many as `samples` has room for.
pub(crate) fn split(element: ElementType, plane: usize, bytes: &[u8], samples: &mut [i32]) {
    match element {
        ElementType::U8 => convert(bytes, samples, |[byte]| byte.into()),
        ElementType::I8 => convert(bytes, samples, |bytes| i8::from_le_bytes(bytes).into()),
        ElementType::U16 => convert(bytes, samples, |bytes| u16::from_le_bytes(bytes).into()),
        ElementType::I16 => convert(bytes, samples, |bytes| i16::from_le_bytes(bytes).into()),
        ElementType::U32 | ElementType::I32 => convert(bytes, samples, i32::from_le_bytes),
        ElementType::F32 => convert(bytes, samples, |bytes| ordered32(i32::from_le_bytes(bytes))),
        ElementType::U64 | ElementType::I64 => {
            convert(bytes, samples, |bytes| half(i64::from_le_bytes(bytes), plane));
        }
        ElementType::F64 => {
            convert(bytes, samples, |bytes| half(ordered64(i64::from_le_bytes(bytes)), plane))
        }
    }
}

/// Converts planes back to little-endian samples; the inverse of [`split`] over all planes.
pub(super) fn join(element: ElementType, planes: &[Vec<i32>], bytes: &mut Vec<u8>) {
    let [high, rest @ ..] = planes else { return };
    match (element, rest) {
        (ElementType::U8 | ElementType::I8, _) => bytes.extend(high.iter().map(|&sample| sample as u8)),
        (ElementType::U16 | ElementType::I16, _) => {
            bytes.extend(high.iter().flat_map(|&sample| (sample as u16).to_le_bytes()));
        }
        (ElementType::F32, _) => {
            bytes.extend(high.iter().flat_map(|&sample| ordered32(sample).to_le_bytes()))
        }
        (ElementType::U32 | ElementType::I32, _) => {
            bytes.extend(high.iter().flat_map(|sample| sample.to_le_bytes()));
        }
        (ElementType::F64, [low]) => {
            bytes.extend(halves(high, low).flat_map(|sample| ordered64(sample).to_le_bytes()));
        }
        (_, [low]) => bytes.extend(halves(high, low).flat_map(i64::to_le_bytes)),
        _ => {}
    }
}

fn convert<const N: usize>(bytes: &[u8], samples: &mut [i32], value: impl Fn([u8; N]) -> i32) {
    for (sample, &bytes) in samples.iter_mut().zip(bytes.as_chunks::<N>().0) {
        *sample = value(bytes);
    }
}

/// The high (0) or low (1) half of 64 bits.
const fn half(bits: i64, plane: usize) -> i32 {
    if plane == 0 { (bits >> 32) as i32 } else { bits as i32 }
}

fn halves(high: &[i32], low: &[i32]) -> impl Iterator<Item = i64> {
    high.iter().zip(low).map(|(&high, &low)| i64::from(high) << 32 | i64::from(low.cast_unsigned()))
}

/// The bits of a float as an integer in the same order, and back: flips all but the sign of negative ones.
pub(super) const fn ordered32(bits: i32) -> i32 {
    bits ^ ((bits >> 31).cast_unsigned() >> 1).cast_signed()
}

/// See [`ordered32`].
pub(super) const fn ordered64(bits: i64) -> i64 {
    bits ^ ((bits >> 63).cast_unsigned() >> 1).cast_signed()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_comes_back() {
        let bytes: Vec<u8> =
            (0..=255).cycle().step_by(7).take(240).chain([0xFF; 16]).chain([0x80; 8]).collect();
        for element in ElementType::ALL {
            let count = bytes.len() / element.bytes();
            let planes: Vec<Vec<i32>> = (0..sample_types(element).len())
                .map(|plane| {
                    let mut samples = vec![0; count];
                    split(element, plane, &bytes, &mut samples);
                    samples
                })
                .collect();
            let mut back = Vec::new();
            join(element, &planes, &mut back);
            assert_eq!(back, bytes, "{element}");
        }
    }

    #[test]
    fn floats_keep_their_order() {
        let values = [
            f32::NEG_INFINITY,
            -1.5,
            -1.0,
            -f32::MIN_POSITIVE,
            -0.0,
            0.0,
            1e-40,
            1.0,
            f32::INFINITY,
            f32::NAN,
        ];
        let mapped = values.map(|value| ordered32(value.to_bits().cast_signed()));
        assert!(mapped.is_sorted_by(|a, b| a < b));
        assert_eq!(mapped.map(ordered32), values.map(|value| value.to_bits().cast_signed()));
        assert!(
            [-1.0_f64, -0.0, 0.0, 2.0]
                .map(|v| ordered64(v.to_bits().cast_signed()))
                .is_sorted_by(|a, b| a < b)
        );
    }
}
