//! psi_Q, the quadratic B-spline wavelet with small support and one vanishing moment (Diss eq. 3.42).

use core::num::Wrapping as W;

use super::step::{Step, nearest, step};

pub(super) const STEPS: [Step; 3] = [
    // c_i <- c_i - [d_{i-1} / 3]
    step!(low -= |left, _| nearest::<3>(left)),
    // d_i <- -d_i + [(9 c_i + 3 c_{i+1}) / 8]
    step!(high = |c, next| nearest::<8>(W(9) * c + W(3) * next), -high),
    // c_i <- c_i - [4 d_i / 9]
    step!(low -= |_, d, _| nearest::<9>(W(4) * d)),
];
