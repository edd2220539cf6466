//! psi_5, the quintic B-spline wavelet (Diss eq. 4.7, Table 3.3), its last step scaled down by 1/4 (Diss §3.4.3).
//!
//! Its fitting operator is unstable: coefficients grow rapidly over many levels (Diss §3.4.4).

use core::num::Wrapping as W;

use super::nearest::nearest;
use super::step::{Lifting, high, low};

pub(super) fn steps() -> impl Lifting {
    // w-lift(-1/6, 1)
    high(|c, next| nearest::<6>(W(-1) * (c + next)))
        // s-lift(-9/16, 1)
        .then(low(|left, d| nearest::<16>(W(-9) * (left + d))))
        // w-lift(-4/3, 1)
        .then(high(|c, next| nearest::<3>(W(-4) * (c + next))))
        // s-lift(5/32, 1)
        .then(low(|left, d| nearest::<32>(W(5) * (left + d))))
}
