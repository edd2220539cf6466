//! Error bounds: floating-point samples as integers on a scale, and the certainty that no sample moves further.
//!
//! A sample x is written as X = round(x / unit), an `i32`; whatever codes the integers may return any X' with
//! |X - X'| <= slack; x' = X' * unit, in double precision, rounded once to the type of the sample. A [`Scale`] is
//! unit and slack, chosen so that |x - x'| <= E follows from the integers alone. That is an expectation, not the
//! promise: the promise is kept by [`Scale::exceptions`], which compares every sample with what a decoder will make
//! of it, in exact arithmetic, and keeps the bits of each that is not within the bound. So NaNs, infinities, negative
//! zeros and values beyond the scale come back bit for bit.
//!
//! Samples that are multiples of some number already (integers and decimals kept as floats) get a scale of that
//! number, see [`Scale::natural`].

mod deviation;
mod error;
mod exceptions;
mod profile;
mod real;
mod scale;
mod tolerance;

pub use deviation::{Deviation, range};
pub use error::BoundError;
pub use exceptions::{Exceptions, Run};
pub use profile::Profile;
pub use real::{Real, extend_bytes, samples_of};
pub use scale::Scale;
pub use tolerance::{Bound, FiniteRange, Tolerance};
