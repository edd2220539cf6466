//! The neighbourhood of a coefficient: what a trained predictor looks at.
//!
//! All of it but the last coefficients of the same row is known before a row begins, so most of a prediction is
//! summed for whole rows at a time.

use core::ops::Range;

use crate::Feature;
use crate::transform::{Plan, Subband};

/// Coefficients to the west with a weight: W, WW, WWW.
pub(super) const WEST: usize = 3;

/// The farthest column of a row with a weight, on either side.
pub(super) const REACH: usize = 3;

/// Rows with weights, at most.
pub(super) const ROWS: usize = 17;

/// Weights of a subband, at most; those to the west where there are no trained predictors.
pub(crate) const WEIGHTS: usize = if Feature::Trained.is_built() { 43 } else { WEST };

/// Where a row lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    /// In the subband itself.
    Own,
    /// In the subband of that orientation of the same level.
    Sibling(u8),
    /// In the low-pass part of the level, known before its details.
    Low,
}

/// The columns -`reach` to `reach` of a row, which lies that many rows and planes away.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowTaps {
    source: Source,
    pub(super) down: isize,
    pub(super) deep: isize,
    pub(super) reach: usize,
}

const fn own(down: isize, deep: isize, reach: usize) -> RowTaps {
    RowTaps { source: Source::Own, down, deep, reach }
}

const fn low(down: isize, deep: isize) -> RowTaps {
    RowTaps { source: Source::Low, down, deep, reach: 1 }
}

const fn sibling(orientation: u8) -> RowTaps {
    RowTaps { source: Source::Sibling(orientation), down: 0, deep: 0, reach: 0 }
}

/// For samples, and the low-pass part: those of the same plane first.
pub(super) const SAMPLES: [RowTaps; 11] = [
    own(-1, 0, 3),
    own(-2, 0, 2),
    own(-3, 0, 1),
    own(-2, -1, 1),
    own(-1, -1, 2),
    own(0, -1, 2),
    own(1, -1, 2),
    own(2, -1, 1),
    own(-1, -2, 0),
    own(0, -2, 1),
    own(1, -2, 0),
];

/// For wavelet coefficients.
const DETAILS: [RowTaps; 17] = [
    own(-1, 0, 2),
    own(-2, 0, 1),
    own(-1, -1, 1),
    own(0, -1, 1),
    own(1, -1, 1),
    own(0, -2, 0),
    sibling(1),
    sibling(2),
    sibling(3),
    sibling(4),
    sibling(5),
    sibling(6),
    low(0, 0),
    low(-1, 0),
    low(1, 0),
    low(0, -1),
    low(0, 1),
];

/// A known row with weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known<'a> {
    pub(super) coefficients: &'a [i32],
    taps: &'static RowTaps,
    /// The place of its weights among all.
    pub(super) first_weight: usize,
}

impl Known<'_> {
    /// How far its weights reach to either side.
    pub(super) const fn reach(&self) -> usize {
        self.taps.reach
    }

    /// Its weights.
    pub(super) const fn len(&self) -> usize {
        self.taps.len()
    }

    /// Whether it counts as its difference from the low-pass coefficient at the same place.
    pub(super) fn is_low(&self) -> bool {
        self.taps.source == Source::Low
    }

    /// Whether it lies in the plane `deep` at the same y, and so holds the centre of the neighbours there.
    pub(super) const fn is_central(&self, deep: isize) -> bool {
        self.taps.down == 0 && self.taps.deep == deep
    }

    /// The plane it lies in.
    pub(super) const fn deep(&self) -> isize {
        self.taps.deep
    }

    /// The place of the weight of the coefficient at the same x.
    pub(super) const fn central_weight(&self) -> usize {
        self.first_weight.wrapping_add(self.taps.reach)
    }
}

impl RowTaps {
    /// Weights of a row.
    pub(super) const fn len(&self) -> usize {
        self.reach.wrapping_mul(2).wrapping_add(1)
    }
}

/// The rows with weights around one.
pub(super) type KnownRows<'a> = heapless::Vec<Known<'a>, ROWS>;

/// The planes of a subband that share weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Planes {
    /// The first of the low-pass part, before which there is none.
    First,
    /// All others, and all of a subband of details.
    Others,
}

/// The neighbourhood of the coefficients of one subband in some planes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Taps {
    plan: Plan,
    pub(super) subband: Subband,
    planes: Planes,
}

impl Taps {
    /// `None` if the subband has no such planes.
    pub(super) const fn new(plan: &Plan, subband: Subband, planes: Planes) -> Option<Self> {
        let [_, _, depth] = subband.sides;
        let there_are = match planes {
            Planes::First => subband.orientation == 0,
            Planes::Others => subband.orientation > 0 || depth > 1,
        };
        if there_are { Some(Self { plan: *plan, subband, planes }) } else { None }
    }

    /// The planes, by number.
    pub(super) const fn numbers(&self) -> Range<usize> {
        let [_, _, depth] = self.subband.sides;
        match self.planes {
            Planes::First => 0..1,
            Planes::Others if self.is_low_pass() => 1..depth,
            Planes::Others => 0..depth,
        }
    }

    /// Whether the neighbours count as differences from the one to the west: so it is in the low-pass part.
    pub(super) const fn is_low_pass(&self) -> bool {
        self.subband.orientation == 0
    }

