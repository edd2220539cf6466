//! Training of a predictor's weights: weighted least squares by its normal equations, in integers.

#[cfg_attr(feature = "vectors", path = "train/vector_products.rs")]
mod products;

use self::products::Columns;
use super::forecast::{FRACTION_BITS, LARGEST_SUM, LARGEST_WEIGHT, Weights};
use super::low_half;
use super::scatter::scattered;
use super::taps::{Known, KnownRows, REACH, Taps, WEIGHTS, WEST};
use crate::memory::copy;

/// Times that the weights are trained: coefficients that the last found hard to predict count less.
const ROUNDS: usize = 2;

/// Neighbouring coefficients whose equations are set up together.
const LANES: usize = BLOCK;

/// As [`LANES`].
pub(super) const BLOCK: usize = 32;

/// Differences are brought down so that the usual one has this many bits, and limited to [`LARGEST`].
const USUAL_BITS: u32 = 8;

/// Bits of the largest difference: the sum of [`LANES`] products of two does not overflow.
const LARGEST_BITS: u32 = 13;

/// The largest difference.
const LARGEST: i32 = (1 << LARGEST_BITS) - 1;

/// Bits of a difference as large as the residual is expected to be.
const NORMAL_BITS: u32 = 6;

/// Fraction bits of sizes that residuals are expected to have.
pub(super) const SIZE_BITS: u32 = 4;

/// What is added to those sizes, as fractions of the usual difference: 2^-1 at first, 2^-3 where residuals are known.
const LEAST_BITS: [u32; ROUNDS] = [1, 3];

/// Fraction bits of the factors of differences.
const FACTOR_FRACTION_BITS: u32 = 8;

/// Bits that the entries of the diagonal are brought to before the equations are solved, or one less.
const ENTRY_BITS: i32 = 30;

/// What is added to the diagonal, as a fraction: 2^-13.
const RIDGE_BITS: u32 = 13;

/// And added to it beside that: 2^10.
const RIDGE_MIN_BITS: u32 = 10;

/// Fraction bits of the factors and of the solution.
const FACTOR_BITS: i32 = 22;

/// Those of the solution beyond the weights', but one for rounding.
const EXCESS_BITS: i32 = FACTOR_BITS - FRACTION_BITS.cast_signed() - 1;

/// Neighbours, and the coefficients themselves behind them.
const ROWS: usize = WEIGHTS + 1;

/// Entries of a triangular matrix of their products.
const ENTRIES: usize = ROWS * (ROWS + 1) / 2;

/// The memory in which an encoder trains predictors, of fixed size.
#[derive(Debug, PartialEq, Eq)]
pub struct Training {
    /// Entry (r, c), c <= r, of the symmetric matrix of the normal equations, row by row; behind them their right sides.
    matrix: [i64; ENTRIES],
    /// The neighbours of some coefficients, by weight; behind those in use the coefficients themselves.
    rows: [[i16; LANES]; ROWS],
}

/// What weights are trained for: coefficients of some planes of a subband.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subject<'a> {
    pub(super) taps: &'a Taps,
    pub(super) coefficients: &'a [i32],
    /// By how many bits differences are brought down.
    shift: u32,
    /// The usual difference, in 1/2^[`SIZE_BITS`].
    usual: i32,
}

impl<'a> Subject<'a> {
    /// The usual difference is that in about so many coefficients.
    pub(super) fn new(taps: &'a Taps, coefficients: &'a [i32], lessons: usize) -> Self {
        let usual = usual_size(taps, coefficients, rows(taps, lessons));
        let shift = u64::BITS.wrapping_sub(usual.leading_zeros()).saturating_sub(USUAL_BITS);
        Self { taps, coefficients, shift, usual: i32::try_from(usual >> shift).unwrap_or(0) << SIZE_BITS }
    }

    /// By how many bits residuals are brought down.
    pub(super) const fn shift(&self) -> u32 {
        self.shift
    }

