//! What a file says of its samples, before any is read.

use super::{ElementType, Metadata};

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
