//! Training of the predictor's weights: least squares by its normal equations, in integers.

use super::rows::RowsBefore;
use super::weights::{Differences, FRACTION_BITS, IN_PLANE, WEIGHTS, Weights};
use crate::transform::{Plan, Subband};

/// Entries of the equations on and below their diagonal, and their right-hand sides.
const ENTRIES: usize = WEIGHTS * (WEIGHTS + 1) / 2 + WEIGHTS;

/// Samples that are trained on, about; of larger low-pass parts only every so many rows.
const SAMPLES: usize = 1 << 15;

/// The normal equations of the weights: row i holds the entries up to the diagonal, then the right-hand side.
///
/// Differences beyond 16 bits are scaled down together. Each sample counts inversely to the mean size of its
/// differences, so that edges do not outweigh everything else.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Training {
    entries: [i64; ENTRIES],
}