    /// What is added to the sizes that residuals are expected to have, in 1/2^[`SIZE_BITS`].
    fn least(&self, bits: u32) -> i32 {
        (self.usual >> bits).wrapping_add(1 << (SIZE_BITS - 1))
    }

    /// Weights as they are used, of those that differences were trained with.
    pub(super) fn finished(&self, trained: &Weights) -> Weights {
        let mut weights = *trained;
        if self.taps.is_low_pass() {
            recentre(self.taps, self.coefficients, &mut weights);
        }
        limit(&mut weights.0);
        weights
    }
}

/// A row, and those around it.
struct Around<'a> {
    known: KnownRows<'a>,
    row: &'a [i32],
    /// What stands before its first coefficient.
    reference: i32,
}

impl<'a> Around<'a> {
    fn new(subject: &Subject<'a>, place: [usize; 2]) -> Option<Self> {
        let known = subject.taps.known(subject.coefficients, place);
        let first = known.first().and_then(|row| row.coefficients.first().copied());
        let reference = if subject.taps.is_low_pass() { first.unwrap_or(0) } else { 0 };
        Some(Self { row: subject.taps.own_row(subject.coefficients, place)?, known, reference })
    }
}

/// Columns of a block, and those on either side that count.
type Window = [i32; LANES + 2 * REACH];

/// The columns around the block at `start` of a row, which has its first and its last coefficient again beyond its ends.
#[cfg_attr(not(feature = "small"), inline(always))]
#[cfg_attr(feature = "small", inline(never))]
fn window(row: &[i32], start: usize) -> Window {
    let from = start.checked_sub(REACH);
    if !cfg!(feature = "small")
        && let Some(window) = from.and_then(|from| row.get(from..)).and_then(|rest| rest.first_chunk())
    {
        return *window;
    }
    let (Some(&first), Some(&last)) = (row.first(), row.last()) else { return [0; _] };
    let mut window = [last; _];
    let before = REACH.saturating_sub(start);
    let (beyond, within) = window.split_at_mut_checked(before).unwrap_or_default();
    beyond.fill(first);
    copy(row.get(start.saturating_sub(REACH)..).unwrap_or(&[]), within);
    window
}

impl Training {
    /// Memory that can be the value of a `static`.
    #[cfg_attr(feature = "trained", expect(clippy::large_stack_arrays, reason = "evaluated by the compiler"))]
    pub const NEW: Self = Self { matrix: [0; ENTRIES], rows: [[0; LANES]; ROWS] };

    /// The weights that suit the coefficients of a subband, learnt from about so many of them in each round: of more from
    /// rows all over it, of a longer row from the first.
    pub(super) fn train(&mut self, taps: &Taps, coefficients: &[i32], lessons: [usize; ROUNDS]) -> Weights {
        let [.., most] = lessons;
        let subject = Subject::new(taps, coefficients, most);
        subject.finished(&self.trained(&subject, lessons))
    }

    /// The same, as they are trained, which is as weights of differences.
    pub(super) fn trained(&mut self, subject: &Subject<'_>, lessons: [usize; ROUNDS]) -> Weights {
        let [at_first, in_the_end] = lessons;
        let mut weights = Weights::ZERO;
        self.learn(subject, at_first, None, &mut weights, &|_, _| true);
        let before = weights;
        self.learn(subject, in_the_end, Some(&before), &mut weights, &|_, _| true);
        weights
    }

