//! Where the samples of a pass are, and the lattice growing in place.

use core::ops::Range;

use crate::Extent;
use crate::memory::{copy, move_within};

/// A pass: the samples halfway between known ones along one axis, with which a lattice becomes finer along it.
///
/// A lattice is held without gaps, x fastest. A pass along x holds each row as its known samples and then its new
/// ones; [`Pass::interleave`] brings them into order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pass {
    pub(super) axis: usize,
    pub(super) level: u8,
    /// Samples of the lattice per axis, the new ones included.
    pub(super) sides: [usize; 3],
    /// New samples along the axis of the pass.
    new: usize,
}

impl Pass {
    /// The passes that make the lattice of stride 2^`level` of that of twice the stride, where `extent` is that of
    /// level `finest`.
    pub(super) fn all(extent: Extent, finest: u8, level: u8) -> impl Iterator<Item = Self> {
        let stride = level.wrapping_sub(finest);
        let (fine, coarse) =
            (extent.coarsened(stride).sides(), extent.coarsened(stride.saturating_add(1)).sides());
        (0..3_usize).filter_map(move |axis| {
            let mut sides = coarse;
            for (side, &fine) in sides.iter_mut().zip(&fine).take(axis.wrapping_add(1)) {
                *side = fine;
            }
            let new = sides.get(axis)? / 2;
            (new > 0).then_some(Self { axis, level, sides, new })
        })
    }

    /// Known samples along the axis of the pass.
    pub(super) fn known(&self) -> usize {
        self.sides.get(self.axis).map_or(0, |side| side.wrapping_sub(self.new))
    }

    /// New samples per axis.
    pub(super) fn new_sides(&self) -> [usize; 3] {
        let mut sides = self.sides;
        sides.iter_mut().skip(self.axis).take(1).for_each(|side| *side = self.new);
        sides
    }

    /// New samples.
    pub(super) fn count(&self) -> usize {
        self.new_sides().iter().product()
    }

    /// The rows of new samples, in order: the y-th of the z-th plane of new samples.
    pub(super) fn rows(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [_, ys, zs] = self.new_sides();
        (0..zs).flat_map(move |z| (0..ys).map(move |y| [y, z]))
    }

    /// Where a row of new samples is, if there is one.
    pub(super) fn new_row(&self, [y, z]: [usize; 2]) -> Option<Range<usize>> {
        let [width, ys, zs] = self.new_sides();
        if y >= ys || z >= zs {
            return None;
        }
        let odd = |at: usize| at.wrapping_mul(2).wrapping_add(1);
        let start = match self.axis {
            0 => self.start(y, z).wrapping_add(self.known()),
            1 => self.start(odd(y), z),
            _ => self.start(y, odd(z)),
        };
        Some(start..start.wrapping_add(width))
    }

    /// Where a row of known samples is, if there is one. Counted along the axis of the pass are known samples only.
    pub(super) fn known_row(&self, [y, z]: [usize; 2]) -> Option<Range<usize>> {
        let [x, mut ys, mut zs] = self.sides;
        let (start, width) = match self.axis {
            0 => (self.start(y, z), self.known()),
            1 => {
                ys = self.known();
                (self.start(y.wrapping_mul(2), z), x)
            }
            _ => {
                zs = self.known();
                (self.start(y, z.wrapping_mul(2)), x)
            }
        };
        (y < ys && z < zs).then_some(start..start.wrapping_add(width))
    }

    /// The known row `y` rows and `z` planes from that of new row `place`, or the nearest there is.
    pub(super) fn near(&self, place: [usize; 2], y: isize, z: isize) -> [usize; 2] {
        let [_, ys, zs] = self.sides;
        let [here_y, here_z] = place;
        let shift =
            |at: usize, by: isize, side: usize| at.saturating_add_signed(by).min(side.wrapping_sub(1));
        [shift(here_y, y, ys), shift(here_z, z, zs)]
    }

    /// As [`Pass::near`] across a pass along y or z; along it, the known row after next and so on, there or not.
    pub(super) fn near_known(&self, place: [usize; 2], y: isize, z: isize) -> [usize; 2] {
        let [near_y, near_z] = self.near(place, y, z);
        let [here_y, here_z] = place;
        if self.axis == 1 {
            [here_y.wrapping_add_signed(y), near_z]
        } else {
            [near_y, here_z.wrapping_add_signed(z)]
        }
    }

    fn start(&self, y: usize, z: usize) -> usize {
        let [width, height, _] = self.sides;
        z.wrapping_mul(height).wrapping_add(y).wrapping_mul(width)
    }

    /// Makes room for the new samples in a lattice without them.
    pub(super) fn spread(&self, lattice: &mut [i32]) {
        let [width, height, depth] = self.sides;
        let run = match self.axis {
            0 => self.known(),
            1 => width,
            _ => width.wrapping_mul(height),
        };
        let runs = match self.axis {
            0 => height.wrapping_mul(depth),
            1 => self.known().wrapping_mul(depth),
            _ => self.known(),
        };
        for number in (1..runs).rev() {
            let from = number.wrapping_mul(run);
            let to = match self.axis {
                0 => number.wrapping_mul(width),
                1 => {
                    let known = self.known().max(1);
                    let (y, z) =
                        (number.checked_rem(known).unwrap_or(0), number.checked_div(known).unwrap_or(0));
                    self.start(y.wrapping_mul(2), z)
                }
                _ => from.wrapping_mul(2),
            };
            match lattice.split_at_mut_checked(to) {
                Some((before, after)) if from.wrapping_add(run) <= to => {
                    copy(before.get(from..from.wrapping_add(run)).unwrap_or(&[]), after);
                }
                _ => move_within(lattice, from..from.wrapping_add(run), to),
            }
        }
    }

    /// Brings the samples of each row into order after a pass along x. `memory` holds a row.
    pub(super) fn interleave(&self, lattice: &mut [i32], memory: &mut [i32]) {
        let width = self.sides.first().copied().unwrap_or(0);
        if self.axis != 0 {
            return;
        }
        for row in lattice.chunks_exact_mut(width.max(1)).take(self.sides.iter().skip(1).product()) {
            copy(row, memory);
            let (known, new) = memory.split_at_checked(self.known()).unwrap_or((&[], &[]));
            row.iter_mut().step_by(2).zip(known).for_each(|(to, from)| *to = *from);
            row.iter_mut().skip(1).step_by(2).zip(new).for_each(|(to, from)| *to = *from);
        }
    }

    /// Sets the new samples to those of `all`, which has `extent` samples.
    pub(super) fn fill(&self, extent: Extent, all: &[i32], lattice: &mut [i32]) {
        let place = |axis: usize, at: usize| {
            let at = if axis == self.axis { at.wrapping_mul(2).wrapping_add(1) } else { at };
            at << if axis > self.axis { self.level.wrapping_add(1) } else { self.level }
        };
        let step = place(0, 1).wrapping_sub(place(0, 0));
        let [width, height, _] = extent.sides();
        for [y, z] in self.rows() {
            let start = place(2, z).wrapping_mul(height).wrapping_add(place(1, y)).wrapping_mul(width);
            let from = all.get(start.wrapping_add(place(0, 0))..).unwrap_or(&[]);
            let row = self.new_row([y, z]).and_then(|row| lattice.get_mut(row)).unwrap_or(&mut []);
            row.iter_mut().zip(from.iter().step_by(step.max(1))).for_each(|(to, from)| *to = *from);
        }
    }
}
