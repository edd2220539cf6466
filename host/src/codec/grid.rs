//! How a volume is cut into bricks.

use serde::{Deserialize, Serialize};
use wavelift_kernel::Extent;

/// Sides along axes that are cut, unless asked otherwise, are multiples of this: four levels without seams.
const ALIGNMENT: u32 = 1 << 4;

/// Samples that a brick may have at most: 2^27, half a GiB of `i32`; coding it takes up to three times as much.
pub(super) const MAX_BRICK_SAMPLES: u64 = 1 << 27;

/// A volume's extent and the sides of its bricks, x first.
///
/// Bricks are counted x fastest, then y, then z, from the first sample; those at the far ends hold what is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Grid {
    /// Samples of the volume along x, y, z.
    pub extent: [u64; 3],
    /// Samples of a brick along x, y, z.
    pub sides: [u32; 3],
}

/// One brick of a [`Grid`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Brick {
    /// Its first sample in the volume.
    pub origin: [u64; 3],
    /// Its samples along x, y, z.
    pub sides: [u32; 3],
}

impl Brick {
    /// Samples in all.
    pub fn samples(&self) -> u64 {
        self.sides.into_iter().map(u64::from).product()
    }
}

impl Grid {
    /// Cuts `extent` into bricks of `sides`, none longer than the volume. `None` if an axis of either is 0 or
    /// a brick would have more than 2^27 samples.
    pub fn new(extent: [u64; 3], sides: [u32; 3]) -> Option<Self> {
        let sides = per_axis(|axis| extent[axis].min(sides[axis].into()) as u32);
        let grid = Self { extent, sides };
        grid.is_sound().then_some(grid)
    }

    /// Samples of a brick that is quick to reach: 64 a side.
    pub const SMALL_BRICK: u32 = 1 << 18;

    /// Samples of a brick for coding that learns long, as every brick has to learn anew: 128 a side.
    pub const LARGE_BRICK: u32 = 1 << 21;

    /// The sides of bricks unless asked otherwise: of about `samples`, whatever the shape of the volume.
    ///
    /// From the shortest axis to the longest, each is cut into equal parts, as near as can be to the side that would
    /// make what is left of the brick a cube; so what a short axis lacks goes to the others.
    pub fn default_sides(extent: [u64; 3], samples: u32) -> [u32; 3] {
        let mut samples = f64::from(samples);
        let mut axes = [0, 1, 2];
        axes.sort_by_key(|&axis| extent[axis]);
        let mut sides = [0; 3];
        for (axis, left) in axes.into_iter().zip([3.0, 2.0, 1.0]) {
            let parts = (extent[axis] as f64 / samples.powf(1.0 / left)).round().max(1.0) as u64;
            let side = u32::try_from(extent[axis].div_ceil(parts)).unwrap_or(u32::MAX);
            sides[axis] = if parts > 1 { side.next_multiple_of(ALIGNMENT) } else { side };
            samples /= f64::from(sides[axis]);
        }
        sides
    }

    /// Whether a grid that was read makes sense.
    pub(super) fn is_sound(&self) -> bool {
        let samples = self.sides.iter().try_fold(1_u64, |product, &side| product.checked_mul(side.into()));
        let axes = self.extent.iter().zip(self.sides);
        axes.into_iter().all(|(&extent, side)| side > 0 && u64::from(side) <= extent)
            && samples.is_some_and(|samples| samples <= MAX_BRICK_SAMPLES)
            && self.counts().into_iter().try_fold(1, u64::checked_mul).is_some()
    }

    /// Levels that a transform of a whole brick has at most.
    pub fn max_levels(&self) -> u8 {
        Extent::new(self.sides).map_or(0, Extent::max_levels)
    }

    /// Bricks along x, y, z.
    pub fn counts(&self) -> [u64; 3] {
        per_axis(|axis| self.extent[axis].div_ceil(self.sides[axis].into()))
    }

    /// Bricks in all.
    pub fn bricks(&self) -> u64 {
        self.counts().into_iter().product()
    }

    /// Brick number `index`, below [`Grid::bricks`].
    pub fn brick(&self, index: u64) -> Brick {
        let [across, down, _] = self.counts();
        let place = [index % across, index / across % down, index / across / down];
        let origin = per_axis(|axis| place[axis] * u64::from(self.sides[axis]));
        let left = |axis: usize| self.extent[axis] - origin[axis];
        Brick { origin, sides: per_axis(|axis| left(axis).min(self.sides[axis].into()) as u32) }
    }

