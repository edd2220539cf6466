//! The row that comes out of a level of a decoder: its halves, where the transform along x leaves them.

use super::plan::{Layout, RowPlan};
use crate::lifting::Halves;
use crate::packed::{Packed, ROUND};

/// A row, its samples at even and at odd places; without a transform all of them are in the first half.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outgoing<'a> {
    even: &'a [i32],
    odd: &'a [i32],
}

impl<'a> Outgoing<'a> {
    /// The row of samples that is in memory.
    pub(super) fn new(plan: &RowPlan, layout: Layout, memory: &'a mut [i32]) -> Self {
        let Layout { scratch, low_row, .. } = layout;
        let width = plan.width_at(0);
        if plan.levels() == 0 {
            let even = memory.get(low_row..low_row.saturating_add(width)).unwrap_or_default();
            return Self { even, odd: &[] };
        }
        Self::halves(width, memory.get_mut(..scratch).unwrap_or_default())
    }

    fn halves(width: usize, scratch: &'a mut [i32]) -> Self {
        let (even, odd) = Halves::new(scratch, 1, width, 1).into_line();
        Self { even, odd }
    }

    /// Puts a row of coefficients of a level there, its transform along x undone.
    pub(super) fn put(plan: &RowPlan, layout: Layout, (row, level): (Packed, u8), memory: &mut [i32]) {
        let Some((scratch, rest)) = memory.split_at_mut_checked(layout.scratch) else { return };
        let (row, width) = (row.after(layout.scratch), plan.width_at(level));
        let mut halves = Halves::new(scratch, 1, width, 1);
        for (low, high) in halves.groups() {
            row.load(rest, low);
            row.skip(low.len()).load(rest, high);
        }
        if width > 1 {
            plan.wavelet().inverse(&mut halves);
        }
    }

    /// Moves the row of a level from there to `to`; `None` if a number takes more bits than there are for it.
    pub(super) fn move_to(
        plan: &RowPlan,
        layout: Layout,
        (to, level): (Packed, u8),
        memory: &mut [i32],
    ) -> Option<()> {
        let (scratch, rest) = memory.split_at_mut_checked(layout.scratch)?;
        let (to, width) = (to.after(layout.scratch), plan.width_at(level));
        let row = Outgoing::halves(width, scratch);
        (0..width).step_by(ROUND).try_for_each(|x| {
            let mut samples = [0; ROUND];
            let samples = samples.get_mut(..width.wrapping_sub(x).min(ROUND))?;
            row.give(x, samples);
            to.skip(x).store(rest, samples)
        })
    }

    /// Whether all of its samples are of the type.
    pub(super) fn is_inside(&self, plan: &RowPlan) -> bool {
        let sample_type = plan.sample_type();
        [self.even, self.odd].into_iter().all(|half| sample_type.first_outside(half).is_none())
    }

    /// Copies the samples from place `first` on.
    pub(super) fn give(&self, first: usize, output: &mut [i32]) {
        for (x, sample) in (first..).zip(output) {
            *sample = self.get(x).unwrap_or_default();
        }
    }

    /// The sample in a place.
    fn get(&self, x: usize) -> Option<i32> {
        let place = match (self.odd, x % 2) {
            ([], _) => self.even.get(x),
            (_, 0) => self.even.get(x / 2),
            _ => self.odd.get(x / 2),
        };
        place.copied()
    }
}
