//! Sums over known rows by the processor's vectors, of samples that fit 16 bits: the products of two neighbours with their
//! weights are added at once, to the sums of every second column. Rows are kept so for all rows that need them.

use wide::{i16x16, i32x8};

use super::Span;
use crate::coder::low_half;
use crate::coder::taps::{REACH, SAMPLES};

/// Columns of the widest rows.
const WIDEST: usize = 128;

/// Columns that are summed up together, where as many have the same weights.
const COLUMNS: usize = 64;

/// Elements of a vector of samples.
const LANES: usize = 16;

/// Columns of a row that is kept, with those around them that count, rounded up.
const PADDED: usize = WIDEST + LANES;

/// Rows that are kept: as many as a row knows of its own plane, of that before, and of the one before that.
const KEPT: usize = SAMPLES.len();

/// Columns behind those that are summed up of which some count, rounded up.
const BEHIND: usize = 8;

const _: () = assert!(2 * REACH <= BEHIND && WIDEST + BEHIND <= PADDED && WIDEST.is_multiple_of(COLUMNS));

/// A row with those samples around it that count, as differences from the middle of what samples may be.
type ShortRow = [i16; PADDED];

/// The rows that are kept.
pub(super) struct ShortRows {
    rows: [ShortRow; KEPT],
    /// Their places, y and z.
    places: [[usize; 2]; KEPT],
    /// Whether all samples fit 16 bits: only those of damaged codestreams do not.
    fit: bool,
}

impl ShortRows {
    #[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
    pub(super) const NEW: Self = Self { rows: [[0; PADDED]; _], places: [[usize::MAX; 2]; _], fit: true };

    /// Whether rows of `width` can be kept, and all samples so far.
    pub(super) const fn suit(&self, width: usize) -> bool {
        width <= WIDEST && self.fit
    }

    /// Takes note of whether samples are of the span.
    pub(super) fn note(&mut self, samples: &[i32], Span { lowest, span }: Span) {
        let is_beyond = |sample: &i32| sample.wrapping_sub(lowest).cast_unsigned() > span.cast_unsigned();
        self.fit &= !samples.iter().fold(false, |any, sample| any | is_beyond(sample));
    }

    /// Keeps the row at `place`, around that at `own`; returns its number. Its samples are asked for unless it is kept
    /// already.
    #[inline(always)]
    pub(super) fn keep<'a>(
        &mut self,
        own: [usize; 2],
        place: [usize; 2],
        middle: i32,
        samples: impl FnOnce() -> Option<&'a [i32]>,
    ) -> Option<usize> {
        let ([_, own_z], [y, z]) = (own, place);
        let number = match own_z.wrapping_sub(z) {
            0 => y % 3,
            1 => (y % 5).wrapping_add(3),
            _ => (y % 3).wrapping_add(8),
        };
        let kept = self.places.get_mut(number)?;
        if *kept != place {
            shorten(samples()?, middle, self.rows.get_mut(number)?);
            *kept = place;
        }
        Some(number)
    }

    /// Sets `sums`, those of the columns from `first`, to `start` and the weighted neighbours in rows that are kept.
    #[inline(always)]
    pub(super) fn sum(&self, rows: &[(usize, &[i16])], start: i32, first: usize, sums: &mut [i32]) {
        let rest = sums.len() % COLUMNS;
        let (many, few) = sums.split_at_mut_checked(sums.len().wrapping_sub(rest)).unwrap_or_default();
        let first_of_few = first.wrapping_add(many.len());
        self.sum_chunks::<{ COLUMNS / LANES }, { COLUMNS + BEHIND }>(rows, start, first, many);
        self.sum_chunks::<2, { 2 * LANES + BEHIND }>(rows, start, first_of_few, few);
    }

    /// The same, so many vectors at a time, for which so many columns of each row are needed.
    #[inline(always)]
    fn sum_chunks<const VECTORS: usize, const NEEDED: usize>(
        &self,
        rows: &[(usize, &[i16])],
        start: i32,
        first: usize,
        sums: &mut [i32],
    ) {
        let columns = VECTORS.wrapping_mul(LANES);
        for (sums, from) in sums.chunks_mut(columns).zip((first..).step_by(columns)) {
            let mut all = Sums::<VECTORS>::ZERO;
            for (number, weights) in rows {
                let Some(row) = self.rows.get(*number).and_then(|row| row.get(from..)) else { return };
                let Some(columns) = row.first_chunk::<NEEDED>() else { return };
                all.add(columns, weights);
            }
            all.write(start, sums);
        }
    }
}

