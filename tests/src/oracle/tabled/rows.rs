//! What is known of the rows before: predictions and classes.

use super::form::{Breadth, Form, scene};
use super::model::Model;
use crate::oracle::coder::array::Array;
use crate::oracle::coder::predict::Predictor;

/// The least energies of the classes above the first, narrow and wide.
const THRESHOLDS: [i64; 13] = [1, 3, 5, 8, 12, 18, 28, 44, 80, 160, 400, 1200, 5000];

/// The same, celled.
const CELLED_THRESHOLDS: [i64; 13] = [2, 3, 5, 9, 15, 26, 44, 74, 126, 215, 365, 621, 1056];

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

    /// A row, or the nearest there is.
    fn nearest_row(&self, y: isize, z: isize) -> [usize; 2] {
        let [_, height, depth] = self.0.extent.map(usize::cast_signed);
        [y.clamp(0, height - 1), z.clamp(0, depth - 1)].map(isize::cast_unsigned)
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
pub(super) fn prediction(samples: &Rows, (form, model): (Form, &Model), span: i32, place: [usize; 3]) -> i64 {
    let [x, y, _] = place;
    let p = match (form.breadth, &model.labels[..]) {
        (Breadth::Narrow, _) => narrow(samples, model, place),
        (_, []) => wide(samples, &model.weights, place),
        (_, labels) => wide(samples, &model.weights[labels[form.cell_at(x, y)]..][..1], place),
    };
    p.clamp(0, span.into())
}

/// p before it is clamped.
fn wide(samples: &Rows, weights: &[Vec<i64>], place: [usize; 3]) -> i64 {
    let narrowed = |set: &Vec<i64>| set.iter().map(|&weight| weight as i32).collect();
    let weights = Predictor::Weights(weights.iter().map(narrowed).collect());
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
pub(super) fn class(ranks: &Rows, (form, model): (Form, &Model), place: [usize; 3]) -> usize {
    let (energy, thresholds) = match form.breadth {
        Breadth::Narrow | Breadth::Wide => (energy(ranks, place), THRESHOLDS),
        Breadth::Celled => ((celled_energy(ranks, place) % (1 << 24)) >> model.scale, CELLED_THRESHOLDS),
    };
    thresholds.iter().filter(|&&threshold| threshold <= energy).count()
}

fn energy(ranks: &Rows, [x, y, z]: [usize; 3]) -> i64 {
    let around = |row| ranks.at(row, x, -1) + 2 * ranks.at(row, x, 0) + ranks.at(row, x, 1);
    match (y, z) {
        (0, 0) => 0,
        (_, 0) => around([y - 1, 0]),
        _ => {
            let Known { n, u, us, .. } = ranks.known(y, z);
            (around(n) + around(u) + ranks.at(us, x, 0)) >> 1
        }
    }
}

/// The rows of the first plane that make its energy, as i and j, and the weights of the columns x, 1 and 2 beside it.
const PLANE: [(isize, isize, [i64; 3]); 3] = [(-1, 0, [11, 8, 6]), (-2, 0, [6, 4, 0]), (-3, 0, [5, 0, 0])];

/// The same of all other planes: N, U, US, NN, UN, USS and UU.
const BRICK: [(isize, isize, [i64; 3]); 7] = [
    (-1, 0, [7, 4, 1]),
    (0, -1, [7, 4, 1]),
    (1, -1, [6, 3, 0]),
    (-2, 0, [3, 0, 0]),
    (-1, -1, [3, 0, 0]),
    (2, -1, [3, 0, 0]),
    (0, -2, [3, 0, 0]),
];

fn celled_energy(ranks: &Rows, [x, y, z]: [usize; 3]) -> i64 {
    let rows = match (y, z) {
        (0, 0) => return 0,
        (_, 0) => &PLANE[..],
        _ => &BRICK,
    };
    let of_row = |&(i, j, weights): &(isize, isize, [i64; 3])| {
        let j = if y == 0 { j.min(-1) } else { j };
        let row = ranks.nearest_row(y.cast_signed() + i, z.cast_signed() + j);
        let columns = ranks.columns(row, x, 2).into_iter().zip([2, 1, 0, 1, 2]);
        columns.map(|(rank, beside): (i64, usize)| rank * weights[beside]).sum::<i64>()
    };
    rows.iter().map(of_row).sum()
}
