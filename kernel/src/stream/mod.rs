//! Slices whose rows arrive one after another, and volumes whose slices do.
//!
//! A [`RowEncoder`] takes the samples of a slice row by row, their number not known before, and gives the bytes of a
//! stream as they become known; a [`RowDecoder`] takes the bytes and gives the samples. Both hold the few rows that
//! each lifting step needs, in lent memory. The coefficients are those of the transform of the whole slice.
//! The format is in `docs/stream.md`.

mod bands;
mod chunks;
mod codec;
mod decoder;
mod encoder;
mod error;
mod fronts;
mod header;
mod inverse;
mod outgoing;
mod plan;
mod schedule;
mod shelf;
mod slabs;
mod spread;
#[cfg(test)]
mod total;

pub use codec::RowCodec;
pub use decoder::RowDecoder;
pub use encoder::RowEncoder;
pub use error::RowError;
pub use plan::RowPlan;
pub use slabs::{SlabDecoder, SlabEncoder, SlabMemory, SlabPlan};

/// The chance that another row follows, in 1/65536.
const MORE: u32 = 0xFFFF;

/// What a call of `step` did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub struct Step {
    /// Elements of the input that were taken.
    pub consumed: usize,
    /// Elements of the output that were written.
    pub produced: usize,
    /// What is needed to go on.
    pub status: Status,
}

/// What is needed to go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Status {
    /// More input, or word that there is none: all of it is taken.
    NeedInput,
    /// More room for output: all of it is full.
    NeedOutput,
    /// Nothing: the stream is complete.
    Done,
}
