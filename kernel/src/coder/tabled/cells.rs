//! The cells of a slice, each of which has one of several sets of weights.

use core::ops::Range;

use super::bits::{BitReader, BitWriter};
use crate::coder::train::BLOCK;
use crate::extent::to_usize;

/// Sets of weights, at most.
pub(super) const SETS: usize = 8;

/// Cells of a slice, at most.
const CELLS: usize = 1 << 11;

/// Columns and rows of the smallest cells, as powers of two.
const SMALLEST: [u32; 2] = [5, 4];

const _: () = assert!((1_usize << SMALLEST[0]).is_multiple_of(BLOCK));

/// Bytes of the labels of all cells, and one for those that lie across two.
const LABELS_LEN: usize = CELLS * 3 / 8 + 1;

/// How a slice is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cells {
    /// Columns and rows of a cell, as powers of two.
    pub(super) bits: [u32; 2],
    /// Cells along each axis.
    pub(super) counts: [usize; 2],
    width: usize,
}

impl Cells {
    /// Into the smallest cells that are not too many; larger ones are so along both axes.
    pub(super) fn new([width, height]: [usize; 2]) -> Self {
        let mut bits = SMALLEST;
        loop {
            let [of_columns, of_rows] = bits;
            let count = |side: usize, bits: u32| (side.saturating_sub(1) >> bits).wrapping_add(1);
            let counts @ [columns, rows] = [count(width, of_columns), count(height, of_rows)];
            if columns.saturating_mul(rows) <= CELLS {
                return Self { bits, counts, width };
            }
            bits = [of_columns.wrapping_add(1), of_rows.wrapping_add(1)];
        }
    }

    /// All of them.
    pub(super) const fn len(&self) -> usize {
        let [columns, rows] = self.counts;
        columns.wrapping_mul(rows)
    }

    /// The cell of a column of row y.
    pub(super) const fn at(&self, y: usize, column: usize) -> usize {
        let ([of_columns, of_rows], [columns, _]) = (self.bits, self.counts);
        (y >> of_rows).wrapping_mul(columns).wrapping_add(column >> of_columns)
    }

    /// The columns of row y that have weights of one set, and its number, from the first.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn runs(&self, labels: Labels<'_>, y: usize) -> impl Iterator<Item = (Range<usize>, usize)> {
        let ([of_columns, _], [columns, _], width) = (self.bits, self.counts, self.width);
        let (first, is_one) = (self.at(y, 0), labels.bits == 0);
        let mut next = 0_usize;
        core::iter::from_fn(move || {
            let start = next;
            if start >= columns {
                return None;
            }
            let label = labels.get(first.wrapping_add(start));
            next = if is_one { columns } else { start.wrapping_add(1) };
            while next < columns && labels.get(first.wrapping_add(next)) == label {
                next = next.wrapping_add(1);
            }
            Some((start << of_columns..width.min(next << of_columns), label))
        })
    }
}

/// The numbers of the sets of all cells, as bits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Labels<'a> {
    bytes: &'a [u8],
    /// The first bit.
    first: usize,
    /// Bits of a label.
    bits: u32,
}

impl<'a> Labels<'a> {
    /// Of cells that all have the only set.
    pub(super) const NONE: Self = Self { bytes: &[], first: 0, bits: 0 };

    /// The number of the set of a cell.
    fn get(&self, cell: usize) -> usize {
        let (at, below) = self.place(cell);
        let pair = self.bytes.get(at..).unwrap_or(&[]);
        let [low, high] = [pair.first(), pair.get(1)].map(|byte| byte.copied().unwrap_or(0));
        usize::from(u16::from_le_bytes([low, high]) >> below) & !(usize::MAX << self.bits)
    }

    /// The byte where the label of a cell begins, and the bits below it there.
    fn place(&self, cell: usize) -> (usize, u32) {
        let bit = self.first.wrapping_add(cell.wrapping_mul(to_usize(self.bits)));
        (bit >> 3, u32::try_from(bit & 7).unwrap_or(0))
    }

    /// Writes the labels of so many cells.
    pub(super) fn write(&self, cells: usize, bits: &mut BitWriter<'_>) -> Option<()> {
        (0..cells).try_for_each(|cell| bits.put(u32::try_from(self.get(cell)).ok()?, self.bits))
    }

