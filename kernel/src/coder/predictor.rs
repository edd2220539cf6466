//! How the coefficients of a subband are predicted, and how a codestream says so.

use super::forecast::{LARGEST_SUM, LARGEST_WEIGHT, RowMemory, Weighted, Weights, West};
use super::residual::Models;
use super::taps::{Planes, Taps};
use super::weightless::Fixed;
use super::{Coder, low_bits};
use crate::transform::{Plan, Subband};
use crate::{DecodeError, Feature, Malformed};

/// How the coefficients of a subband are predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Predictor {
    /// In the low-pass part: from the nearest samples.
    Fixed(Fixed),
    /// By a weighted sum of neighbours: in the first plane of the low-pass part, and everywhere else.
    Trained(Weights, Weights),
    /// As 0.
    Zero,
}

/// Bits of the number of a predictor.
pub(super) const NUMBER_BITS: u32 = 3;

const TRAINED: u32 = 5;
const ZERO: u32 = 6;

impl Predictor {
    /// Codes the predictor of a subband, which an encoder has chosen.
    ///
    /// # Errors
    /// [`Malformed::Segment`] if the codestream names none that there is, [`DecodeError::NotBuilt`] if this build lacks it.
    pub(crate) fn code<C: Coder + ?Sized>(
        &self,
        coder: &mut C,
        models: &mut Models,
        plan: &Plan,
        subband: Subband,
    ) -> Result<Self, DecodeError> {
        let number = match self {
            Self::Fixed(fixed) => fixed.number(),
            Self::Trained(..) => TRAINED,
            Self::Zero => ZERO,
        };
        match coder.raw(number, NUMBER_BITS) & low_bits(NUMBER_BITS) {
            TRAINED if !Feature::Trained.is_built() => Err(DecodeError::NotBuilt(Feature::Trained)),
            TRAINED => {
                let (mut first, mut rest) = match *self {
                    Self::Trained(first, rest) => (first, rest),
                    _ => (Weights::ZERO, Weights::ZERO),
                };
                for (weights, planes) in [(&mut first, Planes::First), (&mut rest, Planes::Others)] {
                    if let Some(taps) = Taps::new(plan, subband, planes) {
                        let coded = code_weights(coder, models, weights, taps.weights());
                        coded.ok_or(Malformed::Segment)?;
                    }
                }
                Ok(Self::Trained(first, rest))
            }
            ZERO => Ok(Self::Zero),
            number => {
                let fixed = if subband.orientation == 0 { Fixed::from_number(number) } else { None };
                Ok(Self::Fixed(fixed.ok_or(Malformed::Segment)?))
            }
        }
    }

    /// The prediction of row `y` of plane `z` by weights, of which [`Predictor::Zero`] has none.
    pub(super) fn weighted<'a>(
        &self,
        plan: &Plan,
        subband: Subband,
        coefficients: &[i32],
        [y, z]: [usize; 2],
        memory: &'a mut RowMemory<'_>,
    ) -> Weighted<'a> {
        let west = match self.weights(plan, subband, z) {
            Some((taps, weights)) => weights.sum_row(&taps, coefficients, [y, z], memory),
            None => {
                memory.clear();
                West::ZERO
            }
        };
        Weighted { west, sums: memory.sums, upper_sums: memory.upper_sums }
    }

    /// The weights for plane `z`, and what they apply to; `None` if there are none.
    fn weights(&self, plan: &Plan, subband: Subband, z: usize) -> Option<(Taps, &Weights)> {
        let Self::Trained(first, rest) = self else { return None };
        if !Feature::Trained.is_built() {
            return None;
        }
        let is_first = z == 0 && subband.orientation == 0;
        let (planes, weights) = if is_first { (Planes::First, first) } else { (Planes::Others, rest) };
        Some((Taps::new(plan, subband, planes)?, weights))
    }
}

/// Codes the first `count` weights.
fn code_weights<C: Coder + ?Sized>(
    coder: &mut C,
    models: &mut Models,
    weights: &mut Weights,
    count: usize,
) -> Option<()> {
    let mut sum = 0_i32;
    for weight in weights.0.iter_mut().take(count) {
        *weight = models.code_weight(coder, *weight);
        sum = sum.wrapping_add(weight.unsigned_abs().into());
        if weight.unsigned_abs() > LARGEST_WEIGHT.unsigned_abs() || sum > LARGEST_SUM {
            return None;
        }
    }
    Some(())
}
