//! What the residuals around a row tell of its own.

use super::pass::Pass;
use super::residual::Context;
use crate::memory::copy;

/// Residuals are remembered up to this magnitude, so that no sum of them overflows.
const LARGEST: i32 = 1 << 20;

/// Rows of scratch that a [`Surroundings`] takes.
pub(super) const ROWS: usize = 6;

/// A residual as it is remembered.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn remembered(residual: i32) -> i32 {
    residual.clamp(-LARGEST, LARGEST)
}

/// What is known around each sample of a row, but to its west.
#[derive(Debug)]
pub(super) struct Surroundings<'a> {
    /// 4 (2 (N + U) + NW + NE + UW + UN + UE + US) + 3 (NN + A + B), of magnitudes.
    energies: &'a mut [i32],
    /// Magnitudes up to 2 of N, U, A, B and NW + NE as digits to base 3, and above signs of N, U, A, B, NW.
    patterns: &'a mut [i32],
    /// The rows to the north and above within zeros, and the known ones.
    memory: &'a mut [i32],
    width: usize,
}

impl<'a> Surroundings<'a> {
    pub(super) fn new(pass: &Pass, pitch: usize, scratch: &'a mut [i32]) -> Option<Self> {
        let [width, ..] = pass.new_sides();
        let (energies, rest) = scratch.split_at_mut_checked(pitch)?;
        let (patterns, memory) = rest.split_at_mut_checked(pitch)?;
        Some(Self {
            energies: energies.get_mut(..width)?,
            patterns: patterns.get_mut(..width)?,
            memory,
            width,
        })
    }

    /// Gathers what is around new row `place`.
    pub(super) fn fill(&mut self, pass: &Pass, residuals: &[i32], place: [usize; 2]) -> Option<()> {
        let [y, z] = place;
        let (north_of, above) = (y.wrapping_sub(1), z.wrapping_sub(1));
        let pitch = self.width.wrapping_add(2);
        let (north, rest) = self.memory.split_at_mut_checked(pitch)?;
        let (up, rest) = rest.split_at_mut_checked(pitch)?;
        let (zeros, rest) = rest.split_at_mut_checked(pitch)?;
        let after = rest.get_mut(..pitch)?;
        zeros.fill(0);
        let row = |y: usize, z: usize| pass.new_row([y, z]).and_then(|row| residuals.get(row));
        for (to, from) in [(&mut *north, row(north_of, z)), (&mut *up, row(y, above))] {
            to.fill(0);
            copy(from.unwrap_or(&[]), to.get_mut(1..)?);
        }
        let zeros = &*zeros;
        let [up_north, up_south, north_north] =
            [row(north_of, above), row(y.wrapping_add(1), above), row(y.wrapping_sub(2), z)]
                .map(|row| row.unwrap_or(zeros));
        let (before, known_after) = known_rows(pass, residuals, place)?;
        copy(before, after);
        copy(known_after, after);
        let others = [up_north, up_south, north_north, before, after];
        summarize(self.energies, self.patterns, [north, up], others);
        Some(())
    }

    /// The context of each sample of the row, given the two residuals before.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn iter(&self) -> impl Iterator<Item = Surrounding> + '_ {
        let pairs = self.energies.iter().zip(self.patterns.iter());
        pairs.map(|(&energy, &pattern)| Surrounding { energy, pattern })
    }
}

/// Sets the energies and patterns of a row: of the rows to the north and above within zeros, and of UN, US, NN, A, B.
fn summarize(energies: &mut [i32], patterns: &mut [i32], [north, up]: [&[i32]; 2], others: [&[i32]; 5]) {
    let [up_north, up_south, north_north, before, after] = others;
    let windows = north.array_windows::<3>().zip(up.array_windows::<3>());
    let others = up_north.iter().zip(up_south).zip(north_north);
    let known = before.iter().zip(after);
    let targets = energies.iter_mut().zip(patterns);
    for (((target, (north, up)), ((a, b), c)), (before, after)) in targets.zip(windows).zip(others).zip(known)
    {
        let values = Values { north: *north, up: *up, others: [*a, *b, *c], known: [*before, *after] };
        (*target.0, *target.1) = (values.energy(), values.pattern());
    }
}

/// The residuals of the known samples before and after a row; at the end of the latter there are none.
fn known_rows<'r>(pass: &Pass, residuals: &'r [i32], place: [usize; 2]) -> Option<(&'r [i32], &'r [i32])> {
    let known = |along: isize| {
        let place =
            if pass.axis == 1 { pass.near_known(place, along, 0) } else { pass.near_known(place, 0, along) };
        pass.known_row(place).and_then(|row| residuals.get(row))
    };
    if pass.axis == 0 {
        let row = residuals.get(pass.known_row(place)?)?;
        return Some((row, row.get(1..)?));
    }
    Some((known(0)?, known(1).unwrap_or(&[])))
}

/// What is known around a sample, but to its west.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surrounding {
    energy: i32,
    pattern: i32,
}

impl Surrounding {
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn after(self, west: i32, west_west: i32) -> Context {
        let (magnitude, far) = (west.wrapping_abs(), west_west.wrapping_abs());
        let sum = self.energy.wrapping_add(magnitude.wrapping_mul(8)).wrapping_add(far.wrapping_mul(3));
        let [a, b, c, d] = self.pattern.to_le_bytes();
        let magnitudes = usize::from(u16::from_le_bytes([a, b]));
        let signs = usize::from(u16::from_le_bytes([c, d]));
        let digit = |value: i32| usize::try_from(value).unwrap_or(0).wrapping_mul(243);
        Context {
            energy: sum >> 2,
            magnitudes: magnitudes.wrapping_add(digit(magnitude.min(2))),
            signs: signs.wrapping_add(digit(west.signum().wrapping_add(1))),
        }
    }
}

/// Residuals around a sample.
#[derive(Clone, Copy, Debug)]
struct Values {
    north: [i32; 3],
    up: [i32; 3],
    /// UN, US, NN.
    others: [i32; 3],
    /// Before and after along the axis of the pass.
    known: [i32; 2],
}

impl Values {
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn energy(self) -> i32 {
        let [north_west, north, north_east] = self.north.map(i32::wrapping_abs);
        let [up_west, up, up_east] = self.up.map(i32::wrapping_abs);
        let [up_north, up_south, north_north] = self.others.map(i32::wrapping_abs);
        let [before, after] = self.known.map(i32::wrapping_abs);
        let sum = |values: [i32; 6]| values.into_iter().fold(0, i32::wrapping_add);
        let corners = sum([north_west, north_east, up_west, up_north, up_east, up_south]);
        let near = corners.wrapping_add(north.wrapping_add(up) << 1);
        let far = sum([north_north, before, after, 0, 0, 0]);
        (near << 2).wrapping_add(far << 1).wrapping_add(far)
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn pattern(self) -> i32 {
        let [north_west, north, north_east] = self.north;
        let [_, up, _] = self.up;
        let [before, after] = self.known;
        let number = |digits: [i32; 5]| {
            digits
                .into_iter()
                .fold(0_i32, |number, digit| (number << 1).wrapping_add(number).wrapping_add(digit))
        };
        let diagonal = north_west.wrapping_abs().wrapping_add(north_east.wrapping_abs());
        let magnitudes = number(
            [north.wrapping_abs(), up.wrapping_abs(), before.wrapping_abs(), after.wrapping_abs(), diagonal]
                .map(|value| value.min(2)),
        );
        let signs =
            number([north, up, before, after, north_west].map(|value| value.signum().wrapping_add(1)));
        magnitudes | signs << 16
    }
}
