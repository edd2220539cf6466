//! Transforms of lines, slices and bricks, in place.
//!
//! Each level transforms along x, then y, then z (only axes longer than one sample); the next level works on the
//! low-pass part, ceil(n/2) along each axis. The result is in Mallat order: along each axis the low half first.

mod lift;
mod plan;
mod row;
mod subband;

pub use plan::Plan;
#[cfg(feature = "stream")]
pub(crate) use plan::row_scratch_len;
pub(crate) use subband::Level;
pub use subband::Subband;
