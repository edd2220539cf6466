//! How far decoded points are from those encoded.

use crate::mesh::Point;
use crate::subdivision::{SubdivisionSurface, normals};

/// Distances between points of the same number, in world units. Those between surfaces are no larger, and to first order
/// those along normals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Root mean square distance.
    pub rms: f64,
    /// Root mean square of the parts along normals.
    pub rms_along_normals: f64,
    /// Largest distance.
    pub largest: f64,
}

impl Deviation {
    pub(super) fn between(surface: &SubdivisionSurface, points: &[Point]) -> Self {
        let normals = normals(&surface.level(surface.levels));
        let mut sums = [0.0; 2];
        let mut largest = 0.0_f64;
        for ((point, given), normal) in points.iter().zip(&surface.positions).zip(&normals) {
            let off = *point - *given;
            let square = off.length_squared();
            sums[0] += square;
            // A vertex without a normal counts wholly.
            sums[1] += if *normal == Point::ZERO { square } else { off.dot(*normal).powi(2) };
            largest = largest.max(square);
        }
        let [rms, rms_along_normals] = sums.map(|sum| (sum / points.len() as f64).sqrt());
        Self { rms, rms_along_normals, largest: largest.sqrt() }
    }
}
