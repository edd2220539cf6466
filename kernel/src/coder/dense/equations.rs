//! Least squares that adapts as coding goes: normal equations over decaying windows, solved after every chunk.

use crate::coder::{low_half, low_word};

/// Differences that a prediction is made of; zeros stand behind those of a smaller neighbourhood.
pub(super) const TAPS: usize = 24;

/// Differences that equations are set up for, at most.
const UNKNOWNS: usize = 19;

/// Samples that are gathered before the equations see them, at most.
pub(in crate::coder) const CHUNK: usize = 64;

/// Fraction bits of weights.
pub(in crate::coder) const WEIGHT_BITS: u32 = 12;

/// Bits of a sample's largest difference as it is predicted from.
pub(super) const SCALED_BITS: u32 = 14;

/// Bits of the same in the equations.
const OBSERVED_BITS: u32 = 8;

/// The largest target in the equations.
const LARGEST_TARGET: i32 = 1 << 9;

/// Entries of the symmetric matrix: (r, c), c <= r, row after row.
const ENTRIES: usize = UNKNOWNS * (UNKNOWNS + 1) / 2;

/// What is added to the diagonal of the equations.
const RIDGE: i32 = 1 << 12;

/// The same, as a part of the diagonal: 2^-12.
const RIDGE_BITS: u32 = 12;

/// Bits that sums are brought to before the equations are solved.
const ENTRY_BITS: u32 = 30;

/// Fraction bits of factors and of solutions.
const FACTOR_BITS: u32 = 16;

/// Fraction bits of the pivots' inverses.
const INVERSE_BITS: u32 = 46;

/// The largest weight, just below 8.
const LARGEST_WEIGHT: i32 = (8 << FACTOR_BITS) - 64;

/// The weights of a prediction.
pub(in crate::coder) type Weights = [i16; TAPS];

/// The differences of a chunk of samples, and what they were to predict, of few bits.
#[derive(Debug, PartialEq, Eq)]
pub(in crate::coder) struct Chunk {
    differences: [[i16; CHUNK]; UNKNOWNS],
    targets: [i16; CHUNK],
    len: usize,
    /// Whether anything in it is not zero.
    tells: bool,
}

impl Chunk {
    #[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
    pub(in crate::coder) const NEW: Self =
        Self { differences: [[0; CHUNK]; UNKNOWNS], targets: [0; CHUNK], len: 0, tells: false };

    /// Samples gathered.
    pub(super) const fn len(&self) -> usize {
        self.len
    }

    /// Whether there is anything to learn from.
    pub(super) const fn tells(&self) -> bool {
        self.tells
    }

    /// Forgets the samples.
    pub(super) fn clear(&mut self) {
        (self.len, self.tells) = (0, false);
    }

