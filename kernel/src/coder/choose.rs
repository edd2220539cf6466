//! The encoder's choice of a predictor for each subband.

use super::forecast::{Forecast, RowMemory, Weights};
use super::predictor::Predictor;
use super::scatter::scattered;
use super::taps::{Planes, Taps};
use super::train::Training;
use super::weightless::{Fixed, FixedRow, RowsBefore};
use crate::Feature;
use crate::transform::{Plan, Subband};

/// Coefficients of the low-pass part that weights are trained on, at first and in the end.
const LESSONS: [usize; 2] = [1 << 12, 1 << 13];

/// Of a subband of details.
const LESSONS_OF_DETAILS: [usize; 2] = [1 << 10, 1 << 11];

/// Coefficients that predictors are compared on, at least: of larger subbands those of some rows.
const COMPARED: usize = 1 << 12;

/// Of so many rows one is compared, or more.
const ROWS_FOR_ONE: usize = 64;

/// Subbands of fewer coefficients are not worth weights of their own.
const WORTH_TRAINING: usize = 1 << 11;

/// Bits that a weight takes, about.
const WEIGHT_COST: u64 = 7;

/// What an encoder knows when it chooses: all coefficients that matter, and scratch of [`Plan::scratch_len`].
#[derive(Debug)]
pub(super) struct Choosing<'a> {
    pub(super) plan: &'a Plan,
    pub(super) subband: Subband,
    pub(super) coefficients: &'a [i32],
    pub(super) scratch: &'a mut [i32],
    pub(super) wide: bool,
}

impl Choosing<'_> {
    /// The predictor that promises the shortest code for the subband; without `training` none has weights.
    pub(super) fn best(&mut self, training: Option<&mut Training>) -> Option<Predictor> {
        let (mut best, least) = match (self.subband.orientation, &training) {
            (0, _) => self.best_fixed().map(|(fixed, cost)| (Predictor::Fixed(fixed), cost))?,
            (_, None) => return Some(Predictor::Zero),
            _ => (Predictor::Zero, self.cost(&Predictor::Zero)?),
        };
        let samples = self.subband.sides.iter().fold(1, |product: usize, &side| product.wrapping_mul(side));
        if Feature::Trained.is_built()
            && let Some(training) = training
            && samples >= WORTH_TRAINING
        {
            let (trained, weights) = self.trained(training);
            let cost = self.cost(&trained)?.saturating_add(weights.wrapping_mul(WEIGHT_COST));
            if cost < least {
                best = trained;
            }
        }
        Some(best)
    }

    /// The best predictor of the low-pass part without weights, and the bits that it promises.
    pub(super) fn best_fixed(&mut self) -> Option<(Fixed, u64)> {
        let mut best = (Fixed::InPlane, u64::MAX);
        for fixed in Fixed::ALL {
            let cost = self.cost(&Predictor::Fixed(fixed))?;
            if cost < best.1 {
                best = (fixed, cost);
            }
        }
        Some(best)
    }

    /// A trained predictor and the number of its weights.
    fn trained(&mut self, training: &mut Training) -> (Predictor, u64) {
        let mut count = 0_u64;
        let [first, rest] = [Planes::First, Planes::Others].map(|planes| {
            let Some(taps) = Taps::new(self.plan, self.subband, planes) else { return Weights::ZERO };
            count = count.saturating_add(u64::try_from(taps.weights()).unwrap_or(0));
            let lessons = if taps.is_low_pass() { LESSONS } else { LESSONS_OF_DETAILS };
            training.train(&taps, self.coefficients, lessons)
        });
        (Predictor::Trained(first, rest), count)
    }

    /// Bits that the residuals take, about, estimated from rows all over the subband.
    fn cost(&mut self, predictor: &Predictor) -> Option<u64> {
        let [width, height, depth] = self.subband.sides;
        let rows = height.wrapping_mul(depth);
        let compared = COMPARED.div_ceil(width.max(1)).max(rows / ROWS_FOR_ONE).min(rows);
        let mut bits = 0_u64;
        for row in scattered(rows).take(compared) {
            let place = [row.checked_rem(height)?, row.checked_div(height)?];
            bits = bits.wrapping_add(self.cost_of_row(predictor, place)?);
        }
        let every = rows.div_ceil(compared.max(1));
        Some(bits.wrapping_mul(u64::try_from(every).unwrap_or(1)))
    }

    fn cost_of_row(&mut self, predictor: &Predictor, [y, z]: [usize; 2]) -> Option<u64> {
        let [width, _, _] = self.subband.sides;
        let start = self.subband.row(self.plan, y, z);
        let row = self.coefficients.get(start..start.wrapping_add(width))?;
        if let &Predictor::Fixed(fixed) = predictor {
            let before = RowsBefore::new(self.plan, self.subband, [y, z], self.coefficients.get(..start)?);
            return Some(bits(row, FixedRow::new(fixed, before)));
        }
        if !Feature::Trained.is_built() {
            return None;
        }
        let mut memory = RowMemory::new(width, self.wide, self.scratch)?;
        let forecast = predictor.weighted(self.plan, self.subband, self.coefficients, [y, z], &mut memory);
        Some(bits(row, forecast))
    }
}

/// Bits of the residuals of a row, about: the length of an Elias gamma code each.
fn bits(row: &[i32], mut forecast: impl Forecast) -> u64 {
    let mut bits = 0_u64;
    for (x, &coefficient) in row.iter().enumerate() {
        let residual = coefficient.wrapping_sub(forecast.expected(x).value);
        bits = bits.wrapping_add(gamma_bits(residual));
        forecast.push(coefficient);
    }
    bits
}

/// 1 for 0, 3 for 1 to 2, 5 for 3 to 6, and so on, either sign.
fn gamma_bits(residual: i32) -> u64 {
    let octave = residual.unsigned_abs().saturating_add(1).checked_ilog2().unwrap_or(0);
    u64::from(octave.wrapping_mul(2).wrapping_add(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Extent, Wavelet};

    #[test]
    fn ramps_are_predicted_exactly() {
        let plan = Plan::new(Wavelet::Haar, Extent::slice(4, 2).unwrap(), 0).unwrap();
        let subband = plan.subbands(0).next().unwrap();
        let (coefficients, scratch) = (&[0, 1, 2, 3, 0, 1, 2, 3], &mut [0; 64]);
        let mut choosing = Choosing { plan: &plan, subband, coefficients, scratch, wide: false };
        // Three steps of 1 in the first row; the second is the same.
        assert_eq!(choosing.cost(&Predictor::Fixed(Fixed::InPlane)), Some(5 + 3 * 3));
    }

    #[test]
    fn code_lengths() {
        assert_eq!([0, 1, -2, 3, -6, 7, i32::MIN].map(gamma_bits), [1, 3, 3, 5, 5, 7, 63]);
    }
}
