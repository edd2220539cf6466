//! psi_H, the Haar wavelet: d_i = c_i - d_i, then c_i becomes the mean (Diss Table 3.2, first row).

use core::num::Wrapping as W;

use super::nearest::nearest;
use super::step::{Lifting, flipped_high, zero_ended_low};

pub(super) fn steps() -> impl Lifting {
    // d_i <- c_i - d_i
    flipped_high(|c, _| c)
        // c_i <- c_i - [d_i / 2]
        .then(zero_ended_low(|_, d, _| W(-1) * nearest::<2>(d)))
}
