//! Lifting along one axis of a part of a brick.
//!
//! Lines along x are lifted one by one; lines along y and z in panels of up to [`LANES`] neighbours in x, so that
//! memory is read and written in runs and the compiler can work on several lines at once.

use crate::lifting::{Halves, Wavelet};
use crate::memory::copy;

/// Lines lifted side by side along y and z: one cache line of samples.
pub(super) const LANES: usize = 16;

/// Which way a wavelet is applied.
#[derive(Clone, Copy, Debug)]
pub(super) enum Direction {
    Forward,
    Inverse,
}

/// The first `part` samples per axis of a brick of `sides` samples per axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) part: [usize; 3],
    pub(super) sides: [usize; 3],
}

/// Neighbouring lines: `lanes` samples at `start`, `start + stride`, … , `n` times.
#[derive(Clone, Copy, Debug)]
struct Panel {
    start: usize,
    stride: usize,
    n: usize,
    lanes: usize,
}

impl Part {
    /// Calls `lift` with each line along x; lines of one sample are left alone.
    pub(super) fn each_line(self, samples: &mut [i32], mut lift: impl FnMut(&mut [i32])) {
        let ([x, y, z], [width, height, _]) = (self.part, self.sides);
        let planes = samples.chunks_mut(width.wrapping_mul(height).max(1)).take(z);
        for row in planes.flat_map(|plane| plane.chunks_mut(width.max(1)).take(y)) {
            row.get_mut(..x).map(&mut lift);
        }
    }

    /// The panels that hold every line along y.
    fn along_y(self) -> impl Iterator<Item = Panel> {
        let ([x, n, z], [width, height, _]) = (self.part, self.sides);
        let starts = (0..z).map(move |z| z.wrapping_mul(width.wrapping_mul(height)));
        starts.flat_map(move |start| panels(start, x, width, n))
    }

    /// The panels that hold every line along z.
    fn along_z(self) -> impl Iterator<Item = Panel> {
        let ([x, y, n], [width, height, _]) = (self.part, self.sides);
        let starts = (0..y).map(move |y| y.wrapping_mul(width));
        starts.flat_map(move |start| panels(start, x, width.wrapping_mul(height), n))
    }

    /// Lifts every line along `axis` (0 = x) that is longer than one sample, in place.
    pub(super) fn lift(
        self,
        axis: u8,
        wavelet: Wavelet,
        direction: Direction,
        memory: (&mut [i32], &mut [i32]),
    ) {
        let (samples, scratch) = memory;
        let [x, y, z] = self.part;
        match axis {
            0 if x > 1 => self.each_line(samples, |line| match direction {
                Direction::Forward => forward_line(wavelet, line, scratch),
                Direction::Inverse => inverse_line(wavelet, line, scratch),
            }),
            1 if y > 1 => self.along_y().for_each(|panel| panel.lift(wavelet, direction, samples, scratch)),
            2 if z > 1 => self.along_z().for_each(|panel| panel.lift(wavelet, direction, samples, scratch)),
            _ => {}
        }
    }
}

/// Panels over the `x` neighbouring lines that begin at `start`.
fn panels(start: usize, x: usize, stride: usize, n: usize) -> impl Iterator<Item = Panel> {
    (0..x).step_by(LANES).map(move |lane| Panel {
        start: start.wrapping_add(lane),
        stride,
        n,
        lanes: LANES.min(x.wrapping_sub(lane)),
    })
}

fn forward_line(wavelet: Wavelet, line: &mut [i32], scratch: &mut [i32]) {
    let Some(scratch) = scratch.get_mut(..line.len()) else { return };
    let Some((low, high)) = scratch.split_at_mut_checked(line.len().div_ceil(2)) else { return };
    let (pairs, odd) = line.as_chunks::<2>();
    for ((&[even, odd], c), d) in pairs.iter().zip(low.iter_mut()).zip(high.iter_mut()) {
        (*c, *d) = (even, odd);
    }
    if let (&[last], Some(c)) = (odd, low.last_mut()) {
        *c = last;
    }
    wavelet.forward(&mut Halves::new(low, high, 1));
    copy(scratch, line);
}

fn inverse_line(wavelet: Wavelet, line: &mut [i32], scratch: &mut [i32]) {
    let Some(scratch) = scratch.get_mut(..line.len()) else { return };
    copy(line, scratch);
    let Some((low, high)) = scratch.split_at_mut_checked(line.len().div_ceil(2)) else { return };
    wavelet.inverse(&mut Halves::new(low, high, 1));
    let (pairs, odd) = line.as_chunks_mut::<2>();
    for ((pair, &c), &d) in pairs.iter_mut().zip(low.iter()).zip(high.iter()) {
        *pair = [c, d];
    }
    if let ([last], Some(&c)) = (odd, low.last()) {
        *last = c;
    }
}

impl Panel {
    fn lift(self, wavelet: Wavelet, direction: Direction, samples: &mut [i32], scratch: &mut [i32]) {
        let Some(scratch) = scratch.get_mut(..self.n.wrapping_mul(self.lanes)) else { return };
        let lows = self.n.div_ceil(2);
        let split = lows.wrapping_mul(self.lanes);
        let interleaved = |row: usize| match row.checked_sub(lows) {
            None => row.wrapping_mul(2),
            Some(i) => i.wrapping_mul(2).wrapping_add(1),
        };
        let in_order = |row: usize| row;
        match direction {
            Direction::Forward => {
                self.gather(samples, scratch, interleaved);
                let Some((low, high)) = scratch.split_at_mut_checked(split) else { return };
                wavelet.forward(&mut Halves::new(low, high, self.lanes));
                self.scatter(samples, scratch, in_order);
            }
            Direction::Inverse => {
                self.gather(samples, scratch, in_order);
                let Some((low, high)) = scratch.split_at_mut_checked(split) else { return };
                wavelet.inverse(&mut Halves::new(low, high, self.lanes));
                self.scatter(samples, scratch, interleaved);
            }
        }
    }

    /// Copies row `place(row)` of the lines to each row of `scratch`.
    fn gather(self, samples: &[i32], scratch: &mut [i32], place: impl Fn(usize) -> usize) {
        for (row, to) in scratch.chunks_exact_mut(self.lanes.max(1)).enumerate() {
            let start = self.start.wrapping_add(place(row).wrapping_mul(self.stride));
            if let Some(from) = samples.get(start..start.wrapping_add(self.lanes)) {
                copy(from, to);
            }
        }
    }

    /// Copies each row of `scratch` to row `place(row)` of the lines.
    fn scatter(self, samples: &mut [i32], scratch: &[i32], place: impl Fn(usize) -> usize) {
        for (row, from) in scratch.chunks_exact(self.lanes.max(1)).enumerate() {
            let start = self.start.wrapping_add(place(row).wrapping_mul(self.stride));
            if let Some(to) = samples.get_mut(start..start.wrapping_add(self.lanes)) {
                copy(from, to);
            }
        }
    }
}
