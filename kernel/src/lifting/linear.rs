//! psi_1, the linear B-spline wavelet (Diss eq. 4.5, Table 3.3): the reversible 5/3 transform of JPEG 2000.

use core::num::Wrapping as W;

use super::nearest::nearest;
use super::step::{Lifting, high, low};

pub(super) fn steps() -> impl Lifting {
    // w-lift(-1/2, 1)
    high(|c, next| nearest::<2>(W(-1) * (c + next)))
        // s-lift(1/4, 1)
        .then(low(|left, d| nearest::<4>(left + d)))
}