    /// Trains weights once more, so that coefficients which are hard to predict by those `before` count less: on about so
    /// many in rows all over the subband, of those which `counts` by the place of the row and the first column of each
    /// [`BLOCK`] of it. Where none does, all become 0: predictions are W, which suits what is flat.
    pub(super) fn learn(
        &mut self,
        subject: &Subject<'_>,
        lessons: usize,
        before: Option<&Weights>,
        weights: &mut Weights,
        counts: &dyn Fn([usize; 2], usize) -> bool,
    ) {
        let Subject { taps, .. } = subject;
        let count = taps.weights();
        let [at_first, later] = LEAST_BITS;
        let least = subject.least(if before.is_some() { later } else { at_first });
        let before = before.and_then(|weights| weights.0.get(..count));
        self.matrix.fill(0);
        for place in rows(taps, lessons) {
            let Some(around) = Around::new(subject, place) else { return };
            for start in (0..taps.row_len().min(lessons)).step_by(LANES) {
                if counts(place, start) && self.fill(subject, &around, start).is_some() {
                    self.add_block(count, least, before);
                }
            }
        }
        self.solve(weights.0.get_mut(..count).unwrap_or(&mut []));
    }

    /// Adds to `sums`, those of the blocks from the first of a row, the sizes of the residuals that each set of weights
    /// leaves.
    pub(super) fn add_residuals<const SETS: usize>(
        &mut self,
        subject: &Subject<'_>,
        place: [usize; 2],
        (first, sums): (usize, &mut [[u32; SETS]]),
        sets: &[Weights],
    ) {
        let count = subject.taps.weights();
        let Some(around) = Around::new(subject, place) else { return };
        for (start, sums) in (first..around.row.len()).step_by(BLOCK).zip(sums) {
            if self.fill(subject, &around, start).is_none() {
                return;
            }
            for (set, sum) in sets.iter().zip(sums) {
                let residuals = self.residuals(set.0.get(..count).unwrap_or(&[]));
                *sum = residuals.iter().fold(*sum, |sum, size| sum.wrapping_add(size.unsigned_abs()));
            }
        }
    }

    /// Takes the differences of the block at `start` of a row.
    fn fill(&mut self, subject: &Subject<'_>, around: &Around<'_>, start: usize) -> Option<()> {
        let Subject { taps, shift, .. } = *subject;
        let Around { known, row, reference } = around;
        let lanes = row.len().wrapping_sub(start).min(LANES);
        if lanes < LANES {
            self.rows.as_flattened_mut().fill(0);
        }
        let fill = |slots: &mut [i16; LANES], values: &[i32], reference: &[i32]| match slots.get_mut(..lanes)
        {
            Some(slots) if lanes < LANES => differences(slots, values, reference, shift),
            _ => block_of_differences(slots, values, reference, shift),
        };
        let mut own = window(row, start);
        if start == 0 {
            own.iter_mut().take(REACH).for_each(|slot| *slot = *reference);
        }
        let west = own.get(REACH - 1..)?;
        let of_west = if taps.is_low_pass() { 1 } else { 0 };
        let reference = if taps.is_low_pass() { west } else { &[] };
        fill(self.rows.get_mut(taps.weights())?, row.get(start..)?, reference);
        for (slots, step) in self.rows.iter_mut().zip(of_west..WEST) {
            fill(slots, own.get((REACH - 1).wrapping_sub(step)..)?, reference);
        }
        let low = known.iter().find(|row| row.is_low()).map_or(&[][..], |row| row.coefficients);
        for row in known {
            let window = window(row.coefficients, start);
            let window = window.get(REACH.wrapping_sub(row.reach())..)?;
            let centre = centre(known, row.deep()).and_then(|centre| centre.coefficients.get(start..));
            let reference = match centre {
                _ if row.is_low() => low.get(start..).unwrap_or(&[]),
                Some(centre) if taps.is_low_pass() => centre,
                _ => reference,
            };
            let slots = self.rows.iter_mut().skip(row.first_weight);
            for (slots, step) in slots.zip(0..row.len()) {
                fill(slots, window.get(step..)?, reference);
            }
            if taps.is_low_pass() && row.is_central(row.deep()) {
                let nearer = self::centre(known, row.deep().wrapping_add(1));
                let nearer = nearer.and_then(|nearer| nearer.coefficients.get(start..)).unwrap_or(west);
                let slots = self.rows.get_mut(row.central_weight())?;
                fill(slots, row.coefficients.get(start..)?, nearer);
            }
        }
        Some(())
    }

