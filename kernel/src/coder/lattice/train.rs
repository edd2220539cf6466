//! Training of the weights of a pass, and the estimate of how much it brings.

use super::equations::{Equations, FRACTION_BITS, VALUES};
use super::pass::Pass;
use super::weights::{MEAN, TAPS, WEIGHT_BITS, Weights, taps};
use super::window::Window;
use crate::Extent;

/// Points that are trained on, at most.
const MOST_POINTS: usize = 4000;

/// Points that are trained on, at least, if the pass has them.
const LEAST_POINTS: usize = 256;

/// Points that an estimate is made from, at most.
const ESTIMATED_FROM: usize = 250;

/// Points that are kept if little is to be gained, at most; one for every [`BITS_A_POINT`] of the pass otherwise.
const KEPT_POINTS: usize = 500;

/// Bits to be coded that make one more point worthwhile.
const BITS_A_POINT: u64 = 4;

/// Columns from one point to the next in a row, at most.
const COLUMN_STEP: usize = 5;

/// Bits to be coded, in 1/256, below which training is not worthwhile.
const LEAST_COST: u64 = 2500 << 8;

/// Bits, in 1/256, that trained weights take.
const WEIGHTS_COST: u64 = (35 * 11) << 8;

/// The points are weighted anew several times, as the weights found so far leave them: of every so many one.
const ROUNDS: [usize; 3] = [2, 2, 1];

/// Points that suit a brick of `samples`.
pub(super) fn points(samples: usize) -> usize {
    (samples >> 4).clamp(LEAST_POINTS, MOST_POINTS)
}

/// `i32`s of scratch for the points of a brick of `samples`.
pub(super) fn scratch_len(samples: usize) -> usize {
    points(samples).saturating_mul(VALUES)
}

/// The weights that suit a pass whose samples `lattice` holds already, learnt from some of them.
pub(super) fn train(
    equations: &mut Equations,
    pass: &Pass,
    lattice: &[i32],
    window: &mut Window<'_>,
    points: &mut [i32],
    step: u32,
) -> Weights {
    let filled = gather(pass, lattice, window, points);
    let points = points.get_mut(..filled.wrapping_mul(VALUES)).unwrap_or(&mut []);
    let default = Weights::CUBIC;
    let all = cost(points, &default, step)
        .wrapping_mul(number(pass.count()))
        .checked_div(number(filled))
        .unwrap_or(0);
    if all < LEAST_COST {
        return default;
    }
    let wanted =
        usize::try_from((all >> 8) / BITS_A_POINT).unwrap_or(MOST_POINTS).clamp(KEPT_POINTS, MOST_POINTS);
    let kept = thin_out(points, filled, wanted);
    let points = points.get(..kept.wrapping_mul(VALUES)).unwrap_or(&[]);
    let weights = fit(equations, points, step);
    let total = |weights: &Weights| {
        cost(points, weights, step).wrapping_mul(number(pass.count())).checked_div(number(kept)).unwrap_or(0)
    };
    if total(&weights).saturating_add(WEIGHTS_COST) < total(&default) { weights } else { default }
}

/// The weights that suit some points.
fn fit(equations: &mut Equations, points: &[i32], step: u32) -> Weights {
    let mut weights = Weights::CUBIC;
    for every in ROUNDS {
        equations.clear();
        for point in points.chunks_exact(VALUES).step_by(every.max(1)) {
            let size = residual(point, &weights).unsigned_abs();
            let bound = u64::from(step).wrapping_add(size.wrapping_mul(5)).max(1);
            let counts = (u64::from(step).wrapping_mul(5) << FRACTION_BITS).checked_div(bound).unwrap_or(0);
            equations.add(point, residual(point, &Weights::CUBIC), counts.cast_signed());
        }
        weights = Weights::CUBIC;
        equations.solve(step, &mut weights);
    }
    weights
}

fn number(count: usize) -> u64 {
    u64::try_from(count).unwrap_or(u64::MAX)
}

