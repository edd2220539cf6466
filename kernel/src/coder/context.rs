//! The class of a coefficient: how large it is expected to be, from the magnitudes around it.

use crate::extent::to_usize;

/// Classes: 0 to 3 for weighted sums 0 to 3, then two an octave.
pub(super) const CLASSES: usize = 32;

/// Magnitudes are remembered up to this: sums stay small, and larger ones are of the last class anyway.
const LARGEST: u32 = 1 << 16;

/// Weight of a sibling's magnitude in a hint.
const SIBLING: u32 = 3;

/// Weight of the parent's magnitude in a hint.
const PARENT: u32 = 2;

/// The magnitude of `value` as it is remembered.
#[inline(always)]
pub(super) fn remembered(value: i32) -> u32 {
    value.unsigned_abs().min(LARGEST)
}

/// What siblings and a parent add to the weighted sum.
#[inline(always)]
pub(super) fn sibling_hint(value: i32) -> u32 {
    remembered(value).wrapping_mul(SIBLING)
}

/// See [`sibling_hint`].
#[inline(always)]
pub(super) fn parent_hint(value: i32) -> u32 {
    remembered(value).wrapping_mul(PARENT)
}

/// Remembered magnitudes around a coefficient of a subband; zero beyond its borders.
///
/// Up is the plane before. East and south of the current place only that plane is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    pub(super) west: u32,
    pub(super) north: u32,
    pub(super) up: u32,
    pub(super) north_west: u32,
    pub(super) north_east: u32,
    pub(super) up_east: u32,
    pub(super) up_south: u32,
    pub(super) west_west: u32,
    pub(super) north_north: u32,
}

impl Around {
    /// The class: of 4 (W + N + U) + 2 (NW + NE + UE + US) + WW + NN + hint.
    #[inline(always)]
    pub(super) fn class(&self, hint: u32) -> usize {
        let near = self.west.wrapping_add(self.north).wrapping_add(self.up);
        let next = self
            .north_west
            .wrapping_add(self.north_east)
            .wrapping_add(self.up_east)
            .wrapping_add(self.up_south);
        let far = self.west_west.wrapping_add(self.north_north);
        let sum =
            near.wrapping_mul(4).wrapping_add(next.wrapping_mul(2)).wrapping_add(far).wrapping_add(hint);
        class_of(sum)
    }
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
        assert_eq!(class_of(LARGEST), CLASSES - 1);
        let most = u64::from(LARGEST) * (3 * 4 + 4 * 2 + 2 + 6 * u64::from(SIBLING) + u64::from(PARENT));
        assert!(most <= u64::from(u32::MAX));
    }
}
