//! Extents as people write them: `64x64x93`, x first, x varying fastest.

use std::fmt;
use std::str::FromStr;

/// Samples per axis, and how many axes were written.
///
/// ```
/// use wavelift_host::volume::RankedExtent;
///
/// let slice: RankedExtent = "512x256".parse()?;
/// assert_eq!((slice.axes(), slice.rank()), ([512, 256, 1], 2));
/// assert_eq!(slice.to_string(), "512x256");
/// # Ok::<(), wavelift_host::volume::ExtentError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RankedExtent {
    axes: [u64; 3],
    rank: u8,
}

impl RankedExtent {
    /// Takes 1 to 3 axes, x first; axes that are not given count one sample.
    ///
    /// # Errors
    ///
    /// [`ExtentError`] for no axis, more than three, an axis of zero samples, or more than `u64::MAX / 8`
    /// samples in all, so that the bytes of any sample type can be counted.
    pub fn new(axes: &[u64]) -> Result<Self, ExtentError> {
        if axes.is_empty() || axes.len() > 3 {
            return Err(ExtentError::Rank { found: axes.len() });
        }
        let mut extent = Self { axes: [1; 3], rank: 0 };
        let mut samples = 1_u64;
        for (slot, (&axis, name)) in extent.axes.iter_mut().zip(axes.iter().zip(['x', 'y', 'z'])) {
            if axis == 0 {
                return Err(ExtentError::ZeroAxis { axis: name });
            }
            samples = samples.checked_mul(axis).ok_or(ExtentError::TooLarge)?;
            *slot = axis;
            extent.rank += 1;
        }
        if samples > u64::MAX / 8 {
            return Err(ExtentError::TooLarge);
        }
        Ok(extent)
    }

    /// Samples along x, y and z, each at least 1.
    pub const fn axes(self) -> [u64; 3] {
        self.axes
    }

    /// Number of axes given, 1 to 3.
    pub const fn rank(self) -> u8 {
        self.rank
    }

    /// Samples in all, at most `u64::MAX / 8`.
    pub const fn samples(self) -> u64 {
        self.axes[0] * self.axes[1] * self.axes[2]
    }
}

impl fmt::Display for RankedExtent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.axes;
        match self.rank {
            1 => write!(f, "{x}"),
            2 => write!(f, "{x}x{y}"),
            _ => write!(f, "{x}x{y}x{z}"),
        }
    }
}

impl FromStr for RankedExtent {
    type Err = ExtentError;

    /// Reads `64x64x93`, `512,512` or `1000`: decimal numbers with `x`, `×`, `*` or a comma between them, nothing else.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let axes = text.split(['x', 'X', '×', '*', ',']).map(parse_axis).collect::<Result<Vec<u64>, _>>()?;
        Self::new(&axes)
    }
}

fn parse_axis(text: &str) -> Result<u64, ExtentError> {
    if text.is_empty() || !text.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(ExtentError::NotANumber { text: text.chars().take(32).collect() });
    }
    text.parse().map_err(|_| ExtentError::TooLarge)
}

/// Why an extent was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExtentError {
    /// Neither 1, 2 nor 3 axes.
    #[error("{found} axes in the extent: a volume has 1 to 3, written x, y, z as in 64x64x93")]
    Rank {
        /// Number of axes given.
        found: usize,
    },
    /// Not a decimal number between two signs.
    #[error("{text:?} is no number of samples: write the extent as in 64x64x93, x first")]
    NotANumber {
        /// The part in question, at most 32 characters of it.
        text: String,
    },
    /// An axis without samples.
    #[error("axis {axis} has zero samples: every axis needs at least one")]
    ZeroAxis {
        /// `x`, `y` or `z`.
        axis: char,
    },
    /// An axis of components or time without samples.
    #[error("an axis of components or time steps has no values: every axis needs at least one")]
    NoValues,
    /// More samples than can be counted.
    #[error("the extent has more samples than 64 bits can count the bytes of")]
    TooLarge,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<([u64; 3], u8), ExtentError> {
        text.parse().map(|extent: RankedExtent| (extent.axes(), extent.rank()))
    }

    #[test]
    fn one_to_three_axes_are_read() {
        assert_eq!(parse("64x32x93"), Ok(([64, 32, 93], 3)));
        assert_eq!(parse("512X511"), Ok(([512, 511, 1], 2)));
        assert_eq!(parse("7"), Ok(([7, 1, 1], 1)));
        for text in ["64,32,93", "64*32*93", "64×32×93"] {
            assert_eq!(parse(text), parse("64x32x93"));
        }
        assert_eq!(parse("7x1x1"), Ok(([7, 1, 1], 3)));
        for text in ["64x32x93", "512x511", "7", "7x1x1"] {
            assert_eq!(text.parse::<RankedExtent>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn everything_else_is_refused_by_its_fault() {
        assert_eq!(parse("1x2x3x4"), Err(ExtentError::Rank { found: 4 }));
        assert_eq!(RankedExtent::new(&[]), Err(ExtentError::Rank { found: 0 }));
        assert_eq!(parse("4x0x4"), Err(ExtentError::ZeroAxis { axis: 'y' }));
        for (text, part) in
            [("", ""), ("4x", ""), ("x4", ""), ("-4x4", "-4"), ("+4", "+4"), ("4 x4", "4 "), ("4/4", "4/4")]
        {
            assert_eq!(parse(text), Err(ExtentError::NotANumber { text: part.to_owned() }), "{text}");
        }
        assert_eq!(parse("18446744073709551616"), Err(ExtentError::TooLarge));
        assert_eq!(parse("4294967296x4294967296"), Err(ExtentError::TooLarge));
        assert_eq!(parse("2305843009213693952"), Err(ExtentError::TooLarge));
        assert_eq!(parse("2305843009213693951"), Ok(([2_305_843_009_213_693_951, 1, 1], 1)));
    }
}
