//! The topology of contours is that of the trilinear interpolant, found by other means.

use super::{Noise, assert_manifold, contour, euler_characteristic};
use crate::field::{Grid, ScalarField};
use crate::mesh::Point;

/// The trilinear interpolant, sampled `fine` times as densely.
fn resampled(field: &ScalarField, fine: usize) -> ScalarField {
    let extent = field.grid().extent.map(|nodes| (nodes - 1) * fine + 1);
    ScalarField::from_function(
        Grid { extent, origin: Point::ZERO, spacing: Point::splat(1.0 / fine as f64) },
        |point| field.sample(point).expect("a point of the grid"),
    )
}

#[test]
fn euler_characteristics_are_those_of_finely_sampled_interpolants() {
    let mut noise = Noise(5);
    for _ in 0..3000 {
        let field = noise.field([2, 2, 2], 1_000_000);
        let mesh = contour(&field, 0.5).unwrap();
        assert_manifold(&mesh, field.grid());
        // Narrow necks need a closer look.
        let agrees = |fine: usize| {
            let fine = contour(&resampled(&field, fine), 0.5).unwrap();
            euler_characteristic(&mesh) == euler_characteristic(&fine)
        };
        assert!([16, 64, 192].into_iter().any(agrees), "{:?}", field.values());
    }
}
