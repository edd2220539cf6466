//! The encoding direction of the arithmetic coder.

use super::distribution::{Distribution, TOTAL_BITS};
use super::{Coder, low_bits, share_of_true};

/// Below this the interval is renormalized, a byte at a time.
pub(super) const MIN_RANGE: u32 = 1 << 24;

/// Raw bits coded in one go.
pub(super) const RAW_BITS: u32 = 12;

/// Where an encoder writes its bytes.
pub(crate) trait Sink {
    /// Takes one byte.
    fn write(&mut self, byte: u8);

    /// Takes a byte `count` times.
    fn repeat(&mut self, byte: u8, count: usize) {
        for _ in 0..count {
            self.write(byte);
        }
    }

    /// Adds one to the byte written last, which is not 0xFF.
    fn carry(&mut self);
}

/// The beginning of lent memory.
#[derive(Debug)]
pub(crate) struct Buffer<'a> {
    out: &'a mut [u8],
    /// Bytes written.
    len: usize,
    /// A byte did not fit; what is written from then on is meaningless.
    full: bool,
}

impl Sink for Buffer<'_> {
    #[inline(always)]
    fn write(&mut self, byte: u8) {
        match self.out.get_mut(self.len) {
            Some(slot) => {
                *slot = byte;
                self.len = self.len.wrapping_add(1);
            }
            None => self.full = true,
        }
    }

    fn carry(&mut self) {
        if let Some(last) = self.len.checked_sub(1).and_then(|last| self.out.get_mut(last)) {
            *last = last.wrapping_add(1);
        }
    }
}

/// Writes one codeword: a number in [0, 1), base 256, most significant byte first, trailing zero bytes left out.
///
/// The number lies in `low .. low + range`, in units of the last byte shifted out; everything above is written, or
/// held back: a run of zeros, which are not written if nothing follows, then a run of 0xFF, which a carry would turn
/// into zeros. A carry ends at the last zero held back, or else at the last byte written, which is then not 0xFF: it
/// changes one byte, and no byte is written that is taken back.
#[derive(Debug)]
pub(crate) struct Interval<S> {
    sink: S,
    /// Bytes 0 held back.
    zeros: usize,
    /// Bytes 0xFF held back, after the zeros.
    ones: usize,
    pub(super) low: u32,
    pub(super) range: u32,
}

/// Writes a codeword to lent memory.
pub(crate) type Encoder<'a> = Interval<Buffer<'a>>;

impl<'a> Encoder<'a> {
    /// Starts a codeword at the beginning of `out`.
    pub(crate) const fn new(out: &'a mut [u8]) -> Self {
        Self::over(Buffer { out, len: 0, full: false })
    }

    /// Ends the codeword in as few bytes as it takes and returns their number; `None` if the output was too short.
    pub(crate) fn finish(mut self) -> Option<usize> {
        self.end();
        (!self.sink.full).then_some(self.sink.len)
    }
}

impl<S> Interval<S> {
    /// Starts a codeword.
    pub(crate) const fn over(sink: S) -> Self {
        Self { sink, zeros: 0, ones: 0, low: 0, range: u32::MAX }
    }

    /// Where the codeword goes.
    #[cfg(feature = "stream")]
    pub(crate) const fn sink(&mut self) -> &mut S {
        &mut self.sink
    }

    /// The same, to look at.
    #[cfg(feature = "stream")]
    pub(crate) const fn peek(&self) -> &S {
        &self.sink
    }
}

