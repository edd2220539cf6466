//! The inverse transform, level by level, as coefficients become known.

use super::bands::{Place, lift_row};
use super::fronts::{Fronts, Passes};
use super::outgoing::Outgoing;
use super::plan::{Role, RowPlan};
use super::schedule::{LEVELS, Schedule};
use crate::lifting::Direction;

/// Where the inverse transform stands.
#[derive(Debug)]
pub(super) struct Inverse {
    passes: Passes,
    levels: [Level; LEVELS],
    /// Whether a row of the low-pass part is there to be used.
    has_low: bool,
}

/// One level: the rows of its pairs that are put together, and its details that wait.
#[derive(Clone, Copy, Debug)]
struct Level {
    fronts: Fronts,
    /// The place of the pair that waits first, and how many do.
    first: u32,
    waiting: u32,
}

impl Inverse {
    pub(super) fn new(plan: &RowPlan) -> Self {
        let passes = Passes::new(plan.wavelet(), Direction::Inverse);
        let level = Level { fronts: Fronts::new(passes), first: 0, waiting: 0 };
        Self { passes, levels: [level; LEVELS], has_low: false }
    }

    /// A row of the low-pass part has come.
    pub(super) const fn receive(&mut self) {
        self.has_low = true;
    }

    /// The details of a pair of a level have come.
    pub(super) fn wait(&mut self, level: u8) {
        if let Some(level) = self.levels.get_mut(usize::from(level)) {
            level.waiting = level.waiting.saturating_add(1);
        }
    }

    /// Pairs that wait on a level.
    #[cfg(test)]
    pub(super) fn waiting(&self, level: u8) -> usize {
        crate::extent::to_usize(self.levels[usize::from(level)].waiting)
    }

    /// The place of the next pair that will wait on a level, counted on beyond the last.
    pub(super) fn next_waiting(&self, level: u8) -> u32 {
        let level = self.levels.get(usize::from(level));
        level.map_or(0, |level| level.first.wrapping_add(level.waiting))
    }

    /// Brings the next row of samples out, if enough is known.
    pub(super) fn pull(&mut self, plan: &RowPlan, schedule: &Schedule, memory: &mut [i32]) -> bool {
        let layout = plan.layout(Role::Decoder);
        if plan.levels() == 0 {
            return core::mem::take(&mut self.has_low);
        }
        let mut level = 0;
        loop {
            let place = Place::new(plan, Role::Decoder, level);
            let Some(row) = self.next_row(level, place, schedule, memory) else {
                let coarser = level.wrapping_add(1);
                if coarser < plan.levels() {
                    level = coarser;
                    continue;
                }
                if !core::mem::take(&mut self.has_low) {
                    return false;
                }
                self.assemble(level, layout.low_row, plan, schedule, memory);
                continue;
            };
            let Some(finer) = level.checked_sub(1) else {
                Outgoing::put(plan, layout, row, memory);
                return true;
            };
            self.assemble(finer, row, plan, schedule, memory);
            level = finer;
        }
    }

    /// Makes what changes can be made on a level, and returns where its next row begins that is complete along y.
    fn next_row(
        &mut self,
        level: u8,
        place: Place,
        schedule: &Schedule,
        memory: &mut [i32],
    ) -> Option<usize> {
        let forward = schedule.fronts(level)?;
        let Level { fronts, waiting, .. } = self.levels.get_mut(usize::from(level))?;
        loop {
            while let Some(change) = fronts.advance(self.passes) {
                place.change(Direction::Inverse, change, memory);
            }
            if let Some(row) = fronts.take(self.passes) {
                return Some(place.row(row));
            }
            if fronts.is_ended() || *waiting > 0 || !forward.is_exhausted() {
                return None;
            }
            fronts.end();
        }
    }

    /// Puts the next pair of a level together, of which the low-pass part has come, and undoes the transform of that
    /// along x.
    fn assemble(
        &mut self,
        level: u8,
        low_pass: usize,
        plan: &RowPlan,
        schedule: &Schedule,
        memory: &mut [i32],
    ) {
        let Some(Level { fronts, first, waiting }) = self.levels.get_mut(usize::from(level)) else { return };
        let place = Place::new(plan, Role::Decoder, level);
        let is_single = *waiting == 1
            && schedule.fronts(level).is_some_and(|forward| forward.is_exhausted() && forward.is_odd());
        let c = fronts.receive();
        let d = if is_single { None } else { Some(fronts.receive()) };
        place.assemble(low_pass, place.waiting(*first), (c, d), memory);
        (*first, *waiting) = (place.next_waiting(*first), waiting.saturating_sub(1));
        if level.wrapping_add(1) < plan.levels() {
            let row = (place.row(c), place.low());
            lift_row(plan, Direction::Inverse, plan.layout(Role::Decoder).scratch, row, memory);
        }
    }
}
