//! The encoding direction of the arithmetic coder.

use super::model::Probability;
use super::{BinaryCoder, low_bits};

/// Below this the interval is renormalized, a byte at a time.
pub(super) const MIN_RANGE: u32 = 1 << 24;

/// Raw bits coded in one go.
pub(super) const RAW_BITS: u32 = 8;

/// Writes one codeword: a number in [0, 1), base 256, most significant byte first, trailing zero bytes left out.
///
/// The number lies in `low .. low + range`, in units of the last byte shifted out; everything above is in `out`, or
/// held back: a run of zeros, which are not written if nothing follows, then a run of 0xFF, which a carry would turn
/// into zeros. A carry ends at the last zero held back, or else at the last byte in `out`, which is then not 0xFF: it
/// changes one byte, and no byte is written that is taken back.
#[derive(Debug)]
pub(crate) struct Encoder<'a> {
    out: &'a mut [u8],
    /// Bytes written.
    len: usize,
    /// Bytes 0 held back.
    zeros: usize,
    /// Bytes 0xFF held back, after the zeros.
    ones: usize,
    /// A byte did not fit; what is written from then on is meaningless.
    full: bool,
    low: u32,
    range: u32,
}

impl<'a> Encoder<'a> {
    /// Starts a codeword at the beginning of `out`.
    pub(crate) const fn new(out: &'a mut [u8]) -> Self {
        Self { out, len: 0, zeros: 0, ones: 0, full: false, low: 0, range: u32::MAX }
    }

    /// Ends the codeword in as few bytes as it takes and returns their number; `None` if the output was too short.
    pub(crate) fn finish(mut self) -> Option<usize> {
        // The smallest multiple of 2^24 in low .. low + range: one more byte, and zeros that need not be written.
        self.add(self.low.wrapping_neg() % MIN_RANGE);
        let [last, ..] = self.low.to_be_bytes();
        self.shift_out(last);
        if self.ones > 0 {
            self.write_held();
        }
        (!self.full).then_some(self.len)
    }

    #[inline(always)]
    fn add(&mut self, offset: u32) {
        let (low, carry) = self.low.overflowing_add(offset);
        self.low = low;
        if carry {
            self.carry();
        }
    }

    #[cold]
    fn carry(&mut self) {
        let ones = core::mem::take(&mut self.ones);
        if let Some(zeros) = self.zeros.checked_sub(1) {
            self.zeros = zeros;
            self.write_held();
            self.write(1);
        } else if let Some(last) = self.len.checked_sub(1).and_then(|last| self.out.get_mut(last)) {
            *last = last.wrapping_add(1);
        }
        self.zeros = ones;
    }

    #[inline(always)]
    fn renormalize(&mut self) {
        while self.range < MIN_RANGE {
            let [byte, ..] = self.low.to_be_bytes();
            self.shift_out(byte);
            self.low <<= 8;
            self.range <<= 8;
        }
    }

    #[inline(always)]
    fn shift_out(&mut self, byte: u8) {
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
                self.write(byte);
            }
        }
    }

    #[cold]
    fn write_held(&mut self) {
        for _ in 0..core::mem::take(&mut self.zeros) {
            self.write(0);
        }
        for _ in 0..core::mem::take(&mut self.ones) {
            self.write(0xFF);
        }
    }

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
}

impl BinaryCoder for Encoder<'_> {
    #[inline(always)]
    fn decide(&mut self, bit: bool, probability: &mut Probability) -> bool {
        let split = (self.range >> 16).wrapping_mul(probability.of_false());
        if bit {
            self.add(split);
            self.range = self.range.wrapping_sub(split);
        } else {
            self.range = split;
        }
        probability.learn(bit);
        self.renormalize();
        bit
    }

    #[inline(always)]
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
    use super::super::Decoder;
    use super::*;

    fn encode(bits: &[bool], bytes: &mut [u8]) -> Option<usize> {
        let mut probability = Probability::NEW;
        let mut encoder = Encoder::new(bytes);
        for &bit in bits {
            encoder.decide(bit, &mut probability);
            encoder.raw(u32::from(bit) * 0xF_FFFF, 20);
        }
        encoder.finish()
    }

    #[test]
    fn zeros_cost_nothing() {
        let (mut probability, mut bytes) = (Probability::NEW, []);
        let mut encoder = Encoder::new(&mut bytes);
        for _ in 0..10_000 {
            encoder.decide(false, &mut probability);
        }
        assert_eq!(encoder.finish(), Some(0));
    }

    #[test]
    fn carries_run_through() {
        // Ones drive the interval to the top, where a carry crosses many bytes of 0xFF.
        for count in 0..60 {
            let mut bits = [true; 60];
            bits[count] = false;
            let mut bytes = [0; 256];
            let len = encode(&bits, &mut bytes).unwrap();
            let (mut probability, mut decoder) = (Probability::NEW, Decoder::new(&bytes[..len]).unwrap());
            for bit in bits {
                assert_eq!(decoder.decide(false, &mut probability), bit);
                assert_eq!(decoder.raw(0, 20), u32::from(bit) * 0xF_FFFF);
            }
            assert!(decoder.is_consumed());
        }
    }

    #[test]
    fn a_short_output_is_noticed_and_never_overrun() {
        let bits = [true, false, true, true, false, true, true, true];
        let mut bytes = [0; 64];
        let len = encode(&bits, &mut bytes).unwrap();
        for room in 0..len {
            assert_eq!(encode(&bits, &mut [0; 64][..room]), None);
        }
        let mut exact = [0; 64];
        assert_eq!(encode(&bits, &mut exact[..len]), Some(len));
        assert_eq!(exact[..len], bytes[..len]);
    }
}
