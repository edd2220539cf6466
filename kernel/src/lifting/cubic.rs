//! psi_3, the cubic B-spline wavelet (Diss eq. 4.6, Table 3.3), its last step scaled down by 1/2 (Diss §3.4.3).

use core::num::Wrapping as W;

use super::nearest::nearest;
use super::step::{Lifting, high, low};

pub(super) fn steps() -> impl Lifting {
    // s-lift(-1/4, 1)
    low(|left, d| nearest::<4>(W(-1) * (left + d)))
        // w-lift(-1, 1)
        .then(high(|c, next| W(-1) * (c + next)))
        // s-lift(3/16, 1)
        .then(low(|left, d| nearest::<16>(W(3) * (left + d))))
}
