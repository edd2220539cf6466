//! Binary decisions for coders outside this crate: the kernel's arithmetic coder, its adaptive chances and their mixing.
//!
//! A format describes itself once, as a function over [`BitCoder`]: an encoder is given each decision and returns it, a
//! decoder ignores what it is given and returns what it reads. The memory of all is the caller's.

use super::mixing::{Counter, Mixer};
use super::{Coder, Decoder, Encoder};

/// An adaptive chance of a decision, in three bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chance(Counter);

impl Chance {
    /// One that has seen nothing, and expects both alike.
    pub const EVEN: Self = Self(Counter::NEW);

    /// One that expects true with a chance of `expected` / 65536, as if it had seen that `seen` times.
    #[must_use]
    pub const fn expecting(expected: u16, seen: u8) -> Self {
        Self(Counter::expecting(expected, seen))
    }
}

/// Weights that tell how much to trust each of `N` chances; learnt by gradient descent on the cost in bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mix<const N: usize>(Mixer<N>);

impl<const N: usize> Mix<N> {
    /// All chances trusted alike, each with `weight` / 65536.
    #[must_use]
    pub const fn new(weight: i32) -> Self {
        Self(Mixer::new(weight))
    }
}

/// One direction of the coder of decisions.
pub trait BitCoder {
    /// Codes a decision, true with a chance of `chance` / 65536, which is 1 to 65535.
    fn decide(&mut self, bit: bool, chance: u32) -> bool;

    /// Codes a decision under an adaptive chance, and adapts it.
    #[inline]
    fn bit(&mut self, bit: bool, chance: &mut Chance) -> bool {
        let bit = self.decide(bit, chance.0.chance().clamp(1, (1 << 16) - 1));
        chance.0.learn(bit);
        bit
    }

    /// Codes a decision under several adaptive chances together, and adapts them and their weights.
    #[inline]
    fn mixed<const N: usize>(&mut self, bit: bool, chances: [&mut Chance; N], mix: &mut Mix<N>) -> bool {
        let odds = core::array::from_fn(|i| chances.get(i).map_or(0, |chance| chance.0.odds()));
        let chance = mix.0.chance(&odds);
        let bit = self.decide(bit, chance);
        // Without this, weights would grow without end where decisions are always alike.
        if !Mixer::<N>::is_sure(chance, bit) {
            mix.0.learn(&odds, chance, bit);
            mix.0.bound();
        }
        for chance in chances {
            chance.0.learn(bit);
        }
        bit
    }
}

/// Writes decisions into lent bytes.
#[derive(Debug)]
pub struct BitEncoder<'a>(Encoder<'a>);

impl<'a> BitEncoder<'a> {
    /// Starts a codeword at the beginning of `out`.
    #[must_use]
    pub const fn new(out: &'a mut [u8]) -> Self {
        Self(Encoder::new(out))
    }

    /// Ends the codeword and returns its length; `None` if `out` was too short. Zero bytes at its end are left out.
    #[must_use]
    pub fn finish(self) -> Option<usize> {
        self.0.finish()
    }
}

impl BitCoder for BitEncoder<'_> {
    #[inline]
    fn decide(&mut self, bit: bool, chance: u32) -> bool {
        self.0.decide(bit, chance)
    }
}

/// Reads decisions from a codeword or from the beginning of one.
#[derive(Debug)]
pub struct BitDecoder<'a> {
    decoder: Decoder<'a>,
    cut: bool,
    ended: bool,
}

impl<'a> BitDecoder<'a> {
    /// Starts on a whole codeword.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { decoder: Decoder::lenient(bytes), cut: false, ended: false }
    }

    /// Starts on the beginning of a codeword whose other bytes are unknown.
    #[must_use]
    pub fn of_prefix(bytes: &'a [u8]) -> Self {
        Self { decoder: Decoder::lenient(bytes), cut: true, ended: false }
    }

    /// Whether a decision depended on bytes that are unknown; it and all later ones were answered with false.
    #[must_use]
    pub const fn is_ended(&self) -> bool {
        self.ended
    }
}

impl BitCoder for BitDecoder<'_> {
    #[inline]
    fn decide(&mut self, bit: bool, chance: u32) -> bool {
        if self.cut && (self.ended || !self.decoder.is_sure(chance)) {
            self.ended = true;
            return false;
        }
        self.decoder.decide(bit, chance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Decisions with a pattern, under a chance each and under two chances mixed.
    fn code<C: BitCoder>(coder: &mut C, given: &[bool], mut each: impl FnMut(&C, usize, bool)) {
        let (mut chances, mut mix) = ([Chance::EVEN; 3], Mix::new(1 << 15));
        for (place, &bit) in given.iter().enumerate() {
            let [first, second, third] = &mut chances;
            let bit = match place % 3 {
                0 => coder.bit(bit, first),
                1 => coder.mixed(bit, [second, third], &mut mix),
                _ => coder.decide(bit, 1 << 15),
            };
            each(coder, place, bit);
        }
    }

    fn given() -> [bool; 600] {
        core::array::from_fn(|place| place % 7 == 0 || place * place % 11 == 3)
    }

    #[test]
    fn decisions_are_restored() {
        let (given, mut bytes) = (given(), [0; 128]);
        let mut encoder = BitEncoder::new(&mut bytes);
        code(&mut encoder, &given, |_, _, _| ());
        let len = encoder.finish().unwrap();
        let mut decoder = BitDecoder::new(&bytes[..len]);
        code(&mut decoder, &given.map(|_| false), |_, place, bit| assert_eq!(bit, given[place]));
        let mut encoder = BitEncoder::new(&mut bytes[..10]);
        code(&mut encoder, &given, |_, _, _| ());
        assert_eq!(encoder.finish(), None);
    }

    /// A million decisions that are alike cost next to nothing, and 600 others after them fit the bytes.
    #[test]
    #[cfg_attr(miri, ignore = "many values through code without addresses")]
    fn weights_do_not_run_away() {
        let mut bytes = [0; 1000];
        let mut encoder = BitEncoder::new(&mut bytes);
        let (mut chances, mut mix) = ([Chance::EVEN; 4], Mix::new(1 << 14));
        let mut code = |bit| {
            let [first, second, third, fourth] = &mut chances;
            encoder.mixed(bit, [first, second, third, fourth], &mut mix);
        };
        (0..1_000_000).for_each(|_| code(false));
        (0..600).for_each(|place| code(place % 2 == 0));
        let len = encoder.finish().unwrap();
        assert!(len > 100, "{len}");
    }

    #[test]
    fn prefixes_are_right_until_they_end() {
        let (given, mut bytes) = (given(), [0; 128]);
        let mut encoder = BitEncoder::new(&mut bytes);
        code(&mut encoder, &given, |_, _, _| ());
        let len = encoder.finish().unwrap();
        let mut before = 0;
        for kept in (0..len).step_by(if cfg!(miri) { 40 } else { 1 }) {
            let mut right = 0;
            let mut decoder = BitDecoder::of_prefix(&bytes[..kept]);
            code(&mut decoder, &given.map(|_| false), |decoder, place, bit| {
                if !decoder.is_ended() {
                    assert_eq!(bit, given[place]);
                    right += 1;
                }
            });
            // Each byte tells something, and no more than a few decisions wait for the next byte.
            assert!(right >= before && right + 40 > given.len() * kept / len, "{kept} {right}");
            before = right;
        }
    }
}
