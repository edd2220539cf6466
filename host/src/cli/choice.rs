//! Words on the command line that are neither plain numbers nor names of a list.

use std::num::NonZeroUsize;
use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use wavelift_host::codec::{Choice, Effort};
use wavelift_host::volume::{ExtentError, RankedExtent};
use wavelift_kernel::Wavelet;

/// `auto` or a number of levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Levels {
    /// As many as a brick allows.
    Auto,
    /// So many.
    Count(u8),
}

impl Levels {
    /// The number, if one is given.
    pub(crate) const fn count(self) -> Option<u8> {
        match self {
            Self::Auto => None,
            Self::Count(levels) => Some(levels),
        }
    }
}

/// Neither `auto` nor a number of levels.
#[derive(Debug, thiserror::Error)]
#[error("give auto, or a number from 0 to 31")]
pub(crate) struct LevelsError;

impl FromStr for Levels {
    type Err = LevelsError;

    fn from_str(text: &str) -> Result<Self, LevelsError> {
        match text.parse() {
            _ if text == "auto" => Ok(Self::Auto),
            Ok(levels @ 0..=31) => Ok(Self::Count(levels)),
            _ => Err(LevelsError),
        }
    }
}

/// Not a number of threads.
#[derive(Debug, thiserror::Error)]
#[error("give a number of threads from 1")]
pub(crate) struct ThreadsError;

/// Reads a number of threads.
pub(crate) fn parse_threads(text: &str) -> Result<NonZeroUsize, ThreadsError> {
    text.parse().map_err(|_| ThreadsError)
}

/// Not a size of memory.
#[derive(Debug, thiserror::Error)]
#[error("give a number of bytes, such as 512MiB, 4G or 1000000")]
pub(crate) struct MemoryError;

/// Reads a size of memory: K, M, G and T are powers of 1024, with or without iB or B behind.
pub(crate) fn parse_memory(text: &str) -> Result<u64, MemoryError> {
    let digits = text.find(|character: char| !character.is_ascii_digit()).unwrap_or(text.len());
    let (number, unit) = text.split_at(digits);
    let unit = unit.trim_start().to_ascii_lowercase();
    let power = match unit.trim_end_matches('b').trim_end_matches('i') {
        "" if unit.contains('i') => return Err(MemoryError),
        "" => 0,
        "k" => 10,
        "m" => 20,
        "g" => 30,
        "t" => 40,
        _ => return Err(MemoryError),
    };
    let number: u64 = number.parse().map_err(|_| MemoryError)?;
    number.checked_mul(1 << power).filter(|&bytes| bytes > 0).ok_or(MemoryError)
}

/// Takes `auto`, `none`, or the name of a wavelet.
pub(crate) fn wavelet_choices() -> impl TypedValueParser<Value = Choice> {
    let choices = [Choice::Auto].into_iter().chain(Wavelet::ALL.map(Choice::Wavelet)).chain([Choice::None]);
    PossibleValuesParser::new(choices.map(Choice::name)).map(|name| name.parse().expect("a name of the list"))
}

/// Takes the name of an effort.
pub(crate) fn effort_names() -> impl TypedValueParser<Value = Effort> {
    PossibleValuesParser::new(Effort::ALL.map(Effort::name))
        .map(|name| name.parse().expect("a name of the list"))
}

/// Reads `64` (as long along each axis) or `64x64x32`.
pub(crate) fn parse_brick(text: &str) -> Result<[u32; 3], ExtentError> {
    let extent: RankedExtent = text.parse()?;
    let [x, y, z] = extent.axes();
    let sides = if extent.rank() == 1 { [x; 3] } else { [x, y, z] };
    Ok(sides.map(|side| u32::try_from(side).unwrap_or(u32::MAX)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_auto_or_a_number() {
        assert_eq!("auto".parse::<Levels>().unwrap().count(), None);
        assert_eq!("0".parse::<Levels>().unwrap().count(), Some(0));
        assert_eq!("31".parse::<Levels>().unwrap().count(), Some(31));
        for text in ["", "Auto", "-1", "32", "1.5"] {
            text.parse::<Levels>().unwrap_err();
        }
    }

    #[test]
    fn memory_has_a_unit_or_none() {
        assert_eq!(parse_memory("512MiB").unwrap(), 512 << 20);
        assert_eq!(parse_memory("4g").unwrap(), 4 << 30);
        assert_eq!(parse_memory("64 kB").unwrap(), 64 << 10);
        assert_eq!(parse_memory("1000").unwrap(), 1000);
        for text in ["", "0", "M", "-1M", "1X", "1.5G", "99999999999T", "5iB"] {
            parse_memory(text).unwrap_err();
        }
    }

    #[test]
    fn bricks_have_one_side_or_three() {
        assert_eq!(parse_brick("32").unwrap(), [32; 3]);
        assert_eq!(parse_brick("512x256").unwrap(), [512, 256, 1]);
        assert_eq!(parse_brick("64x64x8").unwrap(), [64, 64, 8]);
        assert_eq!(parse_brick("4294967296").unwrap(), [u32::MAX; 3]);
        for text in ["", "0", "8x0", "1x2x3x4", "a"] {
            parse_brick(text).unwrap_err();
        }
    }
}
