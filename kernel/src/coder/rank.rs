//! Residuals numbered from the smallest.

/// 0, 1, -1, 2, -2, … by number.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) const fn rank(residual: i32) -> i32 {
    let mirrored = residual.wrapping_neg();
    (mirrored << 1) ^ (mirrored >> 31)
}

/// The inverse of [`rank`].
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) const fn of_rank(rank: i32) -> i32 {
    let mirrored = (rank.cast_unsigned() >> 1).cast_signed() ^ (rank & 1).wrapping_neg();
    mirrored.wrapping_neg()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_by_hand() {
        for (residual, number) in [(0, 0), (1, 1), (-1, 2), (2, 3), (-2, 4), (1 << 19, (1 << 20) - 1)] {
            assert_eq!((rank(residual), of_rank(number)), (number, residual));
        }
    }
}