    /// Takes one sample more, at most [`CHUNK`] in all: its differences of [`SCALED_BITS`] bits, and its own.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn push(&mut self, differences: &[i16; TAPS], target: i32) {
        const DOWN: u32 = SCALED_BITS - OBSERVED_BITS;
        const HALF: i16 = 1 << (DOWN - 1);
        let place = self.len & (CHUNK - 1);
        let mut reduced = *differences;
        for difference in &mut reduced {
            *difference = difference.wrapping_add(HALF) >> DOWN;
        }
        for (row, difference) in self.differences.iter_mut().zip(&reduced) {
            if let Some(slot) = row.get_mut(place) {
                *slot = *difference;
            }
        }
        let target = target.wrapping_add(HALF.into()) >> DOWN;
        let target = low_half(target.clamp(-LARGEST_TARGET, LARGEST_TARGET));
        if let Some(slot) = self.targets.get_mut(place) {
            *slot = target;
        }
        let [nearest, ..] = reduced;
        self.tells |= target | nearest != 0;
        self.len = self.len.wrapping_add(1);
    }

    /// Takes `len` samples at once, in place of all others: `fill` makes their differences of each of `sources` in turn,
    /// and what these were to predict of the last.
    pub(in crate::coder) fn load<S>(
        &mut self,
        len: usize,
        sources: impl Iterator<Item = S>,
        fill: impl Fn(&mut [i16], S),
    ) {
        let mut sources = sources.peekable();
        let mut rows = self.differences.iter_mut();
        while let Some(source) = sources.next() {
            let row = if sources.peek().is_some() { rows.next() } else { Some(&mut self.targets) };
            fill(row.and_then(|row| row.get_mut(..len)).unwrap_or(&mut []), source);
        }
        self.len = len;
    }

    /// The products of the first `taps` differences with one another and with the target, summed up; forgets them.
    pub(super) fn products(&mut self, taps: usize) -> Sums {
        for row in self.differences.iter_mut().chain([&mut self.targets]) {
            row.get_mut(self.len..).unwrap_or(&mut []).fill(0);
        }
        let mut sums = Sums::ZERO;
        let mut entries = sums.matrix.iter_mut();
        let rows = self.differences.iter().zip(&mut sums.right).take(taps);
        for (last, (row, right)) in rows.enumerate() {
            let columns = self.differences.iter().take(last.wrapping_add(1));
            for (column, entry) in columns.zip(&mut entries) {
                *entry = dot(row, column);
            }
            *right = dot(row, &self.targets);
        }
        self.clear();
        sums
    }

    /// Adds the same to `sums`; in small builds with more code and in half the time.
    pub(in crate::coder) fn add_products(&mut self, taps: usize, sums: &mut Sums) {
        if !cfg!(feature = "small") {
            return sums.renew(&self.products(taps), 0);
        }
        let padded = self.len.next_multiple_of(RUN);
        for row in self.differences.iter_mut().take(taps).chain([&mut self.targets]) {
            row.get_mut(self.len..padded).unwrap_or(&mut []).fill(0);
        }
        let mut entries = sums.matrix.iter_mut();
        for (last, row) in self.differences.iter().enumerate().take(taps) {
            self.add_dots(row, (&mut entries).take(last.wrapping_add(1)));
        }
        self.add_dots(&self.targets, sums.right.iter_mut().take(taps));
        self.clear();
    }

    /// Adds the products of a row with as many of the differences as there are sums.
    fn add_dots<'a>(&self, row: &[i16; CHUNK], mut sums: impl Iterator<Item = &'a mut i32>) {
        let runs = self.len.div_ceil(RUN);
        for columns in self.differences.chunks(COLUMNS) {
            let dots = dots(row, columns, runs);
            for dot in dots {
                let Some(sum) = sums.next() else { return };
                *sum = sum.wrapping_add(dot);
            }
        }
    }
}

/// Elements that small builds multiply in a run.
const RUN: usize = 4;

/// Columns that they multiply with a row at once.
const COLUMNS: usize = 3;

#[cfg_attr(not(feature = "small"), inline(always))]
fn dot(a: &[i16; CHUNK], b: &[i16; CHUNK]) -> i32 {
    a.iter().zip(b).fold(0, |sum, (&a, &b)| sum.wrapping_add(product(a, b)))
}

/// The products of the first runs of a row with those of up to three columns, and with itself where there are fewer.
fn dots(row: &[i16; CHUNK], columns: &[[i16; CHUNK]], runs: usize) -> [i32; COLUMNS] {
    let column = |number| columns.get(number).unwrap_or(row).as_chunks::<RUN>().0;
    let runs = row.as_chunks::<RUN>().0.iter().zip(column(0)).zip(column(1)).zip(column(2)).take(runs);
    runs.fold([0; COLUMNS], |[a, b, c], (((&row, first), second), third)| {
        [add_run(a, row, first), add_run(b, row, second), add_run(c, row, third)]
    })
}

#[inline(always)]
fn add_run(sum: i32, [a, b, c, d]: [i16; RUN], &[p, q, r, s]: &[i16; RUN]) -> i32 {
    let sum = sum.wrapping_add(product(a, p)).wrapping_add(product(b, q));
    sum.wrapping_add(product(c, r)).wrapping_add(product(d, s))
}

#[inline(always)]
fn product(a: i16, b: i16) -> i32 {
    i32::from(a).wrapping_mul(b.into())
}

/// What the weights make of the differences, in 1/2^[`WEIGHT_BITS`].
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn predict(weights: &Weights, differences: &[i16; TAPS]) -> i32 {
    let products = weights.iter().zip(differences).map(|(&w, &d)| i32::from(w).wrapping_mul(d.into()));
    products.fold(0, i32::wrapping_add)
}

/// Sums of products: the matrix of normal equations, and their right-hand sides.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::coder) struct Sums {
    matrix: [i32; ENTRIES],
    right: [i32; UNKNOWNS],
}

