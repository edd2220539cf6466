//! The weights that suit the samples of a brick: least squares over some of its rows.

use core::ops::Range;

use super::narrow::{TAPS, WEIGHT_BITS, Weights};
use super::neighbours::{Around, Kind, row_at};
use crate::coder::dense::{CHUNK, Chunk, SOLUTION_BITS, Solution, Sums};
use crate::coder::low_half;

/// Parts of rows that are learnt from, at most and about.
const PARTS: usize = 192;

/// Of so many samples one is learnt from, or fewer.
const SAMPLES_FOR_ONE: usize = 16;

/// Bits that the largest difference of a part is brought to.
const DIFFERENCE_BITS: u32 = 8;

/// A part needs scaling up by at most this many bits.
const MOST_UP: u32 = 7;

/// The equations, and samples on their way there.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Lessons {
    sums: Sums,
    chunk: Chunk,
}

/// Samples of a row and what they are predicted from, all as differences from the sample of one known row, the centre.
struct Part<'a> {
    centre: &'a [i32],
    targets: &'a [i32],
    /// W, then the neighbours in known rows, all but the centre.
    neighbours: heapless::Vec<&'a [i32], TAPS>,
}

impl Lessons {
    #[cfg(any(feature = "tabled", test))]
    pub(crate) const NEW: Self = Self { sums: Sums::ZERO, chunk: Chunk::NEW };

    /// The weights of rows of a kind; `None` if there is nothing to learn, or they would be too large.
    pub(super) fn learn(&mut self, kind: Kind, sides: [usize; 3], samples: &mut [i32]) -> Option<Weights> {
        self.sums.clear();
        let [width, height, depth] = sides;
        let planes = if kind == Kind::Brick { 1..depth } else { 0..1 };
        let first = usize::from(height > 1);
        let rows = height.wrapping_sub(first).wrapping_mul(planes.len());
        // An odd step meets rows at every height.
        let part = width.min(CHUNK).wrapping_mul(SAMPLES_FOR_ONE);
        let parts = samples.len().checked_div(part).unwrap_or(0).clamp(1, PARTS);
        let every = rows.wrapping_mul(width.div_ceil(CHUNK)).div_ceil(parts) | 1;
        for place in planes.flat_map(|z| (first..height).map(move |y| [y, z])).step_by(every) {
            let (around, row) = row_at(samples, sides, place)?;
            let reach = reach(kind);
            for start in (reach..width.saturating_sub(reach)).step_by(CHUNK) {
                let end = width.wrapping_sub(reach).min(start.wrapping_add(CHUNK));
                self.add(&Part::of(&around, row, start..end)?);
            }
        }
        let mut solution = [0; _];
        self.sums.solve(Weights::taps(kind), &mut solution)?;
        Some(weights_of(kind, &solution)).filter(Weights::are_small)
    }

    /// Adds a part of a row, which counts as much as any other, however large its differences are.
    fn add(&mut self, part: &Part<'_>) {
        let sources = part.neighbours.iter().chain([&part.targets]);
        let all = sources.fold(0, |all, source| {
            let differences =
                source.iter().zip(part.centre).map(|(value, centre)| value.wrapping_sub(*centre));
            differences.fold(all, |all, difference| all | difference.unsigned_abs())
        });
        let bits = u32::BITS.wrapping_sub(all.leading_zeros());
        if bits == 0 {
            return;
        }
        let (up, down) =
            (DIFFERENCE_BITS.saturating_sub(bits).min(MOST_UP), bits.saturating_sub(DIFFERENCE_BITS));
        let scaled = |difference: i32| low_half(difference << up >> down);
        let sources = part.neighbours.iter().chain([&part.targets]);
        self.chunk.load(part.centre.len(), sources, |slots, source| {
            for ((slot, value), centre) in slots.iter_mut().zip(*source).zip(part.centre) {
                *slot = scaled(value.wrapping_sub(*centre));
            }
        });
        self.chunk.add_products(part.neighbours.len(), &mut self.sums);
    }
}

