//! What is known of the rows before: predictions and classes.

use super::form::{Breadth, scene};
use super::model::Model;
use crate::oracle::coder::array::Array;
use crate::oracle::coder::predict::Predictor;

/// The least energies of the classes above the first.
const THRESHOLDS: [i64; 13] = [1, 3, 5, 8, 12, 18, 28, 44, 80, 160, 400, 1200, 5000];

/// The values of places as far as they are known: fewer, perhaps, than the extent has.
#[derive(Debug)]
pub(super) struct Rows(Array);

/// The known rows of a brick, as (y, z): of a plane N alone.
struct Known {
    n: [usize; 2],
    u: [usize; 2],
    un: [usize; 2],
    us: [usize; 2],
}

/// All places, x fastest.
pub(super) fn places([width, height, depth]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let rows = (0..depth).flat_map(move |z| (0..height).map(move |y| [y, z]));
    rows.flat_map(move |[y, z]| (0..width).map(move |x| [x, y, z]))
}

impl Rows {
    pub(super) const fn new(extent: [usize; 3], values: Vec<i32>) -> Self {
        Self(Array { extent, values })
    }

    /// Those that are known, x fastest.
    pub(super) fn values(&self) -> &[i32] {
        &self.0.values
    }

    pub(super) fn push(&mut self, value: i64) {
        self.0.values.push(i32::try_from(value).expect("a tabled value has few bits"));
    }

    /// The value of a row at x + i, or its first or last.
    fn at(&self, [y, z]: [usize; 2], x: usize, i: isize) -> i64 {
        self.0.nearest([x.cast_signed() + i, y.cast_signed(), z.cast_signed()]).into()
    }

    fn columns(&self, row: [usize; 2], x: usize, reach: isize) -> Vec<i64> {
        (-reach..=reach).map(|i| self.at(row, x, i)).collect()
    }

    /// Those of a brick, z > 0.
    const fn known(&self, y: usize, z: usize) -> Known {
        let u = [y, z - 1];
        Known {
            n: if y > 0 { [y - 1, z] } else { u },
            u,
            un: if y > 0 { [y - 1, z - 1] } else { u },
            us: if y + 1 < self.0.extent[1] { [y + 1, z - 1] } else { u },
        }
    }
}

/// p of the text at a place, from samples less the lowest.
pub(super) fn prediction(
    samples: &Rows,
    (breadth, model): (Breadth, &Model),
    span: i32,
    place: [usize; 3],
) -> i64 {
    let p = match breadth {
        Breadth::Narrow => narrow(samples, model, place),
        Breadth::Wide => wide(samples, model, place),
    };
    p.clamp(0, span.into())
}

/// p before it is clamped.
fn wide(samples: &Rows, model: &Model, place: [usize; 3]) -> i64 {
    let narrowed = |set: &Vec<i64>| set.iter().map(|&weight| weight as i32).collect();
    let weights = Predictor::Weights(model.weights.iter().map(narrowed).collect());
    scene(&samples.0).predict(&weights, place.map(usize::cast_signed)).p.into()
}

/// p before it is clamped.
fn narrow(samples: &Rows, model: &Model, [x, y, z]: [usize; 3]) -> i64 {
    let before = |n: [usize; 2]| if x > 0 { samples.at([y, z], x, -1) } else { samples.at(n, 0, 0) };
    let (weights, values) = match (y, z) {
        (0, 0) => return if x > 0 { samples.at([0, 0], x, -1) } else { 0 },
        (_, 0) => {
            let n = [y - 1, 0];
            let mut values = vec![before(n)];
            values.extend(samples.columns(n, x, 2));
            (model.weights.first(), values)
        }
        _ => {
            let Known { n, u, un, us } = samples.known(y, z);
            let mut values = vec![before(n)];
            values.extend([n, u, un, us].iter().flat_map(|row| samples.columns(*row, x, 1)));
            (model.weights.last(), values)
        }
    };
    let weights = weights.expect("a set for the kind of every row");
    assert_eq!(weights.len(), values.len(), "a weight for every value");
    let sum: i64 = weights.iter().zip(values).map(|(weight, value)| weight * value).sum();
    (128 + sum) >> 8
}

/// The class of a place, from ranks.
pub(super) fn class(ranks: &Rows, [x, y, z]: [usize; 3]) -> usize {
    let around = |row| ranks.at(row, x, -1) + 2 * ranks.at(row, x, 0) + ranks.at(row, x, 1);
    let energy = match (y, z) {
        (0, 0) => 0,
        (_, 0) => around([y - 1, 0]),
        _ => {
            let Known { n, u, us, .. } = ranks.known(y, z);
            (around(n) + around(u) + ranks.at(us, x, 0)) >> 1
        }
    };
    THRESHOLDS.iter().filter(|&&threshold| threshold <= energy).count()
}
