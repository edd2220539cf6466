//! The predictors.

use super::array::{Array, Place};

/// The largest magnitude of a weight.
pub(super) const LARGEST_WEIGHT: u32 = 2048;

/// The largest sum of the magnitudes of a set of weights.
pub(super) const LARGEST_SUM: u32 = 32768;

/// How the coefficients of a subband are predicted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Predictor {
    /// Those of the numbers 0 to 4.
    Fixed(u8),
    /// A set of weights for each of [`super::Shape::sets`].
    Weights(Vec<Vec<i32>>),
    /// Predicts 0.
    Zero,
}

/// A prediction p and its offset t.
#[derive(Debug, Clone, Copy)]
pub(in crate::oracle) struct Prediction {
    pub(in crate::oracle) p: i32,
    pub(super) t: i32,
}

/// Columns x - `reach` to x + `reach` of a row of a source, `down` and `deep` from the current one.
#[derive(Debug, Clone, Copy)]
struct Row {
    /// Orientation of the source.
    source: usize,
    down: isize,
    deep: isize,
    reach: isize,
}

/// A subband and what predicts it: the subbands of its level up to its own, and the low-pass part as number 0. The
/// coarsest low-pass part is a level of its own, whose only subband it is.
#[derive(Debug, Clone, Copy)]
pub(in crate::oracle) struct Scene<'a> {
    pub(in crate::oracle) level: &'a [Array],
    pub(in crate::oracle) orientation: usize,
    /// Whether sums have 32 bits, or else 64.
    pub(in crate::oracle) narrow: bool,
}

