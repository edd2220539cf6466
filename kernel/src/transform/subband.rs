//! Subbands: where the coefficients of one level and one low/high choice per axis lie.

use core::ops::Range;

use super::Plan;

/// A box of coefficients in Mallat order.
///
/// Written `LLH` in axis order x, y, z; the orientation is that word as bits, bit 0 for a high x, bit 1 for a high y,
/// bit 2 for a high z, so 0 is the low-pass part and 1 to 7 are wavelet coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Subband {
    /// Levels below which this subband lies; for wavelet coefficients of the finest level, 0.
    pub level: u8,
    /// Low or high, per axis.
    pub orientation: u8,
    /// Position of its first coefficient, `[x, y, z]`.
    pub origin: [usize; 3],
    /// Coefficients per axis, each at least 1.
    pub sides: [usize; 3],
}

impl Subband {
    /// Its rows in coding order, as `[y, z]`.
    pub(crate) fn rows(&self) -> impl DoubleEndedIterator<Item = [usize; 2]> + use<> {
        let [_, height, depth] = self.sides;
        (0..depth).flat_map(move |z| (0..height).map(move |y| [y, z]))
    }

    /// Where row `y` of plane `z` begins among the coefficients of `plan`.
    pub(crate) fn row(&self, plan: &Plan, y: usize, z: usize) -> usize {
        let ([width, height, _], [left, top, front]) = (plan.extent().sides(), self.origin);
        let plane = front.wrapping_add(z).wrapping_mul(height);
        plane.wrapping_add(top).wrapping_add(y).wrapping_mul(width).wrapping_add(left)
    }
}

impl Plan {
    /// The subbands of resolution `resolution` in coding order: 0 is the low-pass part alone, resolution r > 0 the
    /// wavelet coefficients of level `levels() - r`, by orientation.
    pub fn subbands(&self, resolution: u8) -> impl Iterator<Item = Subband> + use<> {
        let plan = *self;
        let orientations = if resolution == 0 { 0..=0 } else { 1..=7 };
        orientations.filter_map(move |orientation| plan.subband(resolution, orientation))
    }

    /// The subband of another orientation of the same level as `subband`, which holds details; 0 is the low-pass part.
    pub(crate) fn sibling(&self, subband: Subband, orientation: u8) -> Option<Subband> {
        self.subband(self.levels().wrapping_sub(subband.level), orientation)
    }

    /// The level that `subband` is a part of.
    pub(crate) const fn level_of(&self, subband: Subband) -> Level {
        let fine = self.extent().coarsened(subband.level);
        Level { low: fine.coarsened(1).sides(), fine: fine.sides(), all: self.extent().sides() }
    }

    /// The subband of that orientation, unless an axis too short to be split leaves it empty.
    fn subband(&self, resolution: u8, orientation: u8) -> Option<Subband> {
        let level = self.levels().checked_sub(resolution)?;
        let fine = self.extent().coarsened(level).sides();
        if resolution == 0 {
            return Some(Subband { level, orientation: 0, origin: [0; 3], sides: fine });
        }
        let low = self.extent().coarsened(level.wrapping_add(1)).sides();
        let mut subband = Subband { level, orientation, origin: [0; 3], sides: low };
        let axes = subband.origin.iter_mut().zip(&mut subband.sides).zip(fine).zip(low);
        for (axis, (((origin, side), fine), low)) in axes.enumerate() {
            if (orientation >> axis) & 1 == 1 {
                *origin = low;
                *side = fine.wrapping_sub(low);
            }
        }
        (!subband.sides.contains(&0)).then_some(subband)
    }
}

/// Where the subbands of one level lie.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Level {
    /// Coefficients per axis: of the low-pass part, of all subbands, and of all levels.
    low: [usize; 3],
    fine: [usize; 3],
    all: [usize; 3],
}

impl Level {
    /// Row `y` of plane `z` of the subband of that orientation, if it has one.
    pub(crate) fn row(&self, orientation: u8, [y, z]: [usize; 2]) -> Option<Range<usize>> {
        let part = |axis: u8, low: usize, fine: usize| match (orientation >> axis) & 1 {
            0 => (0, low),
            _ => (low, fine.wrapping_sub(low)),
        };
        let ([low_x, low_y, low_z], [x, fine_y, fine_z], [width, height, _]) =
            (self.low, self.fine, self.all);
        let ((left, sides), (top, rows), (front, planes)) =
            (part(0, low_x, x), part(1, low_y, fine_y), part(2, low_z, fine_z));
        if y >= rows || z >= planes {
            return None;
        }
        let row = front.wrapping_add(z).wrapping_mul(height).wrapping_add(top).wrapping_add(y);
        let start = row.wrapping_mul(width).wrapping_add(left);
        Some(start..start.wrapping_add(sides))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Extent, Wavelet};

    #[test]
    fn subbands_tile_the_brick() {
        for axes in [[1, 1, 1], [5, 1, 1], [4, 7, 1], [8, 8, 8], [3, 17, 2]] {
            let extent = Extent::new(axes).unwrap();
            let plan = Plan::new(Wavelet::Haar, extent, extent.max_levels()).unwrap();
            let mut covered = [0_u8; 512];
            for subband in (0..=plan.levels()).flat_map(|resolution| plan.subbands(resolution)) {
                let ([x, y, z], [w, h, d]) = (subband.origin, subband.sides);
                for (z, y, x) in
                    (z..z + d).flat_map(|z| (y..y + h).flat_map(move |y| (x..x + w).map(move |x| (z, y, x))))
                {
                    covered[(z * extent.sides()[1] + y) * extent.sides()[0] + x] += 1;
                }
            }
            assert!(covered[..extent.samples()].iter().all(|&times| times == 1), "{axes:?}");
        }
    }

    #[test]
    fn levels_find_the_rows_of_subbands() {
        let plan = Plan::new(Wavelet::Haar, Extent::brick(5, 6, 3).unwrap(), 3).unwrap();
        for subband in (1..=3).flat_map(|resolution| plan.subbands(resolution)) {
            let (level, [width, height, depth]) = (plan.level_of(subband), subband.sides);
            for [y, z] in subband.rows() {
                let start = subband.row(&plan, y, z);
                assert_eq!(level.row(subband.orientation, [y, z]), Some(start..start + width));
            }
            assert_eq!(level.row(subband.orientation, [height, 0]), None);
            assert_eq!(level.row(subband.orientation, [0, depth]), None);
        }
    }

    #[test]
    fn coding_order() {
        let plan = Plan::new(Wavelet::Linear, Extent::slice(5, 4).unwrap(), 2).unwrap();
        let orders =
            |resolution| plan.subbands(resolution).map(|s| (s.level, s.orientation, s.origin, s.sides));
        assert!(orders(0).eq([(2, 0, [0, 0, 0], [2, 1, 1])]));
        assert!(orders(2).eq([
            (0, 1, [3, 0, 0], [2, 2, 1]),
            (0, 2, [0, 2, 0], [3, 2, 1]),
            (0, 3, [3, 2, 0], [2, 2, 1]),
        ]));
    }
}