    /// Adds a block of coefficients, each of which counts inversely to the square of the size that its residual is expected
    /// to have. What a residual costs is how large it is beside those around it, so a few edges, or the noise of a bright
    /// part, must not outweigh everything else.
    fn add_block(&mut self, count: usize, least: i32, weights: Option<&[i16]>) {
        let sizes = match weights {
            Some(weights) => self.residuals_around(weights),
            None => self.mean_differences(count),
        };
        self.normalise(count, sizes.map(|size| size.wrapping_add(least)));
        let rows = self.rows.get(..=count).unwrap_or(&[]);
        let columns = Columns::new(rows);
        for (r, row) in rows.iter().enumerate() {
            let entries = self.matrix.get_mut(index(r, 0)..=index(r, r)).unwrap_or(&mut []);
            columns.add_products(row, entries);
        }
    }

    /// About the mean size of the differences of each coefficient, in 1/2^[`SIZE_BITS`].
    fn mean_differences(&self, count: usize) -> [i32; LANES] {
        let mut sizes = [0_i32; LANES];
        for row in self.rows.iter().take(count) {
            for (size, &difference) in sizes.iter_mut().zip(row) {
                *size = size.wrapping_add(i32::from(difference).wrapping_abs());
            }
        }
        let bits = count.checked_ilog2().unwrap_or(0);
        sizes.map(|size| size << SIZE_BITS >> bits)
    }

    /// The mean size of the residuals around each coefficient under `weights`, in 1/2^[`SIZE_BITS`].
    fn residuals_around(&self, weights: &[i16]) -> [i32; LANES] {
        let mut sizes = self.residuals(weights);
        average(sizes.iter_mut());
        average(sizes.iter_mut().rev());
        sizes
    }

    /// The sizes of the residuals under `weights`, in 1/2^[`SIZE_BITS`].
    fn residuals(&self, weights: &[i16]) -> [i32; LANES] {
        let targets = self.rows.get(weights.len()).copied().unwrap_or([0; _]);
        let mut residuals = targets.map(|target| i32::from(target) << FRACTION_BITS);
        for (row, &weight) in self.rows.iter().zip(weights) {
            // If it were not hidden, several rows would be taken at once, element by element.
            let weight = if cfg!(feature = "small") { weight } else { core::hint::black_box(weight) };
            for (residual, &difference) in residuals.iter_mut().zip(row) {
                *residual = residual.wrapping_sub(i32::from(difference).wrapping_mul(weight.into()));
            }
        }
        residuals.map(|residual| residual.wrapping_abs() >> (FRACTION_BITS - SIZE_BITS))
    }

    /// Brings the differences of each coefficient to units of its size, given in 1/2^[`SIZE_BITS`], which gets
    /// [`NORMAL_BITS`]; or only as far as none of them becomes larger than [`LARGEST`].
    fn normalise(&mut self, count: usize, sizes: [i32; LANES]) {
        const UNIT: i32 = 1 << (NORMAL_BITS + SIZE_BITS + FACTOR_FRACTION_BITS);
        let rows = self.rows.get_mut(..=count).unwrap_or(&mut []);
        let mut largest = [1_i16; LANES];
        for row in &*rows {
            for (largest, &difference) in largest.iter_mut().zip(row) {
                *largest = difference.wrapping_abs().max(*largest);
            }
        }
        let mut factors = [0_i32; LANES];
        for ((factor, size), largest) in factors.iter_mut().zip(sizes).zip(largest) {
            let least = (i32::from(largest) << SIZE_BITS >> (LARGEST_BITS - NORMAL_BITS)).wrapping_add(1);
            *factor = UNIT.checked_div(size.max(least)).unwrap_or(0);
        }
        for row in rows {
            for (difference, factor) in row.iter_mut().zip(factors) {
                let product = i32::from(*difference).wrapping_mul(factor);
                *difference =
                    low_half(product.wrapping_add(1 << (FACTOR_FRACTION_BITS - 1)) >> FACTOR_FRACTION_BITS);
            }
        }
    }

