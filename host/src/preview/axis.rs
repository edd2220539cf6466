//! The axis that a picture is seen along.

use std::str::FromStr;

/// An axis of a volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Seen from the side: y goes right, z down.
    X,
    /// Seen from the front: x goes right, z down.
    Y,
    /// Seen from above: x goes right, y down.
    Z,
}

impl Axis {
    /// Its number: 0 for x.
    pub const fn number(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }

    /// The axes that go right and down in a picture along this one.
    pub const fn across(self) -> [usize; 2] {
        match self {
            Self::X => [1, 2],
            Self::Y => [0, 2],
            Self::Z => [0, 1],
        }
    }

    /// `x`, `y` or `z`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        }
    }
}

/// None of the axes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no axis: give x, y or z")]
pub struct UnknownAxis(String);

impl FromStr for Axis {
    type Err = UnknownAxis;

    fn from_str(text: &str) -> Result<Self, UnknownAxis> {
        let found = [Self::X, Self::Y, Self::Z].into_iter().find(|axis| axis.name() == text);
        found.ok_or_else(|| UnknownAxis(text.to_owned()))
    }
}
