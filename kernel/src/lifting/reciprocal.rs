//! Division by the constants of the lifting steps, rounded to nearest.

use core::num::Wrapping;

/// \[numerator / D\], the nearest integer with ties toward +inf, for every `i32` numerator and 0 < D < 2^16.
///
/// Two shifts where D is a power of two, else a multiplication of 32 by 32 bits: nothing that vectors lack.
#[inline(always)]
pub(super) fn nearest<const D: u32>(numerator: Wrapping<i32>) -> Wrapping<i32> {
    if D == 1 {
        numerator
    } else if D.is_power_of_two() {
        let doubled = numerator.0 >> D.trailing_zeros().wrapping_sub(1);
        Wrapping(doubled) - Wrapping(doubled >> 1)
    } else {
        const { Reciprocal::of(D) }.nearest(numerator)
    }
}

/// Gives \[r / D\] as floor((factor (r + 2^31) + addend) / 2^(32 + shift)) - offset.
#[derive(Clone, Copy)]
struct Reciprocal {
    factor: u64,
    addend: u64,
    shift: u32,
    offset: Wrapping<u32>,
}

impl Reciprocal {
    /// With 2^shift <= D < 2^(shift + 1), and offset D at least 2^31: \[r / D\] + offset = floor(x / D), where
    /// x = (r + 2^31) + (offset D - 2^31 + floor(D / 2)) is from 0 to 2^32 + 2 D.
    ///
    /// The factor is 2^(32 + shift) / D rounded either way, at a distance of error / D. Rounded up it is exact for
    /// error x < 2^(32 + shift); rounded down, and applied to x + 1, for error (x + 1) <= 2^(32 + shift).
    const fn of(d: u32) -> Self {
        let (d, shift) = (u64::from_le_bytes(widened(d)), d.ilog2());
        let power = 1_u64 << 32_u32.wrapping_add(shift);
        let (down, up) = (power / d, power.div_ceil(d));
        let offset = (1_u64 << 31).div_ceil(d);
        Self { factor: down, addend: up, shift, offset: Wrapping(0) }
    }
}