impl<'a> Part<'a> {
    /// Columns `lanes` of a row, none of which is nearer to its ends than neighbours reach.
    fn of(around: &Around<'a>, row: &'a [i32], lanes: Range<usize>) -> Option<Self> {
        let reach = reach(around.kind);
        let rows = [around.north, around.up, around.up_north, around.up_south];
        let (known, centre) = match around.kind {
            Kind::Brick => (4, around.up),
            _ => (1, around.north),
        };
        let shifted = |row: &'a [i32], step: usize| {
            let start = lanes.start.wrapping_add(step).wrapping_sub(reach);
            row.get(start..start.wrapping_add(lanes.len()))
        };
        let mut neighbours = heapless::Vec::new();
        neighbours.push(shifted(row, reach.wrapping_sub(1))?).ok()?;
        let taps = (0..known).flat_map(|row| (0..=reach.wrapping_mul(2)).map(move |step| (row, step)));
        for (number, (row, step)) in taps.enumerate() {
            if number != centre_tap(around.kind) {
                neighbours.push(shifted(rows.get(row)?, step)?).ok()?;
            }
        }
        Some(Self { centre: shifted(centre, reach)?, targets: shifted(row, reach)?, neighbours })
    }
}

/// How far neighbours in known rows are from the own column, at most.
const fn reach(kind: Kind) -> usize {
    if matches!(kind, Kind::Brick) { 1 } else { 2 }
}

/// Which of the neighbours in known rows is the centre: N in a plane, U in a brick.
const fn centre_tap(kind: Kind) -> usize {
    if matches!(kind, Kind::Brick) { 4 } else { 2 }
}

/// Weights, which sum up to 1, from those of differences.
fn weights_of(kind: Kind, solution: &Solution) -> Weights {
    const DOWN: u32 = SOLUTION_BITS - WEIGHT_BITS;
    let rounded = |weight: &i16| i32::from(*weight).wrapping_add(1 << (DOWN - 1)) >> DOWN;
    let mut weights = Weights { west: 0, rows: [0; TAPS] };
    let mut solution = solution.iter().map(rounded);
    weights.west = solution.next().unwrap_or(0);
    let mut centre = (1_i32 << WEIGHT_BITS).wrapping_sub(weights.west);
    let taps = weights.rows.iter_mut().take(Weights::taps(kind)).enumerate();
    for (slot, weight) in taps.filter(|(tap, _)| *tap != centre_tap(kind)).map(|(_, slot)| slot).zip(solution)
    {
        *slot = weight;
        centre = centre.wrapping_sub(weight);
    }
    if let Some(slot) = weights.rows.get_mut(centre_tap(kind)) {
        *slot = centre;
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    extern crate std;
    use std::vec::Vec;

    /// Samples that follow a rule, and a little noise.
    fn samples(sides: [usize; 3], unruled: usize, rule: impl Fn(&[i32], usize) -> i32) -> Vec<i32> {
        let mut seed = 1_u32;
        let mut samples = Vec::new();
        for at in 0..sides.iter().product() {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = (seed >> 22).cast_signed() - 512;
            let predicted = if at < unruled { 0 } else { rule(&samples, at) };
            samples.push(predicted + noise);
        }
        samples
    }

    #[test]
    fn rules_are_found() {
        let mut slice =
            samples([64, 128, 1], 64, |before, at| (before[at - 1] + before[at - 64]).div_euclid(2));
        let weights = { Lessons::NEW }.learn(Kind::Plane, [64, 128, 1], &mut slice).unwrap();
        assert!((weights.west - 128).abs() < 24 && (weights.rows[2] - 128).abs() < 24, "{weights:?}");
        let sides = [32, 16, 16];
        let mut brick =
            samples(sides, 512, |before, at| (3 * before[at - 512] + before[at - 32]).div_euclid(4));
        let weights = { Lessons::NEW }.learn(Kind::Brick, sides, &mut brick).unwrap();
        assert!((weights.rows[4] - 192).abs() < 24 && (weights.rows[1] - 64).abs() < 24, "{weights:?}");
        assert_eq!(weights.rows.iter().sum::<i32>() + weights.west, 256);
    }

    #[test]
    fn nothing_is_learnt_from_little() {
        assert_eq!(
            { Lessons::NEW }.learn(Kind::Plane, [3, 2, 1], &mut [1; 6]),
            Some(weights_of(Kind::Plane, &[0; _]))
        );
    }
}
