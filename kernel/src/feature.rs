//! The parts that a build may leave out, by the features of the crate.

use core::fmt;

use crate::Wavelet;

/// What only some builds of this crate can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Feature {
    /// That wavelet, both ways: the feature of its name, or `wavelets` for all.
    Wavelet(Wavelet),
    /// Distributions that adapt, to encode, [`Effort::Fast`](crate::Effort::Fast) and all below but [`Feature::Light`], and
    /// to decode: feature `adaptive`.
    Adaptive,
    /// Few decisions a sample, to encode, [`Effort::Light`](crate::Effort::Light), and to decode: feature `light`.
    Light,
    /// Predictors with weights, to train and to decode: feature `trained`.
    Trained,
    /// Tables of frequencies, to encode and to decode, [`Effort::Tabled`](crate::Effort::Tabled) and, with
    /// [`Feature::Trained`], [`Effort::Wide`](crate::Effort::Wide): feature `tabled`.
    Tabled,
    /// [`Dense`](crate::Dense) coding: feature `dense`.
    Dense,
    /// Near-lossless coding, [`Lattice`](crate::Lattice): feature `lattice`.
    Lattice,
}

impl Feature {
    /// Whether this build has the part; what it has not is refused, and takes no room.
    #[must_use]
    #[inline]
    pub const fn is_built(self) -> bool {
        match self {
            Self::Wavelet(Wavelet::Haar) => cfg!(feature = "haar"),
            Self::Wavelet(Wavelet::Quadratic) => cfg!(feature = "quadratic"),
            Self::Wavelet(Wavelet::Duchaineau) => cfg!(feature = "duchaineau"),
            Self::Wavelet(Wavelet::Linear) => cfg!(feature = "linear"),
            Self::Wavelet(Wavelet::Cubic) => cfg!(feature = "cubic"),
            Self::Wavelet(Wavelet::Quintic) => cfg!(feature = "quintic"),
            Self::Adaptive => cfg!(feature = "adaptive"),
            Self::Light => cfg!(feature = "light"),
            Self::Trained => cfg!(feature = "trained"),
            Self::Tabled => cfg!(feature = "tabled"),
            Self::Dense => cfg!(feature = "dense"),
            Self::Lattice => cfg!(feature = "lattice"),
        }
    }
}

impl fmt::Display for Feature {
    /// The name of its feature.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Wavelet(wavelet) => wavelet.name(),
            Self::Adaptive => "adaptive",
            Self::Light => "light",
            Self::Trained => "trained",
            Self::Tabled => "tabled",
            Self::Dense => "dense",
            Self::Lattice => "lattice",
        })
    }
}
