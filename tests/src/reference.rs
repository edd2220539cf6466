//! What the references of [`crate::oracle`] say, in the kernel's terms.

use wavelift_kernel::{Extent, Plan, Wavelet};

use crate::oracle::lifting::{self, Psi};

/// The symbol of a wavelet.
#[must_use]
pub const fn psi(wavelet: Wavelet) -> Psi {
    match wavelet {
        Wavelet::Haar => Psi::H,
        Wavelet::Quadratic => Psi::Q,
        Wavelet::Duchaineau => Psi::D,
        Wavelet::Linear => Psi::One,
        Wavelet::Cubic => Psi::Three,
        Wavelet::Quintic => Psi::Five,
    }
}

/// Samples along x, y and z, as lengths.
#[must_use]
pub fn sides(extent: Extent) -> [usize; 3] {
    extent.axes().map(|n| n as usize)
}

/// The coefficients of `samples` in Mallat order.
#[must_use]
pub fn forward(plan: &Plan, samples: &[i32]) -> Vec<i32> {
    let mut coefficients = samples.to_vec();
    lifting::forward(psi(plan.wavelet()), &mut coefficients, sides(plan.extent()), plan.levels().into());
    coefficients
}

/// Every 2^level-th of `samples` along each axis.
#[must_use]
pub fn lattice(plan: &Plan, samples: &[i32], level: u8) -> Vec<i32> {
    let [width, height, depth] = sides(plan.extent());
    let every = |n: usize| (0..n).step_by(1 << level);
    let rows = every(depth).flat_map(|z| every(height).map(move |y| (z * height + y) * width));
    rows.flat_map(|start| every(width).map(move |x| samples[start + x])).collect()
}

/// What is left of `samples` after `level` levels of the plan's transform.
#[must_use]
pub fn low_pass(plan: &Plan, samples: &[i32], level: u8) -> Vec<i32> {
    let whole = sides(plan.extent());
    let mut coefficients = samples.to_vec();
    lifting::forward(psi(plan.wavelet()), &mut coefficients, whole, level.into());
    let [width, height, depth] = whole.map(|n| n.div_ceil(1 << level));
    let rows = (0..depth).flat_map(|z| (0..height).map(move |y| (z * whole[1] + y) * whole[0]));
    rows.flat_map(|start| &coefficients[start..start + width]).copied().collect()
}
