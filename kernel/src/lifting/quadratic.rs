//! psi_Q, the quadratic B-spline wavelet with small support and one vanishing moment (Diss eq. 3.42).

use core::num::Wrapping as W;

use super::nearest::nearest;
use super::step::{Lifting, flipped_high, low, zero_ended_low};

pub(super) fn steps() -> impl Lifting {
    // c_i <- c_i - [d_{i-1} / 3]
    low(|left, _| W(-1) * nearest::<3>(left))
        // d_i <- -d_i + [(9 c_i + 3 c_{i+1}) / 8]
        .then(flipped_high(|c, next| nearest::<8>(W(9) * c + W(3) * next)))
        // c_i <- c_i - [4 d_i / 9]
        .then(zero_ended_low(|_, d, _| W(-1) * nearest::<9>(W(4) * d)))
}