    /// Those of so many cells and sets that are next to be read; `None` if one is the number of no set.
    pub(super) fn read(cells: usize, sets: usize, bits: &mut BitReader<'a>) -> Option<Self> {
        let labels = Self { bytes: bits.bytes(), first: bits.position(), bits: label_bits(sets) };
        (0..cells).all(|_| to_usize(bits.take(labels.bits)) < sets).then_some(labels)
    }
}

/// Labels that an encoder sets.
#[derive(Debug)]
pub(super) struct OwnLabels {
    bytes: [u8; LABELS_LEN],
    bits: u32,
}

impl OwnLabels {
    pub(super) const NEW: Self = Self { bytes: [0; LABELS_LEN], bits: 0 };

    /// Gives all cells the first of so many sets.
    pub(super) fn clear(&mut self, sets: usize) {
        *self = Self { bits: label_bits(sets), ..Self::NEW };
    }

    pub(super) const fn labels(&self) -> Labels<'_> {
        Labels { bytes: &self.bytes, first: 0, bits: self.bits }
    }

    /// The number of the set of a cell.
    pub(super) fn get(&self, cell: usize) -> usize {
        self.labels().get(cell)
    }

    pub(super) fn set(&mut self, cell: usize, label: usize) {
        let (at, below) = self.labels().place(cell);
        let Some(pair) = self.bytes.get_mut(at..).and_then(|rest| rest.first_chunk_mut()) else { return };
        let others = u16::from_le_bytes(*pair) & !(!(u16::MAX << self.bits) << below);
        *pair = (others | u16::try_from(label).unwrap_or(0) << below).to_le_bytes();
    }
}

/// Bits of the labels of so many sets.
fn label_bits(sets: usize) -> u32 {
    sets.next_power_of_two().trailing_zeros()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_are_divided() {
        let cells = |width, height| {
            let Cells { bits, counts, .. } = Cells::new([width, height]);
            (bits, counts)
        };
        assert_eq!(cells(1, 1), ([5, 4], [1, 1]));
        assert_eq!(cells(512, 512), ([5, 4], [16, 32]));
        assert_eq!(cells(1024, 1024), ([5, 4], [32, 64]));
        assert_eq!(cells(1025, 1024), ([6, 5], [17, 32]));
        let ([of_columns, of_rows], [columns, rows]) = cells(1 << 31, 1);
        assert_eq!((of_columns, of_rows, columns, rows), (20, 19, 1 << 11, 1));
    }

    #[test]
    fn labels_come_back() {
        for sets in [2, 3, 4, 8] {
            let mut own = OwnLabels::NEW;
            own.clear(sets);
            (0..CELLS).for_each(|cell| own.set(cell, cell * 5 % sets));
            (0..CELLS).rev().for_each(|cell| own.set(cell, cell * 7 % sets));
            let mut out = [0; LABELS_LEN + 1];
            let mut bits = BitWriter::new(&mut out);
            bits.put(5, 3).unwrap();
            own.labels().write(CELLS, &mut bits).unwrap();
            bits.finish().unwrap();
            let mut bits = BitReader::new(&out);
            bits.take(3);
            let labels = Labels::read(CELLS, sets, &mut bits).unwrap();
            assert!((0..CELLS).all(|cell| labels.get(cell) == cell * 7 % sets));
            assert_eq!(bits.finish(), Some((3 + CELLS * to_usize(label_bits(sets))).div_ceil(8)));
        }
    }

    #[test]
    fn numbers_of_no_set_are_refused() {
        assert!(Labels::read(2, 3, &mut BitReader::new(&[0b0110])).is_some());
        assert!(Labels::read(2, 3, &mut BitReader::new(&[0b1110])).is_none());
    }

    #[test]
    fn runs_of_a_row() {
        let cells = Cells::new([100, 20]);
        let mut own = OwnLabels::NEW;
        own.clear(2);
        [0, 1, 6].into_iter().for_each(|cell| own.set(cell, 1));
        let runs = |y| {
            let mut runs = cells.runs(own.labels(), y);
            [(); 3].map(|()| runs.next())
        };
        assert_eq!(runs(15), [Some((0..64, 1)), Some((64..100, 0)), None]);
        assert_eq!(runs(16), [Some((0..64, 0)), Some((64..96, 1)), Some((96..100, 0))]);
        assert_eq!(cells.runs(Labels::NONE, 16).next(), Some((0..100, 0)));
    }
}
