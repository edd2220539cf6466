//! The decoding direction of the arithmetic coder.

use super::distribution::{Distribution, TOTAL_BITS};
use super::encoder::{MIN_RANGE, RAW_BITS};
use super::{Coder, low_bits, share_of_true};

/// Bytes of a codeword that the decoder holds at a time, and so reads ahead.
pub(crate) const WINDOW: usize = 4;

/// Reads one codeword; beyond its last byte it reads zeros.
#[derive(Debug)]
pub(crate) struct Decoder<'a> {
    pub(super) bytes: &'a [u8],
    /// Bytes taken, zeros beyond the end included.
    pub(super) taken: usize,
    /// The codeword less the encoder's `low`, always below `range`.
    pub(super) code: u32,
    pub(super) range: u32,
}

/// A decoder without its bytes.
#[cfg(feature = "stream")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Suspended {
    code: u32,
    range: u32,
}

#[cfg(feature = "stream")]
impl Suspended {
    /// Before a codeword.
    pub(crate) const NONE: Self = Self { code: 0, range: u32::MAX };
}

impl<'a> Decoder<'a> {
    /// Starts on a codeword. `None` if no encoder ends one like this: with a zero byte, or at 1 - 2^-32 and above.
    pub(crate) fn new(bytes: &'a [u8]) -> Option<Self> {
        if bytes.last() == Some(&0) { None } else { Self::begin(bytes) }
    }

    /// Starts on a codeword of which `bytes` are the first. `None` if it stands for 1 - 2^-32 or more.
    pub(crate) fn begin(bytes: &'a [u8]) -> Option<Self> {
        let decoder = Self::lenient(bytes);
        (decoder.code < decoder.range).then_some(decoder)
    }

    /// Starts on any bytes.
    pub(super) fn lenient(bytes: &'a [u8]) -> Self {
        let mut decoder = Self { bytes, taken: 0, code: 0, range: u32::MAX };
        for _ in 0..WINDOW {
            decoder.take();
        }
        decoder
    }

    /// Whether the next decision is the same whatever follows the bytes.
    #[inline]
    pub(super) const fn is_sure(&self, chance: u32) -> bool {
        let share = share_of_true(self.range, chance);
        let unknown = match self.taken.saturating_sub(self.bytes.len()) {
            0 => 0,
            1 => 0xFF,
            2 => 0xFFFF,
            3 => 0xFF_FFFF,
            _ => u32::MAX,
        };
        let most = self.code.saturating_add(unknown);
        (self.code < share) == (most < share)
    }

    /// Goes on with a codeword where another decoder left it; `bytes` are those not taken yet.
    #[cfg(feature = "stream")]
    pub(crate) const fn resume(left: Suspended, bytes: &'a [u8]) -> Self {
        let Suspended { code, range } = left;
        Self { bytes, taken: 0, code, range }
    }

    /// Bytes not taken yet.
    #[cfg(feature = "stream")]
    pub(crate) const fn left(&self) -> usize {
        self.bytes.len().saturating_sub(self.taken)
    }

    /// What another decoder needs to go on, and the bytes taken, zeros beyond the end included.
    #[cfg(feature = "stream")]
    pub(crate) const fn suspend(self) -> (Suspended, usize) {
        (Suspended { code: self.code, range: self.range }, self.taken)
    }

    /// Whether an encoder that made these decisions would have written a codeword of this length: it writes as many
    /// bytes as were shifted out, and at most one more.
    pub(crate) const fn is_consumed(&self) -> bool {
        self.bytes.len() <= self.taken.wrapping_sub(WINDOW - 1)
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn take(&mut self) {
        let byte = self.bytes.get(self.taken).copied().unwrap_or(0);
        self.taken = self.taken.wrapping_add(1);
        self.code = (self.code << 8) | u32::from(byte);
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn renormalize(&mut self) {
        while self.range < MIN_RANGE {
            self.take();
            self.range <<= 8;
        }
    }
}

impl Coder for Decoder<'_> {
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn symbol(&mut self, _: usize, distribution: &mut Distribution) -> usize {
        let unit = self.range >> TOTAL_BITS;
        // Rounding leaves a little of the interval to no symbol; no encoder points there.
        let point = self.code.checked_div(unit).and_then(|point| i16::try_from(point).ok());
        let symbol = distribution.find(point.unwrap_or(i16::MAX));
        let share = distribution.share(symbol);
        self.code = self.code.wrapping_sub(unit.wrapping_mul(share.below));
        self.range = unit.wrapping_mul(share.size);
        distribution.learn(symbol);
        self.renormalize();
        symbol
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn decide(&mut self, _: bool, chance: u32) -> bool {
        let share = share_of_true(self.range, chance);
        let bit = self.code < share;
        if bit {
            self.range = share;
        } else {
            self.code = self.code.wrapping_sub(share);
            self.range = self.range.wrapping_sub(share);
        }
        self.renormalize();
        bit
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn raw(&mut self, _: u32, count: u32) -> u32 {
        let mut bits = 0_u32;
        let mut left = count;
        while left > 0 {
            let now = left.min(RAW_BITS);
            left = left.wrapping_sub(now);
            let largest = low_bits(now);
            let unit = self.range >> now;
            // Rounding leaves the rest of the interval to the largest value.
            let part = self.code.checked_div(unit).unwrap_or(0).min(largest);
            let below = unit.wrapping_mul(part);
            self.code = self.code.wrapping_sub(below);
            self.range = if part == largest { self.range.wrapping_sub(below) } else { unit };
            bits = (bits << now) | part;
            self.renormalize();
        }
        bits
    }
}
