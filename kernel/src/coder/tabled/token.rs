//! Ranks as tokens, of which tables hold the frequencies, and extra bits, which are taken as they come.
//!
//! The first ranks are tokens themselves; of each octave beyond there are two, one for each half.

/// Tokens there are: all ranks of spans of 19 bits have one.
pub(super) const TOKENS: usize = 42;

/// Ranks that are tokens.
pub(super) const DIRECT: u32 = 8;

/// The octave of the first rank that is not.
const FIRST_OCTAVE: u32 = 3;

/// The token of a rank, and how many of its low bits are extra.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) const fn of_rank(rank: u32) -> (u32, u32) {
    if rank < DIRECT {
        return (rank, 0);
    }
    let octave = 31_u32.wrapping_sub(rank.leading_zeros());
    let bits = octave.wrapping_sub(1);
    let half = (rank >> bits) & 1;
    (DIRECT.wrapping_add(octave.wrapping_sub(FIRST_OCTAVE) << 1).wrapping_add(half), bits)
}

/// The least rank of a token that is not the rank itself, and how many extra bits follow.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) const fn octave(token: u32) -> Option<(u32, u32)> {
    if token < DIRECT {
        return None;
    }
    let bits = (token.wrapping_sub(DIRECT) >> 1).wrapping_add(FIRST_OCTAVE - 1) & 31;
    Some(((2 | (token & 1)) << bits, bits))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_by_hand() {
        assert_eq!([of_rank(0), of_rank(7), of_rank(8), of_rank(11)], [(0, 0), (7, 0), (8, 2), (8, 2)]);
        assert_eq!([of_rank(12), of_rank(16), of_rank((1 << 20) - 1)], [(9, 2), (10, 3), (41, 18)]);
        assert_eq!([octave(7), octave(8), octave(9)], [None, Some((8, 2)), Some((12, 2))]);
        assert_eq!(octave(41), Some((3 << 18, 18)));
    }
}
