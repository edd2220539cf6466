//! Components that wrapping does not fit, or the parts of them that it misses, are placed by way of the collapses, where that
//! is better.
//!
//! Wrapping spreads vertices more evenly, which makes short files. So where all but a horn or the tip of an ear fits, only
//! what is around that is placed.

use super::care::grow;
use super::fit::{Aim, MISSED, Measured, RMS};
use crate::mesh::{Point, PolygonMesh};
use crate::simplify::History;
use crate::wrap::{Settling, Wrapped};

/// A component is placed if that leaves less than this of what distances are too large by, …
const WORTH: f64 = 0.7;
/// … and a part of it if less than this.
const WORTH_IN_PART: f64 = 0.9;
/// A part is what is farther than this from the target, in cells' edges, …
const FAR: f64 = 0.5;
/// … and so many rings of faces around it.
const RINGS: usize = 8;

/// The components of a surface that do not fit.
pub(super) struct Misfits {
    /// The component of the target that each vertex belongs to.
    ones: Vec<u32>,
    /// Bounds on root mean squares and on all distances, in cells' edges.
    limits: [f64; 2],
    /// By how many times each component is too far off.
    before: Vec<f64>,
    /// What must be left of that for its placing to be worth it.
    worth: Vec<f64>,
    /// Whether each vertex belongs to what does not fit.
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
        let before = aim.excesses(&ones, measured, limits, |_| true);
        if !ones.iter().any(|&one| before[one as usize] > 1.0) {
            return None;
        }
        let far = around_far(surface, measured, FAR * unit);
        let rests = aim.excesses(&ones, measured, limits, |vertex| !far[vertex]);
        let in_part = |one: u32| rests[one as usize] <= 1.0;
        let is_misfit = |(&one, far): (&u32, bool)| before[one as usize] > 1.0 && (far || !in_part(one));
        let worth = (0..before.len() as u32).map(|one| if in_part(one) { WORTH_IN_PART } else { WORTH });
        let worth = worth.collect();
        let misfits = ones.iter().zip(far).map(is_misfit).collect();
        Some(Self { ones, limits, before, worth, misfits })
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
        let after = aim.excesses(&self.ones, &settled, self.limits, |_| true);
        let is_worth = |one: usize| after[one] < self.worth[one] * self.before[one];
        let placed = self.ones.iter().zip(&self.misfits);
        let better: Vec<bool> = placed.map(|(&one, &misfit)| misfit && is_worth(one as usize)).collect();
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

/// Which vertices of a surface are farther than `limit` from the target, or next to what of that is so far from it, or some
/// rings of faces around those.
fn around_far(surface: &PolygonMesh, measured: &Measured, limit: f64) -> Vec<bool> {
    let of_vertices = measured.of_surface.iter().take(surface.positions.len());
    let mut marked: Vec<bool> = of_vertices.map(|&distance| distance > limit).collect();
    for (&vertex, &distance) in measured.nearest.iter().zip(&measured.of_target) {
        marked[vertex as usize] |= distance > limit;
    }
    (0..RINGS).for_each(|_| grow(surface.faces().iter(), &mut marked));
    marked
}
