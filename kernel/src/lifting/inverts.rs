//! Every lifting step is undone, for every input.
//!
//! A step changes one half of a line, c or d, and reads the other; what it reads it does not change. So each value x
//! that it changes becomes x + f or f - x, where f depends on unchanged values alone, and is the same number when the
//! step is undone. Addition wraps at 2^32: x -> x + f is a bijection of the 2^32 values for every f, with x -> x - f as
//! its inverse, and x -> f - x is its own. Nothing is asked of f, neither that its products fit 32 bits nor that its
//! division is exact; and a transform is steps in turn, undone in reverse order.
//!
//! What could be wrong is thus only the code around that: a margin that a step reads and another writes, an end of a
//! line, a sign. All of that depends on the length of a line, not on the values; the values here are all of a window
//! around zero, where every residue of every divisor (27 is the largest) occurs, and the ends of `i32`, where sums and
//! products wrap.

extern crate std;

use std::vec;
use std::vec::Vec;

use super::{Halves, Wavelet};

/// Transforms lines of `n` samples side by side and back, and compares.
fn check(wavelet: Wavelet, n: usize, lines: &[i32]) {
    let lanes = lines.len() / n;
    let mut scratch = vec![0; Halves::group_len(lanes, n)];
    let mut halves = Halves::new(&mut scratch, lanes, n, 1);
    let (evens, odds) = lines.split_at(n.div_ceil(2) * lanes);
    let (low, high) = halves.groups().next().unwrap();
    low.copy_from_slice(evens);
    high.copy_from_slice(odds);
    wavelet.forward(&mut halves);
    wavelet.inverse(&mut halves);
    let (low, high) = halves.groups().next().unwrap();
    assert!(low == evens && high == odds, "{wavelet} on lines of {n}");
}

/// Every line of `n` of the values, all of those with the same first value side by side.
fn exhaust(n: usize, values: &[i32]) {
    let lanes = values.len().pow(u32::try_from(n).unwrap() - 1);
    for &first in values {
        let mut lines = vec![first; lanes];
        for position in 1..n {
            let every = values.len().pow(u32::try_from(position).unwrap() - 1);
            lines.extend((0..lanes).map(|lane| values[lane / every % values.len()]));
        }
        for wavelet in Wavelet::ALL {
            check(wavelet, n, &lines);
        }
    }
}

/// Beside the ends of the range, and beside what makes 9 c + 3 c' and the other products wrap.
fn extremes() -> impl Iterator<Item = i32> {
    [i32::MIN, i32::MIN / 3, i32::MIN / 9, i32::MAX / 12, i32::MAX / 4, i32::MAX - 1]
        .into_iter()
        .flat_map(|value| [value, value + 1])
}

#[test]
#[cfg_attr(miri, ignore = "many values through code without addresses")]
fn every_pair_of_bytes_and_of_extremes() {
    let values: Vec<i32> = (-128..128).chain(extremes()).collect();
    exhaust(2, &values);
}

/// In either place of a line of two, as every value beside it enters by its residue alone.
#[test]
#[cfg_attr(miri, ignore = "many values through code without addresses")]
fn every_sixteen_bits_beside_a_window_and_extremes() {
    let all: Vec<i32> = (-32_768..32_768).collect();
    let beside = (-27..=27).chain([-32_768, 32_767, 65_535]).chain(extremes());
    for value in beside {
        let same = vec![value; all.len()];
        for lines in [[&all[..], &same].concat(), [&same[..], &all].concat()] {
            for wavelet in Wavelet::ALL {
                check(wavelet, 2, &lines);
            }
        }
    }
}

/// Twice the largest divisor: every residue, with either sign.
#[test]
#[cfg_attr(miri, ignore = "many values through code without addresses")]
fn every_three_of_a_window_and_extremes() {
    let values: Vec<i32> = (-27..=27).chain(extremes()).collect();
    exhaust(3, &values);
}

/// Lines with an inner coefficient of either kind, and longer than the longest step reaches.
#[test]
#[cfg_attr(miri, ignore = "many values through code without addresses")]
fn longer_lines_of_few_values() {
    let values = [-14, -1, 0, 1, 5, 13, i32::MIN, i32::MAX];
    for n in 4..=6 {
        exhaust(n, &values);
    }
    exhaust(9, &[-1, 2, i32::MIN]);
}
