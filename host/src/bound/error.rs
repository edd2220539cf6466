//! What can be wrong with an error bound.

/// Why a number is no error bound.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BoundError {
    /// Not a number.
    #[error("the error bound is not a number")]
    NotANumber,
    /// Zero or less.
    #[error("an error bound of {0} is not possible: give one above 0, or none to keep every bit")]
    NotPositive(f64),
    /// A part of the range that is all of it, or more.
    #[error(
        "an error bound of {0} times the range leaves nothing: give a part of it, such as 0.01 for a hundredth"
    )]
    NoPart(f64),
    /// Infinite.
    #[error("the error bound is infinite")]
    Infinite,
}
