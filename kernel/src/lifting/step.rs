//! Lifting steps, and transforms made of them.

use core::num::Wrapping;

#[cfg(feature = "stream")]
use super::Direction;
#[cfg(feature = "stream")]
use super::halves::each;
use super::halves::{Beyond, Halves};

type Sample = Wrapping<i32>;

/// A transform of the halves of a line: a lifting step, or several in turn.
pub(crate) trait Lifting: Sized {
    /// Changes `halves` (n >= 2 samples a line).
    fn forward(&self, halves: &mut Halves<'_>);

    /// Undoes [`Lifting::forward`].
    fn inverse(&self, halves: &mut Halves<'_>);

    /// Lifting steps.
    #[cfg(feature = "stream")]
    const STEPS: usize;

    /// Applies or undoes one step on one coefficient of each of many lines: on a row across them.
    ///
    /// `beside` are the rows of the other kind that the step reads: d_{i-1}, d_i, d_{i+1}, or c_i, c_{i+1}, and any.
    #[cfg(feature = "stream")]
    fn lift_row(&self, step: usize, direction: Direction, row: &mut [i32], beside: [&[i32]; 3]);

    /// This, and then `next`.
    fn then<L: Lifting>(self, next: L) -> Then<Self, L> {
        Then(self, next)
    }
}

/// s-lift: c_i <- c_i + term(d_{i-1}, d_i), reflected at the ends.
pub(super) fn low<F: Fn(Sample, Sample) -> Sample>(term: F) -> Low<F> {
    Low(term)
}

/// c_i <- c_i + term(d_{i-1}, d_i, d_{i+1}), with zeros beyond the ends.
pub(super) fn zero_ended_low<F: Fn(Sample, Sample, Sample) -> Sample>(term: F) -> ZeroEndedLow<F> {
    ZeroEndedLow(term)
}

/// w-lift: d_i <- d_i + term(c_i, c_{i+1}), reflected at the ends.
pub(super) fn high<F: Fn(Sample, Sample) -> Sample>(term: F) -> High<F> {
    High(term)
}

/// d_i <- term(c_i, c_{i+1}) - d_i, reflected at the ends: its own inverse.
pub(super) fn flipped_high<F: Fn(Sample, Sample) -> Sample>(term: F) -> FlippedHigh<F> {
    FlippedHigh(term)
}

#[derive(Clone, Copy)]
pub(crate) struct Then<A, B>(A, B);
#[derive(Clone, Copy)]
pub(super) struct Low<F>(F);
#[derive(Clone, Copy)]
pub(super) struct ZeroEndedLow<F>(F);
#[derive(Clone, Copy)]
pub(super) struct High<F>(F);
#[derive(Clone, Copy)]
pub(super) struct FlippedHigh<F>(F);

impl<A: Lifting, B: Lifting> Lifting for Then<A, B> {
    fn forward(&self, halves: &mut Halves<'_>) {
        self.0.forward(halves);
        self.1.forward(halves);
    }

    fn inverse(&self, halves: &mut Halves<'_>) {
        self.1.inverse(halves);
        self.0.inverse(halves);
    }

    #[cfg(feature = "stream")]
    const STEPS: usize = A::STEPS.wrapping_add(B::STEPS);

    #[cfg(feature = "stream")]
    fn lift_row(&self, step: usize, direction: Direction, row: &mut [i32], beside: [&[i32]; 3]) {
        match step.checked_sub(A::STEPS) {
            None => self.0.lift_row(step, direction, row, beside),
            Some(step) => self.1.lift_row(step, direction, row, beside),
        }
    }
}

/// Forward, a step adds its term; its inverse subtracts it.
const ADD: Sample = Wrapping(1);
const SUBTRACT: Sample = Wrapping(-1);

impl<F: Fn(Sample, Sample) -> Sample> Low<F> {
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn lift(&self, sign: Sample, halves: &mut Halves<'_>) {
        halves.each_low(Beyond::Nearest, |c, [left, d, _]| c + sign * self.0(left, d));
    }
}

impl<F: Fn(Sample, Sample) -> Sample> Lifting for Low<F> {
    fn forward(&self, halves: &mut Halves<'_>) {
        self.lift(ADD, halves);
    }

    fn inverse(&self, halves: &mut Halves<'_>) {
        self.lift(SUBTRACT, halves);
    }

    #[cfg(feature = "stream")]
    const STEPS: usize = 1;

    #[cfg(feature = "stream")]
    fn lift_row(&self, _: usize, direction: Direction, row: &mut [i32], beside: [&[i32]; 3]) {
        match direction {
            Direction::Forward => each(row, beside, |c, [left, d, _]| c + self.0(left, d)),
            Direction::Inverse => each(row, beside, |c, [left, d, _]| c - self.0(left, d)),
        }
    }
}

impl<F: Fn(Sample, Sample, Sample) -> Sample> ZeroEndedLow<F> {
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn lift(&self, sign: Sample, halves: &mut Halves<'_>) {
        halves.each_low(Beyond::Zero, |c, [left, d, right]| c + sign * self.0(left, d, right));
    }
}

impl<F: Fn(Sample, Sample, Sample) -> Sample> Lifting for ZeroEndedLow<F> {
    fn forward(&self, halves: &mut Halves<'_>) {
        self.lift(ADD, halves);
    }

    fn inverse(&self, halves: &mut Halves<'_>) {
        self.lift(SUBTRACT, halves);
    }

    #[cfg(feature = "stream")]
    const STEPS: usize = 1;

    #[cfg(feature = "stream")]
    fn lift_row(&self, _: usize, direction: Direction, row: &mut [i32], beside: [&[i32]; 3]) {
        match direction {
            Direction::Forward => each(row, beside, |c, [left, d, right]| c + self.0(left, d, right)),
            Direction::Inverse => each(row, beside, |c, [left, d, right]| c - self.0(left, d, right)),
        }
    }
}

impl<F: Fn(Sample, Sample) -> Sample> High<F> {
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn lift(&self, sign: Sample, halves: &mut Halves<'_>) {
        halves.each_high(|d, [c, next]| d + sign * self.0(c, next));
    }
}

impl<F: Fn(Sample, Sample) -> Sample> Lifting for High<F> {
    fn forward(&self, halves: &mut Halves<'_>) {
        self.lift(ADD, halves);
    }

    fn inverse(&self, halves: &mut Halves<'_>) {
        self.lift(SUBTRACT, halves);
    }

    #[cfg(feature = "stream")]
    const STEPS: usize = 1;

    #[cfg(feature = "stream")]
    fn lift_row(&self, _: usize, direction: Direction, row: &mut [i32], beside: [&[i32]; 3]) {
        match direction {
            Direction::Forward => each(row, beside, |d, [c, next, _]| d + self.0(c, next)),
            Direction::Inverse => each(row, beside, |d, [c, next, _]| d - self.0(c, next)),
        }
    }
}

impl<F: Fn(Sample, Sample) -> Sample> Lifting for FlippedHigh<F> {
    fn forward(&self, halves: &mut Halves<'_>) {
        halves.each_high(|d, [c, next]| self.0(c, next) - d);
    }

    fn inverse(&self, halves: &mut Halves<'_>) {
        self.forward(halves);
    }

    #[cfg(feature = "stream")]
    const STEPS: usize = 1;

    #[cfg(feature = "stream")]
    fn lift_row(&self, _: usize, _: Direction, row: &mut [i32], beside: [&[i32]; 3]) {
        each(row, beside, |d, [c, next, _]| self.0(c, next) - d);
    }
}
