//! The adaptive arithmetic coder and what it codes: coefficients, one subband after another.
//!
//! Encoder and decoder run the *same* description of the codestream, [`scan`] and [`residual`], over a [`Coder`]: the
//! encoder is given each symbol and returns it, the decoder ignores what it is given and returns what it reads. The
//! two directions cannot drift apart.

pub mod bits;
mod choose;
mod context;
mod decoder;
mod dense;
mod distribution;
mod encoder;
mod energy;
mod forecast;
mod history;
mod lattice;
mod light;
mod memory;
mod mixing;
mod predictor;
mod priors;
mod rank;
mod residual;
#[cfg(feature = "stream")]
mod row;
#[cfg(feature = "stream")]
mod row_models;
mod scan;
mod scatter;
pub(crate) mod tabled;
mod taps;
mod train;
mod weightless;

pub(crate) use decoder::Decoder;
#[cfg(feature = "stream")]
pub(crate) use decoder::{Suspended, WINDOW};
pub use dense::Dense;
pub(crate) use encoder::Encoder;
#[cfg(feature = "stream")]
pub(crate) use encoder::{Interval, Sink};
pub use lattice::Lattice;
pub(crate) use lattice::{Grid, LARGEST_SLACK, Precision, SHRINKING};
pub(crate) use light::Band;
pub(crate) use memory::Memory;
pub(crate) use predictor::Predictor;
pub(crate) use residual::Models;
#[cfg(feature = "stream")]
pub(crate) use row::{Above, Cursor, MOST_BYTES, Row};
#[cfg(feature = "stream")]
pub(crate) use row_models::RowModels;
pub(crate) use scan::{Coefficients, scratch_len};
pub use train::Training;
pub(crate) use weightless::Fixed;

pub(crate) use distribution::Distribution;

/// One direction of the arithmetic coder.
pub(crate) trait Coder {
    /// Codes one symbol under an adaptive distribution, and adapts it.
    fn symbol(&mut self, symbol: usize, distribution: &mut Distribution) -> usize;

    /// Codes one decision under the chance of true, 1 to 65535 in 1/65536.
    fn decide(&mut self, bit: bool, chance: u32) -> bool;

    /// Codes the `count` (at most 32) low bits of `bits` as they are, half a chance each.
    fn raw(&mut self, bits: u32, count: u32) -> u32;
}

/// The coder as the description of the codestream takes it: itself, so that each direction is compiled for speed, or in
/// small builds one code for both.
#[cfg(not(feature = "small"))]
pub(crate) const fn described<C: Coder>(coder: &mut C) -> &mut C {
    coder
}

/// The coder as the description of the codestream takes it: one code for both directions.
#[cfg(feature = "small")]
pub(crate) fn described<'a>(coder: &'a mut impl Coder) -> &'a mut (dyn Coder + 'a) {
    coder
}

/// The part of an interval that stands for true under `chance`: neither nothing nor all of it.
#[cfg_attr(not(feature = "small"), inline(always))]
const fn share_of_true(range: u32, chance: u32) -> u32 {
    (range >> 16).wrapping_mul(chance).wrapping_add((range & 0xFFFF).wrapping_mul(chance) >> 16)
}

/// The `count` (at most 32) low bits set.
#[inline(always)]
const fn low_bits(count: u32) -> u32 {
    match u32::MAX.checked_shl(count) {
        Some(high) => !high,
        None => u32::MAX,
    }
}

/// The low 32 bits.
#[inline(always)]
const fn low_word(value: i64) -> i32 {
    let [a, b, c, d, ..] = value.to_le_bytes();
    i32::from_le_bytes([a, b, c, d])
}

/// The low 16 bits.
#[inline(always)]
const fn low_half(value: i32) -> i16 {
    let [a, b, ..] = value.to_le_bytes();
    i16::from_le_bytes([a, b])
}

/// The smallest and the largest sample.
fn range(samples: &[i32]) -> (i32, i32) {
    let first = samples.first().copied().unwrap_or(0);
    samples
        .iter()
        .fold((first, first), |(lowest, highest), &sample| (lowest.min(sample), highest.max(sample)))
}
