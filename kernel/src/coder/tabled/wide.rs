//! Predictions from the neighbourhood of trained predictors: 43 samples where there is a plane before.

use core::ops::Range;

use super::bits::{BitReader, BitWriter};
use super::cells::{Cells, Labels, OwnLabels, SETS};
use super::neighbours::split_at_row;
use super::own::OwnRow;
use super::short_rows::ShortRows;
use super::{Form, Span, sets};
use crate::coder::forecast::{FRACTION_BITS, Weights, add, pad};
use crate::coder::taps::{Planes, REACH, RowTaps, SAMPLES, Taps, WEST};
use crate::coder::{Training, low_half};
use crate::extent::to_usize;
use crate::memory::copy;
use crate::{Extent, Plan, Wavelet};

/// Bits of a weight in the codestream, with its sign.
pub(super) const CODED_BITS: u32 = 12;

/// The largest magnitude of a weight.
const LARGEST: i16 = (1 << (CODED_BITS - 1)) - 1;

/// The largest sum of magnitudes of weights: sums of products with samples of 16 bits do not overflow.
const LARGEST_SUM: u32 = 1 << 14;

/// Bits of the number of sets, less one.
const SETS_BITS: u32 = 3;

const _: () = assert!(SETS == 1 << SETS_BITS);

/// Samples that the weights of the first plane of a brick are trained on, at first and in the end: it is not worth more.
const LESSONS_OF_FIRST: [usize; 2] = [1 << 9, 1 << 10];

/// Samples that the weights of all other planes are trained on.
const LESSONS: [usize; 2] = [1 << 11, 3 << 11];

/// Half of the last bit that is rounded away.
const HALF: i32 = 1 << (FRACTION_BITS - 1);

/// Weights of rows of the plane itself, which come first.
const OF_PLANE: usize = SAMPLES[0].len() + SAMPLES[1].len() + SAMPLES[2].len();

const _: () = assert!(SAMPLES[2].deep == 0 && SAMPLES[3].deep < 0);

/// Bits that samples may span.
pub(super) const MOST_SPAN_BITS: u32 = 16;

/// Weights of all sets, at most: those of a slice have fewer than those of a brick, which has one.
const WEIGHTS: usize = SETS * (WEST - 1 + OF_PLANE);

/// The weights for the first plane of a brick and for all others, or those of each cell of a slice.
#[derive(Clone, Debug)]
pub(super) struct Wide<'a> {
    plan: Plan,
    span: Span,
    /// Those of the first plane of a brick, then the sets.
    weights: [i16; WEIGHTS],
    /// How many of the first plane there are.
    of_first: usize,
    /// And in a set.
    of_set: usize,
    sets: usize,
    cells: Cells,
    labels: Labels<'a>,
}

impl<'a> Wide<'a> {
    fn new(extent: Extent, span: Span) -> Option<Self> {
        let plan = Plan::new(Wavelet::Haar, extent, 0).ok()?;
        let [width, height, _] = extent.sides();
        let cells = Cells::new([width, height]);
        let (weights, labels) = ([0; _], Labels::NONE);
        let mut wide = Self { plan, span, weights, of_first: 0, of_set: 0, sets: 1, cells, labels };
        let (of_sets, of_first) = wide.taps()?;
        (wide.of_first, wide.of_set) = (of_first.map_or(0, |taps| taps.weights()), of_sets.weights());
        Some(wide)
    }

