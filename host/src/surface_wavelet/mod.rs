//! B-spline wavelets on surfaces with subdivision connectivity: generalized lifting at any valence, with sharp edges,
//! sharp vertices and boundaries.
//!
//! Source: Vis2000 §3, Diss §4.1.2–4.1.4.

mod basis;
mod integer;
mod lift;
mod norms;
mod selection;
mod transform;

pub use basis::{Basis, Kind, Lift};
pub use norms::Norms;
pub use selection::keep_largest;
pub use transform::{forward, forward_step, inverse, inverse_step, inverse_to_level};

pub mod lossless {
    //! The same wavelets on integer coordinates, without loss.
    pub use super::integer::{IntegerLift, Ratio, forward, inverse, inverse_to_level, lifts, unit_of};
}

#[cfg(test)]
mod tests;