impl Scene<'_> {
    fn own(&self) -> &Array {
        &self.level[self.orientation]
    }

    /// The number of weights in each set.
    pub(in crate::oracle) fn sets(&self) -> Vec<usize> {
        let count = |first_plane| {
            let rows = self.rows(first_plane).into_iter().map(|row| 2 * row.reach.unsigned_abs() + 1);
            self.offsets_of_own_row().len() + rows.sum::<usize>()
        };
        match (self.orientation, self.own().extent[2]) {
            (0, 2..) => vec![count(true), count(false)],
            _ => vec![count(true)],
        }
    }

    /// How far left the coefficients of the current row are that have weights.
    const fn offsets_of_own_row(&self) -> &'static [isize] {
        if self.orientation == 0 { &[2, 3] } else { &[1, 2, 3] }
    }

    /// The rows that have weights.
    fn rows(&self, first_plane: bool) -> Vec<Row> {
        let own = |(down, deep, reach)| Row { source: self.orientation, down, deep, reach };
        let mut rows = Vec::new();
        if self.orientation == 0 {
            rows.extend([(-1, 0, 3), (-2, 0, 2), (-3, 0, 1)].map(own));
            if !first_plane {
                rows.extend([(-2, -1, 1), (-1, -1, 2), (0, -1, 2), (1, -1, 2), (2, -1, 1)].map(own));
                rows.extend([(-1, -2, 0), (0, -2, 1), (1, -2, 0)].map(own));
            }
        } else {
            rows.extend([(-1, 0, 2), (-2, 0, 1), (-1, -1, 1), (0, -1, 1), (1, -1, 1), (0, -2, 0)].map(own));
            rows.extend((1..self.orientation).map(|source| Row { source, down: 0, deep: 0, reach: 0 }));
            let low = |(down, deep)| Row { source: 0, down, deep, reach: 1 };
            rows.extend([(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)].map(low));
        }
        rows.retain(|row| {
            let source = &self.level[row.source];
            !source.is_empty()
                && (row.down == 0 || source.extent[1] > 1)
                && (row.deep == 0 || source.extent[2] > 1)
        });
        rows
    }

    fn is_known(&self, row: Row, [_, y, z]: Place) -> bool {
        if row.source == self.orientation {
            !(row.deep == 0 && y == 0 || row.deep < 0 && z == 0)
        } else {
            self.level[row.source].get([0, y, z]).is_some()
        }
    }

    /// The coefficient of a known row in column `x`, for the place of which these are y and z.
    fn of_row(&self, row: Row, x: isize, [y, z]: [isize; 2]) -> i64 {
        self.level[row.source].nearest([x, y + row.down, z + row.deep]).into()
    }

    pub(in crate::oracle) fn predict(&self, predictor: &Predictor, place: Place) -> Prediction {
        match predictor {
            Predictor::Fixed(number) => Prediction { p: self.fixed(*number, place), t: 0 },
            Predictor::Weights(sets) => {
                let first_plane = self.orientation > 0 || place[2] == 0;
                self.rounded(self.weighted(&sets[usize::from(!first_plane)], first_plane, place))
            }
            Predictor::Zero => Prediction { p: 0, t: 0 },
        }
    }

    /// p and t of the sum S.
    const fn rounded(&self, sum: i64) -> Prediction {
        let shifted = if self.narrow { (sum as i32).wrapping_add(128) as i64 } else { sum + 128 };
        Prediction { p: (shifted >> 8) as i32, t: (shifted.rem_euclid(256) - 128) as i32 }
    }

    /// The sum S.
    fn weighted(&self, weights: &[i32], first_plane: bool, place: Place) -> i64 {
        let [x, y, z] = place;
        let rows = self.rows(first_plane);
        let before = match rows.iter().find(|row| self.is_known(**row, place)) {
            Some(row) if self.orientation == 0 => self.of_row(*row, 0, [y, z]),
            _ => 0,
        };
        let left = |offset: isize| self.own().get([x - offset, y, z]).map_or(before, i64::from);
        // What every coefficient is taken from: W in the low-pass part.
        let base = if self.orientation == 0 { left(1) } else { 0 };
        let mut factors: Vec<i64> =
            self.offsets_of_own_row().iter().map(|&offset| left(offset) - base).collect();
        for row in rows {
            let known = self.is_known(row, place);
            let base = match row.source {
                0 if self.orientation > 0 => i64::from(self.level[0].at(place)),
                _ => base,
            };
            let factor = |x| if known { self.of_row(row, x, [y, z]) - base } else { 0 };
            factors.extend((x - row.reach..=x + row.reach).map(factor));
        }
        assert_eq!(weights.len(), factors.len(), "as many weights as the set has");
        let products = weights.iter().zip(factors).map(|(&weight, factor)| i64::from(weight) * factor);
        256 * base + products.sum::<i64>()
    }

    /// The predictors 0 to 4.
    fn fixed(&self, number: u8, [x, y, z]: Place) -> i32 {
        let u = if z == 0 { 0 } else { self.own().at([x, y, z - 1]) };
        let [w, n, nw] = self.neighbours([x, y, z], u);
        if z == 0 {
            return median(w, n, plane(w, n, nw));
        }
        let [uw, un, unw] = self.neighbours([x, y, z - 1], u);
        match number {
            0 => median(w, n, plane(w, n, nw)),
            1 => u,
            2 => median(plane(w, n, nw), plane(w, u, uw), plane(u, n, un)),
            3 => {
                let (w, n, nw) = (w.wrapping_sub(uw), n.wrapping_sub(un), nw.wrapping_sub(unw));
                u.wrapping_add(median(w, n, plane(w, n, nw)))
            }
            4 => w.wrapping_add(n).wrapping_add(u).div_euclid(3),
            _ => panic!("the fixed predictors are 0 to 4"),
        }
    }

    /// w, n and nw of a place in its plane, replaced where they do not exist.
    fn neighbours(&self, [x, y, z]: Place, fallback: i32) -> [i32; 3] {
        let own = self.own();
        let w = match (x > 0, y > 0) {
            (true, _) => own.at([x - 1, y, z]),
            (false, true) => own.at([x, y - 1, z]),
            (false, false) => fallback,
        };
        let n = if y > 0 { own.at([x, y - 1, z]) } else { w };
        [w, n, own.get([x - 1, y - 1, z]).unwrap_or(w)]
    }
}

const fn plane(a: i32, b: i32, c: i32) -> i32 {
    a.wrapping_add(b).wrapping_sub(c)
}

fn median(a: i32, b: i32, c: i32) -> i32 {
    let mut three = [a, b, c];
    three.sort_unstable();
    three[1]
}