/// Differences of samples from the middle; beyond the ends of a row stand the first and the last.
#[inline(never)]
fn shorten(row: &[i32], middle: i32, short: &mut ShortRow) {
    let difference = |sample: i32| low_half(sample.wrapping_sub(middle));
    let (Some(&first), Some(&last)) = (row.first(), row.last()) else { return };
    let (before, rest) = short.split_at_mut(REACH);
    before.fill(difference(first));
    rest.iter_mut().zip(row).for_each(|(slot, sample)| *slot = difference(*sample));
    rest.iter_mut().skip(row.len()).take(REACH).for_each(|slot| *slot = difference(last));
}

/// Sums of columns, by vectors of samples: those of even columns, and those of odd ones.
struct Sums<const VECTORS: usize>([[i32x8; 2]; VECTORS]);

impl<const VECTORS: usize> Sums<VECTORS> {
    const ZERO: Self = Self([[i32x8::ZERO; 2]; _]);

    /// Adds the weighted neighbours in a row.
    #[inline(always)]
    fn add<const NEEDED: usize>(&mut self, columns: &[i16; NEEDED], weights: &[i16]) {
        match *weights {
            [a] => self.add_pairs(columns, [[a, 0]]),
            [a, b, c] => self.add_pairs(columns, [[a, b], [c, 0]]),
            [a, b, c, d, e] => self.add_pairs(columns, [[a, b], [c, d], [e, 0]]),
            [a, b, c, d, e, f, g] => self.add_pairs(columns, [[a, b], [c, d], [e, f], [g, 0]]),
            _ => {}
        }
    }

    #[inline(always)]
    fn add_pairs<const NEEDED: usize, const N: usize>(
        &mut self,
        columns: &[i16; NEEDED],
        pairs: [[i16; 2]; N],
    ) {
        let pairs = pairs.map(|[a, b]| i16x16::new([a, b, a, b, a, b, a, b, a, b, a, b, a, b, a, b]));
        let first = (REACH + 1).wrapping_sub(N);
        for (sums, first) in self.0.iter_mut().zip((first..).step_by(LANES)) {
            for (sum, from) in sums.iter_mut().zip(first..) {
                for (pair, at) in pairs.iter().zip((from..).step_by(2)) {
                    let lanes = columns.get(at..).and_then(|lanes| lanes.first_chunk());
                    *sum += lanes.map_or(i32x8::ZERO, |lanes| i16x16::new(*lanes).dot(*pair));
                }
            }
        }
    }

    /// Sets `sums` to all, and `start`.
    #[inline(always)]
    fn write(&self, start: i32, sums: &mut [i32]) {
        for ([even, odd], sums) in self.0.iter().zip(sums.chunks_mut(LANES)) {
            let (even, odd) = (even.to_array(), odd.to_array());
            let mut all = [0; LANES];
            for (pair, (even, odd)) in all.as_chunks_mut().0.iter_mut().zip(even.into_iter().zip(odd)) {
                *pair = [even.wrapping_add(start), odd.wrapping_add(start)];
            }
            match sums.first_chunk_mut() {
                Some(sums) => *sums = all,
                None => crate::memory::copy(&all, sums),
            }
        }
    }
}
