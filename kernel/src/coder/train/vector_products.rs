//! In place of `products` where there are vectors: the sums of eight rows at once, each in an element of its own.

use core::array;

use wide::bytemuck::cast;
use wide::{i16x16, i32x8, u32x8};

use super::{LANES, ROWS};

/// Elements of a row that are multiplied and added up at once.
const PAIRS: usize = LANES / 2;

/// Rows that a vector holds a pair of each of.
const AT_ONCE: usize = 8;

/// The rows that others are multiplied with: of each eight the first pairs, then the second ones, and so on.
pub(super) struct Columns([[u32x8; PAIRS]; ROWS.div_ceil(AT_ONCE)]);

impl Columns {
    #[inline(always)]
    #[expect(clippy::large_stack_frames, reason = "on computers, which alone have vectors, that is little")]
    pub(super) fn new(rows: &[[i16; LANES]]) -> Self {
        let mut rows = rows.chunks(AT_ONCE);
        Self(array::from_fn(|_| rows.next().map_or([u32x8::ZERO; _], pairs)))
    }

    /// Adds the sums of products of a row with the first of these to as many `sums`.
    #[inline(never)]
    pub(super) fn add_products(&self, row: &[i16; LANES], sums: &mut [i64]) {
        for (sums, columns) in sums.chunks_mut(AT_ONCE).zip(&self.0) {
            let products = row.as_chunks().0.iter().zip(columns).map(|(&[a, b], columns)| {
                let pair = i16x16::new([a, b, a, b, a, b, a, b, a, b, a, b, a, b, a, b]);
                cast::<_, i16x16>(*columns).dot(pair)
            });
            let products = products.fold(i32x8::ZERO, |sum, products| sum + products).to_array();
            let add = |(sum, product): (&mut i64, i32)| *sum = sum.wrapping_add(product.into());
            // The same, but of a length that is known all are added at once.
            match sums.first_chunk_mut::<AT_ONCE>() {
                Some(sums) => sums.iter_mut().zip(products).for_each(add),
                None => sums.iter_mut().zip(products).for_each(add),
            }
        }
    }
}

/// The pairs of up to eight rows: the first of each, then the second, and so on.
#[inline(always)]
fn pairs(rows: &[[i16; LANES]]) -> [u32x8; PAIRS] {
    let mut columns = [u32x8::ZERO; PAIRS];
    for (part, columns) in columns.as_chunks_mut::<AT_ONCE>().0.iter_mut().enumerate() {
        let of_row = |row: &[i16; LANES]| row.as_chunks::<PAIRS>().0.get(part).map(|part| cast(*part));
        *columns =
            u32x8::transpose(array::from_fn(|row| rows.get(row).and_then(of_row).unwrap_or(u32x8::ZERO)));
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    extern crate std;

    #[test]
    fn products_are_those_of_each() {
        let mut seed = 7_u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            crate::coder::low_half((seed >> 18).cast_signed()) - (1 << 13)
        };
        let rows: std::vec::Vec<_> = (0..ROWS).map(|_| array::from_fn(|_| random())).collect();
        let columns = Columns::new(&rows);
        for count in 1..=rows.len() {
            let mut sums = [5_i64; ROWS + 1];
            columns.add_products(&rows[count - 1], &mut sums[..count]);
            let expected = |number: usize| {
                let products = |a: &[i16; LANES], b: &[i16; LANES]| -> i64 {
                    a.iter().zip(b).map(|(&a, &b)| i64::from(a) * i64::from(b)).sum()
                };
                5 + if number < count { products(&rows[count - 1], &rows[number]) } else { 0 }
            };
            assert_eq!(sums, core::array::from_fn(expected), "{count}");
        }
    }
}
