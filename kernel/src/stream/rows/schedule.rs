//! The order in which rows of coefficients are coded: each pair of rows of a level as soon as it is known, then what it
//! makes known on the next level.

use super::fronts::{Change, Fronts, Passes};
use super::header::MAX_LEVELS;
use super::plan::RowPlan;
use crate::lifting::Direction;

/// Levels, as a length.
pub(super) const LEVELS: usize = {
    #[expect(clippy::as_conversions, reason = "lossless; From is not const")]
    let levels = MAX_LEVELS as usize;
    levels
};

/// Where the forward transform stands, level by level.
#[derive(Debug)]
pub(super) struct Schedule {
    passes: Passes,
    levels: u8,
    fronts: [Fronts; LEVELS],
    /// The level that is looked at.
    level: u8,
}

/// What comes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// A row of a level is changed by a step.
    Change(u8, Change),
    /// A pair of rows of a level is known.
    Pair(Pair),
    /// The next row of samples is wanted.
    Row,
    /// All coefficients are known, and coded.
    Done,
}

/// A pair of rows of a level: c_i and, unless it is the last of an odd number, d_i.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pair {
    pub(super) level: u8,
    pub(super) c: i16,
    pub(super) d: Option<i16>,
}

impl Schedule {
    pub(super) fn new(plan: &RowPlan) -> Self {
        let passes = Passes::new(plan.wavelet(), Direction::Forward);
        Self { passes, levels: plan.levels(), fronts: [Fronts::new(passes); LEVELS], level: 0 }
    }

    /// A row arrives at a level, which is looked at from then on: its number.
    pub(super) fn receive(&mut self, level: u8) -> i16 {
        self.level = level;
        self.fronts.get_mut(usize::from(level)).map_or(0, Fronts::receive)
    }

    /// There are no more rows of samples.
    pub(super) fn end(&mut self) {
        self.fronts.first_mut().into_iter().for_each(Fronts::end);
    }

    /// How far a level is.
    pub(super) fn fronts(&self, level: u8) -> Option<&Fronts> {
        self.fronts.get(usize::from(level))
    }

    /// What comes next.
    pub(super) fn next(&mut self) -> Event {
        let (passes, levels) = (self.passes, self.levels);
        loop {
            let level = self.level;
            let Some(front) = self.fronts.get_mut(usize::from(level)) else { return Event::Done };
            if levels == 0 {
                return if front.is_ended() { Event::Done } else { Event::Row };
            }
            if let Some(change) = front.advance(passes) {
                return Event::Change(level, change);
            }
            if let Some((c, d)) = front.take_pair(passes) {
                return Event::Pair(Pair { level, c, d });
            }
            if !front.is_ended() {
                let Some(finer) = level.checked_sub(1) else { return Event::Row };
                self.level = finer;
                continue;
            }
            let coarser = level.wrapping_add(1);
            if coarser >= levels {
                return Event::Done;
            }
            self.level = coarser;
            self.fronts.get_mut(usize::from(coarser)).into_iter().for_each(Fronts::end);
        }
    }
}
