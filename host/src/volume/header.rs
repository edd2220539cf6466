//! What a file says of its samples, before any is read.

use super::axis::{self, Axis};
use super::{ElementType, ExtentError, Metadata, RankedExtent};

/// A data set without its samples: time steps of volumes, each sample of which has one value or several.
///
/// The values of a data set have one order wherever they pass: component fastest, then x, y, z, and the time step
/// slowest, each little-endian.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// Samples along x, y and z, each at least 1.
    pub extent: [u64; 3],
    /// Values of a sample: 1, or those of a vector or a colour.
    pub components: u32,
    /// Volumes that follow each other in time, at least 1.
    pub steps: u64,
    /// Type of a value.
    pub element: ElementType,
    /// What else the file says.
    pub metadata: Metadata,
}

impl Header {
    /// One volume of single values.
    pub const fn scalar(extent: [u64; 3], element: ElementType, metadata: Metadata) -> Self {
        Self { extent, components: 1, steps: 1, element, metadata }
    }

    /// A data set whose file has the axes of `metadata`, each of so many samples.
    ///
    /// # Errors
    /// [`ExtentError`]: an axis of no samples, or more values than the bytes of can be counted.
    pub(super) fn of_axes(
        counts: &[u64],
        element: ElementType,
        metadata: Metadata,
    ) -> Result<Self, ExtentError> {
        let mut extent = [1; 3];
        for (axis, &count) in metadata.axes.iter().zip(counts) {
            if let Some(axis) = axis.space() {
                extent[axis] = count;
            }
        }
        let samples = RankedExtent::new(&extent)?.samples();
        let components = axis::components(&metadata.axes).ok_or(ExtentError::TooLarge)?;
        let steps = axis::steps(&metadata.axes).ok_or(ExtentError::TooLarge)?;
        let others = u64::from(components).checked_mul(steps).ok_or(ExtentError::TooLarge)?;
        match samples.checked_mul(others) {
            Some(0) => Err(ExtentError::NoValues),
            Some(values) if values <= u64::MAX / 8 => {
                Ok(Self { extent, components, steps, element, metadata })
            }
            _ => Err(ExtentError::TooLarge),
        }
    }

    /// Axes of a file of this data set, fastest first: those of the source if they hold it and have x, y and z in this
    /// order, else those of components, x, y, z and time in this order, as far as they are needed.
    pub fn axes(&self) -> Vec<Axis> {
        if let Some(axes) = self.own_axes()
            && axes.iter().filter_map(|axis| axis.space()).is_sorted()
        {
            return axes;
        }
        let components = (self.components != 1).then_some(Axis::Component(self.components));
        let steps = (self.steps != 1).then_some(Axis::Time(self.steps));
        let space = Axis::SPACE[..self.rank()].iter().copied();
        components.into_iter().chain(space).chain(steps).collect()
    }

    /// Axes of the source, in its order, if they hold this data set.
    pub(super) fn own_axes(&self) -> Option<Vec<Axis>> {
        let axes = &self.metadata.axes;
        let holds = axis::components(axes) == Some(self.components)
            && axis::steps(axes) == Some(self.steps)
            && self.rank() == self.metadata.rank();
        holds.then(|| axes.clone())
    }

    /// Samples along an axis.
    pub(super) fn count(&self, axis: Axis) -> u64 {
        match axis {
            Axis::Component(count) => count.into(),
            Axis::X => self.extent[0],
            Axis::Y => self.extent[1],
            Axis::Z => self.extent[2],
            Axis::Time(count) => count,
        }
    }

    /// Whether this is one volume of single values.
    pub const fn is_scalar(&self) -> bool {
        self.components == 1 && self.steps == 1
    }

    /// Number of axes that a file of one volume has, 1 to 3: those of the source, and more if z or y need them.
    pub fn rank(&self) -> usize {
        self.metadata.rank_of(self.extent)
    }

    /// Bytes of one plane of samples, x by y.
    pub fn plane_bytes(&self) -> Option<u64> {
        let [x, y, _] = self.extent;
        [x, y, self.components.into()].into_iter().try_fold(self.element.bytes() as u64, u64::checked_mul)
    }

    /// Bytes of one time step.
    pub fn step_bytes(&self) -> Option<u64> {
        self.plane_bytes()?.checked_mul(self.extent[2])
    }

    /// Bytes of all values, `None` if 64 bits do not count them.
    pub fn bytes(&self) -> Option<u64> {
        self.step_bytes()?.checked_mul(self.steps)
    }
}
