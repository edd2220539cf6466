//! What a segment is of.

use crate::oracle::coder::array::Array;
use crate::oracle::coder::predict::Scene;

/// From how many others a sample is predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Breadth {
    /// From up to 13.
    Narrow,
    /// From as many as in the low-pass part of a codestream without levels.
    Wide,
}

impl Breadth {
    /// The storage field that says so.
    pub const fn storage(self) -> u8 {
        match self {
            Self::Narrow => 3,
            Self::Wide => 4,
        }
    }

    /// Of which storage.
    pub fn of_storage(storage: u8) -> Option<Self> {
        [Self::Narrow, Self::Wide].into_iter().find(|breadth| breadth.storage() == storage)
    }

    /// The smallest span that is too large.
    pub const fn span_limit(self) -> i32 {
        match self {
            Self::Narrow => 1 << 19,
            Self::Wide => 1 << 16,
        }
    }

    /// The largest sum of the magnitudes of a set of weights.
    pub const fn largest_sum(self) -> i64 {
        match self {
            Self::Narrow => 2048,
            Self::Wide => 16384,
        }
    }
}

/// The form of the samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    /// Storage 3 or 4.
    pub breadth: Breadth,
    /// Samples along x, y, z.
    pub extent: [usize; 3],
}

impl Form {
    /// The number of weights in each set.
    pub fn sets(self) -> Vec<usize> {
        let [_, height, depth] = self.extent;
        match self.breadth {
            Breadth::Narrow => {
                let plane = if height > 1 { Some(6) } else { None };
                let brick = if depth > 1 { Some(13) } else { None };
                plane.into_iter().chain(brick).collect()
            }
            Breadth::Wide => scene(&Array::zeros(self.extent)).sets(),
        }
    }
}

/// Samples as the low-pass part that has no levels above it; sums have 32 bits.
pub(super) const fn scene(low_pass: &Array) -> Scene<'_> {
    Scene { level: std::slice::from_ref(low_pass), orientation: 0, narrow: true }
}