    /// Weights that suit samples.
    #[inline(never)]
    #[cfg_attr(
        feature = "trained",
        expect(
            clippy::large_stack_frames,
            reason = "the lint counts every copy of the weights; the frame is far smaller"
        )
    )]
    pub(super) fn train(
        training: &mut Training,
        extent: Extent,
        span: Span,
        samples: &[i32],
        labels: &'a mut OwnLabels,
    ) -> Option<Self> {
        let mut wide = Self::new(extent, span)?;
        let (of_sets, of_first) = wide.taps()?;
        let (first, sets) = wide.weights.split_at_mut_checked(wide.of_first)?;
        if let Some(taps) = of_first {
            copy(&usable(training.train(&taps, samples, LESSONS_OF_FIRST)).0, first);
            copy(&usable(training.train(&of_sets, samples, LESSONS)).0, sets);
        } else {
            wide.sets = sets::learn(training, &of_sets, samples, &wide.cells, (labels, sets));
            wide.labels = labels.labels();
        }
        Some(wide)
    }

    /// What the sets apply to; and the weights of the first plane of a brick.
    fn taps(&self) -> Option<(Taps, Option<Taps>)> {
        let subband = self.plan.subbands(0).next()?;
        let [first, others] =
            [Planes::First, Planes::Others].map(|planes| Taps::new(&self.plan, subband, planes));
        match others {
            Some(others) => Some((others, first)),
            None => Some((first?, None)),
        }
    }

    /// Weights in use.
    const fn len(&self) -> usize {
        self.of_first.wrapping_add(self.of_set.wrapping_mul(self.sets))
    }

    /// Writes the weights.
    pub(super) fn write(&self, bits: &mut BitWriter<'_>) -> Option<()> {
        if self.of_first == 0 {
            bits.put(u32::try_from(self.sets.checked_sub(1)?).ok()?, SETS_BITS)?;
        }
        let mut used = self.weights.iter().take(self.len());
        used.try_for_each(|&weight| bits.put(i32::from(weight).cast_unsigned(), CODED_BITS))?;
        self.labels.write(self.cells.len(), bits)
    }

    /// Reads what [`Wide::write`] wrote; `None` if sums of products could overflow.
    pub(super) fn read(extent: Extent, span: Span, form: Form, bits: &mut BitReader<'a>) -> Option<Self> {
        const SPARE: u32 = u32::BITS - CODED_BITS;
        let mut wide = Self::new(extent, span)?;
        if wide.of_first == 0 && form == Form::Celled {
            wide.sets = to_usize(bits.take(SETS_BITS)).wrapping_add(1);
        }
        let used = wide.len();
        for weight in wide.weights.iter_mut().take(used) {
            *weight = low_half((bits.take(CODED_BITS) << SPARE).cast_signed() >> SPARE);
        }
        let (first, sets) = wide.weights.get(..used)?.split_at_checked(wide.of_first)?;
        if !are_small(first) || !sets.chunks(wide.of_set.max(1)).all(are_small) {
            return None;
        }
        wide.labels = Labels::read(wide.cells.len(), wide.sets, bits)?;
        Some(wide)
    }

    /// Makes ranks of residuals of the samples of row y of plane z.
    pub(super) fn forward(
        &self,
        values: &mut [i32],
        place: [usize; 2],
        scratch: &mut [i32],
        short_rows: &mut ShortRows,
    ) -> Option<()> {
        self.code_row(values, place, scratch, short_rows, OwnRow::forward).map(|_| ())
    }

    /// Makes samples of the ranks of row y of plane z.
    pub(super) fn inverse(
        &self,
        values: &mut [i32],
        place: [usize; 2],
        scratch: &mut [i32],
        short_rows: &mut ShortRows,
    ) -> Option<()> {
        let row = self.code_row(values, place, scratch, short_rows, OwnRow::inverse)?;
        short_rows.note(row, self.span);
        Some(())
    }

    /// Does `code` to each part of a row that has the same weights: with the part, the sums over its known rows, and the
    /// last samples before it. Returns the row.
    #[inline(always)]
    fn code_row<'b>(
        &self,
        values: &'b mut [i32],
        place: [usize; 2],
        scratch: &mut [i32],
        short_rows: &mut ShortRows,
        code: impl Fn(&OwnRow<WEST>, &mut [i32], &mut [i32], &mut [i32; WEST]),
    ) -> Option<&'b [i32]> {
        let (before, row) = split_at_row(values, self.plan.extent().sides(), place)?;
        let sums = self.sum_known(before, place, scratch, short_rows)?;
        let mut west = [self.reference(before, place); WEST];
        for (columns, set) in self.runs(place) {
            let own = self.own_row(set, place);
            code(&own, row.get_mut(columns.clone())?, sums.get_mut(columns)?, &mut west);
        }
        Some(row)
    }

    /// The columns of a row that have the same weights, and these.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn runs(&self, [y, z]: [usize; 2]) -> impl Iterator<Item = (Range<usize>, &[i16])> {
        let (first, sets) = self.weights.split_at_checked(self.of_first).unwrap_or_default();
        self.cells.runs(self.labels, y).filter_map(move |(columns, number)| {
            let set = sets.get(number.wrapping_mul(self.of_set)..)?.get(..self.of_set)?;
            Some((columns, if z == 0 && !first.is_empty() { first } else { set }))
        })
    }

    /// What completes the sums over known rows, and these.
    #[inline(never)]
    fn sum_known<'b>(
        &self,
        before: &[i32],
        place: [usize; 2],
        scratch: &'b mut [i32],
        short_rows: &mut ShortRows,
    ) -> Option<&'b mut [i32]> {
        let [width, ..] = self.plan.extent().sides();
        let (padded, rest) = scratch.split_at_mut_checked(width.wrapping_add(2 * REACH))?;
        let sums = rest.get_mut(..width)?;
        let start = HALF.wrapping_sub(self.span.lowest << FRACTION_BITS);
        if short_rows.suit(width) {
            self.sum_short(before, place, start, sums, short_rows)?;
            return Some(sums);
        }
        sums.fill(start);
        for (at, taps, of_row) in self.known_rows(place) {
            pad(self.samples(before, at)?, width, padded, |sample| sample);
            for (columns, set) in self.runs(place) {
                let window = padded.get(columns.start..)?;
                add(sums.get_mut(columns)?, window, taps.reach, set.get(of_row.clone())?);
            }
        }
        Some(sums)
    }

    /// Sets `sums` to `start` and the weighted samples of known rows, by vectors.
    #[inline(always)]
    fn sum_short(
        &self,
        before: &[i32],
        place: [usize; 2],
        start: i32,
        sums: &mut [i32],
        short_rows: &mut ShortRows,
    ) -> Option<()> {
        let middle = self.span.lowest.wrapping_add(1 << (MOST_SPAN_BITS - 1));
        let mut kept: heapless::Vec<_, { SAMPLES.len() }> = heapless::Vec::new();
        for (at, _, of_row) in self.known_rows(place) {
            let number = short_rows.keep(place, at, middle, || self.samples(before, at))?;
            kept.push((number, of_row)).ok()?;
        }
        for (columns, set) in self.runs(place) {
            let of_middle = middle.wrapping_mul(self.known_weight(set, place));
            let mut rows: heapless::Vec<_, { SAMPLES.len() }> = heapless::Vec::new();
            for (number, of_row) in &kept {
                rows.push((*number, set.get(of_row.clone())?)).ok()?;
            }
            short_rows.sum(&rows, start.wrapping_add(of_middle), columns.start, sums.get_mut(columns)?);
        }
        Some(())
    }

    /// What stands before the first sample of a row: the first of N, or of U in the first row of a plane.
    fn reference(&self, before: &[i32], place: [usize; 2]) -> i32 {
        let nearest = match place {
            [0, 0] => None,
            [0, z] => self.samples(before, [0, z.wrapping_sub(1)]),
            [y, z] => self.samples(before, [y.wrapping_sub(1), z]),
        };
        nearest.and_then(|row| row.first().copied()).unwrap_or(self.span.lowest)
    }

    /// The weights of the row's own samples.
    fn own_row(&self, set: &[i16], place: [usize; 2]) -> OwnRow<WEST> {
        let [second, third] = set.first_chunk().copied().unwrap_or([0; WEST - 1]).map(i32::from);
        let others = self.known_weight(set, place).wrapping_add(second).wrapping_add(third);
        let first = (1_i32 << FRACTION_BITS).wrapping_sub(others);
        OwnRow { weights: [first, second, third], span: self.span }
    }

    /// The sum of the weights of known rows.
    fn known_weight(&self, set: &[i16], [y, _]: [usize; 2]) -> i32 {
        // The first row of a plane knows none of it.
        let [_, height, _] = self.plan.extent().sides();
        let unknown = if y == 0 && height > 1 { OF_PLANE } else { 0 };
        let known = set.get(unknown.wrapping_add(WEST - 1)..).unwrap_or(&[]);
        known.iter().fold(0, |sum: i32, &weight| sum.wrapping_add(weight.into()))
    }

    /// The places of the known rows around a row, and which weights are theirs.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn known_rows(
        &self,
        place: [usize; 2],
    ) -> impl Iterator<Item = ([usize; 2], &'static RowTaps, Range<usize>)> {
        let mut next = WEST - 1;
        SAMPLES.iter().filter(move |taps| self.has(taps, place)).filter_map(move |taps| {
            let first = next;
            next = next.wrapping_add(taps.len());
            Some((self.known(taps, place)?, taps, first..next))
        })
    }

    /// Whether rows have weights in the plane.
    const fn has(&self, taps: &RowTaps, [_, z]: [usize; 2]) -> bool {
        let [_, height, _] = self.plan.extent().sides();
        (taps.down == 0 || height > 1) && (taps.deep == 0 || z > 0)
    }

    /// The place of one of the rows around row y of plane z; beyond the border stands the nearest. `None` if none is known.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn known(&self, taps: &RowTaps, [y, z]: [usize; 2]) -> Option<[usize; 2]> {
        if taps.deep == 0 && y == 0 {
            return None;
        }
        let [_, height, _] = self.plan.extent().sides();
        let last = height.wrapping_sub(1).cast_signed();
        let at = |place: usize, step: isize| place.cast_signed().wrapping_add(step).max(0);
        Some([at(y, taps.down).min(last).cast_unsigned(), at(z, taps.deep).cast_unsigned()])
    }

    /// The samples of a row that is known.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn samples<'b>(&self, before: &'b [i32], [y, z]: [usize; 2]) -> Option<&'b [i32]> {
        let [width, height, _] = self.plan.extent().sides();
        let start = z.wrapping_mul(height).wrapping_add(y).wrapping_mul(width);
        before.get(start..start.wrapping_add(width))
    }
}

