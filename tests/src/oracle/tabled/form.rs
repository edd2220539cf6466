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
    /// From as many, under several sets of weights in a slice, with classes by more ranks.
    Celled,
}

impl Breadth {
    /// All there are.
    pub const ALL: [Self; 3] = [Self::Narrow, Self::Wide, Self::Celled];

    /// The storage field that says so.
    pub const fn storage(self) -> u8 {
        match self {
            Self::Narrow => 3,
            Self::Wide => 4,
            Self::Celled => 6,
        }
    }

    /// Of which storage.
    pub fn of_storage(storage: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|breadth| breadth.storage() == storage)
    }

    /// The smallest span that is too large.
    pub const fn span_limit(self) -> i32 {
        match self {
            Self::Narrow => 1 << 19,
            Self::Wide | Self::Celled => 1 << 16,
        }
    }

    /// The largest sum of the magnitudes of a set of weights.
    pub const fn largest_sum(self) -> i64 {
        match self {
            Self::Narrow => 2048,
            Self::Wide | Self::Celled => 16384,
        }
    }
}

/// The form of the samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    /// Storage 3, 4 or 6.
    pub breadth: Breadth,
    /// Samples along x, y, z.
    pub extent: [usize; 3],
}

impl Form {
    /// The number of weights in each set, were there one set for all cells.
    pub fn sets(self) -> Vec<usize> {
        let [_, height, depth] = self.extent;
        match self.breadth {
            Breadth::Narrow => {
                let plane = if height > 1 { Some(6) } else { None };
                let brick = if depth > 1 { Some(13) } else { None };
                plane.into_iter().chain(brick).collect()
            }
            Breadth::Wide | Breadth::Celled => scene(&Array::zeros(self.extent)).sets(),
        }
    }

    /// Whether there may be a set of weights for each cell.
    pub fn has_cells(self) -> bool {
        self.breadth == Breadth::Celled && self.extent[2] == 1
    }

    /// The number of cells of a slice.
    pub fn cells(self) -> usize {
        self.cells_of(self.cell()).into_iter().product()
    }

    /// The cell at a column of a row, in rows from the first.
    pub(super) fn cell_at(self, x: usize, y: usize) -> usize {
        let [columns, rows] = self.cell();
        y / rows * self.extent[0].div_ceil(columns) + x / columns
    }

    /// Columns and rows of a cell.
    fn cell(self) -> [usize; 2] {
        let mut cell = [32, 16];
        while self.cells_of(cell).into_iter().product::<usize>() > 2048 {
            cell = cell.map(|side| 2 * side);
        }
        cell
    }

    const fn cells_of(self, [columns, rows]: [usize; 2]) -> [usize; 2] {
        [self.extent[0].div_ceil(columns), self.extent[1].div_ceil(rows)]
    }
}

/// Samples as the low-pass part that has no levels above it; sums have 32 bits.
pub(super) const fn scene(low_pass: &Array) -> Scene<'_> {
    Scene { level: std::slice::from_ref(low_pass), orientation: 0, narrow: true }
}
