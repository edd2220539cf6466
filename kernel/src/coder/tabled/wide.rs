//! Predictions from the neighbourhood of trained predictors: 43 samples where there is a plane before.

use super::Span;
use super::bits::{BitReader, BitWriter};
use super::neighbours::split_at_row;
use super::own::{Known, OwnRow};
use super::short_rows::ShortRows;
use crate::coder::forecast::{FRACTION_BITS, Weights, add, pad};
use crate::coder::taps::{Planes, REACH, RowTaps, SAMPLES, Taps, WEST};
use crate::coder::{Training, low_half};
use crate::{Extent, Plan, Wavelet};

/// Bits of a weight in the codestream, with its sign.
const CODED_BITS: u32 = 12;

/// The largest magnitude of a weight.
const LARGEST: i16 = (1 << (CODED_BITS - 1)) - 1;

/// The largest sum of magnitudes of weights: sums of products with samples of 16 bits do not overflow.
const LARGEST_SUM: u32 = 1 << 14;

/// Samples that weights are trained on, at first and in the end.
const LESSONS: [usize; 2] = [1 << 11, 3 << 11];

/// Those of the first plane of a brick, for which it is not worth more.
const LESSONS_OF_FIRST: [usize; 2] = [1 << 9, 1 << 10];

/// Half of the last bit that is rounded away.
const HALF: i32 = 1 << (FRACTION_BITS - 1);

/// Weights of rows of the plane itself, which come first.
const OF_PLANE: usize = SAMPLES[0].len() + SAMPLES[1].len() + SAMPLES[2].len();

const _: () = assert!(SAMPLES[2].deep == 0 && SAMPLES[3].deep < 0);

/// Bits that samples may span.
pub(super) const MOST_SPAN_BITS: u32 = 16;

/// The weights for the first plane and for all others.
#[derive(Clone, Debug)]
pub(super) struct Wide {
    plan: Plan,
    span: Span,
    weights: [Weights; 2],
}

impl Wide {
    const fn new(extent: Extent, span: Span) -> Option<Self> {
        match Plan::new(Wavelet::Haar, extent, 0) {
            Ok(plan) => Some(Self { plan, span, weights: [Weights::ZERO; 2] }),
            Err(_) => None,
        }
    }

    /// Weights that suit samples.
    pub(super) fn train(
        training: &mut Training,
        extent: Extent,
        span: Span,
        samples: &[i32],
        scratch: &mut [i32],
    ) -> Option<Self> {
        let mut wide = Self::new(extent, span)?;
        let [_, _, depth] = extent.sides();
        let of_first = if depth == 1 { LESSONS } else { LESSONS_OF_FIRST };
        for (number, lessons) in [of_first, LESSONS].into_iter().enumerate() {
            let Some(taps) = wide.taps(number) else { continue };
            let mut learnt = training.train(&taps, samples, scratch, lessons);
            learnt.0.iter_mut().for_each(|weight| *weight = (*weight).clamp(-LARGEST, LARGEST));
            if let Some(slot) = wide.weights.get_mut(number)
                && are_small(&learnt)
            {
                *slot = learnt;
            }
        }
        Some(wide)
    }

    /// What the weights of the first plane, or of all others, apply to; `None` if there are no such planes.
    fn taps(&self, number: usize) -> Option<Taps> {
        let planes = if number == 0 { Planes::First } else { Planes::Others };
        Taps::new(&self.plan, self.plan.subbands(0).next()?, planes)
    }

    /// Writes the weights.
    pub(super) fn write(&self, bits: &mut BitWriter<'_>) -> Option<()> {
        for (number, weights) in self.weights.iter().enumerate() {
            let count = self.taps(number).map_or(0, |taps| taps.weights());
            let mut used = weights.0.iter().take(count);
            used.try_for_each(|&weight| bits.put(i32::from(weight).cast_unsigned(), CODED_BITS))?;
        }
        Some(())
    }

    /// Reads what [`Wide::write`] wrote; `None` if sums of products could overflow.
    pub(super) fn read(extent: Extent, span: Span, bits: &mut BitReader<'_>) -> Option<Self> {
        const SPARE: u32 = u32::BITS - CODED_BITS;
        let mut wide = Self::new(extent, span)?;
        for number in 0..2 {
            let count = wide.taps(number).map_or(0, |taps| taps.weights());
            let weights = wide.weights.get_mut(number)?;
            for weight in weights.0.iter_mut().take(count) {
                *weight = low_half((bits.take(CODED_BITS) << SPARE).cast_signed() >> SPARE);
            }
            if !are_small(weights) {
                return None;
            }
        }
        Some(wide)
    }

