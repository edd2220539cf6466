#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![deny(
    missing_docs,
    clippy::alloc_instead_of_core,
    clippy::arithmetic_side_effects,
    clippy::as_conversions,
    clippy::expect_used,
    clippy::float_arithmetic,
    clippy::indexing_slicing,
    clippy::large_stack_arrays,
    clippy::large_stack_frames,
    clippy::large_types_passed_by_value,
    clippy::missing_errors_doc,
    clippy::missing_panics_doc,
    clippy::panic,
    clippy::std_instead_of_core,
    clippy::string_slice,
    clippy::unreachable,
    clippy::unwrap_used
)]
#![cfg_attr(
    test,
    expect(
        clippy::arithmetic_side_effects,
        clippy::indexing_slicing,
        clippy::unwrap_used,
        reason = "a test may fail by panicking"
    )
)]

mod coder;
pub mod codestream;
mod error;
mod extent;
mod feature;
#[cfg(feature = "embedded-io")]
pub mod io;
pub mod lifting;
mod memory;
pub mod metric;
#[cfg(feature = "stream")]
mod packed;
#[cfg(feature = "serde")]
pub mod record;
mod sample;
pub mod stencil;
#[cfg(feature = "slabs")]
pub mod stream;
#[cfg(test)]
mod total;
pub mod transform;

pub use coder::{Dense, Lattice, Training, bits};
pub use codestream::{Codec, Effort, Header, Near, max_encoded_len};
pub use error::{
    AdjacencyError, DecodeError, EncodeError, LengthError, LiftError, Malformed, PlanError, Slice,
};
pub use extent::Extent;
pub use feature::Feature;
pub use lifting::Wavelet;
pub use sample::SampleType;
pub use transform::Plan;
