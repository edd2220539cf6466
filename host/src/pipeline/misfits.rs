//! Components that wrapping does not fit are placed by way of the collapses, where that is much better.

use super::fit::{Aim, MISSED, Measured, RMS};
use crate::mesh::{Point, PolygonMesh};
use crate::simplify::History;
use crate::wrap::{Settling, Wrapped};

/// Much better is what leaves less than this of what distances are too large by.
const WORTH: f64 = 0.7;

/// The components of a surface that do not fit.
pub(super) struct Misfits {
    /// The component of the target that each vertex belongs to.
    ones: Vec<u32>,
    /// Bounds on root mean squares and on all distances, in cells' edges.
    limits: [f64; 2],
    /// By how many times each component is too far off.
    before: Vec<f64>,
    /// Whether the component of each vertex is.
    misfits: Vec<bool>,
}

impl Misfits {
    /// Looks for them, by distances in units of so many cells' edges; none if all components fit.
    pub(super) fn new(
        aim: &Aim,
        surface: &PolygonMesh,
        history: &History,
        measured: &Measured,
        unit: f64,
    ) -> Option<Self> {
        let ones = aim.components_of(surface, history);
        let limits = [RMS, MISSED].map(|limit| limit * unit);
        let before = aim.excesses(&ones, measured, limits);
        let misfits: Vec<bool> = ones.iter().map(|&one| before[one as usize] > 1.0).collect();
        misfits.contains(&true).then_some(Self { ones, limits, before, misfits })
    }

    /// Puts those that become much better where `places` say; the measures of what comes of it.
    pub(super) fn placed(
        &self,
        aim: &Aim,
        wrapped: &mut Wrapped,
        settling: &mut Settling,
        places: &[Point],
        measured: Measured,
    ) -> Measured {
        let mut surface = wrapped.surface.level(wrapped.surface.levels);
        let settled = settling.settled(&wrapped.surface.positions, places, &self.misfits);
        surface.positions.copy_from_slice(settled);
        let settled = aim.measure(&surface);
        let after = aim.excesses(&self.ones, &settled, self.limits);
        let is_worth = |&one: &u32| after[one as usize] < WORTH * self.before[one as usize];
        let better: Vec<bool> = self.ones.iter().map(is_worth).collect();
        if !better.contains(&true) {
            return measured;
        }
        settling.finish(wrapped, &better);
        if better == self.misfits {
            return settled;
        }
        surface.positions.copy_from_slice(&wrapped.surface.positions);
        aim.measure(&surface)
    }
}
