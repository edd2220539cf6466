//! The class of a coefficient: how large it is expected to be, from the magnitudes around it.

use crate::extent::to_usize;

/// Classes: 0 to 3 for weighted sums 0 to 3, then two an octave.
pub(super) const CLASSES: usize = 32;

/// Contexts of a sign: three signs of neighbours, each negative, zero or positive.
pub(super) const SIGN_CONTEXTS: usize = 27;

/// Values are remembered up to this magnitude: sums stay small, and larger ones are of the last class anyway.
const LARGEST: i32 = 1 << 16;

/// Weight of a sibling's magnitude in a hint.
const SIBLING: i32 = 3;

/// Weight of the parent's magnitude in a hint.
const PARENT: i32 = 2;

/// `value` as it is remembered.
#[inline(always)]
pub(super) fn remembered(value: i32) -> i32 {
    value.clamp(LARGEST.wrapping_neg(), LARGEST)
}

/// What a sibling of that value adds to the weighted sum.
#[inline(always)]
pub(super) fn sibling_hint(value: i32) -> i32 {
    remembered(value).wrapping_abs().wrapping_mul(SIBLING)
}

/// What a parent of that value adds to the weighted sum.
#[inline(always)]
pub(super) fn parent_hint(value: i32) -> i32 {
    remembered(value).wrapping_abs().wrapping_mul(PARENT)
}

/// Remembered values around a coefficient of a subband; zero beyond its borders.
///
/// Up is the plane before. East and south of the current place only that plane is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    pub(super) west: i32,
    pub(super) north: i32,
    pub(super) up: i32,
    pub(super) north_west: i32,
    pub(super) north_east: i32,
    pub(super) up_east: i32,
    pub(super) up_south: i32,
    pub(super) west_west: i32,
    pub(super) north_north: i32,
}

/// What the probabilities of a value depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Context {
    /// How large it is expected to be, below [`CLASSES`].
    pub(super) class: usize,
    /// Signs of its neighbours, below [`SIGN_CONTEXTS`].
    pub(super) signs: usize,
}

impl Around {
    /// The context: the class of 4 (W + N + U) + 2 (NW + NE + UE + US) + WW + NN + hint, of magnitudes, and the
    /// signs of W, N and U.
    #[inline(always)]
    pub(super) fn context(&self, hint: i32) -> Context {
        let near = sum_of([self.west, self.north, self.up]);
        let next = sum_of([self.north_west, self.north_east, self.up_east, self.up_south]);
        let far = sum_of([self.west_west, self.north_north]);
        let sum = sum_of([near.wrapping_mul(4), next.wrapping_mul(2), far, hint]);
        let signs =
            [self.west, self.north, self.up].map(|value| value.signum().wrapping_add(1).cast_unsigned());
        let signs = signs.into_iter().fold(0_u32, |signs, sign| signs.wrapping_mul(3).wrapping_add(sign));
        Context { class: class_of(sum.cast_unsigned()), signs: to_usize(signs) }
    }
}

/// The sum of the magnitudes.
#[inline(always)]
fn sum_of<const N: usize>(values: [i32; N]) -> i32 {
    values.into_iter().fold(0, |sum: i32, value| sum.wrapping_add(value.wrapping_abs()))
}

#[inline(always)]
fn class_of(sum: u32) -> usize {
    if sum < 4 {
        return to_usize(sum);
    }
    let octave = sum.ilog2();
    let upper_half = (sum >> octave.wrapping_sub(1)) & 1;
    to_usize(octave.wrapping_mul(2).wrapping_add(upper_half)).min(CLASSES - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_classes_an_octave() {
        let classes = [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 15, 16].map(class_of);
        assert_eq!(classes, [0, 1, 2, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8]);
        assert_eq!(class_of(u32::MAX), CLASSES - 1);
    }

    #[test]
    fn the_cap_changes_no_class() {
        assert_eq!(class_of(LARGEST.cast_unsigned()), CLASSES - 1);
        let most = i64::from(LARGEST) * i64::from(3 * 4 + 4 * 2 + 2 + 6 * SIBLING + PARENT);
        assert!(most <= i64::from(i32::MAX));
    }
}
