//! Predictors without weights, for the low-pass part (all of the samples where there is no transform).

use super::context::Expected;
use super::forecast::Forecast;
use super::predictor::NUMBER_BITS;
use super::{Coder, low_bits};
use crate::transform::{Plan, Subband};

/// The rows of the low-pass part next to one of its rows: empty where there is none.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowsBefore<'a> {
    north: &'a [i32],
    up: &'a [i32],
    up_north: &'a [i32],
}

impl<'a> RowsBefore<'a> {
    /// Those of row `y` of plane `z`, among the coefficients of `plan` that lie `before` it.
    pub(super) fn new(plan: &Plan, low_pass: Subband, [y, z]: [usize; 2], before: &'a [i32]) -> Self {
        let [width, _, _] = low_pass.sides;
        let row = |y: Option<usize>, z: Option<usize>| {
            let start = low_pass.row(plan, y?, z?);
            before.get(start..start.wrapping_add(width))
        };
        let (above, plane) = (y.checked_sub(1), z.checked_sub(1));
        let or_none = |row: Option<&'a [i32]>| row.unwrap_or(&[]);
        Self {
            north: or_none(row(above, Some(z))),
            up: or_none(row(Some(y), plane)),
            up_north: or_none(row(above, plane)),
        }
    }
}

/// Samples around a place in a plane: west, north, and between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    west: i32,
    north: i32,
    north_west: i32,
}

impl Corner {
    /// Beyond the border stands the nearest sample there is, or else `fallback`. North-west does not matter there:
    /// where it is missing, west equals north.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn new(west: Option<i32>, north: Option<i32>, north_west: Option<i32>, fallback: i32) -> Self {
        let near_west = west.or(north).unwrap_or(fallback);
        let near_north = north.unwrap_or(near_west);
        Self { west: near_west, north: near_north, north_west: north_west.unwrap_or(near_west) }
    }

    /// The value that the plane through the three takes: west + north - north-west.
    fn plane(self) -> i32 {
        self.west.wrapping_add(self.north).wrapping_sub(self.north_west)
    }

    /// The median of west, north and [`Corner::plane`] (the predictor of JPEG-LS).
    pub(super) fn median(self) -> i32 {
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
    #[cfg_attr(not(feature = "small"), inline(always))]
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

/// How the low-pass part is predicted. In its first plane every one of them is [`Fixed::InPlane`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fixed {
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
}

impl Fixed {
    pub(super) const ALL: [Self; 5] = [Self::InPlane, Self::Up, Self::Planes, Self::Change, Self::Mean];

    /// The number of this predictor in a codestream.
    pub(super) const fn number(self) -> u32 {
        match self {
            Self::InPlane => 0,
            Self::Up => 1,
            Self::Planes => 2,
            Self::Change => 3,
            Self::Mean => 4,
        }
    }

    /// The predictor of that number, if there is one.
    pub(super) fn from_number(number: u32) -> Option<Self> {
        Self::ALL.iter().copied().find(|fixed| fixed.number() == number)
    }

    /// Codes the number of this predictor, which an encoder has chosen; `None` if a codestream says one that is not there.
    pub(crate) fn code<C: Coder>(self, coder: &mut C) -> Option<Self> {
        Self::from_number(coder.raw(self.number(), NUMBER_BITS) & low_bits(NUMBER_BITS))
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn predict_after(self, Before { here, up }: Before) -> i32 {
        let Some((up, above)) = up else { return here.median() };
        match self {
            Self::InPlane => here.median(),
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

/// A fixed predictor at work on one row.
#[derive(Debug)]
pub(super) struct FixedRow<'a> {
    fixed: Fixed,
    before: RowsBefore<'a>,
    west: Option<i32>,
}

impl<'a> FixedRow<'a> {
    pub(super) const fn new(fixed: Fixed, before: RowsBefore<'a>) -> Self {
        Self { fixed, before, west: None }
    }
}

impl Forecast for FixedRow<'_> {
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn expected(&self, x: usize) -> Expected {
        Expected::exactly(self.fixed.predict_after(Before::new(&self.before, x, self.west)))
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn push(&mut self, coefficient: i32) {
        self.west = Some(coefficient);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Extent, Wavelet};

    fn before(plane: [i32; 3], up: i32, above: [i32; 3]) -> Before {
        let corner = |[west, north, north_west]: [i32; 3]| Corner { west, north, north_west };
        Before { here: corner(plane), up: Some((up, corner(above))) }
    }

    #[test]
    fn predictors_by_hand() {
        let before = before([10, 20, 12], 30, [13, 22, 14]);
        assert_eq!(Fixed::InPlane.predict_after(before), 18);
        assert_eq!(Fixed::Up.predict_after(before), 30);
        // Planes 10+20-12 = 18, 10+30-13 = 27, 20+30-22 = 28.
        assert_eq!(Fixed::Planes.predict_after(before), 27);
        // Changes -3, -2 and -2: their plane is -3.
        assert_eq!(Fixed::Change.predict_after(before), 27);
        assert_eq!(Fixed::Mean.predict_after(before), 20);
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
