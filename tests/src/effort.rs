//! The efforts of an encoder, without the memory that they need.

use serde::Deserialize;
use wavelift_kernel::{Dense, Effort as Lending, Training};

/// How much an encoder tries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Effort {
    /// Few decisions a sample.
    Light,
    /// Predictions and tables that the codestream brings.
    Tabled,
    /// As that, from as many samples as trained predictors.
    Wide,
    /// Predictors without weights.
    Fast,
    /// Predictors trained on the samples.
    Default,
    /// Under what is learnt from all samples before.
    Dense,
}

impl Effort {
    /// Every effort whose codestreams `Codec::decode` decodes.
    pub const ALL: [Self; 5] = [Self::Fast, Self::Default, Self::Tabled, Self::Wide, Self::Light];

    /// Runs with the effort as the kernel has it, and new memory to train in.
    pub fn lend<T>(self, run: impl FnOnce(Lending<'_>) -> T) -> T {
        match self {
            Self::Light => run(Lending::Light),
            Self::Tabled => run(Lending::Tabled),
            Self::Wide => run(Lending::Wide(&mut { Training::NEW })),
            Self::Fast => run(Lending::Fast),
            Self::Default => run(Lending::Default(&mut { Training::NEW })),
            Self::Dense => run(Lending::Dense(&mut Box::new(Dense::NEW), &mut { Training::NEW })),
        }
    }
}
