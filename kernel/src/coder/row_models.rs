//! The adaptive distributions of rows of a stream.

use super::Coder;
use super::context::{Class, LARGE_CLASSES, SMALL_CLASSES};
use super::distribution::Distribution;
use super::priors;
use super::residual::{ESCAPES, code_small, code_step};

/// As [`Models`](super::Models), but for predictions that are always integers, and without weights.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct RowModels {
    small: [Distribution; SMALL_CLASSES],
    large: [Distribution; LARGE_CLASSES],
    exponents: [Distribution; ESCAPES],
}

impl RowModels {
    #[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
    pub(crate) const NEW: Self =
        Self { small: SMALL, large: [priors::LARGE; LARGE_CLASSES], exponents: priors::EXPONENTS };

    /// Makes `self` equal to [`RowModels::NEW`].
    pub(crate) fn reset(&mut self) {
        self.small = SMALL;
        self.large.fill(priors::LARGE);
        self.exponents = priors::EXPONENTS;
    }

    /// Codes one residual.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn code<C: Coder>(&mut self, coder: &mut C, energy: i32, residual: i32) -> i32 {
        let [small_exponents, large_exponents] = &mut self.exponents;
        match Class::of(energy) {
            Class::Small(class) => {
                let Some(distribution) = self.small.get_mut(class) else { return 0 };
                code_small(coder, distribution, small_exponents, residual)
            }
            Class::Large { class, step_bits } => {
                let Some(distribution) = self.large.get_mut(class) else { return 0 };
                code_step(coder, distribution, large_exponents, residual, step_bits)
            }
        }
    }
}

/// What is expected where predictions are integers.
const SMALL: [Distribution; SMALL_CLASSES] = {
    let [[a, ..], [b, ..], [c, ..], [d, ..], [e, ..], [f, ..], [g, ..], [h, ..], [i, ..], [j, ..]] =
        priors::SMALL;
    [a, b, c, d, e, f, g, h, i, j]
};