    /// All bricks in order, each of which is a [`Region`](super::Region) to be read.
    ///
    /// ```
    /// use wavelift_host::array::Samples;
    /// use wavelift_host::codec::{CompressOptions, Container, Part};
    /// use wavelift_host::ndarray::Array3;
    /// use wavelift_host::progress::ignore;
    ///
    /// let ramp = Array3::from_shape_fn((20, 30, 40), |(z, y, x)| (z + y + x) as f32);
    /// let options = CompressOptions { brick: Some([16; 3]), ..CompressOptions::default() };
    /// let container = Container::new(Box::new(Samples::of_array(ramp.view())?.compress(&options)?))?;
    ///
    /// let mut sum = 0.0;
    /// for brick in container.grid(0)?.iter() {
    ///     let samples: Array3<f32> = container.read_array(&Part::region(brick), None, &ignore)?;
    ///     sum += samples.sum();
    /// }
    /// assert_eq!(sum, ramp.sum());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn iter(&self) -> impl Iterator<Item = Brick> + use<> {
        let grid = *self;
        (0..grid.bricks()).map(move |index| grid.brick(index))
    }

    /// The numbers, in order, of the bricks that the samples `from .. to` of a region lie in.
    pub fn bricks_in(&self, from: [u64; 3], to: [u64; 3]) -> impl Iterator<Item = u64> + use<> {
        let [across, down, _] = self.counts();
        let sides = self.sides.map(u64::from);
        let range = move |axis: usize| from[axis] / sides[axis]..to[axis].div_ceil(sides[axis]);
        range(2)
            .flat_map(move |z| range(1).flat_map(move |y| range(0).map(move |x| (z * down + y) * across + x)))
    }

    /// The number of levels that can be read across brick borders: while every border stays on a sample, that is
    /// while the sides of a brick, along each axis with more than one, are multiples of 2^level.
    pub fn aligned_levels(&self) -> u8 {
        let counts = self.counts();
        let cut = (0..3).filter(|&axis| counts[axis] > 1);
        cut.map(|axis| self.sides[axis].trailing_zeros() as u8).min().unwrap_or(u8::MAX)
    }
}

/// An array of what `of` makes of axis 0, 1, 2.
pub(super) fn per_axis<T>(of: impl Fn(usize) -> T) -> [T; 3] {
    std::array::from_fn(of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bricks_tile_the_volume() {
        let grid = Grid::new([10, 7, 3], [4, 3, 2]).unwrap();
        assert_eq!((grid.counts(), grid.bricks()), ([3, 3, 2], 18));
        assert_eq!(grid.brick(0), Brick { origin: [0; 3], sides: [4, 3, 2] });
        assert_eq!(grid.brick(17), Brick { origin: [8, 6, 2], sides: [2, 1, 1] });
        let samples: u32 = (0..18).map(|i| grid.brick(i).sides.iter().product::<u32>()).sum();
        assert_eq!(samples, 210);
    }

    #[test]
    fn regions_meet_the_right_bricks() {
        let grid = Grid::new([10, 7, 3], [4, 3, 2]).unwrap();
        assert!(grid.bricks_in([4, 0, 0], [5, 1, 1]).eq([1]));
        assert!(grid.bricks_in([3, 2, 1], [5, 4, 3]).eq([0, 1, 3, 4, 9, 10, 12, 13]));
        assert!(grid.bricks_in([0; 3], [10, 7, 3]).eq(0..18));
    }

    #[test]
    fn bricks_hold_as_many_samples_whatever_the_shape() {
        let sides = |extent| Grid::default_sides(extent, Grid::SMALL_BRICK);
        assert_eq!(sides([256, 256, 128]), [64; 3]);
        assert_eq!(sides([9, 9, 9]), [9; 3]);
        assert_eq!(sides([1024, 1536, 1]), [512, 512, 1]);
        assert_eq!(sides([1 << 20, 1, 1]), [1 << 18, 1, 1]);
        assert_eq!(sides([480, 241, 6]), [160, 241, 6]);
        assert_eq!(sides([6, 480, 241]), [6, 160, 241]);
        assert_eq!(sides([91, 91, 91]), [91, 48, 48]);
        assert_eq!(Grid::default_sides([512, 256, 128], Grid::LARGE_BRICK), [128; 3]);
        for extent in [[1 << 40, 1 << 40, 1 << 40], [u64::MAX, 1, 1], [1, 3, 1 << 50], [5000, 4999, 2]] {
            for samples in [Grid::SMALL_BRICK, Grid::LARGE_BRICK] {
                let grid = Grid { extent, sides: Grid::default_sides(extent, samples) };
                let samples: u64 = grid.sides.into_iter().map(u64::from).product();
                assert!(samples <= 1 << 23 && grid.aligned_levels() >= 4, "{grid:?}");
                assert!(samples >= 1 << 17, "{grid:?}");
            }
        }
    }

    #[test]
    fn limits() {
        assert_eq!(Grid::new([9, 9, 1], [512, 512, 1]).unwrap().sides, [9, 9, 1]);
        assert_eq!(Grid::new([1 << 40, 1, 1], [u32::MAX, 1, 1]), None);
        assert_eq!(Grid::new([4, 4, 4], [0, 1, 1]), None);
        assert_eq!(Grid::new([128, 64, 50], [64, 64, 64]).unwrap().aligned_levels(), 6);
        assert_eq!(Grid::new([128, 64, 50], [24, 64, 64]).unwrap().aligned_levels(), 3);
        assert_eq!(Grid::new([9, 9, 1], [9, 9, 1]).unwrap().aligned_levels(), u8::MAX);
    }
}
