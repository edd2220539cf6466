//! The row of samples that comes out of a decoder: its halves, where the transform along x leaves them.

use super::plan::{Layout, RowPlan};
use crate::lifting::Halves;
use crate::memory::copy;

/// A row of samples, those at even and at odd places; without a transform all of them are in the first half.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outgoing<'a> {
    even: &'a [i32],
    odd: &'a [i32],
}

impl<'a> Outgoing<'a> {
    /// The row that is in memory.
    pub(super) fn new(plan: &RowPlan, layout: Layout, memory: &'a mut [i32]) -> Self {
        let Layout { scratch, low_row, .. } = layout;
        let width = plan.width_at(0);
        if plan.levels() == 0 {
            let even = memory.get(low_row..low_row.saturating_add(width)).unwrap_or_default();
            return Self { even, odd: &[] };
        }
        let scratch = memory.get_mut(..scratch).unwrap_or_default();
        let (even, odd) = Halves::new(scratch, 1, width, 1).into_line();
        Self { even, odd }
    }

    /// Puts a row of coefficients there, its transform along x undone.
    pub(super) fn put(plan: &RowPlan, layout: Layout, row: usize, memory: &mut [i32]) {
        let Some((scratch, rest)) = memory.split_at_mut_checked(layout.scratch) else { return };
        let (start, width) = (row.saturating_sub(layout.scratch), plan.width_at(0));
        let row = rest.get(start..start.saturating_add(width)).unwrap_or_default();
        let mut halves = Halves::new(scratch, 1, width, 1);
        for (low, high) in halves.groups() {
            copy(row, low);
            copy(row.get(low.len()..).unwrap_or_default(), high);
        }
        if width > 1 {
            plan.wavelet().inverse(&mut halves);
        }
    }

    /// Whether all of its samples are of the type.
    pub(super) fn is_inside(&self, plan: &RowPlan) -> bool {
        let sample_type = plan.sample_type();
        [self.even, self.odd].into_iter().all(|half| sample_type.first_outside(half).is_none())
    }

    /// Copies the samples from place `first` on.
    pub(super) fn give(&self, first: usize, output: &mut [i32]) {
        for (x, sample) in (first..).zip(output) {
            let place = match (self.odd, x % 2) {
                ([], _) => self.even.get(x),
                (_, 0) => self.even.get(x / 2),
                _ => self.odd.get(x / 2),
            };
            *sample = place.copied().unwrap_or_default();
        }
    }
}
