//! Predictions from the nearest samples, row by row, and the residuals that they leave.

use super::bits::{BitReader, BitWriter};
use super::neighbours::{Around, Kind, add_row, add_three, five, row_at};
use super::own::OwnRow;
use super::train::Lessons;
use super::{MOST_SPAN_BITS, Span};

/// Fraction bits of weights.
pub(super) const WEIGHT_BITS: u32 = crate::coder::forecast::FRACTION_BITS;

/// Bits of a weight in the codestream, with its sign.
const CODED_BITS: u32 = 12;

/// The largest sum of magnitudes of weights: sums of products do not overflow.
const LARGEST_SUM: u32 = 1 << (31 - MOST_SPAN_BITS - 1);

/// Half of the last bit that is rounded away.
const HALF: i32 = 1 << (WEIGHT_BITS - 1);

/// Neighbours in a row that is known, at most.
pub(super) const TAPS: usize = 12;

/// What a prediction is made of, in 1/256: W, and the neighbours in known rows.
///
/// In a plane these are the five nearest of N, in a brick the three nearest of N, U, UN and US each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Weights {
    pub(super) west: i32,
    pub(super) rows: [i32; TAPS],
}

impl Weights {
    /// For samples that nothing is known of: W + N - NW, of which the last counts half; half W, half N, three quarters of U,
    /// a quarter less of the three between.
    pub(super) const FIRST: BothWeights = [
        Self { west: 192, rows: [0, -128, 192, 0, 0, 0, 0, 0, 0, 0, 0, 0] },
        Self { west: 128, rows: [-64, 128, 0, -64, 192, 0, 0, -64, 0, 0, 0, 0] },
    ];

    /// Neighbours in known rows.
    pub(super) const fn taps(kind: Kind) -> usize {
        match kind {
            Kind::First => 0,
            Kind::Plane => 5,
            Kind::Brick => TAPS,
        }
    }

    /// Their sum.
    fn sum(&self) -> i32 {
        self.rows.iter().fold(self.west, |sum, weight| sum.wrapping_add(*weight))
    }

    /// Whether no sum of products overflows.
    pub(super) fn are_small(&self) -> bool {
        let magnitudes = self.rows.iter().map(|weight| weight.unsigned_abs());
        let sum = magnitudes.fold(self.west.unsigned_abs(), u32::saturating_add);
        let limit = 1 << (CODED_BITS - 1);
        sum <= LARGEST_SUM && self.rows.iter().chain([&self.west]).all(|weight| *weight < limit)
    }

    /// Writes the weights of rows of a kind.
    pub(super) fn write(&self, kind: Kind, bits: &mut BitWriter<'_>) -> Option<()> {
        bits.put(self.west.cast_unsigned(), CODED_BITS)?;
        let mut rows = self.rows.iter().take(Self::taps(kind));
        rows.try_for_each(|weight| bits.put(weight.cast_unsigned(), CODED_BITS))
    }

    /// Reads what [`Weights::write`] wrote; `None` if sums of products could overflow.
    pub(super) fn read(kind: Kind, bits: &mut BitReader<'_>) -> Option<Self> {
        const SPARE: u32 = u32::BITS - CODED_BITS;
        let mut weight = || (bits.take(CODED_BITS) << SPARE).cast_signed() >> SPARE;
        let mut weights = Self { west: weight(), rows: [0; TAPS] };
        weights.rows.iter_mut().take(Self::taps(kind)).for_each(|slot| *slot = weight());
        weights.are_small().then_some(weights)
    }
}

/// The weights in a plane, and from plane to plane.
pub(super) type BothWeights = [Weights; 2];

/// Predictions of samples, by weights for samples less the lowest.
#[derive(Debug)]
pub(super) struct Narrow {
    weights: BothWeights,
    span: Span,
    /// What the sums of rows of the first plane and of others begin with: half a unit, so that they round, and what takes
    /// the lowest from all samples.
    starts: [i32; 2],
}

/// The weight of W, what stands before a row, the row itself, and the sums over known rows.
type Known<'a> = (OwnRow<1>, [i32; 1], &'a mut [i32], &'a mut [i32]);

/// Kinds of rows that have weights in a brick of `sides`.
fn weighted([_, height, depth]: [usize; 3]) -> impl Iterator<Item = Kind> {
    let kinds = [(height > 1, Kind::Plane), (depth > 1, Kind::Brick)];
    kinds.into_iter().filter_map(|(present, kind)| present.then_some(kind))
}

impl Narrow {
    pub(super) fn new(weights: BothWeights, span: Span) -> Self {
        let start = |sum: i32| HALF.wrapping_sub(span.lowest.wrapping_mul(sum));
        Self { starts: weights.each_ref().map(|weights| start(weights.sum())), weights, span }
    }

    /// Those that suit samples.
    #[cfg_attr(feature = "small", inline(never))]
    pub(super) fn train(lessons: &mut Lessons, sides: [usize; 3], span: Span, samples: &mut [i32]) -> Self {
        let mut weights = Weights::FIRST;
        for kind in weighted(sides) {
            if let Some(learnt) = lessons.learn(kind, sides, samples) {
                *kind.of(&mut weights) = learnt;
            }
        }
        Self::new(weights, span)
    }

