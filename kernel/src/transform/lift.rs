//! One level of a transform, in place.
//!
//! Lines along x are lifted several at a time, end to end; lines along y and z in panels of neighbours in x, side by
//! side. Either way memory is read and written in runs, and the compiler can work on many samples at once.

use super::row::{Row, divide, interleave, join, separate};
use crate::lifting::{Direction, Halves, Wavelet};
use crate::memory::copy;

/// Lines lifted side by side along y and z: one cache line of samples.
const LANES: usize = 16;

/// Lines lifted side by side in small builds: where instructions count, as many as are copied at once.
const SMALL_LANES: usize = if cfg!(feature = "light") { 8 } else { 1 };

/// The most lines that are lifted at a time along x.
const ROWS: usize = 16;

/// The first `part` samples per axis of a brick of `sides` samples per axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) part: [usize; 3],
    pub(super) sides: [usize; 3],
}

impl Part {
    /// The same samples: slices of one row each are rows of a slice.
    const fn with_rows(self) -> Self {
        match self {
            Self { part: [x, _, z], sides: [width, 1, depth] } => {
                Self { part: [x, z, 1], sides: [width, depth, 1] }
            }
            part => part,
        }
    }
}

/// A wavelet, and memory for the lines that it is applied to.
#[derive(Debug)]
pub(super) struct Lifter<'a> {
    pub(super) wavelet: Wavelet,
    pub(super) scratch: &'a mut [i32],
}

/// Neighbouring lines: `lanes` samples, each `right` of the one before, at `start`, `start + stride`, … , `n` times.
#[derive(Clone, Copy, Debug)]
struct Lines {
    start: usize,
    stride: usize,
    right: usize,
    n: usize,
    lanes: usize,
}

/// `i32`s of scratch that [`Lifter`] takes for a brick of these sides.
pub(super) const fn scratch_len([x, y, z]: [usize; 3]) -> usize {
    let longest = if y > z { y } else { z };
    if cfg!(feature = "small") {
        let longest = if x > longest { x } else { longest };
        return Halves::group_len(SMALL_LANES, longest);
    }
    let lanes = if x < LANES { x } else { LANES };
    let columns = if longest > 1 { Halves::group_len(lanes, longest) } else { 0 };
    let row = if x > 1 { Halves::group_len(1, x) } else { 0 };
    if row > columns { row } else { columns }
}

impl Lifter<'_> {
    /// Lifts the lines of `part`, those longer than one sample: forward along x, y, z, inverse along z, y, x.
    ///
    /// Along x and y slice by slice, which the fastest memory may hold.
    pub(super) fn lift(&mut self, direction: Direction, part: Part, samples: &mut [i32]) {
        if cfg!(feature = "small") {
            return self.lift_in_panels(direction, part, samples);
        }
        let part = part.with_rows();
        let ([x, y, z], [width, height, _]) = (part.part, part.sides);
        let slice = width.wrapping_mul(height);
        if let Direction::Inverse = direction {
            self.lift_depth(direction, part, samples);
        }
        let columns = Lines { start: 0, stride: width, right: 1, n: y, lanes: x };
        for slice in samples.chunks_mut(slice.max(1)).take(z) {
            let rows = slice.get_mut(..width.wrapping_mul(y)).unwrap_or_default();
            match direction {
                Direction::Forward => {
                    self.lift_rows(direction, [x, width], rows);
                    self.lift_lines(direction, columns, rows);
                }
                Direction::Inverse => {
                    self.lift_lines(direction, columns, rows);
                    self.lift_rows(direction, [x, width], rows);
                }
            }
        }
        if let Direction::Forward = direction {
            self.lift_depth(direction, part, samples);
        }
    }

    /// The same a few lines at a time, whatever their direction: less code, and memory for fewer lines.
    fn lift_in_panels(&mut self, direction: Direction, part: Part, samples: &mut [i32]) {
        let ([x, y, z], [width, height, _]) = (part.part, part.sides);
        let [x, y, z] = [(x, 1), (y, width), (z, width.wrapping_mul(height))];
        let axes = match direction {
            Direction::Forward => [(x, y, z), (y, x, z), (z, x, y)],
            Direction::Inverse => [(z, x, y), (y, x, z), (x, y, z)],
        };
        for ((n, stride), (columns, right), (rows, down)) in axes {
            if n < 2 {
                continue;
            }
            for row in 0..rows {
                for column in (0..columns).step_by(SMALL_LANES) {
                    let start = row.wrapping_mul(down).wrapping_add(column.wrapping_mul(right));
                    let lanes = SMALL_LANES.min(columns.wrapping_sub(column));
                    self.lift_panel(direction, Lines { start, stride, right, n, lanes }, samples);
                }
            }
        }
    }

    /// Lifts along z.
    fn lift_depth(&mut self, direction: Direction, part: Part, samples: &mut [i32]) {
        let ([lanes, y, n], [width, height, _]) = (part.part, part.sides);
        for start in (0..y).map(|row| row.wrapping_mul(width)) {
            self.lift_lines(
                direction,
                Lines { start, stride: width.wrapping_mul(height), right: 1, n, lanes },
                samples,
            );
        }
    }

    /// Lifts the first `x` samples of each row of `width`.
    fn lift_rows(&mut self, direction: Direction, [x, width]: [usize; 2], rows: &mut [i32]) {
        if x < 2 {
            return;
        }
        let room = self.scratch.len().checked_div(Halves::group_len(1, x)).unwrap_or(0);
        let batch = room.clamp(1, ROWS);
        for rows in rows.chunks_mut(width.wrapping_mul(batch).max(1)) {
            let mut halves = Halves::new(self.scratch, 1, x, batch);
            match direction {
                Direction::Forward => {
                    each_row(rows, [x, width], &mut halves, separate);
                    self.wavelet.forward(&mut halves);
                    each_row(rows, [x, width], &mut halves, join);
                }
                Direction::Inverse => {
                    each_row(rows, [x, width], &mut halves, divide);
                    self.wavelet.inverse(&mut halves);
                    each_row(rows, [x, width], &mut halves, interleave);
                }
            }
        }
    }

    /// Lifts neighbouring lines, panel by panel.
    fn lift_lines(&mut self, direction: Direction, lines: Lines, samples: &mut [i32]) {
        if lines.n < 2 {
            return;
        }
        for lane in (0..lines.lanes).step_by(LANES) {
            let lanes = LANES.min(lines.lanes.wrapping_sub(lane));
            self.lift_panel(
                direction,
                Lines { start: lines.start.wrapping_add(lane), lanes, ..lines },
                samples,
            );
        }
    }

    fn lift_panel(&mut self, direction: Direction, panel: Lines, samples: &mut [i32]) {
        let mut halves = Halves::new(self.scratch, panel.lanes, panel.n, 1);
        // Where the first d is, and how far it is from one c or d to the next.
        let (in_turn, in_halves) = ((1, 2), (panel.n.div_ceil(2), 1));
        let (from, to) = match direction {
            Direction::Forward => (in_turn, in_halves),
            Direction::Inverse => (in_halves, in_turn),
        };
        for (low, high) in halves.groups() {
            panel.gather(samples, low, (0, from.1));
            panel.gather(samples, high, from);
        }
        match direction {
            Direction::Forward => self.wavelet.forward(&mut halves),
            Direction::Inverse => self.wavelet.inverse(&mut halves),
        }
        for (low, high) in halves.groups() {
            panel.scatter(samples, low, (0, to.1));
            panel.scatter(samples, high, to);
        }
    }
}

