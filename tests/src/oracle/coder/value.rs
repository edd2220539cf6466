//! The adaptive probabilities, and a value as decisions under them.

use super::arithmetic::{Decoder, Encoder};

/// The chance of *false*, estimated twice.
#[derive(Debug, Clone, Copy)]
struct Probability {
    fast: u32,
    slow: u32,
    seen: u32,
}

impl Probability {
    const NEW: Self = Self { fast: 32768, slow: 32768, seen: 0 };

    const fn of_false(self) -> u32 {
        (self.fast + self.slow) >> 1
    }

    fn learn(&mut self, decision: bool) {
        let rate = (self.seen + 2).ilog2() + 1;
        let moved = |x: u32, k: u32| if decision { x - (x >> k) } else { x + ((65535 - x) >> k) };
        self.fast = moved(self.fast, rate.min(4));
        self.slow = moved(self.slow, rate);
        self.seen = (self.seen + 1).min(62);
    }

    fn encode(&mut self, to: &mut Encoder, decision: bool) {
        to.decide(self.of_false(), decision);
        self.learn(decision);
    }

    fn decode(&mut self, from: &mut Decoder<'_>) -> bool {
        let decision = from.decide(self.of_false());
        self.learn(decision);
        decision
    }
}

/// What is around a value: all that chooses the probabilities of its first decisions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Context {
    /// The class c, 0 to 31.
    pub(super) class: usize,
    /// The context of signs g, 0 to 26.
    pub(super) signs: usize,
}

/// All probabilities of a codestream.
#[derive(Debug)]
pub(super) struct Models {
    nonzero: [Probability; 32],
    negative: [Probability; 27],
    above: [[Probability; 20]; 32],
    mantissa: [[Probability; 3]; 20],
}

impl Models {
    pub(super) const fn new() -> Self {
        Self {
            nonzero: [Probability::NEW; 32],
            negative: [Probability::NEW; 27],
            above: [[Probability::NEW; 20]; 32],
            mantissa: [[Probability::NEW; 3]; 20],
        }
    }

    pub(super) fn encode(&mut self, to: &mut Encoder, context: Context, value: i32) {
        let Context { class, signs } = context;
        self.nonzero[class].encode(to, value != 0);
        if value == 0 {
            return;
        }
        self.negative[signs].encode(to, value < 0);
        let magnitude = value.unsigned_abs();
        let e = magnitude.ilog2();
        for k in 0..31.min(e + 1) {
            self.above[class][k.min(19) as usize].encode(to, e > k);
        }
        let mantissa = &mut self.mantissa[e.min(19) as usize];
        let bit = |place: u32| magnitude >> place & 1 == 1;
        if e >= 1 {
            mantissa[0].encode(to, bit(e - 1));
        }
        if e >= 2 {
            mantissa[if bit(e - 1) { 2 } else { 1 }].encode(to, bit(e - 2));
            to.raw(e - 2, u64::from(magnitude) % (1 << (e - 2)));
        }
    }

    pub(super) fn decode(&mut self, from: &mut Decoder<'_>, context: Context) -> i32 {
        let Context { class, signs } = context;
        if !self.nonzero[class].decode(from) {
            return 0;
        }
        let negative = self.negative[signs].decode(from);
        let mut e = 0;
        while e < 31 && self.above[class][e.min(19) as usize].decode(from) {
            e += 1;
        }
        let mantissa = &mut self.mantissa[e.min(19) as usize];
        let mut magnitude = 1;
        if e >= 1 {
            magnitude = magnitude << 1 | u64::from(mantissa[0].decode(from));
        }
        if e >= 2 {
            let second = &mut mantissa[if magnitude == 3 { 2 } else { 1 }];
            magnitude = magnitude << 1 | u64::from(second.decode(from));
            magnitude = magnitude << (e - 2) | from.raw(e - 2);
        }
        let value = magnitude as i64;
        (if negative { -value } else { value }) as i32
    }
}
