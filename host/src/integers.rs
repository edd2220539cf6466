//! Samples as the kernel takes them without a detour: integers of up to 32 bits.

use wavelift_kernel::SampleType;

use crate::codec::planes;
use crate::volume::ElementType;

/// Samples that are no integers of up to 32 bits, where only those make sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the samples are {element}, but only integers of up to 32 bits have coefficients to look at: scale, round and \
     convert them first, as with NumPy's numpy.rint(a / step).astype('<i4')"
)]
pub struct NotIntegers {
    /// Type of the samples.
    pub element: ElementType,
}

/// The kernel's type of samples of `element`.
///
/// # Errors
///
/// [`NotIntegers`] for floats and for integers of 64 bits.
pub(crate) fn sample_type(element: ElementType) -> Result<SampleType, NotIntegers> {
    match planes::sample_types(element) {
        [sample_type] if !element.is_float() => Ok(*sample_type),
        _ => Err(NotIntegers { element }),
    }
}

/// Appends little-endian samples of such an `element`, each as an `i32`; `u32` as the same bits.
pub(crate) fn widen(element: ElementType, bytes: &[u8], samples: &mut Vec<i32>) {
    let start = samples.len();
    samples.resize(start + bytes.len() / element.bytes(), 0);
    planes::split(element, 0, bytes, &mut samples[start..]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_of_up_to_32_bits_are_widened() {
        let widened = |element, bytes: &[u8]| {
            let mut samples = vec![7];
            widen(element, bytes, &mut samples);
            samples
        };
        assert_eq!(widened(ElementType::I8, &[0xff, 1]), [7, -1, 1]);
        assert_eq!(widened(ElementType::U16, &[0xff, 0xff]), [7, 0xffff]);
        assert_eq!(widened(ElementType::U32, &[0xfe, 0xff, 0xff, 0xff]), [7, -2]);
        assert_eq!(sample_type(ElementType::U32), Ok(SampleType::U32));
    }

    #[test]
    fn other_types_are_refused() {
        for element in [ElementType::F32, ElementType::F64, ElementType::U64, ElementType::I64] {
            assert_eq!(sample_type(element), Err(NotIntegers { element }));
        }
    }
}
