//! The inverse transform, level by level, as coefficients become known.

use super::bands::lift;
use super::fronts::{Fronts, Passes};
use super::outgoing::Outgoing;
use super::plan::{Layout, RowPlan};
use super::schedule::{LEVELS, Schedule};
use super::shelf::Shelf;
use crate::lifting::Direction;
use crate::packed::Packed;

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
    /// The places of the pair that waits first, and how many do.
    first: [u32; 2],
    waiting: u32,
}

impl Level {
    /// Where a row is that the transform along y works on; the newest d lay before the pair that waits first.
    fn row(&self, shelf: &Shelf, row: i16) -> Packed {
        let half = |row: i16| usize::from(row.unsigned_abs() / 2);
        if row % 2 == 0 {
            return shelf.c(half(row));
        }
        let [d, _] = self.first;
        let newer = half(self.fronts.received()).wrapping_sub(half(row));
        shelf.d(d, newer)
    }
}

impl Inverse {
    pub(super) fn new(plan: &RowPlan) -> Self {
        let passes = Passes::new(plan.wavelet(), Direction::Inverse);
        let level = Level { fronts: Fronts::new(passes), first: [0; 2], waiting: 0 };
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

    /// Coefficients that are on their way, in 32nds of a row of samples, of up to four levels.
    #[cfg(test)]
    pub(super) fn on_the_way(&self, levels: u8) -> usize {
        let of_level = |level: u8| {
            let Level { fronts, waiting, .. } = self.levels[usize::from(level)];
            let rows = 32 * usize::try_from(fronts.inside()).unwrap();
            (rows + 48 * crate::extent::to_usize(waiting)) >> level
        };
        let low = if self.has_low { 32 >> levels } else { 0 };
        (0..levels).map(of_level).sum::<usize>() + low
    }

    /// The places of the next pair that will wait on a level, counted on beyond the last.
    pub(super) fn next_waiting(&self, level: u8) -> [u32; 2] {
        let level = self.levels.get(usize::from(level));
        level.map_or([0; 2], |level| level.first.map(|first| first.wrapping_add(level.waiting)))
    }

    /// Brings the next row of samples out, if enough is known. `None` if a number takes more bits than any that samples of
    /// the type make.
    pub(super) fn pull(
        &mut self,
        plan: &RowPlan,
        layout: Layout,
        schedule: &Schedule,
        memory: &mut [i32],
    ) -> Option<bool> {
        if plan.levels() == 0 {
            return Some(core::mem::take(&mut self.has_low));
        }
        let mut level = 0_u8;
        loop {
            let coarser = level.wrapping_add(1);
            if let Some(row) = self.next_row((plan, layout), level, schedule, memory)? {
                Outgoing::put(plan, layout, (row, level), memory);
                let Some(finer) = level.checked_sub(1) else { return Some(true) };
                let low_part = self.assemble((plan, layout), finer, schedule, memory)?;
                Outgoing::move_to(plan, layout, (low_part, level), memory)?;
                level = finer;
            } else if coarser < plan.levels() {
                level = coarser;
            } else if core::mem::take(&mut self.has_low) {
                let low_part = self.assemble((plan, layout), level, schedule, memory)?;
                Packed::words(layout.low_row).copy_to(low_part, plan.width_at(coarser), memory)?;
            } else {
                return Some(false);
            }
        }
    }

    /// Makes what changes can be made on a level, and returns its next row that is complete along y, if there is one.
    /// `None` as for [`Inverse::pull`].
    fn next_row(
        &mut self,
        (plan, layout): (&RowPlan, Layout),
        level: u8,
        schedule: &Schedule,
        memory: &mut [i32],
    ) -> Option<Option<Packed>> {
        let passes = self.passes;
        // Where the shelf is takes longer to find than that there is nothing to do.
        let shelf = || plan.shelf_at(layout, level);
        let forward = schedule.fronts(level)?;
        let level = self.levels.get_mut(usize::from(level))?;
        loop {
            while let Some(change) = level.fronts.advance(passes) {
                let shelf = shelf();
                let place = |row| level.row(&shelf, row);
                lift(plan.wavelet(), Direction::Inverse, (change, shelf.width()), place, memory)?;
            }
            if let Some(row) = level.fronts.take(passes) {
                return Some(Some(level.row(&shelf(), row)));
            }
            if level.fronts.is_ended() || level.waiting > 0 || !forward.is_exhausted() {
                return Some(None);
            }
            level.fronts.end();
        }
    }

    /// Puts the next pair of a level together, of which the low-pass part has come, and returns where that belongs.
    fn assemble(
        &mut self,
        (plan, layout): (&RowPlan, Layout),
        level: u8,
        schedule: &Schedule,
        memory: &mut [i32],
    ) -> Option<Packed> {
        let shelf = plan.shelf_at(layout, level);
        let forward = schedule.fronts(level)?;
        let Level { fronts, first, waiting } = self.levels.get_mut(usize::from(level))?;
        let is_single = *waiting == 1 && forward.is_exhausted() && forward.is_odd();
        let places = *first;
        let c = fronts.receive();
        if !is_single {
            fronts.receive();
            *first = shelf.next(*first);
        }
        *waiting = waiting.saturating_sub(1);
        shelf.assemble(places, usize::from(c.unsigned_abs() / 2), memory)
    }
}
