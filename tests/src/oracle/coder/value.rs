//! Numbers, weights and residuals as symbols and raw bits.

use super::arithmetic::{Decoder, Encoder};
use super::distribution::{Distribution, Models};

/// What is around a residual: all that chooses its distribution.
#[derive(Debug, Clone, Copy)]
pub(super) struct Context {
    /// The energy s.
    pub(super) energy: u64,
    /// The offset t of the prediction.
    pub(super) offset: i32,
}

/// A class of energies.
enum Class {
    Small { c: usize },
    Large { c: usize, k: u32 },
}

impl Context {
    fn class(self) -> Class {
        let s = self.energy;
        if s < 4 {
            return Class::Small { c: s as usize };
        }
        let o = s.ilog2();
        let h = s >> (o - 1) & 1;
        let c = 2 * o as usize + h as usize;
        if s < 32 { Class::Small { c } } else { Class::Large { c: (c - 10).min(49), k: o - 5 } }
    }

    /// The fraction f.
    const fn fraction(self) -> usize {
        match self.offset.unsigned_abs() {
            0..32 => 0,
            32..80 => 1,
            _ => 2,
        }
    }

    /// The residual, or the one that this stands for, negated if the offset is negative.
    const fn turned(self, residual: i32) -> i32 {
        if self.offset < 0 { residual.wrapping_neg() } else { residual }
    }
}

/// The rank of a value; the one left for -2^31 is 2^32 - 1.
pub(super) const fn rank(v: i32) -> u32 {
    let v = v as i64;
    if v > 0 || v == i32::MIN as i64 { (2 * v - 1) as u32 } else { (-2 * v) as u32 }
}

/// The value of a rank.
pub(super) const fn unrank(q: u32) -> i32 {
    let q = q as i64;
    (if q % 2 == 1 { (q + 1) / 2 } else { -(q / 2) }) as i32
}

fn encode_number(to: &mut Encoder, distribution: &mut Distribution, n: u64) {
    let e = n.ilog2();
    to.symbol(distribution, e.min(15) as usize);
    if e >= 15 {
        to.raw(5, u64::from(e - 15));
    }
    to.raw(e, n % (1 << e));
}

fn decode_number(from: &mut Decoder<'_>, distribution: &mut Distribution) -> u64 {
    let mut e = from.symbol(distribution) as u32;
    if e == 15 {
        e = (15 + from.raw(5) as u32).min(31);
    }
    (1 << e) | from.raw(e)
}

impl Models {
    pub(super) fn encode_weight(&mut self, to: &mut Encoder, weight: i32) {
        encode_number(to, &mut self.weight, u64::from(rank(weight)) + 1);
    }

    /// A weight, which may be any value.
    pub(super) fn decode_weight(&mut self, from: &mut Decoder<'_>) -> i32 {
        unrank((decode_number(from, &mut self.weight) - 1) as u32)
    }

    pub(super) fn encode(&mut self, to: &mut Encoder, context: Context, residual: i32) {
        match context.class() {
            Class::Small { c } => {
                let q = u64::from(rank(context.turned(residual)));
                to.symbol(&mut self.small[c][context.fraction()], q.min(15) as usize);
                if q >= 15 {
                    encode_number(to, &mut self.exponent[0], q - 14);
                }
            }
            Class::Large { c, .. } if residual == 0 => to.symbol(&mut self.large[c], 0),
            Class::Large { c, k } => {
                let m = u64::from(residual.unsigned_abs()) - 1;
                let j = m >> k;
                to.symbol(&mut self.large[c], (j + 1).min(15) as usize);
                if j + 1 >= 15 {
                    encode_number(to, &mut self.exponent[1], j - 13);
                }
                to.raw(k + 1, (m % (1 << k)) << 1 | u64::from(residual < 0));
            }
        }
    }

    pub(super) fn decode(&mut self, from: &mut Decoder<'_>, context: Context) -> i32 {
        match context.class() {
            Class::Small { c } => {
                let mut q = from.symbol(&mut self.small[c][context.fraction()]) as u64;
                if q == 15 {
                    q = decode_number(from, &mut self.exponent[0]) + 14;
                }
                context.turned(unrank(q as u32))
            }
            Class::Large { c, k } => {
                let mut j = match from.symbol(&mut self.large[c]) {
                    0 => return 0,
                    symbol => symbol as u64 - 1,
                };
                if j == 14 {
                    j = decode_number(from, &mut self.exponent[1]) + 13;
                }
                let low = from.raw(k + 1);
                let magnitude = (((j << k) | (low >> 1)) + 1) as i32;
                if low % 2 == 1 { magnitude.wrapping_neg() } else { magnitude }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_has_a_rank() {
        assert_eq!([0, 1, -1, 2, -2].map(rank), [0, 1, 2, 3, 4]);
        for value in [0, 1, -1, i32::MAX, -i32::MAX, i32::MIN] {
            assert_eq!(unrank(rank(value)), value);
        }
    }
}
