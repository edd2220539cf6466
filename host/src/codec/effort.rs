//! How hard an encoder tries.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use wavelift_kernel::{Dense, Effort as KernelEffort, Training};

/// How much work a volume is worth. Every effort is decoded by every reader, which need not be told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Effort {
    /// Quickest: tables that suit a whole brick.
    Fast,
    /// The same with predictors trained on each brick, and lattices where samples may move.
    #[default]
    Default,
    /// Smallest, and slowest both ways: all that the kernel knows, and larger bricks to learn from.
    Dense,
    /// Few binary decisions a sample, for bricks that small processors decode; with a transform about as small as fast.
    Light,
}

impl Effort {
    /// Every effort: that for small processors, and the others, the quickest first.
    pub const ALL: [Self; 4] = [Self::Light, Self::Fast, Self::Default, Self::Dense];

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Default => "default",
            Self::Dense => "dense",
            Self::Light => "light",
        }
    }

    /// Whether lattices, which are trained, are worth their time.
    pub(super) const fn has_lattices(self) -> bool {
        matches!(self, Self::Default | Self::Dense)
    }

    /// The ways that a brick is encoded in, of which the shortest is kept.
    pub(super) const fn ways(self) -> &'static [Way] {
        match self {
            Self::Fast => &[Way::Tabled],
            Self::Default => &[Way::Wide],
            Self::Dense => &[Way::Adaptive, Way::Dense],
            Self::Light => &[Way::Light],
        }
    }
}

/// What the kernel is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// Predictions from the nearest samples, and distributions that adapt.
    Nearest,
    /// Tables, and predictions from the nearest samples.
    Tabled,
    /// Tables, and trained predictors.
    Wide,
    /// Trained predictors, and distributions that adapt.
    Adaptive,
    /// Under what is learnt from all samples before.
    Dense,
    /// In binary decisions.
    Light,
}

impl Way {
    /// This way, or, for samples that are nearly still, the one that predicts alike and has no tables: these would be most
    /// of what there is to write.
    pub(super) fn of_samples(self, samples: &[i32]) -> Self {
        match self {
            Self::Tabled if are_still(samples) => Self::Nearest,
            Self::Wide if are_still(samples) => Self::Adaptive,
            _ => self,
        }
    }

    /// The kernel's effort, with the memory that it learns in.
    pub(super) const fn of_kernel<'a>(
        self,
        training: &'a mut Training,
        dense: &'a mut Dense,
    ) -> KernelEffort<'a> {
        match self {
            Self::Nearest => KernelEffort::Fast,
            Self::Tabled => KernelEffort::Tabled,
            Self::Wide => KernelEffort::Wide(training),
            Self::Adaptive => KernelEffort::Default(training),
            Self::Dense => KernelEffort::Dense(dense, training),
            Self::Light => KernelEffort::Light,
        }
    }
}

/// Whether fewer than one in ten samples differ from the one before.
fn are_still(samples: &[i32]) -> bool {
    let changes =
        samples.iter().zip(samples.iter().skip(1)).filter(|(before, sample)| before != sample).count();
    10 * changes < samples.len()
}

impl fmt::Display for Effort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is no effort's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no effort: give light, fast, default or dense")]
pub struct UnknownEffort(String);

impl FromStr for Effort {
    type Err = UnknownEffort;

    fn from_str(name: &str) -> Result<Self, UnknownEffort> {
        let found = Self::ALL.into_iter().find(|effort| effort.name() == name);
        found.ok_or_else(|| UnknownEffort(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back() {
        for effort in Effort::ALL {
            assert_eq!(effort.to_string().parse(), Ok(effort));
        }
        assert_eq!(
            "slow".parse::<Effort>().unwrap_err().to_string(),
            "'slow' is no effort: give light, fast, default or dense"
        );
        assert_eq!(Effort::default(), Effort::Default);
    }
}
