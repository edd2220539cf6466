//! `xtask/budgets.toml`: what the kernel may take on a target, and what it should.

use serde::Deserialize;

const FILE: &str = "xtask/budgets.toml";

/// The workspace of firmware.
pub(crate) const WORKSPACE: &str = "tests/device/Cargo.toml";

/// All budgets.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Budgets {
    #[serde(rename = "image")]
    pub(crate) images: Vec<Image>,
    #[serde(rename = "run")]
    pub(crate) runs: Vec<Run>,
}

/// A part of the kernel that is linked alone.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Image {
    /// What the table calls the features and the build.
    pub(crate) profile: String,
    pub(crate) binary: String,
    pub(crate) target: String,
    pub(crate) features: Vec<String>,
    pub(crate) build: String,
    pub(crate) flash: Limit,
}

/// Firmware that runs on a board.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Run {
    pub(crate) profile: String,
    pub(crate) board: String,
    pub(crate) target: String,
    pub(crate) features: Vec<String>,
    pub(crate) build: String,
    /// Golden vectors that come out as they should, exactly so many.
    pub(crate) vectors: u64,
    /// The brick that is measured: wavelet, levels and effort.
    pub(crate) brick: (String, u64, String),
    /// Instructions per sample.
    pub(crate) encode: Limit,
    pub(crate) decode: Limit,
    /// Bytes of state, scratch and stack.
    pub(crate) memory: Limit,
    /// Streams that are measured.
    #[serde(default, rename = "stream")]
    pub(crate) streams: Vec<Stream>,
}

/// A stream that firmware makes.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Stream {
    /// `slabs`, `slabs_of_rows`, whose slices are rows, or `rows`.
    pub(crate) kind: String,
    pub(crate) effort: String,
    /// Instructions per sample.
    pub(crate) encode: Limit,
    pub(crate) decode: Limit,
}

/// The most that is allowed, and what is aimed at where that is less.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(untagged)]
pub(crate) enum Limit {
    Most(u64),
    Short { most: u64, goal: u64 },
}

impl Limit {
    /// What is wrong with `found`, in words.
    pub(crate) fn check(self, what: &str, found: u64) -> Option<String> {
        let (Self::Most(most) | Self::Short { most, .. }) = self;
        (found > most).then(|| format!("{what}: {found}, and {FILE} allows {most}"))
    }

    /// The goal, if it is not reached.
    pub(crate) fn missed(self) -> Option<u64> {
        match self {
            Self::Most(_) => None,
            Self::Short { goal, .. } => Some(goal),
        }
    }
}

/// Reads them.
pub(crate) fn read() -> Result<Budgets, String> {
    let text = std::fs::read_to_string(FILE).map_err(|error| format!("{FILE}: {error}"))?;
    toml::from_str(&text).map_err(|error| format!("{FILE}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_more_than_allowed_is_wrong() {
        let short = Limit::Short { most: 10, goal: 7 };
        for limit in [Limit::Most(10), short] {
            assert_eq!(limit.check("a", 10), None);
            assert_eq!(limit.check("a", 11), Some("a: 11, and xtask/budgets.toml allows 10".to_owned()));
        }
        assert_eq!((Limit::Most(10).missed(), short.missed()), (None, Some(7)));
    }
}
