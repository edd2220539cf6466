//! Axes of files: which of them lie in space, which hold components, which is time.

use serde::{Deserialize, Serialize};

/// What lies along one axis of a file.
///
/// A file may have several axes of components, such as the rows and columns of a tensor, and several of time; in a
/// [`Header`](super::Header) their counts are multiplied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Axis {
    /// Values of a sample, so many.
    Component(u32),
    /// The first axis of space.
    X,
    /// The second axis of space.
    Y,
    /// The third axis of space.
    Z,
    /// Time steps, so many.
    Time(u64),
}

impl Axis {
    /// The axes of space.
    pub const SPACE: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Whether this is x, y or z.
    pub const fn is_space(self) -> bool {
        self.space().is_some()
    }

    /// 0, 1, 2 for x, y, z.
    pub(super) const fn space(self) -> Option<usize> {
        match self {
            Self::X => Some(0),
            Self::Y => Some(1),
            Self::Z => Some(2),
            Self::Component(_) | Self::Time(_) => None,
        }
    }

    /// Whether both are of components, both of time, or both the same axis of space.
    pub(super) const fn is_like(self, other: Self) -> bool {
        self.place() == other.place()
    }

    /// Place in the order of values: components before x, y, z, and time behind them.
    pub(super) const fn place(self) -> u8 {
        match self {
            Self::Component(_) => 0,
            Self::X => 1,
            Self::Y => 2,
            Self::Z => 3,
            Self::Time(_) => 4,
        }
    }
}

/// Values of a sample that `axes` say; `None` if they are more than 32 bits count.
pub(super) fn components(axes: &[Axis]) -> Option<u32> {
    axes.iter().try_fold(1_u32, |product, axis| match axis {
        Axis::Component(count) => product.checked_mul(*count),
        _ => Some(product),
    })
}

/// Time steps that `axes` say; `None` if they are more than 64 bits count.
pub(super) fn steps(axes: &[Axis]) -> Option<u64> {
    axes.iter().try_fold(1_u64, |product, axis| match axis {
        Axis::Time(count) => product.checked_mul(*count),
        _ => Some(product),
    })
}
