//! Some of many places, all over them.

use crate::extent::to_usize;

/// The golden section of 2^32.
const GOLDEN: u32 = 0x9E37_79B9;

/// All places below `count`, each once, in such an order that however few are taken, they lie all over.
///
/// They keep time with nothing: equal steps would meet the same few rows of every plane where a step is about as long as
/// a plane is high.
pub(super) fn scattered(count: usize) -> impl Iterator<Item = usize> {
    let cycle = count.checked_next_power_of_two().unwrap_or(0);
    // An odd stride visits each place of the cycle once.
    let bits = cycle.checked_ilog2().unwrap_or(0);
    let stride = to_usize(GOLDEN.checked_shr(u32::BITS.saturating_sub(bits)).unwrap_or(0)) | 1;
    let places = (0..cycle).map(move |number| number.wrapping_mul(stride) & cycle.wrapping_sub(1));
    places.filter(move |&place| place < count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_comes_once() {
        for count in [0, 1, 2, 3, 7, 8, 9, 100, 257] {
            let mut seen = [false; 257];
            for place in scattered(count) {
                assert!(!core::mem::replace(&mut seen[place], true), "{place} of {count} again");
            }
            assert_eq!(seen.iter().filter(|&&seen| seen).count(), count);
        }
    }

    #[test]
    fn a_few_lie_all_over() {
        for count in [64, 100, 4096] {
            let mut sixths = [0; 6];
            scattered(count).take(24).for_each(|place| sixths[place * 6 / count] += 1);
            assert!(sixths.iter().all(|few| (2..=6).contains(few)), "{count}: {sixths:?}");
        }
    }
}
