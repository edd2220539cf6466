//! Several sets of weights for the cells of a slice: each is trained on the cells that it suits best, and these are found
//! again, in turn.

use core::ops::Range;

use super::cells::{Cells, OwnLabels, SETS};
use super::wide::{CODED_BITS, usable};
use crate::coder::Training;
use crate::coder::forecast::Weights;
use crate::coder::taps::Taps;
use crate::coder::train::{BLOCK, SIZE_BITS, Subject};
use crate::memory::copy;

/// Samples that weights for all cells are trained on, at first and in the end.
const LESSONS: [usize; 2] = [1 << 10, 1 << 11];

/// Samples that each set is trained on, about.
const LESSONS_OF_SET: usize = 1 << 10;

/// Sets that are tried, of small slices and of large ones: powers of two.
const TRIED: [usize; 2] = [4, 8];

/// Samples of a large slice, at least.
const LARGE: usize = 3 << 16;

/// Times that sets are trained, and cells find theirs.
const ROUNDS: usize = 3;

/// Rows of a cell that are looked at.
const LOOKS: usize = 2;

/// Blocks of a row that are looked at together.
const BLOCKS: usize = 16;

/// Fraction bits of estimates of bits.
const BIT_FRACTION: u32 = 8;

/// The sizes of residuals under the weights for all cells, and under each set.
type Sizes = [u32; 1 + SETS];

/// The cells of a slice, and what is learnt from.
struct Pupils<'a> {
    subject: Subject<'a>,
    cells: &'a Cells,
    sides: [usize; 2],
}

/// Learns sets of weights, one behind the other, and labels cells with their numbers: only one if more are not worth their
/// bits. Returns how many.
// Apart from its callers, so that those which never come here do not take its stack.
#[inline(never)]
pub(super) fn learn(
    training: &mut Training,
    taps: &Taps,
    samples: &[i32],
    cells: &Cells,
    (labels, learnt): (&mut OwnLabels, &mut [i16]),
) -> usize {
    let [width, height, _] = taps.subband.sides;
    let [.., most] = LESSONS;
    let pupils = Pupils { subject: Subject::new(taps, samples, most), cells, sides: [width, height] };
    let [small, large] = TRIED;
    let tried = if samples.len() < LARGE { small } else { large };
    let mut sets = [training.trained(&pupils.subject, LESSONS); 1 + SETS];
    let sets = sets.get_mut(..=tried).unwrap_or(&mut []);
    labels.clear(tried);
    pupils.label_by_steepness(tried, labels);
    let mut saved = 0;
    for _ in 0..ROUNDS {
        for (number, set) in sets.iter_mut().skip(1).enumerate() {
            let before = *set;
            let belongs = |[y, _]: [usize; 2], column: usize| labels.get(cells.at(y, column)) == number;
            let lessons = LESSONS_OF_SET.wrapping_mul(tried);
            training.learn(&pupils.subject, lessons, Some(&before), set, &belongs);
        }
        saved = pupils.label_by_residuals(training, sets, labels);
    }
    let (for_all, of_cells) = sets.split_at_mut_checked(1).unwrap_or_default();
    let used = if saved > pupils.cost(tried) {
        of_cells
    } else {
        labels.clear(1);
        for_all
    };
    for (set, learnt) in used.iter().zip(learnt.chunks_mut(taps.weights().max(1))) {
        copy(&usable(pupils.subject.finished(set)).0, learnt);
    }
    used.len()
}

