//! Weights and frequencies, as they are written.

use super::bits::{BitReader, BitWriter};
use super::form::Form;
use super::token::{TOKENS, rank_of_value, value_of_rank};
use crate::oracle::coder::Reject;

/// How many tables there are.
pub const CLASSES: usize = 14;

/// What the frequencies of a class sum up to.
pub(super) const SUM: i64 = 4096;

/// What a codestream says before its residuals.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Model {
    /// A set for each of [`Form::sets`].
    pub weights: Vec<Vec<i64>>,
    /// The frequencies of each class.
    pub tables: Vec<Vec<i64>>,
}

impl Model {
    pub(super) fn read(bits: &mut BitReader<'_>, form: Form) -> Result<Self, Reject> {
        let weights = form.sets().into_iter().map(|count| read_set(bits, count, form.breadth.largest_sum()));
        let weights = weights.collect::<Result<_, _>>()?;
        let tables = (0..CLASSES).map(|_| read_table(bits)).collect::<Result<_, _>>()?;
        Ok(Self { weights, tables })
    }

    /// Its bits, whatever it says.
    pub fn write(&self) -> BitWriter {
        let mut bits = BitWriter::default();
        self.weights.iter().flatten().for_each(|&weight| bits.bits(12, weight));
        self.tables.iter().for_each(|table| write_table(&mut bits, table));
        bits
    }
}

fn read_set(bits: &mut BitReader<'_>, count: usize, largest_sum: i64) -> Result<Vec<i64>, Reject> {
    let mut weights = Vec::new();
    for _ in 0..count {
        let low = bits.bits(12)?;
        weights.push(if low < 2048 { low } else { low - 4096 });
    }
    if weights.iter().map(|weight| weight.abs()).sum::<i64>() > largest_sum {
        return Err(Reject::Segment);
    }
    Ok(weights)
}

fn read_table(bits: &mut BitReader<'_>) -> Result<Vec<i64>, Reject> {
    let count = bits.bits(6)? as usize;
    if count > TOKENS {
        return Err(Reject::Segment);
    }
    let (mut size, mut frequencies) = (12, Vec::new());
    for _ in 0..count {
        let mut ones = 0;
        while bits.bits(1)? == 1 {
            ones += 1;
        }
        size += value_of_rank(ones);
        frequencies.push(match size {
            0 => 0,
            1..=13 => (1 << (size - 1)) + bits.bits(size as u32 - 1)?,
            _ => return Err(Reject::Segment),
        });
    }
    let sound = frequencies.last().is_none_or(|&last| last > 0 && frequencies.iter().sum::<i64>() == SUM);
    if sound { Ok(frequencies) } else { Err(Reject::Segment) }
}

fn write_table(bits: &mut BitWriter, frequencies: &[i64]) {
    bits.bits(6, frequencies.len() as i64);
    let mut before = 12;
    for &f in frequencies {
        let size = f.checked_ilog2().map_or(0, |log2| log2 + 1);
        for _ in 0..rank_of_value(i64::from(size) - before) {
            bits.bits(1, 1);
        }
        bits.bits(1, 0);
        bits.bits(size.saturating_sub(1), f);
        before = i64::from(size);
    }
}

/// The frequencies of a class, of which there may be none.
pub(super) fn effective(table: &[i64]) -> &[i64] {
    if table.is_empty() { &[SUM] } else { table }
}

/// Frequencies in proportion to counts, none of what does occur 0; the most frequent token takes what rounding leaves.
pub(super) fn frequencies(counts: &[i64]) -> Vec<i64> {
    let all: i64 = counts.iter().sum();
    if all == 0 {
        return Vec::new();
    }
    let last = counts.iter().rposition(|&count| count > 0).expect("there are some");
    let share = |&count: &i64| if count > 0 { (count * SUM / all).max(1) } else { 0 };
    let mut frequencies: Vec<i64> = counts[..=last].iter().map(share).collect();
    let most = (0..=last).max_by_key(|&token| counts[token]).expect("there are some");
    frequencies[most] += SUM - frequencies.iter().sum::<i64>();
    frequencies
}
