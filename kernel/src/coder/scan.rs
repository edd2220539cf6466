//! The order of coefficients within a resolution, and what is known when each is coded.

use super::BinaryCoder;
use super::context::{parent_hint, remembered, sibling_hint};
use super::history::History;
use super::predict::Predictor;
use super::rows::RowsBefore;
use super::symbol::Models;
use crate::transform::{Plan, Subband};

/// The coefficients of a plan in Mallat order, and scratch of [`Plan::scratch_len`].
#[derive(Debug)]
pub(crate) struct Coefficients<'a> {
    pub(crate) plan: Plan,
    pub(crate) samples: &'a mut [i32],
    pub(crate) scratch: &'a mut [i32],
}

impl Coefficients<'_> {
    /// Runs either direction of the coder over one resolution; the coarser ones are known already.
    ///
    /// `None` never happens: the plan and the lengths of the memory were checked at the door.
    pub(crate) fn code<C: BinaryCoder>(
        &mut self,
        coder: &mut C,
        models: &mut Models,
        resolution: u8,
        predictor: &Predictor,
    ) -> Option<()> {
        for subband in self.plan.subbands(resolution) {
            if subband.orientation == 0 {
                self.code_low_pass(coder, models, subband, predictor)?;
            } else {
                self.code_details(coder, models, subband)?;
            }
        }
        Some(())
    }

    /// Codes what the prediction of the low-pass part leaves.
    fn code_low_pass<C: BinaryCoder>(
        &mut self,
        coder: &mut C,
        models: &mut Models,
        low_pass: Subband,
        predictor: &Predictor,
    ) -> Option<()> {
        let (mut history, _) = History::new(low_pass.sides, self.scratch)?;
        for [y, z] in low_pass.rows() {
            let (before, row) = self.samples.split_at_mut_checked(low_pass.row(&self.plan, y, z))?;
            let before = RowsBefore::new(&self.plan, low_pass, [y, z], before);
            let rows = history.rows(y)?;
            let [mut west_west, mut west] = [None; 2];
            for ((x, value), (around, place)) in row.iter_mut().enumerate().zip(rows.places()) {
                let predicted = predictor.predict(&before, x, [west_west, west]);
                let residual = models.code(coder, around.context(0), value.wrapping_sub(predicted));
                place.set(remembered(residual));
                *value = predicted.wrapping_add(residual);
                [west_west, west] = [west, Some(*value)];
            }
            history.end_row();
        }
        Some(())
    }

    /// Codes the wavelet coefficients of one subband.
    fn code_details<C: BinaryCoder>(
        &mut self,
        coder: &mut C,
        models: &mut Models,
        subband: Subband,
    ) -> Option<()> {
        let family = Family::new(&self.plan, subband);
        let (mut history, hints) = History::new(subband.sides, self.scratch)?;
        for [y, z] in subband.rows() {
            family.hint(&self.plan, [y, z], self.samples, hints);
            let row = self.samples.get_mut(subband.row(&self.plan, y, z)..)?;
            let rows = history.rows(y)?;
            for ((value, &hint), (around, place)) in row.iter_mut().zip(hints.iter()).zip(rows.places()) {
                *value = models.code(coder, around.context(hint), *value);
                place.set(remembered(*value));
            }
            history.end_row();
        }
        Some(())
    }
}

/// The subbands that are known and have something to say about one of wavelet coefficients.
#[derive(Debug)]
struct Family {
    /// Those of the same level and a lower orientation.
    siblings: heapless::Vec<Subband, 6>,
    /// That of the next coarser level and the same orientation.
    parent: Option<Subband>,
}

impl Family {
    fn new(plan: &Plan, child: Subband) -> Self {
        let resolution = plan.levels().wrapping_sub(child.level);
        let mut siblings = heapless::Vec::new();
        for sibling in plan.subbands(resolution).take_while(|sibling| sibling.orientation < child.orientation)
        {
            // At most six orientations are lower than the highest, so the list cannot overflow.
            let _ = siblings.push(sibling);
        }
        let mut coarser = plan.subbands(resolution.wrapping_sub(1));
        Self { siblings, parent: coarser.find(|parent| parent.orientation == child.orientation) }
    }

    /// Writes what the family says about row `y` of plane `z`: the weighted magnitudes at the same place.
    fn hint(&self, plan: &Plan, [y, z]: [usize; 2], samples: &[i32], hints: &mut [i32]) {
        hints.fill(0);
        let row_of = |subband: &Subband, y: usize, z: usize| {
            let [width, height, depth] = subband.sides;
            let start = subband.row(plan, y, z);
            if y < height && z < depth { samples.get(start..start.wrapping_add(width)) } else { None }
        };
        for row in self.siblings.iter().filter_map(|sibling| row_of(sibling, y, z)) {
            for (hint, &value) in hints.iter_mut().zip(row) {
                *hint = hint.wrapping_add(sibling_hint(value));
            }
        }
        if let Some(row) = self.parent.as_ref().and_then(|parent| row_of(parent, y / 2, z / 2)) {
            let children = hints.chunks_mut(2);
            for (children, &value) in children.zip(row) {
                for hint in children {
                    *hint = hint.wrapping_add(parent_hint(value));
                }
            }
        }
    }
}
