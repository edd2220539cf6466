//! How large ranks are expected to be: the ranks around them.

use crate::coder::energy::around;
use crate::transform::{Plan, Subband};

/// What is known around a row of ranks.
#[derive(Debug)]
pub(super) struct Around<'a> {
    /// The row before; in the first row of a plane that of the plane before.
    north: &'a [i32],
    /// The same row of the plane before; in the first plane the row before.
    up: &'a [i32],
    /// Of the plane before, the row after that, if there is one; else as `up`.
    up_south: &'a [i32],
}

impl<'a> Around<'a> {
    /// What is known around row `y` of plane `z` of a subband, where all that lies `before` it is ranks.
    pub(super) fn new(plan: &Plan, subband: Subband, [y, z]: [usize; 2], before: &'a [i32]) -> Self {
        let [columns, rows, _] = subband.sides;
        let [width, height, _] = plan.extent().sides();
        let plane = width.wrapping_mul(height);
        let known = |back: usize| {
            let from = before.len().wrapping_sub(back);
            before.get(from..from.wrapping_add(columns)).unwrap_or(&[])
        };
        let (north, up) = match (y, z) {
            (0, 0) => (&[][..], &[][..]),
            (0, _) => (known(plane), known(plane)),
            (_, 0) => (known(width), known(width)),
            _ => (known(width), known(plane)),
        };
        let has_south = z > 0 && y.wrapping_add(1) < rows;
        Self { north, up, up_south: if has_south { known(plane.wrapping_sub(width)) } else { up } }
    }

    /// How much of an energy the rank before in the row is.
    pub(super) const fn share_of_west(&self) -> u32 {
        if self.north.is_empty() { 8 } else { 2 }
    }

    /// The energies of the row, but for the ranks before in it: sums, which wrap.
    pub(super) fn energies(&self, energies: &mut [i32]) {
        if self.north.is_empty() {
            return energies.fill(0);
        }
        around([self.north, self.up, self.up_south], energies, |energy| energy);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Extent, Wavelet};

    /// The energies of a row, of ranks that are all told.
    fn energies<const N: usize>(axes: [u32; 3], place: [usize; 2], ranks: &[i32]) -> ([i32; N], u32) {
        let plan = Plan::new(Wavelet::Haar, Extent::new(axes).unwrap(), 0).unwrap();
        let subband = plan.subbands(0).next().unwrap();
        let before = &ranks[..subband.row(&plan, place[0], place[1])];
        let around = Around::new(&plan, subband, place, before);
        let mut energies = [-1; N];
        around.energies(&mut energies);
        (energies, around.share_of_west())
    }

    #[test]
    fn rows_by_hand() {
        assert_eq!(energies([4, 1, 1], [0, 0], &[]), ([0; 4], 8));
        // Nothing but the row before, which stands for all.
        let slice = energies([3, 2, 1], [1, 0], &[1, 2, 3]);
        assert_eq!(slice, ([2 * (3 + 2) + 1, 2 * (1 + 4 + 3) + 2, 2 * (2 + 6 + 3) + 3], 2));
        // The plane before stands for the row before.
        assert_eq!(energies([2, 2, 2], [0, 1], &[1, 2, 3, 4]), ([2 * (3 + 2) + 3, 2 * (1 + 4 + 2) + 4], 2));
        // The last row of a plane has none after it.
        assert_eq!(energies([1, 2, 2], [1, 1], &[1, 2, 3]), ([4 * (2 + 3) + 2], 2));
        assert_eq!(energies([1, 1, 2], [0, 1], &[-1]), ([-9], 2));
    }
}
