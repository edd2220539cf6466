//! The encoder's choice of a predictor.

use super::predict::Predictor;
use super::rows::each_sample;
use super::train::Equations;
use crate::transform::{Plan, Subband};

/// Samples that the predictors are compared on, about: of larger low-pass parts only every so many rows, of longer
/// rows the first.
const COMPARED: usize = 1 << 14;

/// Low-pass parts smaller than this are not worth weights of their own.
const WORTH_TRAINING: usize = 512;

/// Bits of the weights in a header, about.
const WEIGHTS_COST: u64 = 8 * 40;

impl Predictor {
    /// The predictor that promises the shortest code for the low-pass part of `coefficients`.
    pub(crate) fn best(plan: &Plan, coefficients: &[i32], equations: &mut Equations) -> Self {
        let Some(low_pass) = plan.subbands(0).next() else { return Self::InPlane };
        let samples = plan.coarsened(plan.levels()).extent().samples();
        let every = samples.div_ceil(COMPARED) | 1;
        let cost = |predictor: &Self| predictor.cost(plan, low_pass, coefficients, every);
        let fixed = Self::FIXED.map(|predictor| (cost(&predictor), predictor));
        let best = fixed.into_iter().min_by_key(|&(cost, _)| cost);
        let (fixed_cost, fixed) = best.unwrap_or((u64::MAX, Self::InPlane));
        if samples < WORTH_TRAINING {
            return fixed;
        }
        let trained = Self::Trained(equations.train(plan, low_pass, coefficients));
        let saved =
            fixed_cost.saturating_sub(cost(&trained)).saturating_mul(u64::try_from(every).unwrap_or(1));
        if saved > WEIGHTS_COST { trained } else { fixed }
    }

    /// Bits that the residuals of every so many rows take, about: the length of an Elias gamma code each.
    fn cost(&self, plan: &Plan, low_pass: Subband, coefficients: &[i32], every: usize) -> u64 {
        let mut bits = 0_u64;
        let rows = low_pass.rows().step_by(every.max(1));
        each_sample(plan, low_pass, coefficients, rows, COMPARED, |before, x, wests, value| {
            let residual = value.wrapping_sub(self.predict(before, x, wests));
            bits = bits.wrapping_add(gamma_bits(residual));
        });
        bits
    }
}

/// 1 for 0, 3 for 1 to 2, 5 for 3 to 6, and so on, either sign.
fn gamma_bits(residual: i32) -> u64 {
    let octave = residual.unsigned_abs().saturating_add(1).ilog2();
    u64::from(octave.wrapping_mul(2).wrapping_add(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Extent, Wavelet};

    #[test]
    fn ramps_are_predicted_exactly() {
        let plan = Plan::new(Wavelet::Haar, Extent::slice(4, 2).unwrap(), 0).unwrap();
        let low_pass = plan.subbands(0).next().unwrap();
        let cost = Predictor::InPlane.cost(&plan, low_pass, &[0, 1, 2, 3, 0, 1, 2, 3], 1);
        // Three steps of 1 in the first row; the second is the same.
        assert_eq!(cost, 5 + 3 * 3);
    }

    #[test]
    fn code_lengths() {
        assert_eq!([0, 1, -2, 3, -6, 7, i32::MIN].map(gamma_bits), [1, 3, 3, 5, 5, 7, 63]);
    }
}