    /// Solves the leading equations for as many weights: elimination, then substitution, in fixed point.
    #[cfg_attr(
        feature = "trained",
        expect(
            clippy::large_stack_frames,
            reason = "the lint counts every copy of an iterator; the frame is far smaller"
        )
    )]
    fn solve(&mut self, weights: &mut [i16]) {
        let n = weights.len();
        let scales = self.condition(n);
        for pivot in 0..n {
            for row in pivot.wrapping_add(1)..=n {
                self.eliminate(pivot, row);
            }
        }
        let mut solution = [0_i64; WEIGHTS];
        for row in (0..n).rev() {
            let known = solution.iter().enumerate().take(n).skip(row.wrapping_add(1));
            let sum = known
                .fold(0, |sum: i64, (column, &x)| sum.wrapping_add(x.wrapping_mul(self.at(column, row))));
            let x = divided((self.at(n, row) << FACTOR_BITS).wrapping_sub(sum), self.at(row, row));
            solution.iter_mut().skip(row).take(1).for_each(|slot| *slot = x);
        }
        let of_right = scales.get(n).copied().unwrap_or(0).wrapping_add(EXCESS_BITS);
        for ((weight, x), scale) in weights.iter_mut().zip(solution).zip(scales) {
            let rounded = shifted(x, scale.wrapping_sub(of_right)).wrapping_add(1) >> 1;
            let largest = i64::from(LARGEST_WEIGHT);
            *weight = i16::try_from(rounded.clamp(largest.wrapping_neg(), largest)).unwrap_or(0);
        }
    }

    /// Adds a little to the diagonal, so that the equations have one solution, and brings all unknowns and the right sides
    /// to one scale. Returns by how many bits each was shifted.
    fn condition(&mut self, n: usize) -> [i32; ROWS] {
        let mut scales = [0_i32; ROWS];
        for (i, scale) in scales.iter_mut().enumerate().take(n.wrapping_add(1)) {
            let Some(entry) = self.matrix.get_mut(index(i, i)) else { continue };
            *entry = entry.wrapping_add(*entry >> RIDGE_BITS).wrapping_add(1 << RIDGE_MIN_BITS);
            let bits = i64::BITS.wrapping_sub(entry.leading_zeros()).cast_signed();
            *scale = ENTRY_BITS.wrapping_sub(bits).div_euclid(2);
        }
        let mut entries = self.matrix.iter_mut();
        for (r, &row_scale) in scales.iter().enumerate().take(n.wrapping_add(1)) {
            for (scale, entry) in scales.iter().take(r.wrapping_add(1)).zip(entries.by_ref()) {
                *entry = shifted(*entry, scale.wrapping_add(row_scale));
            }
        }
        scales
    }

    /// Takes the multiple of equation `pivot` from equation `row`, or from the right sides, that frees it of unknown `pivot`.
    fn eliminate(&mut self, pivot: usize, row: usize) {
        let dividend = self.at(row, pivot) << FACTOR_BITS;
        let factor = divided(dividend, self.at(pivot, pivot));
        if factor == 0 {
            return;
        }
        for column in pivot.wrapping_add(1)..=row {
            let part = factor.wrapping_mul(self.at(column, pivot)) >> FACTOR_BITS;
            if let Some(entry) = self.matrix.get_mut(index(row, column)) {
                *entry = entry.wrapping_sub(part);
            }
        }
    }

    /// Entry (`row`, `column`), `column` <= `row`.
    fn at(&self, row: usize, column: usize) -> i64 {
        self.matrix.get(index(row, column)).copied().unwrap_or(0)
    }
}

