//! The integer transform of a whole volume at once, for study and for tests.
//!
//! Coefficients are a volume of `i32` of the same extent in Mallat order: along each axis the low half first, the
//! coarsest level in the corner of the first sample. Nothing is cut into bricks and nothing is coded.

use wavelift_kernel::{Extent, Plan, PlanError, Wavelet};

use crate::integers::{NotIntegers, sample_type, widen};
use crate::volume::{ElementType, FileFormat, Metadata, Volume};

/// Why a volume could not be transformed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TransformError {
    /// Floats, or integers of 64 bits.
    #[error(transparent)]
    NotIntegers(#[from] NotIntegers),
    /// Coefficients of another type than `i32`.
    #[error("coefficients are i32, but these samples are {element}: give what the forward transform made")]
    NotCoefficients {
        /// Type of the samples.
        element: ElementType,
    },
    /// The extent allows fewer levels.
    #[error("{levels} levels are too many: the extent allows at most {max}")]
    TooManyLevels {
        /// Levels asked for.
        levels: u8,
        /// The most levels of that extent.
        max: u8,
    },
    /// More samples than the kernel transforms at once.
    #[error("one transform takes fewer than 2^31 samples: cut the volume first")]
    TooLarge,
}

/// Transforms a volume of integers of up to 32 bits (`u32` as the same bits); 0 levels only convert to `i32`.
///
/// # Errors
///
/// [`TransformError`].
///
/// Cost: one pass per level and axis; samples and coefficients are in memory, the latter twice.
pub fn forward(volume: &Volume, wavelet: Wavelet, levels: u8) -> Result<Volume, TransformError> {
    sample_type(volume.element)?;
    transform(volume, wavelet, levels, Plan::forward)
}

/// Undoes [`forward`]; the samples stay `i32`, whatever they were before.
///
/// # Errors
///
/// [`TransformError`]; in particular for coefficients of another type than `i32`.
///
/// Cost: as [`forward`].
pub fn inverse(coefficients: &Volume, wavelet: Wavelet, levels: u8) -> Result<Volume, TransformError> {
    if coefficients.element != ElementType::I32 {
        return Err(TransformError::NotCoefficients { element: coefficients.element });
    }
    transform(coefficients, wavelet, levels, Plan::inverse)
}

/// [`Plan::forward`] or [`Plan::inverse`].
type Direction = fn(&Plan, &mut [i32], &mut [i32]) -> Result<(), wavelift_kernel::LengthError>;

fn transform(
    volume: &Volume,
    wavelet: Wavelet,
    levels: u8,
    direction: Direction,
) -> Result<Volume, TransformError> {
    let plan = plan(volume.extent, wavelet, levels)?;
    let mut values = Vec::new();
    widen(volume.element, &volume.samples, &mut values);
    direction(&plan, &mut values, &mut vec![0; plan.scratch_len()]).expect("the memory is that of the plan");
    Ok(Volume {
        extent: volume.extent,
        element: ElementType::I32,
        samples: values.into_iter().flat_map(i32::to_le_bytes).collect(),
        metadata: Metadata::plain(volume.metadata.rank() as u8, FileFormat::Raw),
    })
}

fn plan(extent: [u64; 3], wavelet: Wavelet, levels: u8) -> Result<Plan, TransformError> {
    let [x, y, z] = extent.map(|axis| u32::try_from(axis).unwrap_or(u32::MAX));
    let extent = Extent::new([x, y, z]).map_err(|_| TransformError::TooLarge)?;
    Plan::new(wavelet, extent, levels).map_err(|error| match error {
        PlanError::TooManyLevels { max } => TransformError::TooManyLevels { levels, max },
        _ => TransformError::TooLarge,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::synthetic::{Kind, generate};

    fn values(volume: &Volume) -> Vec<i32> {
        volume.samples.as_chunks().0.iter().map(|bytes| i32::from_le_bytes(*bytes)).collect()
    }

    #[test]
    fn a_line_by_hand_and_back() {
        let mut line = generate(Kind::Constant, [3, 1, 1], ElementType::U8, 0);
        line.samples = vec![1, 4, 7];
        // psi_1: d = 4 - floor((1 + 7) / 2) = 0; c_0 = 1 + 0, c_1 = 7 + 0
        let coefficients = forward(&line, Wavelet::Linear, 1).unwrap();
        assert_eq!(values(&coefficients), [1, 7, 0]);
        assert_eq!((coefficients.element, coefficients.rank()), (ElementType::I32, 1));
        assert_eq!(values(&inverse(&coefficients, Wavelet::Linear, 1).unwrap()), [1, 4, 7]);
        assert_eq!(values(&forward(&line, Wavelet::Linear, 0).unwrap()), [1, 4, 7]);
    }

    #[test]
    fn every_integer_type_comes_back_as_i32() {
        for element in [
            ElementType::U8,
            ElementType::I8,
            ElementType::U16,
            ElementType::I16,
            ElementType::U32,
            ElementType::I32,
        ] {
            let volume = generate(Kind::Noise, [9, 6, 5], element, 3);
            let widened = forward(&volume, Wavelet::Haar, 0).unwrap();
            for wavelet in Wavelet::ALL {
                let back = inverse(&forward(&volume, wavelet, 4).unwrap(), wavelet, 4).unwrap();
                assert_eq!(back, widened, "{element} {wavelet:?}");
            }
        }
    }

    #[test]
    fn what_cannot_be_transformed_is_refused() {
        let volume = |extent, element| generate(Kind::Constant, extent, element, 0);
        assert_eq!(
            forward(&volume([8, 3, 1], ElementType::U8), Wavelet::Haar, 4),
            Err(TransformError::TooManyLevels { levels: 4, max: 3 })
        );
        assert_eq!(
            forward(&volume([8, 1, 1], ElementType::F32), Wavelet::Haar, 1),
            Err(NotIntegers { element: ElementType::F32 }.into())
        );
        assert_eq!(
            inverse(&volume([8, 1, 1], ElementType::U8), Wavelet::Haar, 1),
            Err(TransformError::NotCoefficients { element: ElementType::U8 })
        );
        assert_eq!(plan([1 << 40, 1, 1], Wavelet::Haar, 0), Err(TransformError::TooLarge));
        assert_eq!(plan([1 << 16, 1 << 15, 1], Wavelet::Haar, 0), Err(TransformError::TooLarge));
    }
}