    /// Writes the weights.
    pub(super) fn write(&self, sides: [usize; 3], bits: &mut BitWriter<'_>) -> Option<()> {
        weighted(sides).try_for_each(|kind| kind.of(&mut self.weights.clone()).write(kind, bits))
    }

    /// Reads what [`Narrow::write`] wrote; `None` if sums of products could overflow.
    pub(super) fn read(sides: [usize; 3], span: Span, bits: &mut BitReader<'_>) -> Option<Self> {
        let mut weights = Weights::FIRST;
        for kind in weighted(sides) {
            *kind.of(&mut weights) = Weights::read(kind, bits)?;
        }
        Some(Self::new(weights, span))
    }

    /// Row y of plane z, with what is known of it. `scratch` holds a row.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn row<'a>(
        &self,
        values: &'a mut [i32],
        sides: [usize; 3],
        place: [usize; 2],
        scratch: &'a mut [i32],
    ) -> Option<Known<'a>> {
        let (around, row) = row_at(values, sides, place)?;
        let sums = scratch.get_mut(..row.len())?;
        let weights = [self.sum_known(&around, sums)];
        let reference = *around.north.first().unwrap_or(&self.span.lowest);
        Some((OwnRow { weights, span: self.span }, [reference], row, sums))
    }

    /// The sums over known rows; returns the weight of W.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn sum_known(&self, around: &Around<'_>, sums: &mut [i32]) -> i32 {
        let ([plane, brick], [start, brick_start]) = (&self.weights, self.starts);
        match around.kind {
            Kind::First => {
                sums.fill(HALF.wrapping_sub(self.span.lowest << WEIGHT_BITS));
                1 << WEIGHT_BITS
            }
            Kind::Plane => {
                sums.fill(start);
                let [a, b, c, d, e, ..] = plane.rows;
                add_row(sums, around.north, five([a, b, c, d, e]));
                plane.west
            }
            Kind::Brick => {
                sums.fill(brick_start);
                let rows = [around.north, around.up, around.up_north, around.up_south];
                for (row, weights) in rows.into_iter().zip(brick.rows.as_chunks::<3>().0) {
                    add_three(sums, row, *weights);
                }
                brick.west
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn predictions_by_hand() {
        let mut weights = Weights::FIRST;
        weights[0] = Weights { west: 128, rows: [0, 0, 128, 64, 0, 0, 0, 0, 0, 0, 0, 0] };
        let narrow = Narrow::new(weights, Span { lowest: 0, span: 25 });
        // p = (10 + 10) / 2 + 20 / 4 = 15, (17 + 20) / 2 + 30 / 4 = 26, 25 at most, (20 + 30) / 2 + 30 / 4 = 32.5, 25.
        let mut values = [10, 20, 30, 17, 20, 25];
        let mut scratch = [0; 3];
        let (own, mut west, row, sums) = narrow.row(&mut values, [3, 2, 1], [1, 0], &mut scratch).unwrap();
        own.forward(row, sums, &mut west);
        assert_eq!(values, [10, 20, 30, 3, 10, 0]);
        let (own, mut west, row, sums) = narrow.row(&mut values, [3, 2, 1], [1, 0], &mut scratch).unwrap();
        own.inverse(row, sums, &mut west);
        assert_eq!(values, [10, 20, 30, 17, 20, 25]);
    }

    #[test]
    fn the_lowest_is_nothing() {
        let mut weights = Weights::FIRST;
        weights[1].rows[0] = 77;
        let ranks = |place: [usize; 2], lowest: i32| {
            let narrow = Narrow::new(weights.clone(), Span { lowest, span: 30 });
            let mut values = [7, 9, 3, 1, 20, 5, 5, 12, 0, 8, 8, 30].map(|sample| sample + lowest);
            let mut scratch = [0; 3];
            let (own, mut west, row, sums) = narrow.row(&mut values, [3, 2, 2], place, &mut scratch).unwrap();
            own.forward(row, sums, &mut west);
            let [y, z] = place;
            values.iter().copied().skip(6 * z + 3 * y).take(3).collect::<heapless::Vec<i32, 3>>()
        };
        for place in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            assert_eq!(ranks(place, 0), ranks(place, 1000));
        }
    }

    #[test]
    fn large_sums_of_weights_are_refused() {
        let read = |west: u32, north: u32| {
            let mut out = [0; 16];
            let mut bits = BitWriter::new(&mut out);
            [west, 0, 0, north, 0, 0].iter().for_each(|&weight| bits.put(weight, CODED_BITS).unwrap());
            bits.finish().unwrap();
            Weights::read(Kind::Plane, &mut BitReader::new(&out))
                .map(|weights| [weights.west, weights.rows[2]])
        };
        assert_eq!(read(1024, 0x1000 - 1024), Some([1024, -1024]));
        assert_eq!([read(1025, 1024), read(0x800, 1)], [None; 2]);
    }
}