    fn rows(&self) -> &'static [RowTaps] {
        if self.is_low_pass() { &SAMPLES } else { &DETAILS }
    }

    /// Whether those rows have weights in this subband: whether they can differ from others.
    fn has(&self, row: &RowTaps) -> bool {
        let Some(subband) = self.source(row.source) else { return false };
        let [_, height, depth] = subband.sides;
        let is_earlier = match row.source {
            Source::Own => self.planes == Planes::Others || row.deep == 0,
            Source::Sibling(orientation) => orientation < self.subband.orientation,
            Source::Low => true,
        };
        is_earlier && (row.down == 0 || height > 1) && (row.deep == 0 || depth > 1)
    }

    fn source(&self, source: Source) -> Option<Subband> {
        match source {
            Source::Own => Some(self.subband),
            Source::Sibling(orientation) => self.plan.sibling(self.subband, orientation),
            Source::Low => self.plan.sibling(self.subband, 0),
        }
    }

    /// Weights in use.
    pub(super) fn weights(&self) -> usize {
        let west = if self.is_low_pass() { WEST - 1 } else { WEST };
        let of_rows = self.rows().iter().filter(|row| self.has(row)).map(|row| row.len());
        of_rows.fold(west, usize::wrapping_add)
    }

    /// Coefficients of a row.
    pub(super) const fn row_len(&self) -> usize {
        let [width, _, _] = self.subband.sides;
        width
    }

    /// Row `y` of plane `z` itself.
    pub(super) fn own_row<'a>(&self, coefficients: &'a [i32], [y, z]: [usize; 2]) -> Option<&'a [i32]> {
        let start = self.subband.row(&self.plan, y, z);
        coefficients.get(start..start.wrapping_add(self.row_len()))
    }

    /// The known rows around row `y` of plane `z`.
    pub(super) fn known<'a>(&self, coefficients: &'a [i32], [y, z]: [usize; 2]) -> KnownRows<'a> {
        let mut known = KnownRows::new();
        let mut next = if self.is_low_pass() { WEST - 1 } else { WEST };
        for row in self.rows().iter().filter(|row| self.has(row)) {
            let first_weight = next;
            next = next.wrapping_add(row.len());
            if let Some(coefficients) = self.row(row, coefficients, [y, z]) {
                // No list has more than ROWS entries.
                let _ = known.push(Known { coefficients, taps: row, first_weight });
            }
        }
        known
    }

    /// One of the rows around row `y` of plane `z`; beyond the border stands the nearest. `None` if none is known.
    fn row<'a>(&self, row: &RowTaps, coefficients: &'a [i32], [y, z]: [usize; 2]) -> Option<&'a [i32]> {
        let subband = self.source(row.source)?;
        let [width, height, depth] = subband.sides;
        let nearest = |place: usize, step: isize, sides: usize| {
            place.saturating_add_signed(step).min(sides.wrapping_sub(1))
        };
        if row.source == Source::Own && ((row.deep == 0 && y == 0) || (row.deep < 0 && z == 0)) {
            return None;
        }
        if matches!(row.source, Source::Sibling(_)) && (y >= height || z >= depth) {
            return None;
        }
        let start = subband.row(&self.plan, nearest(y, row.down, height), nearest(z, row.deep, depth));
        coefficients.get(start..start.wrapping_add(width))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Extent, Wavelet};

    fn plan(axes: [u32; 3], levels: u8) -> Plan {
        Plan::new(Wavelet::Linear, Extent::new(axes).unwrap(), levels).unwrap()
    }

    fn taps(plan: &Plan, resolution: u8, orientation: u8, planes: Planes) -> Option<Taps> {
        let mut subbands = plan.subbands(resolution);
        Taps::new(plan, subbands.find(|subband| subband.orientation == orientation).unwrap(), planes)
    }

    #[test]
    fn weights_in_use() {
        let (brick, slice, line) = (plan([8, 8, 8], 1), plan([8, 8, 1], 1), plan([8, 1, 1], 1));
        let weights = |plan, orientation, planes| {
            taps(plan, u8::from(orientation > 0), orientation, planes).map(|taps| taps.weights())
        };
        assert_eq!(weights(&brick, 0, Planes::First), Some(17));
        assert_eq!(weights(&brick, 0, Planes::Others), Some(WEIGHTS));
        assert_eq!(weights(&slice, 0, Planes::Others), None);
        assert_eq!(weights(&line, 0, Planes::First), Some(2));
        // Three to the west, 18 in the subband, six siblings, 15 of the low-pass part.
        assert_eq!(weights(&brick, 7, Planes::Others), Some(42));
        assert_eq!(weights(&brick, 1, Planes::Others), Some(36));
        assert_eq!(weights(&slice, 3, Planes::Others), Some(3 + 8 + 2 + 9));
        assert_eq!(weights(&line, 1, Planes::Others), Some(3 + 3));
    }

    #[test]
    fn rows_beyond_the_border_are_the_nearest() {
        let plan = plan([1, 3, 3], 0);
        let samples = [0, 1, 2, 3, 4, 5, 6, 7, 8];
        let rows = |y, z, planes| {
            let taps = taps(&plan, 0, 0, planes).unwrap();
            taps.known(&samples, [y, z])
                .iter()
                .map(|row| row.coefficients[0])
                .collect::<heapless::Vec<_, 12>>()
        };
        assert!(rows(0, 0, Planes::First).is_empty());
        assert_eq!(rows(1, 0, Planes::First), [0, 0, 0]);
        assert_eq!(rows(0, 1, Planes::Others), [0, 0, 0, 1, 2, 0, 0, 1]);
        assert_eq!(rows(2, 2, Planes::Others), [7, 6, 6, 3, 4, 5, 5, 5, 1, 2, 2]);
    }
}
