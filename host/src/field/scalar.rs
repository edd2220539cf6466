//! Values at the nodes of a grid, and between them.

use super::Grid;
use crate::mesh::Point;
use crate::volume::{ElementType, FileFormat, HeaderLine, Metadata, Volume};

/// One number a node, x fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalarField {
    grid: Grid,
    values: Vec<f32>,
}

/// Why a volume is no field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FieldError {
    /// A sample is NaN or infinite.
    #[error("sample {index} (x fastest) is not finite, so that no surface passes near it: fill it in first")]
    NotFinite {
        /// Place of the first such sample.
        index: usize,
    },
}

impl ScalarField {
    /// A field of as many values as the grid has nodes, x fastest.
    ///
    /// # Panics
    /// If there are more or fewer.
    pub fn new(grid: Grid, values: Vec<f32>) -> Self {
        assert_eq!(values.len(), grid.len(), "one value a node");
        Self { grid, values }
    }

    /// Values of a function at the nodes of a grid.
    pub fn from_function(grid: Grid, function: impl Fn(Point) -> f64) -> Self {
        let [width, height, depth] = grid.extent;
        let nodes =
            (0..depth).flat_map(|k| (0..height).flat_map(move |j| (0..width).map(move |i| [i, j, k])));
        let values = nodes.map(|node| function(grid.position(node)) as f32).collect();
        Self { grid, values }
    }

    /// The samples of a volume, rounded to `f32`, with the spacing that its file gives (1 where it gives none) and the
    /// first sample where it says (at zero where it says nothing). Axes are taken for those of space, whatever their
    /// directions in the file.
    ///
    /// # Errors
    /// [`FieldError::NotFinite`].
    ///
    /// Cost: one pass.
    pub fn from_volume(volume: &Volume) -> Result<Self, FieldError> {
        let extent = volume.extent.map(|axis| axis as usize);
        let spacing = volume.metadata.spacing().map_or(Point::ONE, Point::from_array);
        let values = numbers(volume.element, &volume.samples);
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(FieldError::NotFinite { index });
        }
        let origin = volume.metadata.origin().and_then(|origin| <[f64; 3]>::try_from(origin).ok());
        Ok(Self::new(Grid { extent, origin: origin.map_or(Point::ZERO, Point::from_array), spacing }, values))
    }

    /// The values as a volume, whose metadata say where they lie.
    pub fn to_volume(&self) -> Volume {
        let Grid { extent, origin, spacing } = self.grid;
        let mut metadata = Metadata::plain(3, FileFormat::Nrrd);
        let field = |name: &str, value| HeaderLine::Field { name: name.to_owned(), value };
        let axis = |axis: usize| {
            let mut direction = [0.0; 3];
            direction[axis] = spacing[axis];
            vector(direction)
        };
        metadata.lines = vec![
            field("space dimension", "3".to_owned()),
            field("space directions", [0, 1, 2].map(axis).join(" ")),
            field("space origin", vector(origin.to_array())),
        ];
        let samples = self.values.iter().flat_map(|value| value.to_le_bytes()).collect();
        Volume { extent: extent.map(|axis| axis as u64), element: ElementType::F32, samples, metadata }
    }

    /// Where the values lie.
    pub const fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The values, x fastest.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Value at node (i, j, k).
    pub fn at(&self, node: [usize; 3]) -> f32 {
        self.values[self.grid.index(node)]
    }
}

/// A vector as NRRD writes it, with all digits.
fn vector([x, y, z]: [f64; 3]) -> String {
    format!("({x},{y},{z})")
}

/// Little-endian samples as numbers.
fn numbers(element: ElementType, samples: &[u8]) -> Vec<f32> {
    macro_rules! read {
        ($type:ty) => {
            samples.as_chunks().0.iter().map(|&bytes| <$type>::from_le_bytes(bytes) as f32).collect()
        };
    }
    match element {
        ElementType::U8 => read!(u8),
        ElementType::I8 => read!(i8),
        ElementType::U16 => read!(u16),
        ElementType::I16 => read!(i16),
        ElementType::U32 => read!(u32),
        ElementType::I32 => read!(i32),
        ElementType::U64 => read!(u64),
        ElementType::I64 => read!(i64),
        ElementType::F32 => read!(f32),
        ElementType::F64 => read!(f64),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn volumes_become_fields() {
        let samples = [1.5_f64, -2.0, 3.0, 4.0].iter().flat_map(|value| value.to_le_bytes()).collect();
        let metadata = Metadata::plain(2, FileFormat::Raw);
        let mut volume = Volume { extent: [2, 2, 1], element: ElementType::F64, samples, metadata };
        let field = ScalarField::from_volume(&volume).unwrap();
        assert_eq!(field.values(), [1.5, -2.0, 3.0, 4.0]);
        assert_eq!(field.at([0, 1, 0]), 3.0);
        volume.samples[8..16].copy_from_slice(&f64::NAN.to_le_bytes());
        assert_eq!(ScalarField::from_volume(&volume), Err(FieldError::NotFinite { index: 1 }));
    }

    #[test]
    fn fields_come_back_from_volumes() {
        let grid = Grid {
            extent: [3, 2, 2],
            origin: Point::new(0.1, -7.0, 1e-9),
            spacing: Point::new(0.3, 2.0, 1.0),
        };
        let field = ScalarField::from_function(grid, |point| point.x * point.y - point.z);
        assert_eq!(ScalarField::from_volume(&field.to_volume()), Ok(field));
    }

    #[test]
    fn functions_are_sampled_x_first() {
        let grid = Grid { extent: [2, 1, 2], origin: Point::X, spacing: Point::new(1.0, 1.0, 0.5) };
        let field = ScalarField::from_function(grid, |point| point.x + 10.0 * point.z);
        assert_eq!(field.values(), [1.0, 2.0, 6.0, 7.0]);
        assert_eq!(grid.local(grid.position([1, 0, 1])), Point::new(1.0, 0.0, 1.0));
    }
}