impl Pupils<'_> {
    /// Bits that so many sets have to save, in an estimate that is too good where cells are alike: half as many again as the
    /// sets and the labels of cells take, and one for each 32 samples.
    fn cost(&self, sets: usize) -> u64 {
        let weights = self.subject.taps.weights().wrapping_mul(sets.wrapping_sub(1));
        let counts = [weights, self.cells.len(), self.subject.coefficients.len()];
        let [weights, cells, samples] = counts.map(|count| u64::try_from(count).unwrap_or(u64::MAX));
        let of_labels = cells.saturating_mul(sets.trailing_zeros().into());
        let coded = weights.saturating_mul(CODED_BITS.into()).saturating_add(of_labels);
        (coded.saturating_mul(3) / 2).saturating_add(samples / 32)
    }

    /// The rows that are looked at in cells of a row of them.
    fn looks(&self, row: usize) -> [usize; LOOKS] {
        let ([_, of_rows], [_, height]) = (self.cells.bits, self.sides);
        core::array::from_fn(|look| {
            let within = (look.wrapping_mul(2).wrapping_add(1) << of_rows) / (2 * LOOKS);
            (row << of_rows).wrapping_add(within).min(height.wrapping_sub(1))
        })
    }

    /// The columns and rows of a cell: fewer at the end of the slice.
    fn columns(&self, start: usize) -> Range<usize> {
        let ([of_columns, _], [width, _]) = (self.cells.bits, self.sides);
        let first = start >> of_columns << of_columns;
        first..width.min(first.wrapping_add(1 << of_columns))
    }

    /// Labels cells by how steep they are: by the logarithm of the mean difference of neighbours beside that of all.
    fn label_by_steepness(&self, sets: usize, labels: &mut OwnLabels) {
        let mean = |[sum, columns]: [u64; 2]| log2(sum).wrapping_sub(log2(columns));
        let mut all = [0_u64; 2];
        self.for_each_steepness(|_, [sum, columns]| {
            let [of_sums, of_columns] = all;
            all = [of_sums.wrapping_add(sum), of_columns.wrapping_add(columns)];
        });
        let mean_of_all = mean(all);
        // Four labels are an octave apart, eight half of one.
        let bits = if sets > 4 { BIT_FRACTION - 1 } else { BIT_FRACTION };
        let middle = i32::try_from(sets / 2).unwrap_or(0);
        self.for_each_steepness(|cell, steepness| {
            let label = (mean(steepness).wrapping_sub(mean_of_all) >> bits).wrapping_add(middle).max(0);
            labels.set(cell, usize::try_from(label).unwrap_or(0).min(sets.wrapping_sub(1)));
        });
    }

    /// Does something with the sum of differences of neighbours in the rows of each cell that are looked at, and its columns.
    fn for_each_steepness(&self, mut then: impl FnMut(usize, [u64; 2])) {
        let ([of_columns, of_rows], [columns, rows]) = (self.cells.bits, self.cells.counts);
        for row_of_cells in 0..rows {
            let rows = self
                .looks(row_of_cells)
                .map(|y| self.subject.taps.own_row(self.subject.coefficients, [y, 0]));
            for start in (0..columns).map(|column| column << of_columns) {
                let columns = self.columns(start);
                let parts = rows.iter().flatten().filter_map(|row| row.get(columns.clone()));
                let sum = parts.fold(0, |sum: u64, part| sum.wrapping_add(steepness(part)));
                let cell = self.cells.at(row_of_cells << of_rows, start);
                then(cell, [sum, u64::try_from(columns.len()).unwrap_or(1)]);
            }
        }
    }

    /// Labels each cell with the set that leaves the smallest residuals. Returns the bits that this saves beside the weights
    /// for all cells, the first, about.
    fn label_by_residuals(&self, training: &mut Training, sets: &[Weights], labels: &mut OwnLabels) -> u64 {
        let ([_, of_rows], [_, rows], [width, height]) = (self.cells.bits, self.cells.counts, self.sides);
        let (mut saved, mut sizes): (u64, Sizes) = (0, [0; _]);
        for first_row in (0..rows).map(|row| row << of_rows) {
            let rows = height.wrapping_sub(first_row).min(1 << of_rows);
            for from in (0..width).step_by(BLOCK * BLOCKS) {
                let mut of_blocks: [Sizes; BLOCKS] = [[0; _]; _];
                for y in self.looks(first_row >> of_rows) {
                    training.add_residuals(&self.subject, [y, 0], (from, &mut of_blocks), sets);
                }
                for (start, of_block) in (from..width).step_by(BLOCK).zip(&of_blocks) {
                    for (size, of_block) in sizes.iter_mut().zip(of_block) {
                        *size = size.saturating_add(*of_block);
                    }
                    let columns = self.columns(start);
                    if start.wrapping_add(BLOCK) >= columns.end {
                        let (cell, columns) = (self.cells.at(first_row, start), columns.len());
                        let gain =
                            self.label((cell, columns), core::mem::take(&mut sizes), sets.len(), labels);
                        let samples = u64::try_from(columns.wrapping_mul(rows)).unwrap_or(0);
                        saved = saved.wrapping_add(gain.wrapping_mul(samples));
                    }
                }
            }
        }
        saved >> BIT_FRACTION
    }

    /// Labels a cell of so many columns with the best of all sets but the first. Returns the bits of a sample that this
    /// saves, about, in 1/2^[`BIT_FRACTION`].
    fn label(
        &self,
        (cell, columns): (usize, usize),
        sizes: Sizes,
        sets: usize,
        labels: &mut OwnLabels,
    ) -> u64 {
        let [for_all, of_sets @ ..] = sizes;
        let of_sets = of_sets.into_iter().take(sets.wrapping_sub(1)).enumerate();
        let Some((best, least)) = of_sets.min_by_key(|(_, size)| *size) else { return 0 };
        labels.set(cell, best);
        let bits = |size| self.bits(columns, size);
        u64::try_from(bits(for_all).wrapping_sub(bits(least))).unwrap_or(0)
    }

    /// Bits that a residual of mean size m takes up to a summand, about log2(1 + e m), in 1/2^[`BIT_FRACTION`]; of the sum
    /// of sizes in so many columns.
    fn bits(&self, columns: usize, size: u32) -> i32 {
        let looked = u64::try_from(columns.wrapping_mul(LOOKS)).unwrap_or(0);
        let size = u64::from(size) << self.subject.shift();
        // 11 / 4 is about e.
        log2((looked << SIZE_BITS << 2).wrapping_add(size.wrapping_mul(11)))
    }
}