/// Calls `work` with the first `x` samples of each row of `width`, and with its halves.
#[cfg_attr(not(feature = "small"), inline(always))]
fn each_row(rows: &mut [i32], [x, width]: [usize; 2], halves: &mut Halves<'_>, work: impl Fn(Row<'_>)) {
    for (samples, (low, high)) in rows.chunks_mut(width.max(1)).zip(halves.groups()) {
        let samples = samples.get_mut(..x).unwrap_or_default();
        work(Row { samples, low, high });
    }
}

impl Lines {
    /// Copies its samples `first`, `first + step`, … to a half.
    fn gather(self, samples: &[i32], half: &mut [i32], (first, step): (usize, usize)) {
        let start = self.start.wrapping_add(self.stride.wrapping_mul(first));
        let pitch = self.stride.wrapping_mul(step);
        if cfg!(feature = "small") {
            return self.gather_any(samples, half, (start, pitch));
        }
        let rows = samples.get(start..).unwrap_or_default().chunks(pitch.max(1));
        if self.lanes == LANES {
            for (to, from) in
                half.as_chunks_mut::<LANES>().0.iter_mut().zip(rows.filter_map(<[i32]>::first_chunk))
            {
                *to = *from;
            }
        } else {
            half.chunks_exact_mut(self.lanes.max(1)).zip(rows).for_each(|(to, from)| copy(from, to));
        }
    }

    /// Copies a half to its samples `first`, `first + step`, …
    fn scatter(self, samples: &mut [i32], half: &[i32], (first, step): (usize, usize)) {
        let start = self.start.wrapping_add(self.stride.wrapping_mul(first));
        let pitch = self.stride.wrapping_mul(step);
        if cfg!(feature = "small") {
            return self.scatter_any(samples, half, (start, pitch));
        }
        let rows = samples.get_mut(start..).unwrap_or_default().chunks_mut(pitch.max(1));
        if self.lanes == LANES {
            for (to, from) in rows.filter_map(<[i32]>::first_chunk_mut).zip(half.as_chunks::<LANES>().0) {
                *to = *from;
            }
        } else {
            rows.zip(half.chunks_exact(self.lanes.max(1))).for_each(|(to, from)| copy(from, to));
        }
    }

    /// How many there are in small builds, at least one; where there is only ever one, the compiler knows.
    fn side_by_side(self) -> usize {
        if SMALL_LANES == 1 { 1 } else { self.lanes.max(1) }
    }

    /// [`Lines::gather`] of lines that lie side by side in any direction.
    fn gather_any(self, samples: &[i32], half: &mut [i32], (mut start, pitch): (usize, usize)) {
        for across in half.chunks_exact_mut(self.side_by_side()) {
            let mut place = start;
            start = start.wrapping_add(pitch);
            if SMALL_LANES > 1
                && self.right == 1
                && let Some(to) = across.as_mut_array::<SMALL_LANES>()
                && let Some(from) = samples.get(place..).and_then(<[i32]>::first_chunk)
            {
                *to = *from;
                continue;
            }
            for to in across {
                *to = samples.get(place).copied().unwrap_or(0);
                place = place.wrapping_add(self.right);
            }
        }
    }

    /// [`Lines::scatter`] to lines that lie side by side in any direction.
    fn scatter_any(self, samples: &mut [i32], half: &[i32], (mut start, pitch): (usize, usize)) {
        for across in half.chunks_exact(self.side_by_side()) {
            let mut place = start;
            start = start.wrapping_add(pitch);
            if SMALL_LANES > 1
                && self.right == 1
                && let Some(from) = across.as_array::<SMALL_LANES>()
                && let Some(to) = samples.get_mut(place..).and_then(<[i32]>::first_chunk_mut)
            {
                *to = *from;
                continue;
            }
            for &from in across {
                samples.get_mut(place).into_iter().for_each(|to| *to = from);
                place = place.wrapping_add(self.right);
            }
        }
    }
}
