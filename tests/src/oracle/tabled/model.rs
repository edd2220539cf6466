//! Weights and frequencies, as they are written.

use super::bits::{BitReader, BitWriter};
use super::form::{Breadth, Form};
use super::token::{TOKENS, rank_of_value, value_of_rank};
use crate::oracle::coder::Reject;

/// How many tables there are.
pub const CLASSES: usize = 14;

/// The largest scale.
const LARGEST_SCALE: u32 = 16;

/// What celled frequencies stay below before they are brought to [`SUM`].
const SUM_LIMIT: i64 = 1 << 16;

/// What the frequencies of a class sum up to.
pub(super) const SUM: i64 = 4096;

/// What a codestream says before its residuals.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Model {
    /// By how many bits energies are shifted, if celled.
    pub scale: u32,
    /// A set for each of [`Form::sets`]; in a celled slice, up to eight of its one kind.
    pub weights: Vec<Vec<i64>>,
    /// The set of each cell, if a slice has several.
    pub labels: Vec<usize>,
    /// The frequencies of each class as they are written.
    pub tables: Vec<Vec<i64>>,
}

impl Model {
    /// Weights alone, with a scale of 0.
    pub const fn new(weights: Vec<Vec<i64>>) -> Self {
        Self { scale: 0, weights, labels: Vec::new(), tables: Vec::new() }
    }

    pub(super) fn read(bits: &mut BitReader<'_>, form: Form) -> Result<Self, Reject> {
        let scale = if form.breadth == Breadth::Celled { bits.bits(5)? as u32 } else { 0 };
        if scale > LARGEST_SCALE {
            return Err(Reject::Segment);
        }
        let count = if form.has_cells() { 1 + bits.bits(3)? as usize } else { 1 };
        let sets = form.sets().repeat(count).into_iter();
        let weights = sets.map(|set| read_set(bits, set, form.breadth.largest_sum()));
        let weights = weights.collect::<Result<_, _>>()?;
        let labels = if count > 1 { form.cells() } else { 0 };
        let labels = (0..labels).map(|_| read_label(bits, count)).collect::<Result<_, _>>()?;
        let tables = (0..CLASSES).map(|_| read_table(bits, form.breadth)).collect::<Result<_, _>>()?;
        Ok(Self { scale, weights, labels, tables })
    }

    /// Its bits under a form, whatever it says.
    pub fn write(&self, form: Form) -> BitWriter {
        let mut bits = BitWriter::default();
        if form.breadth == Breadth::Celled {
            bits.bits(5, self.scale.into());
        }
        if form.has_cells() {
            bits.bits(3, self.weights.len() as i64 - 1);
        }
        self.weights.iter().flatten().for_each(|&weight| bits.bits(12, weight));
        self.labels.iter().for_each(|&label| bits.bits(label_bits(self.weights.len()), label as i64));
        self.tables.iter().for_each(|table| write_table(&mut bits, table, form.breadth));
        bits
    }

    /// The frequencies of each class as they are used.
    pub(super) fn effective_tables(&self) -> Vec<Vec<i64>> {
        self.tables.iter().map(|table| effective(table)).collect()
    }
}

/// The bits that hold the largest number of a set.
const fn label_bits(sets: usize) -> u32 {
    usize::BITS - (sets - 1).leading_zeros()
}

fn read_label(bits: &mut BitReader<'_>, sets: usize) -> Result<usize, Reject> {
    let label = bits.bits(label_bits(sets))? as usize;
    if label < sets { Ok(label) } else { Err(Reject::Segment) }
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

/// How many bits of a frequency of that size, the lowest, are zero and not written.
fn unwritten_bits(size: u32, breadth: Breadth) -> u32 {
    if breadth == Breadth::Celled { size.saturating_sub(4) } else { 0 }
}

fn read_table(bits: &mut BitReader<'_>, breadth: Breadth) -> Result<Vec<i64>, Reject> {
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
            1..=13 => {
                let unwritten = unwritten_bits(size as u32, breadth);
                (1 << (size - 1)) + (bits.bits(size as u32 - 1 - unwritten)? << unwritten)
            }
            _ => return Err(Reject::Segment),
        });
    }
    let sum: i64 = frequencies.iter().sum();
    let is_sum = if breadth == Breadth::Celled { sum < SUM_LIMIT } else { sum == SUM };
    let sound = frequencies.last().is_none_or(|&last| last > 0 && is_sum);
    if sound { Ok(frequencies) } else { Err(Reject::Segment) }
}

fn write_table(bits: &mut BitWriter, frequencies: &[i64], breadth: Breadth) {
    bits.bits(6, frequencies.len() as i64);
    let mut before = 12;
    for &f in frequencies {
        let size = f.checked_ilog2().map_or(0, |log2| log2 + 1);
        for _ in 0..rank_of_value(i64::from(size) - before) {
            bits.bits(1, 1);
        }
        bits.bits(1, 0);
        let unwritten = unwritten_bits(size, breadth);
        bits.bits(size.saturating_sub(1) - unwritten, f >> unwritten);
        before = i64::from(size);
    }
}

/// The frequencies of a class, of which there may be none, brought to their sum.
fn effective(table: &[i64]) -> Vec<i64> {
    if table.is_empty() {
        return vec![SUM];
    }
    let mut frequencies = table.to_vec();
    loop {
        let missing = SUM - frequencies.iter().sum::<i64>();
        // The last of those that are.
        let largest = frequencies.iter_mut().max().expect("there are some");
        *largest += missing.max(-(*largest / 2));
        if missing >= 0 {
            return frequencies;
        }
    }
}

/// Frequencies in proportion to counts, none of what does occur 0; the most frequent token takes what rounding leaves.
/// Celled ones are rounded to the nearest that can be written.
pub(super) fn frequencies(counts: &[i64], breadth: Breadth) -> Vec<i64> {
    let all: i64 = counts.iter().sum();
    if all == 0 {
        return Vec::new();
    }
    let last = counts.iter().rposition(|&count| count > 0).expect("there are some");
    let share = |&count: &i64| if count > 0 { (count * SUM / all).max(1) } else { 0 };
    let mut frequencies: Vec<i64> = counts[..=last].iter().map(share).collect();
    let most = (0..=last).max_by_key(|&token| counts[token]).expect("there are some");
    frequencies[most] += SUM - frequencies.iter().sum::<i64>();
    frequencies.into_iter().map(|f| writable(f, breadth)).collect()
}

/// The nearest frequency that can be written.
fn writable(f: i64, breadth: Breadth) -> i64 {
    let size = f.checked_ilog2().map_or(0, |log2| log2 + 1);
    let step = 1 << unwritten_bits(size, breadth);
    (f + step / 2) / step * step
}
