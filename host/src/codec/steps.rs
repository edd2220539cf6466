//! Integers within an error bound: in steps, or as they are, for a lattice.
//!
//! Steps are 2 E + 1 wide, and every integer within E of a multiple of that is written as it. Where a multiple lies
//! beyond the type, the end of the type does, and is nearer.

use crate::volume::ElementType;

/// The widest step: what it makes of any 64 bits fits into 64 bits.
pub(super) const WIDEST: u64 = i64::MAX.cast_unsigned();

/// The largest slack of a lattice.
pub(super) const MOST_SLACK: u32 = (1 << 30) - 1;

/// The slack of a lattice for a bound; `None` if it allows equal integers only.
pub(super) fn slack(error: f64) -> Option<u32> {
    let slack = (error as u32).min(MOST_SLACK);
    (slack > 0).then_some(slack)
}

/// The width of steps for a bound; `None` if it allows equal integers only.
pub(super) fn width(error: f64) -> Option<u64> {
    // Floats beyond 64 bits become the largest that there is.
    let error = (error as u64).min(WIDEST / 2);
    (error > 0).then_some(2 * error + 1)
}

/// Calls `of` with each sample, and puts what it returns, kept within the type, in its place.
macro_rules! each {
    ($bytes:expr, $wide:ty, $of:expr, $($element:pat => $type:ty),+) => {
        match $bytes {
            $(($element, bytes) => {
                for sample in bytes.as_chunks_mut().0 {
                    let made: $wide = $of(<$type>::from_le_bytes(*sample).into());
                    *sample = (made.clamp(<$type>::MIN.into(), <$type>::MAX.into()) as $type).to_le_bytes();
                }
            })+
            _ => {}
        }
    };
}

fn each_signed(element: ElementType, bytes: &mut [u8], of: impl Fn(i64) -> i64) {
    each!((element, bytes), i64, of,
        ElementType::U8 => u8, ElementType::I8 => i8, ElementType::U16 => u16, ElementType::I16 => i16,
        ElementType::U32 => u32, ElementType::I32 => i32, ElementType::I64 => i64);
}

fn each_unsigned(element: ElementType, bytes: &mut [u8], of: impl Fn(u64) -> u64) {
    each!((element, bytes), u64, of, ElementType::U64 => u64);
}

/// Replaces little-endian integers by the number of the step that they are nearest to.
pub(super) fn divide(element: ElementType, step: u64, bytes: &mut [u8]) {
    let signed = step.cast_signed();
    let half = signed / 2;
    each_signed(element, bytes, |x| x.div_euclid(signed) + i64::from(x.rem_euclid(signed) > half));
    each_unsigned(element, bytes, |x| x / step + u64::from(x % step > step / 2));
}

/// Undoes [`divide`], but for up to half a step.
pub(super) fn multiply(element: ElementType, step: u64, bytes: &mut [u8]) {
    let signed = step.cast_signed();
    each_signed(element, bytes, |number| number.saturating_mul(signed));
    each_unsigned(element, bytes, |number| number.saturating_mul(step));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_follow_the_bound() {
        for (error, expected) in [(0.999, None), (1.0, Some(3)), (2.7, Some(5)), (1e300, Some(WIDEST))] {
            assert_eq!(width(error), expected, "{error}");
        }
        for (error, expected) in [(0.999, None), (1.0, Some(1)), (2.7, Some(2)), (1e300, Some(MOST_SLACK))] {
            assert_eq!(slack(error), expected, "{error}");
        }
    }

    /// The samples of a type, as wide as can be.
    fn wide(element: ElementType, bytes: &[u8]) -> Vec<i128> {
        let value = |sample: &[u8]| {
            let mut wide =
                [if element.is_signed_integer() && sample.last() >= Some(&0x80) { 0xFF } else { 0 }; 16];
            wide[..sample.len()].copy_from_slice(sample);
            i128::from_le_bytes(wide)
        };
        bytes.chunks(element.bytes()).map(value).collect()
    }

    #[test]
    fn no_integer_moves_further_than_half_a_step() {
        let bytes: Vec<u8> = (0..=255)
            .chain((0..4096_u32).map(|i| ((i * i) >> 3) as u8))
            .chain([0xFF; 8])
            .chain([0; 8])
            .collect();
        for element in ElementType::ALL.into_iter().filter(|element| !element.is_float()) {
            for error in [1.0, 2.0, 100.0, 7e4, 1e9, 4e18, 1e30] {
                let step = width(error).unwrap();
                let mut moved = bytes.clone();
                divide(element, step, &mut moved);
                let numbers = wide(element, &moved);
                multiply(element, step, &mut moved);
                for ((a, b), number) in
                    wide(element, &bytes).into_iter().zip(wide(element, &moved)).zip(numbers)
                {
                    assert!((a - b).unsigned_abs() <= u128::from(step / 2), "{element} {error}: {a} {b}");
                    assert!(number.abs() <= a.abs());
                }
            }
        }
    }
}