/// Where entry (`row`, `column`), `column` <= `row`, is.
const fn index(row: usize, column: usize) -> usize {
    (row.wrapping_mul(row.wrapping_add(1)) / 2).wrapping_add(column)
}

/// Sets as many `slots` to the differences of `values` from `reference`, if there is one, brought down and limited.
#[cfg_attr(not(feature = "small"), inline(always))]
#[cfg_attr(feature = "small", inline(never))]
fn differences(slots: &mut [i16], values: &[i32], reference: &[i32], shift: u32) {
    let limited = |difference: i32| low_half((difference >> shift).clamp(-LARGEST, LARGEST));
    if reference.is_empty() {
        slots.iter_mut().zip(values).for_each(|(slot, &value)| *slot = limited(value));
    } else {
        let pairs = values.iter().zip(reference);
        slots
            .iter_mut()
            .zip(pairs)
            .for_each(|(slot, (value, reference))| *slot = limited(value.wrapping_sub(*reference)));
    }
}

/// The same for a whole block.
#[inline(always)]
fn block_of_differences(slots: &mut [i16; LANES], values: &[i32], reference: &[i32], shift: u32) {
    // Of a length that is known, many are taken at once.
    match (values.first_chunk::<LANES>(), reference.first_chunk::<LANES>()) {
        (Some(values), Some(reference)) => differences(slots, values, reference, shift),
        _ => differences(slots, values, reference, shift),
    }
}

/// Makes of each size the mean of itself and of what was made of the one before.
fn average<'a>(sizes: impl Iterator<Item = &'a mut i32>) {
    let mut before = None;
    for size in sizes {
        *size = before.map_or(*size, |before| size.wrapping_add(before) >> 1);
        before = Some(*size);
    }
}

/// `value` times 2^`bits`.
const fn shifted(value: i64, bits: i32) -> i64 {
    if bits < 0 { value >> bits.unsigned_abs() } else { value << bits }
}

/// The quotient, rounded towards 0; 0 where there is none.
fn divided(dividend: i64, divisor: i64) -> i64 {
    if !cfg!(feature = "small") {
        return dividend.checked_div(divisor).unwrap_or(0);
    }
    let quotient = divided_unsigned(dividend.unsigned_abs(), divisor.unsigned_abs()).cast_signed();
    match (dividend < 0) == (divisor < 0) {
        // Of the one quotient that has no sign there is none.
        true => quotient.max(0),
        false => quotient.wrapping_neg(),
    }
}

/// The quotient, rounded down; 0 where there is none. In small builds bit by bit: in a tenth of the code.
fn divided_unsigned(mut dividend: u64, divisor: u64) -> u64 {
    if !cfg!(feature = "small") {
        return dividend.checked_div(divisor).unwrap_or(0);
    }
    let mut quotient = 0_u64;
    let Some(most) = divisor.leading_zeros().checked_sub(dividend.leading_zeros()) else { return 0 };
    for bit in (0..=most).rev().filter(|_| divisor > 0) {
        let part = divisor << bit;
        quotient <<= 1;
        if part <= dividend {
            dividend = dividend.wrapping_sub(part);
            quotient |= 1;
        }
    }
    quotient
}

/// The places of rows of about so many lessons, y and z: however few, they lie all over the subband. The top rows of planes
/// know too little to learn from, unless there is no other.
fn rows(taps: &Taps, lessons: usize) -> impl Iterator<Item = [usize; 2]> {
    all_rows(taps).take(lessons.div_ceil(taps.row_len().max(1)))
}

/// The places of all of them, in that order.
fn all_rows(taps: &Taps) -> impl Iterator<Item = [usize; 2]> {
    let ([_, height, _], planes) = (taps.subband.sides, taps.numbers());
    let first = usize::from(height > 1);
    let rows = height.wrapping_sub(first);
    let count = rows.wrapping_mul(planes.len());
    scattered(count).map(move |place| {
        let (plane, row) = (place.checked_div(rows).unwrap_or(0), place.checked_rem(rows).unwrap_or(0));
        [first.wrapping_add(row), planes.start.wrapping_add(plane)]
    })
}

