//! A resolution after the other, subband by subband, coefficient by coefficient.

use super::arithmetic::{Decoder, Encoder};
use super::array::{Array, Place};
use super::distribution::Models;
use super::header::Reject;
use super::predict::{LARGEST_SUM, LARGEST_WEIGHT, Predictor, Scene};
use super::value::Context;

/// Where predictors and residuals go to, or come from.
pub(super) trait Segment {
    /// The predictor of the next subband, which has sets of that many weights.
    fn predictor(
        &mut self,
        models: &mut Models,
        sets: &[usize],
        is_low_pass: bool,
    ) -> Result<Predictor, Reject>;

    /// The next residual: `residual` itself if it is known.
    fn residual(&mut self, models: &mut Models, context: Context, residual: i32) -> i32;
}

/// A segment being written, of which the predictors are known.
#[derive(Debug)]
pub(super) struct Writing<'a, Predictors> {
    pub(super) to: Encoder,
    pub(super) predictors: &'a mut Predictors,
}

impl<'a, Predictors: Iterator<Item = &'a Predictor>> Segment for Writing<'_, Predictors> {
    fn predictor(&mut self, models: &mut Models, sets: &[usize], _: bool) -> Result<Predictor, Reject> {
        let predictor = self.predictors.next().expect("a predictor for every subband");
        match predictor {
            Predictor::Fixed(number) => self.to.raw(3, (*number).into()),
            Predictor::Weights(weights) => {
                assert!(weights.iter().map(Vec::len).eq(sets.iter().copied()), "weights for every set");
                self.to.raw(3, 5);
                weights.iter().flatten().for_each(|weight| models.encode_weight(&mut self.to, *weight));
            }
            Predictor::Zero => self.to.raw(3, 6),
        }
        Ok(predictor.clone())
    }

    fn residual(&mut self, models: &mut Models, context: Context, residual: i32) -> i32 {
        models.encode(&mut self.to, context, residual);
        residual
    }
}

/// A segment being read, and the predictors that it and those before it name.
#[derive(Debug)]
pub(super) struct Reading<'a> {
    pub(super) from: Decoder<'a>,
    pub(super) predictors: &'a mut Vec<Predictor>,
}

impl Segment for Reading<'_> {
    fn predictor(
        &mut self,
        models: &mut Models,
        sets: &[usize],
        is_low_pass: bool,
    ) -> Result<Predictor, Reject> {
        let predictor = match self.from.raw(3) {
            number @ 0..=4 if is_low_pass => Predictor::Fixed(number as u8),
            5 => {
                let set = |&count: &usize| read_weights(&mut self.from, models, count);
                Predictor::Weights(sets.iter().map(set).collect::<Result<_, _>>()?)
            }
            6 => Predictor::Zero,
            _ => return Err(Reject::Segment),
        };
        self.predictors.push(predictor.clone());
        Ok(predictor)
    }

    fn residual(&mut self, models: &mut Models, context: Context, _: i32) -> i32 {
        models.decode(&mut self.from, context)
    }
}

/// A set of weights.
fn read_weights(from: &mut Decoder<'_>, models: &mut Models, count: usize) -> Result<Vec<i32>, Reject> {
    let weights: Vec<i32> = (0..count).map(|_| models.decode_weight(from)).collect();
    let magnitudes = || weights.iter().map(|weight| weight.unsigned_abs());
    let legal =
        magnitudes().all(|magnitude| magnitude <= LARGEST_WEIGHT) && magnitudes().sum::<u32>() <= LARGEST_SUM;
    if legal { Ok(weights) } else { Err(Reject::Segment) }
}

/// Codes one subband of a level. What the segment makes of its residuals becomes its coefficients.
pub(super) fn subband(
    segment: &mut impl Segment,
    models: &mut Models,
    level: &mut [Array],
    (orientation, narrow): (usize, bool),
) -> Result<(), Reject> {
    if level[orientation].is_empty() {
        return Ok(());
    }
    let mut residuals = Array::zeros(level[orientation].extent);
    let sets = Scene { level, orientation, narrow }.sets();
    let predictor = segment.predictor(models, &sets, orientation == 0)?;
    for place in residuals.places() {
        let prediction = Scene { level, orientation, narrow }.predict(&predictor, place);
        let lower = level.get(1..orientation).unwrap_or_default();
        let context = Context { energy: energy(&residuals, lower, place), offset: prediction.t };
        let known = level[orientation].at(place).wrapping_sub(prediction.p);
        let residual = segment.residual(models, context, known);
        residuals.set(place, residual);
        level[orientation].set(place, prediction.p.wrapping_add(residual));
    }
    Ok(())
}

/// The energy s around a place; `lower` are the subbands of lower orientations.
fn energy(residuals: &Array, lower: &[Array], [x, y, z]: Place) -> u64 {
    let at = |dx, dy, dz| remembered(residuals.get([x + dx, y + dy, z + dz]));
    let (w, n, u) = (at(-1, 0, 0), at(0, -1, 0), at(0, 0, -1));
    let (nw, ne) = (at(-1, -1, 0), at(1, -1, 0));
    let (ue, us) = (at(1, 0, -1), at(0, 1, -1));
    let (ww, nn) = (at(-2, 0, 0), at(0, -2, 0));
    let hint: u64 = lower.iter().map(|subband| 3 * remembered(subband.get([x, y, z]))).sum();
    4 * (w + n + u) + 2 * (nw + ne + ue + us) + ww + nn + hint
}

/// The remembered magnitude of a value, 0 if there is none.
fn remembered(value: Option<i32>) -> u64 {
    value.map_or(0, |value| u64::from(value.unsigned_abs().min(1 << 25)))
}
