//! psi_D, Duchaineau's quadratic wavelet: psi_Q with a longer last step (Diss Table 3.2, third row).
//!
//! From l^D_i = l^Q_i + (h_{i-2} - h_{i+2}) / 3 and the row scaling of Diss eq. (3.42) follows the factor
//! (1/3)(2/3)(2/3) = 4/27 of the outer wavelet coefficients, beside 4/9 = 12/27 of the middle one.

use core::num::Wrapping as W;

use super::nearest::nearest;
use super::step::{Lifting, flipped_high, low, zero_ended_low};

pub(super) fn steps() -> impl Lifting {
    // c_i <- c_i - [d_{i-1} / 3]
    low(|left, _| W(-1) * nearest::<3>(left))
        // d_i <- -d_i + [(9 c_i + 3 c_{i+1}) / 8]
        .then(flipped_high(|c, next| nearest::<8>(W(9) * c + W(3) * next)))
        // c_i <- c_i - [(12 d_i - 4 (d_{i+1} - d_{i-1})) / 27]
        .then(zero_ended_low(|left, d, right| W(-1) * nearest::<27>(W(12) * d - W(4) * (right - left))))
}
