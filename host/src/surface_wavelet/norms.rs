//! How much of the surface a coefficient moves.

use super::basis::{Basis, Kind};

/// L2 norms of the functions that the coefficients of each level stand for, over the vertices of the finest mesh, where
/// the mesh is regular.
///
/// The functions are tensor products there, so that the norms are products of those on a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Norms {
    /// Norms on a line of the scaling function of each level, from the base mesh to the finest mesh.
    scaling: Vec<f64>,
    /// Norms on a line of the wavelet of each step, from coarse to fine.
    wavelet: Vec<f64>,
}

impl Norms {
    /// Norms for a hierarchy of so many steps.
    ///
    /// Cost: that of `steps` transforms of a line of 2^(steps + 5) points; from 8 steps on, norms double from level to
    /// level.
    pub fn new(basis: Basis, steps: usize) -> Self {
        let simulated = steps.min(8);
        let later = |exact: Vec<f64>, count: usize| -> Vec<f64> {
            // From fine to coarse; each level is √2 of the next finer one once functions are smooth.
            let last = exact.last().copied().unwrap_or(1.0);
            let more = (1..=count.saturating_sub(exact.len())).map(|n| last * 2_f64.sqrt().powi(n as i32));
            let mut all: Vec<f64> = exact.iter().copied().chain(more).collect();
            all.reverse();
            all
        };
        let scaling = (0..=simulated).map(|depth| norm(basis, depth, 0)).collect();
        let wavelet = (1..=simulated).map(|depth| norm(basis, depth, 1)).collect();
        Self { scaling: later(scaling, steps + 1), wavelet: later(wavelet, steps) }
    }

    /// Norm for control points of the base mesh.
    pub fn base(&self) -> f64 {
        self.scaling[0] * self.scaling[0]
    }

    /// Norm for details in the edges of a step.
    pub fn edges(&self, step: usize) -> f64 {
        self.wavelet[step] * self.scaling[step + 1]
    }

    /// Norm for details in the faces of a step.
    pub fn faces(&self, step: usize) -> f64 {
        self.wavelet[step] * self.wavelet[step]
    }
}

/// Norm of what a one at place `offset` of a line becomes after `depth` steps: of a wavelet if `offset` is 1.
fn norm(basis: Basis, depth: usize, offset: usize) -> f64 {
    let size = 32 << depth;
    let mut line = vec![0.0; size];
    // In place: after step s the points of the line are those at multiples of 2^(depth - s).
    line[size / 2 + (offset << depth >> 1)] = 1.0;
    for step in 0..depth {
        let apart = 1 << (depth - step - 1);
        for lift in basis.lifts() {
            let first = match lift.kind {
                Kind::S => 0,
                Kind::W => apart,
            };
            for place in (first..size).step_by(2 * apart) {
                let sum = line[(place + size - apart) % size] + line[(place + apart) % size];
                line[place] = lift.b * line[place] + lift.a * sum;
            }
        }
    }
    line.iter().map(|value| value * value).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hat_is_a_hat() {
        let norms = Norms::new(Basis::Bilinear, 1);
        // 1/2, 1, 1/2 squared and summed, twice rooted.
        assert!((norms.base() - 1.5).abs() < 1e-15);
        // The wavelet -1/8 -1/4 3/4 -1/4 -1/8 on a line.
        assert!((norms.faces(0) - (2.0 * (1.0 / 64.0 + 1.0 / 16.0) + 9.0 / 16.0)).abs() < 1e-15);
    }

    #[test]
    fn norms_double_from_level_to_level() {
        for basis in Basis::ALL {
            let norms = Norms::new(basis, 11);
            assert!((norms.base() / 2.0 / (norms.scaling[1] * norms.scaling[1]) - 1.0).abs() < 1e-3);
            for step in 0..5 {
                let ratios =
                    [norms.edges(step) / norms.edges(step + 1), norms.faces(step) / norms.faces(step + 1)];
                assert!(ratios.iter().all(|ratio| (ratio - 2.0).abs() < 1e-2), "{basis:?} {step} {ratios:?}");
            }
        }
    }
}
