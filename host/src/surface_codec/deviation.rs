//! How far decoded points are from those encoded.

use crate::mesh::Point;
use crate::subdivision::{SubdivisionSurface, area_vectors};

/// Distances between points of the same number, in world units. Those between surfaces are no larger, and to first order
/// those along normals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Root mean square distance over the area.
    pub rms: f64,
    /// Root mean square of the parts along normals.
    pub rms_along_normals: f64,
    /// Largest distance.
    pub largest: f64,
}

impl Deviation {
    pub(super) fn between(surface: &SubdivisionSurface, points: &[Point]) -> Self {
        let areas = area_vectors(&surface.level(surface.levels));
        let (mut all, mut rms, mut along) = (0.0, 0.0, 0.0);
        let mut largest = 0.0_f64;
        for ((point, given), area) in points.iter().zip(&surface.positions).zip(&areas) {
            let off = *point - *given;
            // Where there is no area, as if there were next to none.
            let weight = area.length().max(1e-200);
            all += weight;
            rms += weight * off.length_squared();
            along += weight * off.dot(*area / weight).powi(2);
            largest = largest.max(off.length_squared());
        }
        let [rms, rms_along_normals] = [rms, along].map(|sum| (sum / all).sqrt());
        Self { rms, rms_along_normals, largest: largest.sqrt() }
    }
}
