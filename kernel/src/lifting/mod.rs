//! The six integer-to-integer wavelets, each a list of lifting steps.
//!
//! A line x of n samples splits into scaling coefficients c_i = x\[2i\] (`low`, ceil(n/2) of them) and wavelet
//! coefficients d_i = x\[2i+1\] (`high`, floor(n/2)). A lifting step adds to one kind a rounded function of the
//! other, so with wrapping arithmetic it can be undone for every `i32`.
//! Rounding is everywhere \[r\] = floor(r + 1/2).
//!
//! Source: M. Bertram, *Multiresolution Modeling for Scientific Visualization*, dissertation, UC Davis 2000,
//! §3.3.4–3.4; the conventions in full are in `docs/lifting.md`.

mod cubic;
mod duchaineau;
pub mod generalized;
mod haar;
mod halves;
#[cfg(test)]
mod inverts;
mod linear;
mod nearest;
mod quadratic;
mod quintic;
mod step;

use core::fmt;

pub(crate) use halves::Halves;
use step::Lifting;

/// One of the six wavelets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Wavelet {
    /// psi_H: piecewise constant.
    Haar,
    /// psi_Q: quadratic B-spline with small support, one vanishing moment.
    Quadratic,
    /// psi_D: Duchaineau's quadratic wavelet.
    Duchaineau,
    /// psi_1: linear B-spline, two vanishing moments; the reversible 5/3 transform of JPEG 2000.
    Linear,
    /// psi_3: cubic B-spline, two vanishing moments.
    Cubic,
    /// psi_5: quintic B-spline, two vanishing moments; unstable over many levels (Diss §3.4.4).
    Quintic,
}

/// Which way a wavelet is applied.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Direction {
    Forward,
    Inverse,
}

impl Wavelet {
    /// All six, in the order of the dissertation's tables and of their codes in the codestream.
    pub const ALL: [Self; 6] =
        [Self::Haar, Self::Quadratic, Self::Duchaineau, Self::Linear, Self::Cubic, Self::Quintic];

    /// The name used on the command line: `haar`, `quadratic`, `duchaineau`, `linear`, `cubic`, `quintic`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Haar => "haar",
            Self::Quadratic => "quadratic",
            Self::Duchaineau => "duchaineau",
            Self::Linear => "linear",
            Self::Cubic => "cubic",
            Self::Quintic => "quintic",
        }
    }

    /// The symbol of the dissertation: `psi_H`, `psi_Q`, `psi_D`, `psi_1`, `psi_3`, `psi_5`.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Haar => "psi_H",
            Self::Quadratic => "psi_Q",
            Self::Duchaineau => "psi_D",
            Self::Linear => "psi_1",
            Self::Cubic => "psi_3",
            Self::Quintic => "psi_5",
        }
    }

    /// What one level along one axis makes of a constant signal, as `(numerator, denominator)`:
    /// the scaling coefficients are that fraction of the samples, up to rounding.
    #[must_use]
    pub const fn low_pass_gain(self) -> (u32, u32) {
        match self {
            Self::Haar | Self::Linear => (1, 1),
            Self::Quadratic | Self::Duchaineau => (2, 3),
            Self::Cubic => (1, 2),
            Self::Quintic => (1, 4),
        }
    }

    /// Transforms the lines of `halves` (n >= 2 samples each). No plan has a wavelet that is not built.
    pub(crate) fn forward(self, halves: &mut Halves<'_>) {
        match self {
            Self::Haar if cfg!(feature = "haar") => haar::steps().forward(halves),
            Self::Quadratic if cfg!(feature = "quadratic") => quadratic::steps().forward(halves),
            Self::Duchaineau if cfg!(feature = "duchaineau") => duchaineau::steps().forward(halves),
            Self::Linear if cfg!(feature = "linear") => linear::steps().forward(halves),
            Self::Cubic if cfg!(feature = "cubic") => cubic::steps().forward(halves),
            Self::Quintic if cfg!(feature = "quintic") => quintic::steps().forward(halves),
            _ => {}
        }
    }

    /// Undoes [`Wavelet::forward`]: the steps' inverses in reverse order.
    pub(crate) fn inverse(self, halves: &mut Halves<'_>) {
        match self {
            Self::Haar if cfg!(feature = "haar") => haar::steps().inverse(halves),
            Self::Quadratic if cfg!(feature = "quadratic") => quadratic::steps().inverse(halves),
            Self::Duchaineau if cfg!(feature = "duchaineau") => duchaineau::steps().inverse(halves),
            Self::Linear if cfg!(feature = "linear") => linear::steps().inverse(halves),
            Self::Cubic if cfg!(feature = "cubic") => cubic::steps().inverse(halves),
            Self::Quintic if cfg!(feature = "quintic") => quintic::steps().inverse(halves),
            _ => {}
        }
    }

    /// Applies or undoes one step on a row across many lines; see [`Lifting::lift_row`].
    #[cfg(feature = "stream")]
    pub(crate) fn lift_row(self, step: usize, direction: Direction, row: &mut [i32], beside: [&[i32]; 3]) {
        match self {
            Self::Haar if cfg!(feature = "haar") => haar::steps().lift_row(step, direction, row, beside),
            Self::Quadratic if cfg!(feature = "quadratic") => {
                quadratic::steps().lift_row(step, direction, row, beside)
            }
            Self::Duchaineau if cfg!(feature = "duchaineau") => {
                duchaineau::steps().lift_row(step, direction, row, beside)
            }
            Self::Linear if cfg!(feature = "linear") => {
                linear::steps().lift_row(step, direction, row, beside)
            }
            Self::Cubic if cfg!(feature = "cubic") => cubic::steps().lift_row(step, direction, row, beside),
            Self::Quintic if cfg!(feature = "quintic") => {
                quintic::steps().lift_row(step, direction, row, beside)
            }
            _ => {}
        }
    }

    /// The number of this wavelet in a codestream; 0 means no transform.
    pub(crate) const fn code(self) -> u8 {
        match self {
            Self::Haar => 1,
            Self::Quadratic => 2,
            Self::Duchaineau => 3,
            Self::Linear => 4,
            Self::Cubic => 5,
            Self::Quintic => 6,
        }
    }

    /// The wavelet of that number, if there is one.
    pub(crate) fn from_code(code: u8) -> Option<Self> {
        Self::ALL.iter().copied().find(|wavelet| wavelet.code() == code)
    }
}

