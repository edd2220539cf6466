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
    let (mut same, mut tried) = (0, 0);
    for _ in 0..3000 {
        let field = noise.field([2, 2, 2], 1_000_000);
        let mesh = contour(&field, 0.5).unwrap();
        let fine = contour(&resampled(&field, 16), 0.5).unwrap();
        assert_manifold(&mesh, field.grid());
        tried += 1;
        same += usize::from(euler_characteristic(&mesh) == euler_characteristic(&fine));
    }
    println!("{same} of {tried}");
    assert!(same * 1000 >= tried * 990, "{same} of {tried}");
}
