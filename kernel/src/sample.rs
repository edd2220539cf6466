//! The integer types of samples.

use core::fmt;
use core::ops::RangeInclusive;

/// The type a sample has in the caller's data; the kernel itself works on `i32`.
///
/// `u32` travels as the same 32 bits (`u32::cast_signed`); every other type keeps its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SampleType {
    /// 0 to 255.
    U8,
    /// -128 to 127.
    I8,
    /// 0 to 65,535.
    U16,
    /// -32,768 to 32,767.
    I16,
    /// 0 to 2^32 - 1, as the same bits in an `i32`.
    U32,
    /// Any `i32`.
    I32,
}

impl SampleType {
    /// Every type, in the order of their codes in the codestream.
    pub const ALL: [Self; 6] = [Self::U8, Self::I8, Self::U16, Self::I16, Self::U32, Self::I32];

    /// The name used on the command line: `u8`, `i8`, `u16`, `i16`, `u32`, `i32`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::U8 => "u8",
            Self::I8 => "i8",
            Self::U16 => "u16",
            Self::I16 => "i16",
            Self::U32 => "u32",
            Self::I32 => "i32",
        }
    }

    /// Bytes of one sample.
    #[must_use]
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 => 4,
        }
    }

    /// Bits of one sample.
    pub(crate) const fn bits(self) -> u32 {
        match self {
            Self::U8 | Self::I8 => 8,
            Self::U16 | Self::I16 => 16,
            Self::U32 | Self::I32 => 32,
        }
    }

    /// The values that samples of this type take as `i32`.
    #[must_use]
    pub const fn range(self) -> RangeInclusive<i32> {
        match self {
            Self::U8 => 0..=0xFF,
            Self::I8 => -0x80..=0x7F,
            Self::U16 => 0..=0xFFFF,
            Self::I16 => -0x8000..=0x7FFF,
            Self::U32 | Self::I32 => i32::MIN..=i32::MAX,
        }
    }

    /// Position of the first sample outside the type.
    pub(crate) fn first_outside(self, samples: &[i32]) -> Option<usize> {
        let (lowest, highest) = self.range().into_inner();
        let span = highest.wrapping_sub(lowest).cast_unsigned();
        let is_outside = |sample: &i32| sample.wrapping_sub(lowest).cast_unsigned() > span;
        // Whether there is any takes no branch a sample, and by vectors no time; where it is, is seldom asked.
        if !cfg!(feature = "small") && !samples.iter().fold(false, |any, sample| any | is_outside(sample)) {
            return None;
        }
        samples.iter().position(is_outside)
    }

    /// The number of this type in a codestream.
    pub(crate) const fn code(self) -> u8 {
        match self {
            Self::U8 => 0,
            Self::I8 => 1,
            Self::U16 => 2,
            Self::I16 => 3,
            Self::U32 => 4,
            Self::I32 => 5,
        }
    }

    /// The type of that number, if there is one.
    pub(crate) fn from_code(code: u8) -> Option<Self> {
        Self::ALL.iter().copied().find(|sample_type| sample_type.code() == code)
    }
}

impl fmt::Display for SampleType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