/// The mean size of differences of neighbours in a row, or of coefficients in a subband of details.
fn usual_size(taps: &Taps, coefficients: &[i32], rows: impl Iterator<Item = [usize; 2]>) -> u64 {
    let (mut sum, mut count) = (0_u64, 0_u64);
    for row in rows.filter_map(|place| taps.own_row(coefficients, place)) {
        for pair in row.array_windows::<2>() {
            let [west, here] = pair;
            let size = if taps.is_low_pass() { here.wrapping_sub(*west) } else { *here };
            sum = sum.wrapping_add(size.unsigned_abs().into());
            count = count.wrapping_add(1);
        }
    }
    divided_unsigned(sum, count)
}

/// The row of plane `deep` at the same y.
fn centre<'a, 'b>(known: &'a KnownRows<'b>, deep: isize) -> Option<&'a Known<'b>> {
    known.iter().find(|row| row.is_central(deep) && deep != 0)
}

/// Makes weights of differences from W out of those they are trained as: differences of the neighbours in a plane
/// before from the centre of that plane, of the first centre from W, and of each other from the centre before.
fn recentre(taps: &Taps, coefficients: &[i32], weights: &mut Weights) {
    let [_, height, _] = taps.subband.sides;
    let place = [height / 2, taps.numbers().end.wrapping_sub(1)];
    let known = taps.known(coefficients, place);
    let trained = weights.0;
    let mut subtract = |from: Option<&Known<'_>>, weight: i16| {
        if let Some(slot) = from.and_then(|row| weights.0.get_mut(row.central_weight())) {
            *slot = slot.saturating_sub(weight);
        }
    };
    for row in &known {
        let of_row = trained.iter().enumerate().skip(row.first_weight).take(row.len());
        for (place, &weight) in of_row {
            let is_centre = row.is_central(row.deep()) && place == row.central_weight();
            subtract(centre(&known, row.deep().wrapping_add(isize::from(is_centre))), weight);
        }
    }
}

/// Brings weights down to where their sum is allowed.
fn limit(weights: &mut [i16]) {
    let sum = |weights: &[i16]| {
        weights.iter().fold(0, |sum: i32, weight| sum.wrapping_add(i32::from(weight.unsigned_abs())))
    };
    for weight in weights.iter_mut() {
        *weight = (*weight).clamp(LARGEST_WEIGHT.wrapping_neg(), LARGEST_WEIGHT);
    }
    while sum(weights) > LARGEST_SUM {
        weights.iter_mut().for_each(|weight| *weight /= 2);
    }
}

#[cfg(test)]
mod tests {
    use super::super::taps::Planes;
    use super::*;
    use crate::{Extent, Plan, Wavelet};

    fn trained(plan: &Plan, planes: Planes, samples: &[i32]) -> Weights {
        let taps = Taps::new(plan, plan.subbands(0).next().unwrap(), planes).unwrap();
        { Training::NEW }.train(&taps, samples, [1 << 13; 2])
    }

    /// Noise of -2048 to 2047.
    fn noise(seed: &mut u32) -> i32 {
        *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (*seed >> 20).cast_signed() - 2048
    }

