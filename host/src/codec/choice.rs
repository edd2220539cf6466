//! The choice of wavelet and levels.

use std::fmt;
use std::str::FromStr;

use wavelift_kernel::{Extent, Plan, Wavelet};

use super::CompressError;

/// What the user asks for: a wavelet, none, or the best.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// No transform, which is smallest, unless levels are asked for: then the wavelet that makes a sample of the bricks
    /// smallest.
    #[default]
    Auto,
    /// No transform: prediction and coding only; levels are made of decoded samples.
    None,
    /// That wavelet.
    Wavelet(Wavelet),
}

impl Choice {
    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::None => "none",
            Self::Wavelet(wavelet) => wavelet.name(),
        }
    }

    /// The wavelets to choose from, `None` standing for no transform, and the levels of a brick of `sides`.
    pub(super) fn candidates(self, levels: Option<u8>, sides: [u32; 3]) -> Result<Candidates, CompressError> {
        let max = Extent::new(sides).map_or(0, Extent::max_levels);
        let contradiction = |levels| CompressError::Contradiction { wavelet: self.name(), levels };
        match levels {
            Some(levels) if levels > max => return Err(CompressError::TooManyLevels { sides, max }),
            Some(levels @ 1..) if self == Self::None => return Err(contradiction(levels)),
            Some(0) if matches!(self, Self::Wavelet(_)) => return Err(contradiction(0)),
            _ => {}
        }
        let wavelets = match (self, levels) {
            (Self::None, _) | (Self::Auto, Some(0) | None) => vec![None],
            (Self::Wavelet(wavelet), _) => vec![Some(wavelet)],
            (Self::Auto, Some(_)) => Wavelet::ALL.map(Some).to_vec(),
        };
        Ok(Candidates { wavelets, levels: levels.unwrap_or(max) })
    }
}

/// What [`Choice`] leaves to choose from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Candidates {
    pub(super) wavelets: Vec<Option<Wavelet>>,
    pub(super) levels: u8,
}

impl Candidates {
    /// The transforms to try.
    pub(super) fn transforms(&self) -> impl Iterator<Item = Transform> {
        self.wavelets.iter().map(|&wavelet| match wavelet {
            Some(_) if self.levels > 0 => Transform { wavelet, levels: self.levels },
            _ => Transform::NONE,
        })
    }
}

/// A wavelet and levels for every brick; a brick too small for so many takes as many as it can.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Transform {
    pub(crate) wavelet: Option<Wavelet>,
    pub(crate) levels: u8,
}

impl Transform {
    /// No transform.
    pub(super) const NONE: Self = Self { wavelet: None, levels: 0 };

    /// The plan of a brick of `extent`.
    pub(crate) fn plan(self, extent: Extent) -> Plan {
        let levels = if self.wavelet.is_some() { self.levels.min(extent.max_levels()) } else { 0 };
        let wavelet = self.wavelet.unwrap_or(Wavelet::Haar);
        Plan::new(wavelet, extent, levels).expect("the levels are those that the extent allows")
    }
}

/// A name that is none of `auto`, `none` and the wavelets'.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownChoice(String);

impl fmt::Display for UnknownChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "'{}' is not a wavelet: give auto, none", self.0)?;
        Wavelet::ALL.iter().try_for_each(|wavelet| write!(f, ", {}", wavelet.name()))
    }
}

impl std::error::Error for UnknownChoice {}

impl FromStr for Choice {
    type Err = UnknownChoice;

    fn from_str(name: &str) -> Result<Self, UnknownChoice> {
        let all = [Self::Auto, Self::None].into_iter().chain(Wavelet::ALL.map(Self::Wavelet));
        all.into_iter().find(|choice| choice.name() == name).ok_or_else(|| UnknownChoice(name.to_owned()))
    }
}