    /// Row y of plane z, with what is known of it.
    pub(super) fn row<'a>(
        &self,
        values: &'a mut [i32],
        place: [usize; 2],
        scratch: &'a mut [i32],
        short_rows: &mut ShortRows,
    ) -> Option<Known<'a, WEST>> {
        let (before, row) = split_at_row(values, self.plan.extent().sides(), place)?;
        let (own, sums) = self.sum_known(before, place, scratch, short_rows)?;
        Some((own, row, sums))
    }

    /// What completes the sums over known rows, and these.
    #[inline(never)]
    fn sum_known<'a>(
        &self,
        before: &[i32],
        place: [usize; 2],
        scratch: &'a mut [i32],
        short_rows: &mut ShortRows,
    ) -> Option<(OwnRow<WEST>, &'a mut [i32])> {
        let [width, ..] = self.plan.extent().sides();
        let (padded, rest) = scratch.split_at_mut_checked(width.wrapping_add(2 * REACH))?;
        let sums = rest.get_mut(..width)?;
        let own = self.own_row(before, place)?;
        let start = HALF.wrapping_sub(self.span.lowest << FRACTION_BITS);
        if short_rows.suit(width) {
            self.sum_short(before, place, start, sums, short_rows)?;
            return Some((own, sums));
        }
        sums.fill(start);
        for (at, weights) in self.known_rows(place) {
            pad(self.samples(before, at)?, width, padded, |sample| sample);
            add(sums, padded, weights.len() / 2, weights);
        }
        Some((own, sums))
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
        let of_middle = middle.wrapping_mul(self.known_weight(place));
        let mut rows: heapless::Vec<_, { SAMPLES.len() }> = heapless::Vec::new();
        for (at, weights) in self.known_rows(place) {
            let number = short_rows.keep(place, at, middle, || self.samples(before, at))?;
            rows.push((number, weights)).ok()?;
        }
        short_rows.sum(&rows, start.wrapping_add(of_middle), sums);
        Some(())
    }

    /// The weights of the row's own samples, and what stands before its first.
    fn own_row(&self, before: &[i32], place: [usize; 2]) -> Option<OwnRow<WEST>> {
        let [second, third, ..] = self.of_plane(place)?.0.map(i32::from);
        let others = self.known_weight(place).wrapping_add(second).wrapping_add(third);
        let first = (1_i32 << FRACTION_BITS).wrapping_sub(others);
        // That of N, or of U in the first row of a plane.
        let nearest = match place {
            [0, 0] => None,
            [0, z] => self.samples(before, [0, z.wrapping_sub(1)]),
            [y, z] => self.samples(before, [y.wrapping_sub(1), z]),
        };
        let reference = nearest.and_then(|row| row.first().copied()).unwrap_or(self.span.lowest);
        Some(OwnRow { weights: [first, second, third], reference, span: self.span })
    }

    fn of_plane(&self, [_, z]: [usize; 2]) -> Option<&Weights> {
        self.weights.get(usize::from(z > 0))
    }

    /// The sum of the weights of known rows.
    fn known_weight(&self, [y, z]: [usize; 2]) -> i32 {
        let total = |weights: &[i16]| weights.iter().fold(0, |sum: i32, &w| sum.wrapping_add(w.into()));
        let weights = self.of_plane([y, z]).and_then(|weights| weights.0.get(WEST - 1..)).unwrap_or(&[]);
        // The first row of a plane knows none of it; weights not in use are 0.
        let [_, height, _] = self.plan.extent().sides();
        let unknown = if y == 0 && height > 1 { OF_PLANE } else { 0 };
        total(weights.get(unknown..).unwrap_or(&[]))
    }

    /// The places of the known rows around a row, and their weights.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn known_rows(&self, place: [usize; 2]) -> impl Iterator<Item = ([usize; 2], &[i16])> {
        let weights = self.of_plane(place).and_then(|weights| weights.0.get(WEST - 1..)).unwrap_or(&[]);
        let mut rest = weights;
        SAMPLES.iter().filter(move |taps| self.has(taps, place)).filter_map(move |taps| {
            let (weights, after) = rest.split_at_checked(taps.len())?;
            rest = after;
            Some((self.known(taps, place)?, weights))
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
    fn samples<'a>(&self, before: &'a [i32], [y, z]: [usize; 2]) -> Option<&'a [i32]> {
        let [width, height, _] = self.plan.extent().sides();
        let start = z.wrapping_mul(height).wrapping_add(y).wrapping_mul(width);
        before.get(start..start.wrapping_add(width))
    }
}

