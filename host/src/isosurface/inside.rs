//! Which nodes are inside, a bit each.

use rayon::prelude::*;

use crate::field::ScalarField;

/// Bits of nodes, in words of 64 along x; each row starts with a word, and its unused bits are zero.
#[derive(Debug)]
pub(super) struct Inside {
    words: Vec<u64>,
    per_row: usize,
}

impl Inside {
    /// Classifies all nodes.
    pub(super) fn new(field: &ScalarField, isovalue: f32) -> Self {
        let width = field.grid().extent[0];
        let per_row = width.div_ceil(64);
        let mut words = vec![0; field.values().len() / width * per_row];
        let rows = words.par_chunks_mut(per_row).zip(field.values().par_chunks(width));
        rows.with_min_len(64).for_each(|(words, values)| {
            for (word, values) in words.iter_mut().zip(values.chunks(64)) {
                *word = pack(values, isovalue);
            }
        });
        Self { words, per_row }
    }

    /// Words of a row, by its number.
    pub(super) fn row(&self, row: usize) -> &[u64] {
        &self.words[row * self.per_row..][..self.per_row]
    }
}

/// Comparisons of 64 values or less as bits.
fn pack(values: &[f32], isovalue: f32) -> u64 {
    let (eights, rest) = values.as_chunks::<8>();
    let mut word = 0;
    for (n, eight) in eights.iter().enumerate() {
        let bytes = eight.map(|value| u8::from(value > isovalue));
        // Brings the lowest bit of byte n to bit 56 + n.
        let bits = u64::from_le_bytes(bytes).wrapping_mul(0x0102_0408_1020_4080) >> 56;
        word |= bits << (8 * n);
    }
    let tail = rest.iter().enumerate().map(|(n, &value)| u64::from(value > isovalue) << n);
    tail.fold(word, |word, bit| word | bit << (values.len() - rest.len()))
}

/// Bit n + 1 at place n, for word `at` of a row.
pub(super) fn shifted(row: &[u64], at: usize) -> u64 {
    row[at] >> 1 | row.get(at + 1).map_or(0, |next| next << 63)
}

/// Places of the set bits, in ascending order.
pub(super) fn ones(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = word.trailing_zeros() as usize;
        word &= word.wrapping_sub(1);
        (place < 64).then_some(place)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_comparisons() {
        for length in 0..=64_usize {
            let values: Vec<f32> = (0..length).map(|n| (n * n % 7) as f32).collect();
            let word = pack(&values, 3.0);
            assert!((0..64).all(|n| (word >> n & 1 == 1) == values.get(n).is_some_and(|&value| value > 3.0)));
        }
    }

    #[test]
    fn ones_are_places() {
        assert!(ones(0).next().is_none());
        assert_eq!(ones(1 << 63 | 0b101).collect::<Vec<_>>(), [0, 2, 63]);
    }
}
