//! psi_H, the Haar wavelet: d_i = c_i - d_i, then c_i becomes the mean (Diss Table 3.2, first row).

use super::step::{Step, nearest, step};

pub(super) const STEPS: [Step; 2] = [
    // d_i <- c_i - d_i
    step!(high = |c, _| c, -high),
    // c_i <- c_i - [d_i / 2]
    step!(low -= |_, d, _| nearest::<2>(d)),
];