/// Whether no sum of products overflows.
fn are_small(weights: &Weights) -> bool {
    weights.0.iter().fold(0, |sum: u32, weight| sum.saturating_add(weight.unsigned_abs().into()))
        <= LARGEST_SUM
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coder::rank::rank;

    fn wide(axes: [u32; 3], lowest: i32, first: &[i16], others: &[i16]) -> Wide {
        let mut wide = Wide::new(Extent::new(axes).unwrap(), Span { lowest, span: 100 }).unwrap();
        for (Weights(weights), given) in wide.weights.iter_mut().zip([first, others]) {
            weights.iter_mut().zip(given).for_each(|(weight, given)| *weight = *given);
        }
        wide
    }

    #[test]
    fn predictions_by_hand() {
        // Half of N, half of WW: p = (N + WW) / 2, and before the row N's first.
        let mut first = [0; 17];
        (first[0], first[5]) = (128, 128);
        let wide = wide([4, 2, 1], 0, &first, &[]);
        let mut values = [10, 20, 30, 40, 12, 14, 16, 18];
        let mut scratch = [0; 32];
        let (own, row, sums) = wide.row(&mut values, [1, 0], &mut scratch, &mut { ShortRows::NEW }).unwrap();
        own.forward(row, sums);
        // 12 - 10, 14 - 15, 16 - 21, 18 - 27.
        assert_eq!(values[4..], [2, -1, -5, -9].map(rank));
        let (own, row, sums) = wide.row(&mut values, [1, 0], &mut scratch, &mut { ShortRows::NEW }).unwrap();
        own.inverse(row, sums);
        assert_eq!(values[4..], [12, 14, 16, 18]);
    }

    #[test]
    fn vectors_sum_up_the_same() {
        extern crate std;
        use std::vec;
        let weights: [i16; 43] = core::array::from_fn(|i| [301, -297, 38, 5, -11, 129, -90][i % 7]);
        for sides in [[1, 9, 3], [5, 4, 3], [64, 3, 4], [67, 11, 2], [128, 3, 3], [129, 2, 2]] {
            let wide = wide(sides, -7, &weights[..17], &weights);
            let sides = sides.map(crate::extent::to_usize);
            let len = i32::try_from(sides.iter().product::<usize>()).unwrap();
            let samples: vec::Vec<i32> = (0..len).map(|i: i32| ((i * i + 7 * i) & 0xFFFF) - 7).collect();
            let mut scratch = [vec![0; 3 * sides[0] + 6], vec![0; 3 * sides[0] + 6]];
            let [short, long] = &mut scratch;
            let (mut kept, mut unkept) = (ShortRows::NEW, ShortRows::NEW);
            unkept.note(&[i32::MAX], wide.span);
            let rows = (0..sides[2]).flat_map(|z| (0..sides[1]).map(move |y| [y, z]));
            for place in rows.clone().chain(rows.rev()) {
                let [(own, sums), (same, long_sums)] = [(&mut *short, &mut kept), (&mut *long, &mut unkept)]
                    .map(|(scratch, rows)| wide.sum_known(&samples, place, scratch, rows).unwrap());
                assert_eq!((own.weights, own.reference), (same.weights, same.reference));
                assert_eq!(sums, long_sums, "{sides:?} {place:?}");
            }
        }
    }

    #[test]
    fn the_lowest_is_nothing() {
        let weights: [i16; 43] = core::array::from_fn(|i| if i % 2 == 0 { 17 } else { -16 });
        let row = |lowest: i32| {
            let wide = wide([3, 3, 3], lowest, &weights[..17], &weights);
            let mut next = 0;
            let mut values = [0; 27].map(|_: i32| {
                next = (next + 7) % 31;
                lowest + next
            });
            let mut scratch = [0; 32];
            let (own, row, sums) =
                wide.row(&mut values, [1, 2], &mut scratch, &mut { ShortRows::NEW }).unwrap();
            own.forward(row, sums);
            <[i32; 3]>::try_from(&values[21..24]).unwrap()
        };
        assert_eq!(row(0), row(i32::MAX - 31));
        assert_eq!(row(0), row(i32::MIN));
    }

    #[test]
    fn large_sums_of_weights_are_refused() {
        let read = |count: usize| {
            let mut out = [0; 64];
            let mut bits = BitWriter::new(&mut out);
            (0..17).for_each(|i| bits.put(if i < count { 0x800 } else { 0 }, CODED_BITS).unwrap());
            bits.finish().unwrap();
            let extent = Extent::new([4, 4, 1]).unwrap();
            Wide::read(extent, Span { lowest: 0, span: 9 }, &mut BitReader::new(&out)).is_some()
        };
        assert_eq!([read(8), read(9)], [true, false]);
    }
}