impl fmt::Display for Wavelet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hand-computed lines, `low` then `high`.
    #[test]
    fn short_lines_by_hand() {
        let transform = |wavelet: Wavelet, samples: &[i32]| {
            let (mut scratch, mut line) = ([0; 16], [0; 8]);
            let mut halves = Halves::new(&mut scratch, 1, samples.len(), 1);
            for (low, high) in halves.groups() {
                for (i, pair) in samples.chunks(2).enumerate() {
                    low[i] = pair[0];
                    pair.get(1).into_iter().for_each(|&odd| high[i] = odd);
                }
            }
            wavelet.forward(&mut halves);
            for (low, high) in halves.groups() {
                line[..low.len()].copy_from_slice(low);
                line[low.len()..samples.len()].copy_from_slice(high);
            }
            line
        };
        // d = 1 - 4 = -3, c = 1 - [-1.5] = 1 - (-1) = 2
        assert_eq!(transform(Wavelet::Haar, &[1, 4])[..2], [2, -3]);
        // d = 4 - floor((1 + 7) / 2) = 0; c_0 = 1 + 0, c_1 = 7 + 0
        assert_eq!(transform(Wavelet::Linear, &[1, 4, 7])[..3], [1, 7, 0]);
        // c = 1 - [4/3] = 0; d = -4 + [0] = -4; c = 0 - [-16/9] = 2
        assert_eq!(transform(Wavelet::Quadratic, &[1, 4])[..2], [2, -4]);
        // c = 0 and d = -4 as before; c = 0 - [-48/27] = 2
        assert_eq!(transform(Wavelet::Duchaineau, &[1, 4])[..2], [2, -4]);
        // c = 1 + [-8/4] = -1; d = 4 + [-(-1 - 1)] = 6; c = -1 + [36/16] = 1
        assert_eq!(transform(Wavelet::Cubic, &[1, 4])[..2], [1, 6]);
        // d = 4 + [-2/6] = 4; c = 1 + [-72/16] = 1 - 4 = -3; d = 4 + [8] = 12; c = -3 + [120/32] = 1
        assert_eq!(transform(Wavelet::Quintic, &[1, 4])[..2], [1, 12]);
    }
}
