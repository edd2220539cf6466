//! Slices whose rows arrive one after another, and volumes whose slices do.
//!
//! A [`RowEncoder`] takes the samples of a slice row by row, their number not known before, and gives the bytes of a
//! stream as they become known; a [`RowDecoder`] takes the bytes and gives the samples. Both hold the few rows that
//! each lifting step needs, in lent memory. The coefficients are those of the transform of the whole slice.
//! A [`SlabEncoder`] and a [`SlabDecoder`] do the same slice by slice, in memory for the few that are a slab, with any
//! effort but the dense one.
//! The format is in `docs/stream.md`.

mod error;
mod header;
#[cfg(feature = "stream")]
mod rows;
mod slabs;
#[cfg(all(test, feature = "stream"))]
mod total;

pub use error::RowError;
#[cfg(feature = "stream")]
pub use rows::{RowCodec, RowDecoder, RowEncoder, RowPlan};
pub use slabs::{SlabDecoder, SlabEncoder, SlabMemory, SlabPlan};

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