    #[test]
    fn quotients_are_those_of_the_machine() {
        let numbers = [0, 1, 2, 3, 7, 1 << 18, (1 << 30) - 1, 1 << 47, i64::MAX - 1, i64::MAX];
        let signed = numbers.into_iter().flat_map(|number| [number, -number, !number]);
        for (a, b) in signed.clone().flat_map(|a| signed.clone().map(move |b| (a, b))) {
            assert_eq!(divided(a, b), a.checked_div(b).unwrap_or(0), "{a} / {b}");
            let (a, b) = (a.cast_unsigned(), b.cast_unsigned());
            assert_eq!(divided_unsigned(a, b), a.checked_div(b).unwrap_or(0), "{a} / {b}");
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes an hour where each access is checked")]
    fn a_linear_rule_is_found() {
        // Every sample is the mean of west and north, and noise.
        let plan = Plan::new(Wavelet::Haar, Extent::slice(64, 63).unwrap(), 0).unwrap();
        let mut samples: heapless::Vec<i32, 4032> = heapless::Vec::new();
        samples.resize(64 * 63, 0).unwrap();
        let mut seed = 1;
        for i in 65..samples.len() {
            samples[i] = (samples[i - 1] + samples[i - 64]).div_euclid(2) + noise(&mut seed);
        }
        let weights = trained(&plan, Planes::First, &samples);
        // WW, WWW, then N in the middle of seven.
        for (i, weight) in weights.0.into_iter().enumerate() {
            let expected = if i == 5 { 128 } else { 0 };
            assert!((i32::from(weight) - expected).abs() < 40, "{:?}", weights.0);
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes an hour where each access is checked")]
    fn a_noisy_half_does_not_outweigh_a_quiet_one() {
        // To the left there is but noise, to the right every sample is N and little of it.
        let plan = Plan::new(Wavelet::Haar, Extent::slice(64, 63).unwrap(), 0).unwrap();
        let mut samples: heapless::Vec<i32, 4032> = heapless::Vec::new();
        let mut seed = 1;
        samples.extend((0..64).map(|_| noise(&mut seed) / 16));
        for i in 64..4032 {
            let noise = noise(&mut seed);
            samples.push(if i % 64 < 32 { noise / 2 } else { samples[i - 64] + noise / 64 }).unwrap();
        }
        let weights = trained(&plan, Planes::First, &samples);
        // N, NN and NNN; of noise alone, it would be the mean of all that is known.
        let of_quiet: i16 = [5, 11, 15].iter().filter_map(|&at| weights.0.get::<usize>(at)).sum();
        assert!(of_quiet > 180, "{:?}", weights.0);
    }

    #[test]
    fn sizes_are_spread() {
        let mut sizes = [8, 0, 16, 0];
        average(sizes.iter_mut());
        assert_eq!(sizes, [8, 4, 10, 5]);
        average(sizes.iter_mut().rev());
        assert_eq!(sizes, [6, 5, 7, 5]);
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes an hour where each access is checked")]
    fn planes_far_apart_do_not_hide_what_they_share() {
        // The last plane is the one before and 100,000, up to noise.
        let plan = Plan::new(Wavelet::Haar, Extent::brick(32, 32, 2).unwrap(), 0).unwrap();
        let mut samples: heapless::Vec<i32, 2048> = heapless::Vec::new();
        samples.resize(2048, 0).unwrap();
        let mut seed = 1;
        for i in 0..1024 {
            samples[i] = noise(&mut seed);
            samples[i + 1024] = samples[i] + 100_000 + noise(&mut seed) / 64;
        }
        let weights = trained(&plan, Planes::Others, &samples);
        let subband = plan.subbands(0).next().unwrap();
        let taps = Taps::new(&plan, subband, Planes::Others).unwrap();
        let known = taps.known(&samples, [16, 1]);
        let up = known.iter().find(|row| row.is_central(-1)).unwrap().central_weight();
        assert!(weights.0[up] > 200, "{:?}", weights.0);
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes an hour where each access is checked")]
    fn extremes_do_not_panic() {
        let plan = Plan::new(Wavelet::Haar, Extent::brick(4, 4, 4).unwrap(), 0).unwrap();
        let samples: [i32; 64] = core::array::from_fn(|i| if i % 3 == 0 { i32::MIN } else { i32::MAX });
        for planes in [Planes::First, Planes::Others] {
            let weights = trained(&plan, planes, &samples).0;
            assert!(weights.iter().map(|weight| i32::from(weight.abs())).sum::<i32>() <= LARGEST_SUM);
        }
    }
}
