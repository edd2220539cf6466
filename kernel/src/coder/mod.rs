//! The adaptive binary arithmetic coder and what it codes: coefficients, one subband after another.
//!
//! Encoder and decoder run the *same* description of the codestream, [`scan`] and [`symbol`], over a
//! [`BinaryCoder`]: the encoder is given each decision and returns it, the decoder ignores what it is given and
//! returns what it reads. The two directions cannot drift apart.

mod choose;
mod context;
mod decoder;
mod encoder;
mod history;
mod model;
mod predict;
mod rows;
mod scan;
mod symbol;
mod train;
mod weights;

pub(crate) use decoder::Decoder;
pub(crate) use encoder::Encoder;
pub(crate) use history::history_len;
pub(crate) use predict::Predictor;
pub(crate) use scan::Coefficients;
pub(crate) use symbol::Models;
pub(crate) use train::Equations;
pub(crate) use weights::{IN_PLANE, LARGEST_WEIGHT, WEIGHTS, Weights};

pub(crate) use model::Probability;

/// One direction of the arithmetic coder.
pub(crate) trait BinaryCoder {
    /// Codes one decision under an adaptive probability, and adapts it.
    fn decide(&mut self, bit: bool, probability: &mut Probability) -> bool;

    /// Codes the `count` (at most 32) low bits of `bits` as they are, half a chance each.
    fn raw(&mut self, bits: u32, count: u32) -> u32;
}

/// The `count` (at most 32) low bits set.
#[inline(always)]
const fn low_bits(count: u32) -> u32 {
    match u32::MAX.checked_shl(count) {
        Some(high) => !high,
        None => u32::MAX,
    }
}
