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

/// Axes of a file that says no more than their counts, fastest first; `None` for more components than 32 bits count.
///
/// Up to three are x, y, z. Of four, the first holds components if it has four values or fewer, else the last is time.
/// Of more, the first holds components and those from the fifth on are time. No value moves for either, so a wrong
/// guess costs nothing but names.
pub(super) fn guessed(counts: &[u64]) -> Option<Vec<Axis>> {
    let with_components = counts.len() > 4 || counts.len() == 4 && counts[0] <= 4;
    let first = usize::from(with_components);
    let axis = |(index, &count): (usize, &u64)| match index.checked_sub(first) {
        None => Some(Axis::Component(u32::try_from(count).ok()?)),
        Some(index) => Some(Axis::SPACE.get(index).copied().unwrap_or(Axis::Time(count))),
    };
    counts.iter().enumerate().map(axis).collect()
}
