//! Prediction of the low-pass part (all of the samples where there is no transform) from the samples before.

use super::rows::RowsBefore;
use super::weights::{Differences, Weights};

/// Samples around a place in a plane: west, north, and between them.
#[derive(Clone, Copy, Debug)]
struct Corner {
    west: i32,
    north: i32,
    north_west: i32,
}

impl Corner {
    /// Beyond the border stands the nearest sample there is, or else `fallback`. North-west does not matter there:
    /// where it is missing, west equals north.
    #[inline(always)]
    fn new(west: Option<i32>, north: Option<i32>, north_west: Option<i32>, fallback: i32) -> Self {
        let near_west = west.or(north).unwrap_or(fallback);
        let near_north = north.unwrap_or(near_west);
        Self { west: near_west, north: near_north, north_west: north_west.unwrap_or(near_west) }
    }

    /// The value that the plane through the three takes: west + north - north-west.
    fn plane(self) -> i32 {
        self.west.wrapping_add(self.north).wrapping_sub(self.north_west)
    }

    /// The median of west, north and [`Corner::plane`] (the predictor of JPEG-LS).
    fn median(self) -> i32 {
        median(self.west, self.north, self.plane())
    }

    /// How each of the three changed since `other`.
    fn change(self, other: Self) -> Self {
        Self {
            west: self.west.wrapping_sub(other.west),
            north: self.north.wrapping_sub(other.north),
            north_west: self.north_west.wrapping_sub(other.north_west),
        }
    }
}

fn median(a: i32, b: i32, c: i32) -> i32 {
    a.max(b).min(a.min(b).max(c))
}

/// What the fixed predictors look at: the corner of a sample, and that of the sample at the same place of the plane
/// before.
#[derive(Clone, Copy, Debug)]
struct Before {
    here: Corner,
    up: Option<(i32, Corner)>,
}

impl Before {
    #[inline(always)]
    fn new(rows: &RowsBefore<'_>, x: usize, west: Option<i32>) -> Self {
        let left = x.wrapping_sub(1);
        let get = |row: &[i32], x: usize| row.get(x).copied();
        let up = get(rows.up, x);
        let here = Corner::new(west, get(rows.north, x), get(rows.north, left), up.unwrap_or(0));
        let above =
            |up| (up, Corner::new(get(rows.up, left), get(rows.up_north, x), get(rows.up_north, left), up));
        Self { here, up: up.map(above) }
    }
}

/// How the low-pass part is predicted. In its first plane every fixed predictor is [`Predictor::InPlane`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) enum Predictor {
    /// The median of west, north and their plane.
    InPlane,
    /// The sample of the plane before.
    Up,
    /// The median of three planes: through west and north, west and up, north and up.
    Planes,
    /// Up, and the median of the changes since the plane before.
    Change,
    /// The mean of west, north and up, rounded down.
    Mean,
    /// A weighted sum of 20 samples.
    Trained(Weights),
}

impl Predictor {
    /// Those without weights.
    pub(crate) const FIXED: [Self; 5] = [Self::InPlane, Self::Up, Self::Planes, Self::Change, Self::Mean];

    /// The number of this predictor in a codestream.
    pub(crate) const fn code(self) -> u8 {
        match self {
            Self::InPlane => 0,
            Self::Up => 1,
            Self::Planes => 2,
            Self::Change => 3,
            Self::Mean => 4,
            Self::Trained(_) => Self::TRAINED,
        }
    }

    /// The number of [`Predictor::Trained`].
    pub(crate) const TRAINED: u8 = 5;

    /// The fixed predictor of that number, if there is one.
    pub(crate) fn from_code(code: u8) -> Option<Self> {
        Self::FIXED.into_iter().find(|predictor| predictor.code() == code)
    }

    /// The value expected at `x` of a row, after the rows `before` and the last two samples of its own.
    #[inline(always)]
    pub(super) fn predict(&self, before: &RowsBefore<'_>, x: usize, wests: [Option<i32>; 2]) -> i32 {
        match self {
            Self::Trained(weights) => weights.predict(&Differences::new(before, x, wests)),
            fixed => fixed.predict_after(Before::new(before, x, wests[1])),
        }
    }

    #[inline(always)]
    fn predict_after(&self, Before { here, up }: Before) -> i32 {
        let Some((up, above)) = up else { return here.median() };
        match self {
            Self::InPlane | Self::Trained(_) => here.median(),
            Self::Up => up,
            Self::Planes => median(
                here.plane(),
                Corner { north: up, north_west: above.west, ..here }.plane(),
                Corner { west: up, north_west: above.north, ..here }.plane(),
            ),
            Self::Change => up.wrapping_add(here.change(above).median()),
            Self::Mean => here.west.wrapping_add(here.north).wrapping_add(up).div_euclid(3),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Extent, Plan, Wavelet};

    fn before(plane: [i32; 3], up: i32, above: [i32; 3]) -> Before {
        let corner = |[west, north, north_west]: [i32; 3]| Corner { west, north, north_west };
        Before { here: corner(plane), up: Some((up, corner(above))) }
    }

    #[test]
    fn predictors_by_hand() {
        let before = before([10, 20, 12], 30, [13, 22, 14]);
        assert_eq!(Predictor::InPlane.predict_after(before), 18);
        assert_eq!(Predictor::Up.predict_after(before), 30);
        // Planes 10+20-12 = 18, 10+30-13 = 27, 20+30-22 = 28.
        assert_eq!(Predictor::Planes.predict_after(before), 27);
        // Changes -3, -2 and -2: their plane is -3.
        assert_eq!(Predictor::Change.predict_after(before), 27);
        assert_eq!(Predictor::Mean.predict_after(before), 20);
    }

    #[test]
    fn borders_take_the_nearest_sample() {
        let plan = Plan::new(Wavelet::Haar, Extent::brick(2, 2, 2).unwrap(), 0).unwrap();
        let samples = [1, 2, 3, 4, 5, 6, 7, 8];
        let low_pass = plan.subbands(0).next().unwrap();
        let at = |x, y, z, west| Before::new(&RowsBefore::new(&plan, low_pass, [y, z], &samples), x, west);
        let triple = |corner: Corner| [corner.west, corner.north, corner.north_west];
        assert_eq!(triple(at(0, 0, 0, None).here), [0, 0, 0]);
        assert_eq!(triple(at(1, 0, 0, Some(1)).here), [1, 1, 1]);
        assert_eq!(triple(at(0, 1, 0, None).here), [1, 1, 1]);
        let first_up = at(0, 0, 1, None);
        assert_eq!(triple(first_up.here), [1, 1, 1]);
        assert_eq!(first_up.up.map(|(up, above)| (up, triple(above))), Some((1, [1, 1, 1])));
        let last = at(1, 1, 1, Some(7));
        assert_eq!(triple(last.here), [7, 6, 5]);
        assert_eq!(last.up.map(|(up, above)| (up, triple(above))), Some((4, [3, 2, 1])));
    }
}
