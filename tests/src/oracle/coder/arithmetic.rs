//! The arithmetic coder. The encoder holds its whole number and carries digit by digit.

use super::distribution::Distribution;
use super::header::Reject;

/// A shorter range is too coarse for the next symbol.
const SHORTEST: u64 = 1 << 24;

const WHOLE: u64 = (1 << 32) - 1;

/// The part of `range` that belongs to symbol `s`: where it begins and how long it is.
fn part(range: u64, distribution: &Distribution, s: usize) -> (u64, u64) {
    let unit = range >> 15;
    let (below, next) = (distribution.below(s), distribution.below(s + 1));
    (unit * below, unit * (next - below))
}

/// Bits of each group in a run of `count` raw bits, from the highest.
fn groups(count: u32) -> Vec<u32> {
    let mut groups = vec![12; (count / 12) as usize];
    groups.extend((!count.is_multiple_of(12)).then_some(count % 12));
    groups
}

/// The part of `range` that belongs to `b`, a group of `g` raw bits: where it begins and how long it is.
const fn raw_part(range: u64, g: u32, b: u64) -> (u64, u64) {
    let unit = range >> g;
    let largest = (1 << g) - 1;
    (b * unit, if b == largest { range - b * unit } else { unit })
}

/// A segment being written.
#[derive(Debug)]
pub(super) struct Encoder {
    /// Digits in base 256, most significant first: the bytes of the segment, then the four of low.
    number: Vec<u8>,
    range: u64,
}

impl Encoder {
    pub(super) fn new() -> Self {
        Self { number: vec![0; 4], range: WHOLE }
    }

    /// A symbol, which the distribution then learns.
    pub(super) fn symbol(&mut self, distribution: &mut Distribution, s: usize) {
        let (begin, range) = part(self.range, distribution, s);
        self.narrow(begin, range);
        distribution.learn(s);
    }

    /// The `count` low bits of `bits`, highest first.
    pub(super) fn raw(&mut self, count: u32, bits: u64) {
        let mut left = count;
        for g in groups(count) {
            left -= g;
            let b = bits >> left & ((1 << g) - 1);
            let (begin, range) = raw_part(self.range, g, b);
            self.narrow(begin, range);
        }
    }

    /// A decision of a light codestream under a chance of true, in 1/65536.
    pub(super) fn light_decision(&mut self, chance: u64, is_true: bool) {
        let share = (self.range >> 16) * chance;
        let (begin, range) = if is_true { (0, share) } else { (share, self.range - share) };
        self.narrow(begin, range);
    }

    /// The `count` low bits of `bits` in a light codestream.
    pub(super) fn light_run(&mut self, count: u32, bits: u64) {
        let mut left = count;
        for g in groups(count) {
            left -= g;
            let unit = self.range >> g;
            self.narrow((bits >> left & ((1 << g) - 1)) * unit, unit);
        }
    }

    /// The bytes of the segment.
    pub(super) fn finish(mut self) -> Vec<u8> {
        let [.., a, b, c] = self.number[..] else { unreachable!("low has four digits") };
        let beyond = u64::from(a) << 16 | u64::from(b) << 8 | u64::from(c);
        if beyond != 0 {
            self.add(SHORTEST - beyond);
        }
        let digits = self.number.iter().rposition(|&digit| digit != 0).map_or(0, |last| last + 1);
        self.number.truncate(digits);
        self.number
    }

    fn narrow(&mut self, begin: u64, range: u64) {
        self.add(begin);
        self.range = range;
        while self.range < SHORTEST {
            self.number.push(0);
            self.range *= 256;
        }
    }

    /// Adds to the number, in units of its last digit.
    fn add(&mut self, amount: u64) {
        let mut carry = amount;
        let mut digits = self.number.iter_mut().rev();
        while carry != 0 {
            let digit = digits.next().expect("the number stays below 1");
            carry += u64::from(*digit);
            *digit = (carry % 256) as u8;
            carry /= 256;
        }
    }
}

/// A segment being read.
#[derive(Debug)]
pub(in crate::oracle) struct Decoder<'a> {
    segment: &'a [u8],
    /// Digits shifted out so far.
    shifted: usize,
    /// The number less low.
    code: u64,
    range: u64,
}

impl<'a> Decoder<'a> {
    pub(in crate::oracle) fn new(segment: &'a [u8]) -> Result<Self, Reject> {
        if segment.last() == Some(&0) || segment.starts_with(&[0xFF; 4]) {
            return Err(Reject::Segment);
        }
        let mut decoder = Self { segment, shifted: 0, code: 0, range: WHOLE };
        for place in 0..4 {
            decoder.code = decoder.code * 256 + decoder.digit(place);
        }
        Ok(decoder)
    }

    /// A symbol, which the distribution then learns.
    pub(super) fn symbol(&mut self, distribution: &mut Distribution) -> usize {
        let share = (self.code / (self.range >> 15)).min(32767);
        let s = (0..16).rfind(|&s| distribution.below(s) <= share).expect("nothing is below symbol 0");
        let (begin, range) = part(self.range, distribution, s);
        self.narrow(begin, range);
        distribution.learn(s);
        s
    }

    /// A decision under a chance of true, in 1/65536.
    pub(in crate::oracle) fn decision(&mut self, chance: u64) -> bool {
        let share = (self.range >> 16) * chance + (((self.range % 65536) * chance) >> 16);
        let is_true = self.code < share;
        let (begin, range) = if is_true { (0, share) } else { (share, self.range - share) };
        self.narrow(begin, range);
        is_true
    }

    /// A run of `count` raw bits.
    pub(in crate::oracle) fn raw(&mut self, count: u32) -> u64 {
        let mut bits = 0;
        for g in groups(count) {
            let b = (self.code / (self.range >> g)).min((1 << g) - 1);
            let (begin, range) = raw_part(self.range, g, b);
            self.narrow(begin, range);
            bits = bits << g | b;
        }
        bits
    }

    /// A decision of a light codestream under a chance of true, in 1/65536.
    pub(super) fn light_decision(&mut self, chance: u64) -> bool {
        let share = (self.range >> 16) * chance;
        let is_true = self.code < share;
        let (begin, range) = if is_true { (0, share) } else { (share, self.range - share) };
        self.narrow(begin, range);
        is_true
    }

    /// A run of `count` bits of a light codestream.
    pub(super) fn light_run(&mut self, count: u32) -> u64 {
        let mut bits = 0;
        for g in groups(count) {
            let unit = self.range >> g;
            let b = self.code / unit % (1 << g);
            self.narrow(b * unit, unit);
            bits = bits << g | b;
        }
        bits
    }

    /// Checks, after the last value, that the segment is no longer than its values need.
    pub(in crate::oracle) fn finish(self) -> Result<(), Reject> {
        if self.segment.len() > self.shifted + 1 { Err(Reject::Segment) } else { Ok(()) }
    }

    fn narrow(&mut self, begin: u64, range: u64) {
        self.code -= begin;
        self.range = range;
        while self.range < SHORTEST {
            self.code = (self.code * 256 + self.digit(self.shifted + 4)) % (1 << 32);
            self.shifted += 1;
            self.range *= 256;
        }
    }

    fn digit(&self, place: usize) -> u64 {
        self.segment.get(place).copied().map_or(0, u64::from)
    }
}