/// The sum of the sizes of differences of neighbours.
fn steepness(row: &[i32]) -> u64 {
    let pairs = row.iter().zip(row.get(1..).unwrap_or(&[]));
    pairs.fold(0, |sum: u32, (west, here)| sum.saturating_add(here.wrapping_sub(*west).unsigned_abs())).into()
}

/// About the binary logarithm, in 1/2^[`BIT_FRACTION`].
// Where it is inlined, LLVM of Rust 1.95 makes something else of it for riscv32imc.
#[cfg_attr(feature = "small", inline(never))]
fn log2(number: u64) -> i32 {
    let whole = number.checked_ilog2().unwrap_or(0);
    let part = (number << BIT_FRACTION >> whole) & ((1 << BIT_FRACTION) - 1);
    i32::try_from((u64::from(whole) << BIT_FRACTION) | part).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coder::taps::Planes;
    use crate::{Extent, Plan, Wavelet};

    extern crate std;
    use std::vec::Vec;

    #[test]
    #[cfg_attr(miri, ignore = "takes an hour where each access is checked")]
    fn noise_has_one_set() {
        for [width, height] in [[1, 16384], [8192, 2], [33, 512], [129, 131], [512, 32]] {
            let mut seed = 7_u32;
            let mut random = || {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (seed >> 25).cast_signed()
            };
            let samples: Vec<i32> = (0..width * height).map(|_| random()).collect();
            let plan = Plan::new(Wavelet::Haar, Extent::slice(width, height).unwrap(), 0).unwrap();
            let taps = Taps::new(&plan, plan.subbands(0).next().unwrap(), Planes::First).unwrap();
            let cells = Cells::new([width, height].map(crate::extent::to_usize));
            let learnt = (&mut { OwnLabels::NEW }, &mut [0; 8 * 17][..]);
            let sets = learn(&mut { Training::NEW }, &taps, &samples, &cells, learnt);
            assert_eq!(sets, 1, "{width} x {height}");
        }
    }

    #[test]
    fn logarithms_are_near() {
        assert_eq!([1, 2, 3, 4, 6].map(log2), [0, 256, 384, 512, 640]);
        assert_eq!(log2(0), 0);
        assert!(log2(u64::from(u32::MAX)) <= 32 * 256);
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes an hour where each access is checked")]
    fn halves_that_differ_get_sets_of_their_own() {
        // To the left every sample is that to the west, up to noise, to the right that to the north.
        let mut samples: Vec<i32> = (0..256).map(|x| x * 37 % 101).collect();
        let mut seed = 1_u32;
        for i in 256..256 * 128 {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let before = if i % 256 < 128 { i - 1 } else { i - 256 };
            samples.push(samples[before] + (seed >> 28).cast_signed() - 8);
        }
        let extent = Extent::slice(256, 128).unwrap();
        let plan = Plan::new(Wavelet::Haar, extent, 0).unwrap();
        let taps = Taps::new(&plan, plan.subbands(0).next().unwrap(), Planes::First).unwrap();
        let (cells, mut labels) = (Cells::new([256, 128]), OwnLabels::NEW);
        let learn = |samples: &[i32], labels: &mut OwnLabels| {
            super::learn(&mut { Training::NEW }, &taps, samples, &cells, (labels, &mut [0; 8 * 17]))
        };
        assert!(learn(&samples, &mut labels) > 1);
        let of = |column| (0..8).map(|row| labels.get(cells.at(row << 4, column))).collect::<Vec<_>>();
        assert!(of(32).iter().all(|label| !of(192).contains(label)), "{:?} {:?}", of(32), of(192));
        // One set is enough for one rule.
        samples.iter_mut().zip(0..).for_each(|(sample, i)| *sample = i % 256);
        assert_eq!(learn(&samples, &mut labels), 1);
    }
}
