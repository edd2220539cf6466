//! The order of coefficients within a resolution, and what is known when each is coded.

use super::Coder;
use super::choose::Choosing;
use super::context::magnitude;
use super::forecast::{Forecast, RowMemory, Zero};
use super::history::{History, Last, history_len};
use super::predictor::Predictor;
use super::residual::Models;
use super::train::Training;
use super::weightless::{Fixed, FixedRow, RowsBefore};
use crate::Feature;
use crate::transform::{Level, Plan, Subband};

/// `i32`s of scratch that coding takes for the largest subband of `plan`.
pub(crate) const fn scratch_len(plan: &Plan) -> usize {
    let largest = plan.extent().coarsened(if plan.levels() > 0 { 1 } else { 0 }).sides();
    let [x, _, _] = largest;
    if !Feature::Adaptive.is_built() {
        return x;
    }
    let coding = history_len(largest).saturating_add(x);
    if !Feature::Trained.is_built() {
        return coding;
    }
    coding.saturating_add(RowMemory::len(x))
}

/// The coefficients of a plan in Mallat order, and scratch of [`Plan::scratch_len`].
#[derive(Debug)]
pub(crate) struct Coefficients<'a> {
    pub(crate) plan: Plan,
    pub(crate) samples: &'a mut [i32],
    pub(crate) scratch: &'a mut [i32],
    /// Whether samples have more than 16 bits.
    pub(crate) wide: bool,
}

impl Coefficients<'_> {
    /// The predictor that an encoder chooses for a subband.
    pub(crate) fn best_predictor(
        &mut self,
        subband: Subband,
        training: Option<&mut Training>,
    ) -> Option<Predictor> {
        let (plan, coefficients) = (&self.plan, &*self.samples);
        Choosing { plan, subband, coefficients, scratch: self.scratch, wide: self.wide }.best(training)
    }

    /// The predictor without weights that an encoder chooses for the low-pass part.
    pub(crate) fn best_fixed(&mut self) -> Option<Fixed> {
        let subband = self.plan.subbands(0).next()?;
        let (plan, coefficients) = (&self.plan, &*self.samples);
        let mut choosing = Choosing { plan, subband, coefficients, scratch: self.scratch, wide: self.wide };
        choosing.best_fixed().map(|(fixed, _)| fixed)
    }

    /// Undoes the level of the transform that `resolution` completes.
    pub(crate) fn undo_resolution(&mut self, resolution: u8) {
        if resolution > 0
            && let Some(level) = self.plan.levels().checked_sub(resolution)
        {
            self.plan.inverse_level(level, self.samples, self.scratch);
        }
    }

    /// Runs either direction of the coder over one subband under `predictor`; the coarser resolutions are known already, and their inverse transform is done.
    ///
    /// `None` if the codestream says what no encoder does.
    pub(crate) fn code<C: Coder + ?Sized>(
        &mut self,
        coder: &mut C,
        models: &mut Models,
        subband: Subband,
        predictor: Predictor,
    ) -> Option<()> {
        let [width, _, _] = subband.sides;
        let (mut history, rest) = History::new(subband.sides, self.scratch)?;
        let (energies, rest) = rest.split_at_mut_checked(width)?;
        let mut memory = match predictor {
            Predictor::Trained(..) if Feature::Trained.is_built() => RowMemory::new(width, self.wide, rest),
            _ => None,
        };
        let level = self.plan.level_of(subband);
        for [y, z] in subband.rows() {
            hint(&level, subband, [y, z], self.samples, energies);
            history.add_energies(y, energies)?;
            let start = subband.row(&self.plan, y, z);
            let magnitudes = history.row(y)?;
            let (before, rest) = self.samples.split_at_mut_checked(start)?;
            let mut row = Row { values: rest.get_mut(..width)?, energies, magnitudes };
            match (&predictor, &mut memory) {
                (Predictor::Fixed(fixed), _) => {
                    let before = RowsBefore::new(&self.plan, subband, [y, z], before);
                    row.code(coder, models, FixedRow::new(*fixed, before));
                }
                (Predictor::Trained(..), Some(memory)) => {
                    let forecast = predictor.weighted(&self.plan, subband, self.samples, [y, z], memory);
                    let values = self.samples.get_mut(start..start.wrapping_add(width))?;
                    Row { values, energies, magnitudes }.code(coder, models, forecast);
                }
                _ => row.code(coder, models, Zero),
            }
            history.end_row();
        }
        Some(())
    }
}

/// A row that is coded.
#[derive(Debug)]
struct Row<'a> {
    values: &'a mut [i32],
    /// What is known around each value but to its west.
    energies: &'a [i32],
    /// For the magnitudes of residuals.
    magnitudes: &'a mut [i32],
}

impl Row<'_> {
    fn code<C: Coder + ?Sized>(&mut self, coder: &mut C, models: &mut Models, mut forecast: impl Forecast) {
        let mut last = Last::default();
        let places = self.energies.iter().zip(self.magnitudes.iter_mut());
        for ((x, value), (energy, magnitude)) in self.values.iter_mut().enumerate().zip(places) {
            let expected = forecast.expected(x);
            let residual = value.wrapping_sub(expected.value);
            let residual = models.code(coder, energy.wrapping_add(last.energy()), expected, residual);
            *magnitude = last.push(residual);
            *value = expected.value.wrapping_add(residual);
            forecast.push(*value);
        }
    }
}

/// Weight of a sibling's magnitude in the energy.
pub(super) const SIBLING: i32 = 3;

/// Sets `energies` to what the subbands of a lower orientation say about row `y` of plane `z`: the weighted magnitudes
/// at the same place.
fn hint(level: &Level, subband: Subband, place: [usize; 2], samples: &[i32], energies: &mut [i32]) {
    energies.fill(0);
    for sibling in (1..subband.orientation).filter_map(|orientation| level.row(orientation, place)) {
        let row = samples.get(sibling).unwrap_or(&[]);
        for (energy, &value) in energies.iter_mut().zip(row) {
            *energy = energy.wrapping_add(magnitude(value).wrapping_mul(SIBLING));
        }
    }
}
