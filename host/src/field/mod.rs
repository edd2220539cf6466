//! Scalar fields on regular grids, trilinear between their samples.

mod grid;
mod interpolate;
mod scalar;

pub use grid::Grid;
pub use scalar::{FieldError, ScalarField};
