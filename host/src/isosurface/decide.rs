//! How the trilinear interpolant joins corners across faces and through the inside of a cell.
//!
//! Values are relative to the isovalue here: positive corners are inside.

use super::cell::{self, CORNERS};

/// Sets of corners that are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Joined {
    /// A corner of the same set, which is the set's name: the lowest of it.
    set: [u8; CORNERS],
}

impl Joined {
    /// Each corner by itself.
    pub(super) fn new() -> Self {
        Self { set: std::array::from_fn(|corner| corner as u8) }
    }

    pub(super) fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.set[a], self.set[b]);
        self.set.iter_mut().filter(|set| **set == a.max(b)).for_each(|set| *set = a.min(b));
    }

    /// The lowest corner of the set of this corner.
    pub(super) fn set(&self, corner: usize) -> u8 {
        self.set[corner]
    }
}

/// Whether the inside corners of a face on which inside and outside alternate are joined across it: the asymptotic decider
/// (Nielson, Hamann 1991), by the sign of the bilinear interpolant at its saddle.
pub(super) fn joined_across(values: &[f64; CORNERS], face: usize) -> bool {
    let [a, b, c, d] = cell::face_corners(face).map(|corner| values[corner]);
    if a > 0.0 { a * c > b * d } else { b * d > a * c }
}

/// A column of the cell along z: its value goes from that of its lower to that of its upper corner.
#[derive(Clone, Copy, Debug)]
struct Column {
    low: f64,
    high: f64,
    corner: usize,
}

impl Column {
    fn at(&self, z: f64) -> f64 {
        self.low * (1.0 - z) + self.high * z
    }

    fn slope(&self) -> f64 {
        self.high - self.low
    }

    /// Where the column changes sides; somewhere if both ends are infinite.
    fn crossing(&self) -> Option<f64> {
        let crosses = (self.low > 0.0) != (self.high > 0.0);
        let place = self.low / (self.low - self.high);
        crosses.then_some(if place.is_nan() { 0.5 } else { place })
    }

    /// The corner that the column leads to from z without changing sides.
    fn corner_of(&self, z: f64) -> usize {
        let upper = self.crossing().is_some_and(|crossing| z > crossing);
        self.corner | usize::from(upper) << 2
    }
}

/// Joins, in addition to what is joined on the border of the cell, the corners that the trilinear interpolant joins through
/// its inside.
///
/// A slice of constant z is bilinear, so that each part of it which is inside (or outside) contains a corner of the slice,
/// and opposite corners are joined in it by the sign of q = a c - b d, which is quadratic in z. Between the places where
/// columns change sides it is enough to know whether q is positive somewhere, and negative somewhere.
pub(super) fn join_through(values: &[f64; CORNERS], joined: &mut Joined) {
    let columns = [0, 1, 3, 2].map(|corner| Column { low: values[corner], high: values[corner | 4], corner });
    let [a, b, c, d] = columns.each_ref().map(|column| column.crossing().unwrap_or(1.0));
    let mut levels = [0.0, a, b, c, d, 1.0];
    levels.sort_unstable_by(f64::total_cmp);
    for [from, to] in levels.array_windows().copied().filter(|[from, to]| from < to) {
        let corners = columns.map(|column| column.corner_of(0.5 * (from + to)));
        let [a, b, c, d] = corners.map(|corner| values[corner] > 0.0);
        if a == c && b == d && a != b {
            let [least, most] = range_of_saddle(&columns, from, to);
            if most > 0.0 {
                joined.join(corners[0], corners[2]);
            }
            if least < 0.0 {
                joined.join(corners[1], corners[3]);
            }
        }
    }
}

/// Least and greatest value of a c - b d between two levels.
fn range_of_saddle(columns @ [a, b, c, d]: &[Column; 4], from: f64, to: f64) -> [f64; 2] {
    let saddle = |z: f64| {
        let [a, b, c, d] = columns.map(|column| column.at(z));
        a * c - b * d
    };
    let square = a.slope() * c.slope() - b.slope() * d.slope();
    let linear = a.low * c.slope() + c.low * a.slope() - b.low * d.slope() - d.low * b.slope();
    let top = (-0.5 * linear / square).clamp(from, to);
    let candidates = [saddle(from), saddle(to), if top.is_nan() { saddle(from) } else { saddle(top) }];
    [candidates.into_iter().fold(f64::MAX, f64::min), candidates.into_iter().fold(f64::MIN, f64::max)]
}