/// Trained weights as they can be coded, or none if they cannot.
pub(super) fn usable(mut weights: Weights) -> Weights {
    weights.0.iter_mut().for_each(|weight| *weight = (*weight).clamp(-LARGEST, LARGEST));
    if are_small(&weights.0) { weights } else { Weights::ZERO }
}

/// Whether no sum of products overflows.
fn are_small(weights: &[i16]) -> bool {
    weights.iter().fold(0, |sum: u32, weight| sum.saturating_add(weight.unsigned_abs().into())) <= LARGEST_SUM
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coder::rank::rank;

    /// Of `first` for the first plane of a brick, of `sets` for all others or for the cells of a slice.
    fn wide<'a>(axes: [u32; 3], lowest: i32, first: &[i16], sets: &[&[i16]], labels: Labels<'a>) -> Wide<'a> {
        let mut wide = Wide::new(Extent::new(axes).unwrap(), Span { lowest, span: 100 }).unwrap();
        (wide.sets, wide.labels) = (sets.len(), labels);
        let first = &first[..wide.of_first];
        let given = sets.iter().flat_map(|set| &set[..wide.of_set]);
        wide.weights.iter_mut().zip(first.iter().chain(given)).for_each(|(slot, weight)| *slot = *weight);
        wide
    }

    #[test]
    fn predictions_by_hand() {
        // Half of N, half of WW: p = (N + WW) / 2, and before the row N's first.
        let mut first = [0; 17];
        (first[0], first[5]) = (128, 128);
        let wide = wide([4, 2, 1], 0, &[], &[&first], Labels::NONE);
        let mut values = [10, 20, 30, 40, 12, 14, 16, 18];
        let mut scratch = [0; 32];
        wide.forward(&mut values, [1, 0], &mut scratch, &mut { ShortRows::NEW }).unwrap();
        // 12 - 10, 14 - 15, 16 - 21, 18 - 27.
        assert_eq!(values[4..], [2, -1, -5, -9].map(rank));
        wide.inverse(&mut values, [1, 0], &mut scratch, &mut { ShortRows::NEW }).unwrap();
        assert_eq!(values[4..], [12, 14, 16, 18]);
    }

    #[test]
    fn cells_have_weights_of_their_own() {
        // In the first cell N, in the second WW.
        let (mut n, mut ww) = ([0; 17], [0; 17]);
        (n[5], ww[0]) = (256, 256);
        let mut labels = OwnLabels::NEW;
        labels.clear(2);
        labels.set(1, 1);
        let wide = wide([40, 2, 1], 0, &[], &[&n, &ww], labels.labels());
        let samples: [i32; 80] = core::array::from_fn(|i| i32::try_from(i * i % 97).unwrap());
        let (mut values, mut scratch) = (samples, [0; 128]);
        wide.forward(&mut values, [1, 0], &mut scratch, &mut { ShortRows::NEW }).unwrap();
        for x in 40..80 {
            let predicted = if x < 72 { samples[x - 40] } else { samples[x - 2] };
            assert_eq!(values[x], rank(samples[x] - predicted), "{x}");
        }
        wide.inverse(&mut values, [1, 0], &mut scratch, &mut { ShortRows::NEW }).unwrap();
        assert_eq!(values, samples);
    }

    #[test]
    fn vectors_sum_up_the_same() {
        extern crate std;
        use std::vec;
        let weights: [i16; 43] = core::array::from_fn(|i| [301, -297, 38, 5, -11, 129, -90][i % 7]);
        let other: [i16; 43] = core::array::from_fn(|i| weights[42 - i]);
        for sides in [[1, 9, 3], [5, 4, 3], [64, 3, 4], [67, 11, 2], [128, 3, 3], [129, 2, 2], [128, 40, 1]] {
            let is_slice = sides[2] == 1;
            let mut labels = OwnLabels::NEW;
            labels.clear(if is_slice { 2 } else { 1 });
            [1, 2, 4, 7].into_iter().for_each(|cell| labels.set(cell, 1));
            let sets: &[&[i16]] = if is_slice { &[&weights[..17], &other[..17]] } else { &[&weights] };
            let wide = wide(sides, -7, &weights[..17], sets, labels.labels());
            let sides = sides.map(crate::extent::to_usize);
            let len = i32::try_from(sides.iter().product::<usize>()).unwrap();
            let samples: vec::Vec<i32> = (0..len).map(|i: i32| ((i * i + 7 * i) & 0xFFFF) - 7).collect();
            let mut scratch = [vec![0; 3 * sides[0] + 6], vec![0; 3 * sides[0] + 6]];
            let [short, long] = &mut scratch;
            let (mut kept, mut unkept) = (ShortRows::NEW, ShortRows::NEW);
            unkept.note(&[i32::MAX], wide.span);
            let rows = (0..sides[2]).flat_map(|z| (0..sides[1]).map(move |y| [y, z]));
            for place in rows.clone().chain(rows.rev()) {
                let [sums, long_sums] = [(&mut *short, &mut kept), (&mut *long, &mut unkept)]
                    .map(|(scratch, rows)| wide.sum_known(&samples, place, scratch, rows).unwrap());
                assert_eq!(sums, long_sums, "{sides:?} {place:?}");
            }
        }
    }

    #[test]
    fn the_lowest_is_nothing() {
        let weights: [i16; 43] = core::array::from_fn(|i| if i % 2 == 0 { 17 } else { -16 });
        let row = |lowest: i32| {
            let wide = wide([3, 3, 3], lowest, &weights[..17], &[&weights], Labels::NONE);
            let mut next = 0;
            let mut values = [0; 27].map(|_: i32| {
                next = (next + 7) % 31;
                lowest + next
            });
            let mut scratch = [0; 32];
            wide.forward(&mut values, [1, 2], &mut scratch, &mut { ShortRows::NEW }).unwrap();
            <[i32; 3]>::try_from(&values[21..24]).unwrap()
        };
        assert_eq!(row(0), row(i32::MAX - 31));
        assert_eq!(row(0), row(i32::MIN));
    }

    #[test]
    fn large_sums_of_weights_are_refused() {
        let read = |count: usize, form| {
            let mut out = [0; 64];
            let mut bits = BitWriter::new(&mut out);
            if form == Form::Celled {
                bits.put(0, SETS_BITS).unwrap();
            }
            (0..17).for_each(|i| bits.put(if i < count { 0x800 } else { 0 }, CODED_BITS).unwrap());
            bits.finish().unwrap();
            let extent = Extent::new([4, 4, 1]).unwrap();
            Wide::read(extent, Span { lowest: 0, span: 9 }, form, &mut BitReader::new(&out)).is_some()
        };
        for form in [Form::Wide, Form::Celled] {
            assert_eq!([read(8, form), read(9, form)], [true, false]);
        }
    }
}
