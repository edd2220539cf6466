//! Ranks of residuals, and their tokens.

use super::bits::BitReader;
use crate::oracle::coder::Reject;

/// How many there are.
pub(super) const TOKENS: usize = 42;

pub(super) const fn rank_of_value(v: i64) -> i64 {
    if v > 0 { 2 * v - 1 } else { -2 * v }
}

pub(super) const fn value_of_rank(rank: i64) -> i64 {
    if rank % 2 == 1 { (rank + 1) / 2 } else { -(rank / 2) }
}

/// A rank as it is coded.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub number: usize,
    pub extra_bits: u32,
    pub extra: i64,
}

impl Token {
    pub(super) fn of(rank: i64) -> Self {
        if rank < 8 {
            return Self { number: rank as usize, extra_bits: 0, extra: 0 };
        }
        let o = rank.ilog2();
        let h = rank >> (o - 1) & 1;
        let number = 8 + 2 * (o as usize - 3) + h as usize;
        assert!(number < TOKENS, "no token of rank {rank}");
        Self { number, extra_bits: o - 1, extra: rank % (1 << (o - 1)) }
    }

    /// The rank of a token and the extra bits that follow.
    pub(super) fn read(number: usize, extra: &mut BitReader<'_>) -> Result<i64, Reject> {
        if number < 8 {
            return Ok(number as i64);
        }
        let (o, h) = ((number - 8) / 2 + 3, (number - 8) % 2);
        Ok((1 << o) + ((h as i64) << (o - 1)) + extra.bits(o as u32 - 1)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_by_hand() {
        for (v, rank, number, extra_bits, extra) in
            [(0, 0, 0, 0, 0), (-3, 6, 6, 0, 0), (4, 7, 7, 0, 0), (-4, 8, 8, 2, 0), (-7, 14, 9, 2, 2)]
        {
            assert_eq!(rank_of_value(v), rank);
            assert_eq!(value_of_rank(rank), v);
            assert_eq!(Token::of(rank), Token { number, extra_bits, extra });
        }
        assert_eq!(Token::of((1 << 20) - 1), Token { number: 41, extra_bits: 18, extra: (1 << 18) - 1 });
    }
}
