//! Division by the constants of the lifting steps, rounded to nearest.

use core::num::Wrapping;

/// \[numerator / D\], the nearest integer with ties toward +inf, for every `i32` numerator and D > 0.
///
/// Takes two shifts where D is a power of two, else one product of 32 by 32 bits, so that vectors can do it.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn nearest<const D: i32>(numerator: Wrapping<i32>) -> Wrapping<i32> {
    match const { Reciprocal::of(D) } {
        Some(reciprocal) => reciprocal.nearest(numerator),
        None if D == 1 => numerator,
        None => {
            let doubled = numerator.0 >> D.ilog2().wrapping_sub(1);
            Wrapping(doubled) - Wrapping(doubled >> 1)
        }
    }
}

/// \[r / D\] = floor((factor (r + 2^31) + addend) / 2^(32 + shift)) - offset for every `i32` r.
#[derive(Clone, Copy, Debug)]
struct Reciprocal {
    factor: u64,
    addend: u64,
    shift: u32,
    offset: i32,
}

impl Reciprocal {
    /// Where 2^shift < D < 2^(shift + 1).
    ///
    /// \[r / D\] + offset = floor(x / D) for x = r + floor(D / 2) + offset D. With the least offset that makes
    /// x >= 0 for all r, x = (r + 2^31) + bias for a small bias. Let the factor be (2^(32 + shift) + error) / D:
    /// then floor(x / D) = floor(factor x / 2^(32 + shift)) if 0 < error and error x < 2^(32 + shift). If instead
    /// error < 0, x + 1 takes the place of x, and |error| (x + 1) may be at most 2^(32 + shift).
    #[expect(clippy::as_conversions, reason = "no conversion loses anything; From is not const")]
    const fn of(d: i32) -> Option<Self> {
        assert!(d > 0, "a denominator is positive");
        if d.cast_unsigned().is_power_of_two() {
            return None;
        }
        const LEAST: u64 = 1 << 31;
        let (shift, d) = (d.ilog2(), d as u64);
        let power = 1_u64 << 32_u32.saturating_add(shift);
        let offset = LEAST.div_ceil(d);
        let bias = offset.saturating_mul(d).saturating_sub(LEAST).saturating_add(d.div_euclid(2));
        let (down, up) = (power.div_euclid(d), power.div_ceil(d));
        let (below, above) = (power.rem_euclid(d), d.saturating_sub(power.rem_euclid(d)));
        let (factor, bias, error) =
            if above <= below { (up, bias, above) } else { (down, bias.saturating_add(1), below) };
        let most = (u32::MAX as u64).saturating_add(bias);
        assert!(error.saturating_mul(most) < power, "exact for every numerator");
        assert!(factor.checked_mul(most).is_some(), "no product wraps");
        Some(Self { factor, addend: factor.saturating_mul(bias), shift, offset: offset as i32 })
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn nearest(self, numerator: Wrapping<i32>) -> Wrapping<i32> {
        let biased = u64::from(numerator.0.cast_unsigned() ^ (1 << 31));
        let product = biased.wrapping_mul(self.factor).wrapping_add(self.addend);
        let high = u32::try_from(product >> 32).unwrap_or(u32::MAX);
        Wrapping((high >> self.shift).cast_signed()) - Wrapping(self.offset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const D: i32>() {
        let spread = (0..20_000).map(|k: i32| k.wrapping_mul(0x1234_5677));
        let edges = [i32::MIN, 0, i32::MAX]
            .into_iter()
            .flat_map(|middle| (-200..=200).map(move |away: i32| middle.wrapping_add(away)));
        // The numerators around each of many ties and multiples.
        let middles = (0..20_000).flat_map(|k: i32| {
            let multiple = k.wrapping_mul(0x0765_4321) / D * D;
            (-2..=2).flat_map(move |away| [multiple.wrapping_add(away), multiple.wrapping_add(D / 2 + away)])
        });
        for numerator in edges.chain(spread).chain(middles) {
            let expected = (2 * i64::from(numerator) + i64::from(D)).div_euclid(2 * i64::from(D));
            assert_eq!(i64::from(nearest::<D>(Wrapping(numerator)).0), expected, "[{numerator} / {D}]");
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "many values through code without addresses")]
    fn exact_for_every_numerator() {
        check::<1>();
        check::<2>();
        check::<3>();
        check::<4>();
        check::<6>();
        check::<8>();
        check::<9>();
        check::<16>();
        check::<27>();
        check::<32>();
    }
}