/// Collects points all over a pass: what the taps hold and the sample, less the mean of the known samples before and
/// after. Returns how many.
fn gather(pass: &Pass, lattice: &[i32], window: &mut Window<'_>, points: &mut [i32]) -> usize {
    let room = points.len().checked_div(VALUES).unwrap_or(0).max(1);
    let every = pass.count().div_ceil(room) | 1;
    let columns = every.min(COLUMN_STEP);
    let rows = every.div_ceil(columns.max(1)) | 1;
    let taps = taps(pass.axis);
    let mut slots = points.chunks_exact_mut(VALUES);
    for (turn, place) in pass.rows().step_by(rows.max(1)).enumerate() {
        let Some(row) = pass.new_row(place).and_then(|row| lattice.get(row)) else { continue };
        window.fill(lattice, place, true);
        window.set_own(row);
        let first = turn.wrapping_mul(2).checked_rem(columns).unwrap_or(0);
        for (column, &sample) in row.iter().enumerate().skip(first).step_by(columns.max(1)) {
            let Some(point) = slots.next() else { return room };
            let at = |(slot, by)| window.row(slot, by).get(column).copied().unwrap_or(0);
            let mean = at((MEAN, 0));
            let values = taps.iter().map(|&tap| at(tap)).chain([sample]);
            point.iter_mut().zip(values).for_each(|(to, value)| *to = value.wrapping_sub(mean));
        }
    }
    room.wrapping_sub(slots.len())
}

/// Keeps `wanted` of the points or a few less, and returns how many.
fn thin_out(points: &mut [i32], filled: usize, wanted: usize) -> usize {
    let every = filled.div_ceil(wanted.max(1)).max(1);
    if every == 1 {
        return filled;
    }
    let kept = filled.checked_div(every).unwrap_or(0);
    for number in 1..kept {
        let (before, after) = points
            .split_at_mut_checked(number.wrapping_add(1).wrapping_mul(VALUES))
            .unwrap_or((&mut [], &mut []));
        let from = number.wrapping_mul(every.wrapping_sub(1)).wrapping_sub(1).wrapping_mul(VALUES);
        let to = before.get_mut(number.wrapping_mul(VALUES)..).unwrap_or(&mut []);
        crate::memory::copy(after.get(from..).unwrap_or(&[]), to);
    }
    kept
}

/// What is left of a point when it is predicted, rounded.
fn residual(point: &[i32], weights: &Weights) -> i64 {
    let product = |(&difference, &weight): (&i32, &i32)| i64::from(difference).wrapping_mul(weight.into());
    let sum = point.iter().zip(&weights.0).take(TAPS).map(product).fold(0, i64::wrapping_add);
    let sample = point.last().copied().map_or(0, i64::from);
    (sample << WEIGHT_BITS).wrapping_sub(sum).wrapping_add(1 << (WEIGHT_BITS - 1)) >> WEIGHT_BITS
}

/// Bits, in 1/256, that the residuals of points take, about.
fn cost(points: &[i32], weights: &Weights, step: u32) -> u64 {
    let residuals = points.chunks_exact(VALUES).map(|point| residual(point, weights));
    residuals.map(|residual| bits(residual.unsigned_abs(), step)).fold(0, u64::wrapping_add)
}

/// Bits, in 1/256, that a residual takes, about: with e steps, 0.3 e^2 below 1/2 and log2(1 + e) + 0.7 from there on.
pub(super) fn bits(residual: u64, step: u32) -> u64 {
    let steps = (residual << 8).checked_div(step.into()).unwrap_or(0);
    if steps < 128 {
        return steps.wrapping_mul(steps).wrapping_mul(77) >> 16;
    }
    let argument = steps.wrapping_add(256);
    let octave = argument.checked_ilog2().unwrap_or(0);
    let fraction = (argument << 8).wrapping_shr(octave).wrapping_sub(256);
    (u64::from(octave).wrapping_sub(8) << 8).wrapping_add(fraction).wrapping_add(179)
}

/// Bits a sample, in 1/256, that the residuals of the last pass take after training, estimated from some of them.
pub(super) fn estimate(
    equations: &mut Equations,
    extent: Extent,
    samples: &[i32],
    [rows, points]: [&mut [i32]; 2],
    step: u32,
) -> u64 {
    // A pass along x would find its samples in another order.
    let Some(pass) = Pass::all(extent, 0, 0).filter(|pass| pass.axis > 0).last() else { return u64::MAX };
    let points = points.get_mut(..ESTIMATED_FROM.wrapping_mul(VALUES)).unwrap_or(&mut []);
    let filled = gather(&pass, samples, &mut Window::new(pass, rows), points);
    let points = points.get(..filled.wrapping_mul(VALUES)).unwrap_or(&[]);
    let trained = fit(equations, points, step);
    let least = cost(points, &trained, step).min(cost(points, &Weights::CUBIC, step));
    least.checked_div(number(filled)).unwrap_or(u64::MAX)
}