impl Sums {
    pub(in crate::coder) const ZERO: Self = Self { matrix: [0; ENTRIES], right: [0; UNKNOWNS] };

    /// Makes `self` equal to [`Sums::ZERO`].
    pub(in crate::coder) fn clear(&mut self) {
        self.matrix.fill(0);
        self.right.fill(0);
    }

    /// Forgets `decay` 256ths, and adds `new`.
    pub(in crate::coder) fn renew(&mut self, new: &Self, decay: i32) {
        self.combine(new, |sum, new| sum.wrapping_sub((sum >> 8).wrapping_mul(decay)).wrapping_add(new));
    }

    /// Adds `quarters` quarters of `other`.
    pub(super) fn add(&mut self, other: &Self, quarters: i32) {
        self.combine(other, |sum, other| sum.wrapping_add((other >> 2).wrapping_mul(quarters)));
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn combine(&mut self, other: &Self, combined: impl Fn(i32, i32) -> i32) {
        for (sum, other) in self.matrix.iter_mut().zip(&other.matrix) {
            *sum = combined(*sum, *other);
        }
        for (sum, other) in self.right.iter_mut().zip(&other.right) {
            *sum = combined(*sum, *other);
        }
    }

    /// Solves the first `unknowns` equations by their factors L D L^T; the right-hand sides are one row more.
    ///
    /// `None` never happens: the sizes agree.
    pub(in crate::coder) fn solve(&self, unknowns: usize, weights: &mut Weights) -> Option<()> {
        let mut all = 0;
        for (n, right) in self.right.iter().enumerate().take(unknowns) {
            let (_, diagonal) = self.row(n)?;
            all |= diagonal.unsigned_abs() | right.unsigned_abs();
        }
        let scaled = scale(all);
        let mut factors = Factors::ZERO;
        for n in 0..unknowns {
            let (row, diagonal) = self.row(n)?;
            let below = factors.eliminate(n, row, &scaled)?;
            let pivot = scaled(diagonal).wrapping_sub(below);
            *factors.inverses.get_mut(n)? = (1_i64 << INVERSE_BITS).checked_div(pivot.max(1).into())?;
        }
        factors.eliminate(unknowns, &self.right, &scaled)?;
        factors.substitute(unknowns, weights)
    }

    /// The entries of row `n` left of the diagonal, and that on it with the ridge added.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn row(&self, n: usize) -> Option<(&[i32], i32)> {
        let next = n.wrapping_add(1);
        let start = n.wrapping_mul(next) >> 1;
        let (&sum, row) = self.matrix.get(start..start.wrapping_add(next))?.split_last()?;
        Some((row, sum.saturating_add(sum >> RIDGE_BITS).saturating_add(RIDGE)))
    }
}

/// Brings entries, of which the largest has the leading one of `all`, to [`ENTRY_BITS`] bits.
fn scale(all: u32) -> impl Fn(i32) -> i32 {
    const SPARE: u32 = u32::BITS - ENTRY_BITS;
    let (up, down) = (all.leading_zeros().saturating_sub(SPARE), SPARE.saturating_sub(all.leading_zeros()));
    move |entry| entry << up >> down
}

/// L without its diagonal of ones, in 1/2^[`FACTOR_BITS`], and the inverses of D.
struct Factors {
    rows: [[i32; UNKNOWNS]; UNKNOWNS + 1],
    inverses: [i64; UNKNOWNS],
}

impl Factors {
    #[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
    const ZERO: Self = Self { rows: [[0; UNKNOWNS]; UNKNOWNS + 1], inverses: [0; UNKNOWNS] };

    /// Finds row `n` from its entries left of the diagonal, and what the rows above take from the diagonal itself.
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn eliminate(&mut self, n: usize, entries: &[i32], scaled: &impl Fn(i32) -> i32) -> Option<i32> {
        let (known, rest) = self.rows.split_at_mut_checked(n)?;
        let row = rest.first_mut()?;
        // L D
        let mut parts = [0; UNKNOWNS];
        let columns = known.iter().zip(&self.inverses).zip(entries);
        for (column, ((factors, inverse), entry)) in columns.enumerate() {
            let taken = products(parts.get(..column)?, factors.get(..column)?);
            let part = scaled(*entry).wrapping_sub(taken);
            *parts.get_mut(column)? = part;
            let factor = i64::from(part).wrapping_mul(*inverse) >> (INVERSE_BITS - FACTOR_BITS);
            *row.get_mut(column)? = low_word(factor.clamp(-LARGEST_FACTOR, LARGEST_FACTOR));
        }
        Some(products(parts.get(..n)?, row.get(..n)?))
    }

