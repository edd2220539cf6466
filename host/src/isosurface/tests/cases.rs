//! All cases, and how many there are.

use super::{Noise, assert_manifold, contour};
use crate::field::{Grid, ScalarField};

#[test]
fn every_cell_is_a_manifold_in_every_decision() {
    let mut noise = Noise(4);
    for inside in 0..=u8::MAX {
        for _ in 0..60 {
            let values = (0..8).map(|corner| {
                let magnitude =
                    (noise.next() % 1000 + 1) as f32 / if noise.next() & 1 == 1 { 1.0 } else { 50.0 };
                if inside >> corner & 1 == 1 { magnitude } else { -magnitude }
            });
            let field = ScalarField::new(Grid::unit([2, 2, 2]), values.collect());
            let mesh = contour(&field, 0.0).unwrap();
            assert_manifold(&mesh, field.grid());
        }
    }
}
