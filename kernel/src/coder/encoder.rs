//! The encoding direction of the arithmetic coder.

use super::model::Probability;
use super::{BinaryCoder, low_bits};

/// Below this the interval is renormalized, a byte at a time.
pub(super) const MIN_RANGE: u32 = 1 << 24;

/// Raw bits coded in one go.
pub(super) const RAW_BITS: u32 = 8;

/// Writes one codeword: a number in [0, 1), base 256, most significant byte first, trailing zero bytes left out.
///
/// The codeword lies in `low .. low + range`, in units of the last byte kept; everything above is in `out` already.
/// A carry out of `low` is added to the bytes in `out`, which cannot overflow since the number stays below 1.
#[derive(Debug)]
pub(crate) struct Encoder<'a> {
    out: &'a mut [u8],
    /// Bytes written.
    len: usize,
    /// Zero bytes that follow them and are not written yet: at the end they never are.
    zeros: usize,
    /// A byte did not fit; nothing is written from then on.
    full: bool,
    low: u32,
    range: u32,
}

impl<'a> Encoder<'a> {
    /// Starts a codeword at the beginning of `out`.
    pub(crate) const fn new(out: &'a mut [u8]) -> Self {
        Self { out, len: 0, zeros: 0, full: false, low: 0, range: u32::MAX }
    }

    /// Ends the codeword in as few bytes as it takes and returns their number; `None` if the output was too short.
    pub(crate) fn finish(mut self) -> Option<usize> {
        // The smallest multiple of 2^24 in low .. low + range: one more byte, and zeros that need not be written.
        self.add(self.low.wrapping_neg() % MIN_RANGE);
        let [last, ..] = self.low.to_be_bytes();
        self.push(last);
        if self.full {
            return None;
        }
        let written = self.out.get(..self.len)?;
        Some(written.iter().rposition(|&byte| byte != 0).map_or(0, |last| last.wrapping_add(1)))
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
        if let Some(zeros) = self.zeros.checked_sub(1) {
            self.zeros = zeros;
            self.push(1);
            return;
        }
        for byte in self.out.iter_mut().take(self.len).rev() {
            *byte = byte.wrapping_add(1);
            if *byte != 0 {
                break;
            }
        }
    }

    #[inline(always)]
    fn renormalize(&mut self) {
        while self.range < MIN_RANGE {
            let [byte, ..] = self.low.to_be_bytes();
            self.push(byte);
            self.low <<= 8;
            self.range <<= 8;
        }
    }

    #[inline(always)]
    fn push(&mut self, byte: u8) {
        if byte == 0 {
            self.zeros = self.zeros.wrapping_add(1);
            return;
        }
        let end = self.len.wrapping_add(self.zeros);
        match self.out.get_mut(self.len..=end) {
            Some([zeros @ .., last]) if !self.full => {
                zeros.fill(0);
                *last = byte;
                self.len = end.wrapping_add(1);
                self.zeros = 0;
            }
            _ => self.full = true,
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