    /// The weights, from the last to the first.
    fn substitute(&self, unknowns: usize, weights: &mut Weights) -> Option<()> {
        const DOWN: u32 = FACTOR_BITS - WEIGHT_BITS;
        let mut solution = *self.rows.get(unknowns)?;
        for (n, row) in self.rows.iter().enumerate().take(unknowns).rev() {
            let weight = (*solution.get(n)?).clamp(-LARGEST_WEIGHT, LARGEST_WEIGHT);
            for (other, factor) in solution.iter_mut().zip(row).take(n) {
                let part = i64::from(*factor).wrapping_mul(weight.into()) >> FACTOR_BITS;
                *other = other.wrapping_sub(low_word(part));
            }
            *weights.get_mut(n)? = low_half(weight.wrapping_add(1 << (DOWN - 1)) >> DOWN);
        }
        Some(())
    }
}

/// The largest factor.
const LARGEST_FACTOR: i64 = (1 << 31) - 1;

/// The sum of the products of parts and factors.
#[cfg_attr(not(feature = "small"), inline(always))]
fn products(parts: &[i32], factors: &[i32]) -> i32 {
    let products = parts.iter().zip(factors).map(|(&p, &f)| i64::from(p).wrapping_mul(f.into()));
    low_word(products.fold(0, i64::wrapping_add) >> FACTOR_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_that_made_the_samples_are_found() {
        let mut seed = 1_u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            low_half((seed >> 19).cast_signed()) - 4096
        };
        let (mut sums, mut chunk) = (Sums::ZERO, Chunk::NEW);
        for _ in 0..16 {
            for _ in 0..CHUNK {
                let mut differences = [0; TAPS];
                differences[..4].fill_with(&mut next);
                let [a, b, c, _] = *differences.first_chunk().unwrap();
                chunk.push(&differences, i32::from(a) / 2 + i32::from(b) / 4 - i32::from(c) / 8);
            }
            assert_eq!(chunk.len(), CHUNK);
            sums.renew(&chunk.products(4), 2);
        }
        let mut weights = [0; TAPS];
        sums.solve(4, &mut weights).unwrap();
        let exact = [1 << 11, 1 << 10, -1 << 9, 0];
        assert!(weights.iter().zip(exact).all(|(weight, exact): (&i16, i16)| (weight - exact).abs() < 64));
    }

    #[test]
    fn products_are_summed_up() {
        for (len, taps) in [(CHUNK, UNKNOWNS), (30, 12), (1, 4), (7, 5)] {
            let (mut chunk, mut sums) = (Chunk::NEW, Sums::ZERO);
            // What is there from before does not count.
            chunk.differences.as_flattened_mut().fill(77);
            chunk.load(len, 1..=UNKNOWNS + 1, |slots, row| {
                for (slot, column) in slots.iter_mut().zip(1..) {
                    *slot = i16::try_from(row * column * 37 % 509).unwrap() - 254;
                }
            });
            let (rows, targets) = (chunk.differences, chunk.targets);
            let dot = |a: &[i16; CHUNK], b: &[i16; CHUNK]| -> i32 {
                a.iter().zip(b).take(len).map(|(&a, &b)| i32::from(a) * i32::from(b)).sum()
            };
            chunk.add_products(taps, &mut sums);
            for row in 0..taps {
                assert_eq!(sums.right[row], dot(&rows[row], &targets));
                for column in 0..=row {
                    assert_eq!(sums.matrix[row * (row + 1) / 2 + column], dot(&rows[row], &rows[column]));
                }
            }
            assert!(sums.right[taps..].iter().all(|&sum| sum == 0));
        }
    }

    #[test]
    fn equations_of_anything_are_solved() {
        for extreme in [i32::MIN, i32::MAX, -1, 0] {
            let sums = Sums { matrix: [extreme; ENTRIES], right: [extreme; UNKNOWNS] };
            for unknowns in [2, 17, UNKNOWNS] {
                assert_eq!(sums.solve(unknowns, &mut [0; TAPS]), Some(()));
            }
        }
    }
}