impl<S: Sink> Interval<S> {
    /// Ends the codeword in as few bytes as it takes. What follows is another.
    pub(crate) fn end(&mut self) {
        // The smallest multiple of 2^24 in low .. low + range: one more byte, and zeros that need not be written.
        self.add(self.low.wrapping_neg() % MIN_RANGE);
        let [last, ..] = self.low.to_be_bytes();
        self.shift_out(last);
        if self.ones > 0 {
            self.write_held();
        }
        (self.zeros, self.low, self.range) = (0, 0, u32::MAX);
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn add(&mut self, offset: u32) {
        let (low, carry) = self.low.overflowing_add(offset);
        self.low = low;
        if carry {
            self.carry();
        }
    }

    #[cold]
    pub(super) fn carry(&mut self) {
        let ones = core::mem::take(&mut self.ones);
        if let Some(zeros) = self.zeros.checked_sub(1) {
            self.zeros = zeros;
            self.write_held();
            self.sink.write(1);
        } else {
            self.sink.carry();
        }
        self.zeros = ones;
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn renormalize(&mut self) {
        while self.range < MIN_RANGE {
            let [byte, ..] = self.low.to_be_bytes();
            self.shift_out(byte);
            self.low <<= 8;
            self.range <<= 8;
        }
    }

    #[cfg_attr(any(not(feature = "small"), feature = "light"), inline(always))]
    pub(super) fn shift_out(&mut self, byte: u8) {
        match byte {
            0 => {
                if self.ones > 0 {
                    self.write_held();
                }
                self.zeros = self.zeros.wrapping_add(1);
            }
            0xFF => self.ones = self.ones.wrapping_add(1),
            _ => {
                if self.zeros | self.ones != 0 {
                    self.write_held();
                }
                self.sink.write(byte);
            }
        }
    }

    #[cold]
    fn write_held(&mut self) {
        self.sink.repeat(0, core::mem::take(&mut self.zeros));
        self.sink.repeat(0xFF, core::mem::take(&mut self.ones));
    }
}

impl<S: Sink> Coder for Interval<S> {
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn symbol(&mut self, symbol: usize, distribution: &mut Distribution) -> usize {
        let unit = self.range >> TOTAL_BITS;
        let share = distribution.share(symbol);
        self.add(unit.wrapping_mul(share.below));
        self.range = unit.wrapping_mul(share.size);
        distribution.learn(symbol);
        self.renormalize();
        symbol
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn decide(&mut self, bit: bool, chance: u32) -> bool {
        let share = share_of_true(self.range, chance);
        if bit {
            self.range = share;
        } else {
            self.add(share);
            self.range = self.range.wrapping_sub(share);
        }
        self.renormalize();
        bit
    }

    #[cfg_attr(not(feature = "small"), inline(always))]
    fn raw(&mut self, bits: u32, count: u32) -> u32 {
        let mut left = count;
        while left > 0 {
            let now = left.min(RAW_BITS);
            left = left.wrapping_sub(now);
            let largest = low_bits(now);
            let part = (bits >> left) & largest;
            let unit = self.range >> now;
            self.add(unit.wrapping_mul(part));
            self.range =
                if part == largest { self.range.wrapping_sub(unit.wrapping_mul(largest)) } else { unit };
            self.renormalize();
        }
        bits
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Decoder, priors};
    use super::*;

    fn encode(symbols: &[usize], bytes: &mut [u8]) -> Option<usize> {
        let mut distribution = priors::LARGE;
        let mut encoder = Encoder::new(bytes);
        for &symbol in symbols {
            encoder.symbol(symbol, &mut distribution);
            encoder.raw(if symbol > 7 { 0xF_FFFF } else { 0 }, 20);
        }
        encoder.finish()
    }

    #[test]
    fn the_first_symbol_alone_costs_nothing() {
        let (mut distribution, mut bytes) = (priors::LARGE, []);
        let mut encoder = Encoder::new(&mut bytes);
        for _ in 0..10_000 {
            encoder.symbol(0, &mut distribution);
        }
        assert_eq!(encoder.finish(), Some(0));
    }

    #[test]
    fn carries_run_through() {
        // The last symbol drives the interval to the top, where a carry crosses many bytes of 0xFF.
        for count in (0..60).step_by(if cfg!(miri) { 25 } else { 1 }) {
            let mut symbols = [15; 60];
            symbols[count] = 0;
            let mut bytes = [0; 512];
            let len = encode(&symbols, &mut bytes).unwrap();
            let (mut distribution, mut decoder) = (priors::LARGE, Decoder::new(&bytes[..len]).unwrap());
            for symbol in symbols {
                assert_eq!(decoder.symbol(0, &mut distribution), symbol);
                assert_eq!(decoder.raw(0, 20), if symbol > 7 { 0xF_FFFF } else { 0 });
            }
            assert!(decoder.is_consumed());
        }
    }

    #[test]
    fn a_short_output_is_noticed_and_never_overrun() {
        let symbols = [9, 0, 12, 15, 3, 8, 14, 11];
        let mut bytes = [0; 64];
        let len = encode(&symbols, &mut bytes).unwrap();
        for room in 0..len {
            assert_eq!(encode(&symbols, &mut [0; 64][..room]), None);
        }
        let mut exact = [0; 64];
        assert_eq!(encode(&symbols, &mut exact[..len]), Some(len));
        assert_eq!(exact[..len], bytes[..len]);
    }
}
