//! The halves of lines, and what a lifting step reads beyond their ends.

use core::num::Wrapping;

use crate::memory::copy;

type Sample = Wrapping<i32>;

/// The scaling coefficients c_i (`low`) and wavelet coefficients d_i (`high`) of lines of n >= 2 samples each.
///
/// `lanes` lines lie side by side: coefficient i of line k is at `i * lanes + k`. As many such groups lie end to
/// end as there is room for, a group taking ceil(n/2) + 2 rows of `lanes` in each half: in `low` its c and a margin,
/// in `high` one row of margin, its d, and more margin. Margins hold what a step reads beyond the ends of a line, so
/// that a step is the same everywhere: one loop over the whole half, margins and all.
#[derive(Debug)]
pub(crate) struct Halves<'a> {
    low: &'a mut [i32],
    high: &'a mut [i32],
    lanes: usize,
    n: usize,
}

/// Which coefficient stands beyond the ends of a line.
#[derive(Clone, Copy, Debug)]
pub(super) enum Beyond {
    /// The nearest one of its kind.
    Nearest,
    /// Zero.
    Zero,
}

impl<'a> Halves<'a> {
    /// Elements that a group of `lanes` lines of `n` samples takes.
    pub(crate) const fn group_len(lanes: usize, n: usize) -> usize {
        n.div_ceil(2).saturating_add(2).saturating_mul(lanes).saturating_mul(2)
    }

    /// As many groups as `scratch` has room for, at most `groups`; of any content.
    pub(crate) fn new(scratch: &'a mut [i32], lanes: usize, n: usize, groups: usize) -> Self {
        let room = scratch.len().checked_div(Self::group_len(lanes, n)).unwrap_or(0);
        let half = groups.min(room).wrapping_mul(Self::group_len(lanes, n) / 2);
        let (low, rest) = scratch.split_at_mut_checked(half).unwrap_or_default();
        Self { low, high: rest.get_mut(..half).unwrap_or_default(), lanes, n }
    }

    /// The c and the d of each group.
    pub(crate) fn groups(&mut self) -> impl Iterator<Item = (&mut [i32], &mut [i32])> {
        let (lows, highs) = (self.rows(self.n.div_ceil(2)), self.rows(self.n / 2));
        let (lanes, pitch) = (self.lanes, self.pitch());
        let groups = self.low.chunks_exact_mut(pitch).zip(self.high.chunks_exact_mut(pitch));
        groups.map(move |(low, high)| {
            let high = high.get_mut(lanes..).and_then(|high| high.get_mut(..highs));
            (low.get_mut(..lows).unwrap_or_default(), high.unwrap_or_default())
        })
    }

    /// The c and the d of one line.
    #[cfg(feature = "stream")]
    pub(crate) fn into_line(self) -> (&'a [i32], &'a [i32]) {
        let high = self.high.get(1..).and_then(|high| high.get(..self.n / 2));
        (self.low.get(..self.n.div_ceil(2)).unwrap_or_default(), high.unwrap_or_default())
    }

    /// c_i <- update(c_i, \[d_{i-1}, d_i, d_{i+1}\]).
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn each_low(&mut self, beyond: Beyond, update: impl Fn(Sample, [Sample; 3]) -> Sample) {
        self.set_margins_of_high(beyond);
        let here = self.high.get(self.lanes..).unwrap_or_default();
        let right = here.get(self.lanes..).unwrap_or_default();
        each(self.low, [self.high, here, right], update);
    }

    /// d_i <- update(d_i, \[c_i, c_{i+1}\]).
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn each_high(&mut self, update: impl Fn(Sample, [Sample; 2]) -> Sample) {
        self.set_margins_of_low();
        let next = self.low.get(self.lanes..).unwrap_or_default();
        let high = self.high.get_mut(self.lanes..).unwrap_or_default();
        each(high, [self.low, next, next], |d, [c, next, _]| update(d, [c, next]));
    }

    /// The last c once more after it.
    fn set_margins_of_low(&mut self) {
        let (lanes, pitch, last) = (self.lanes, self.pitch(), self.rows(self.n.div_ceil(2).wrapping_sub(1)));
        for group in self.low.chunks_exact_mut(pitch) {
            let ends = group.get_mut(last..).and_then(|last| last.split_at_mut_checked(lanes));
            let (last, after) = ends.unwrap_or_default();
            copy(last, after);
        }
    }

    /// What stands before the first d and after the last, twice.
    fn set_margins_of_high(&mut self, beyond: Beyond) {
        let (lanes, pitch, end) = (self.lanes, self.pitch(), self.rows(self.n / 2).wrapping_add(self.lanes));
        for group in self.high.chunks_exact_mut(pitch) {
            let (inner, after) = group.split_at_mut_checked(end).unwrap_or_default();
            let (before, inner) = inner.split_at_mut_checked(lanes).unwrap_or_default();
            match beyond {
                Beyond::Nearest => {
                    copy(inner, before);
                    let last = inner.get(inner.len().saturating_sub(lanes)..).unwrap_or_default();
                    copy(last, after);
                }
                Beyond::Zero => before.iter_mut().chain(after).for_each(|margin| *margin = 0),
            }
        }
    }

    const fn rows(&self, rows: usize) -> usize {
        rows.wrapping_mul(self.lanes)
    }

    /// Elements of a group in each half, which are not zero.
    fn pitch(&self) -> usize {
        (Self::group_len(self.lanes, self.n) / 2).max(1)
    }
}

/// Updates each value by the three beside it.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn each(
    values: &mut [i32],
    [a, b, c]: [&[i32]; 3],
    update: impl Fn(Sample, [Sample; 3]) -> Sample,
) {
    for (((value, &a), &b), &c) in values.iter_mut().zip(a).zip(b).zip(c) {
        *value = update(Wrapping(*value), [Wrapping(a), Wrapping(b), Wrapping(c)]).0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Records, as decimal digits, which neighbours each coefficient read: the c are 1, 2, … and the d 5, 6, ….
    fn digits<const K: usize>(samples: [Sample; K]) -> Sample {
        samples.into_iter().fold(Wrapping(0), |number, digit| number * Wrapping(10) + digit)
    }

    /// Two lines of n samples end to end, beside copies of themselves, after `run`; they come out alike.
    fn visit(n: usize, run: impl Fn(&mut Halves<'_>)) -> ([i32; 4], [i32; 4]) {
        let mut scratch = [-9; 80];
        let mut halves = Halves::new(&mut scratch, 2, n, 2);
        for (low, high) in halves.groups() {
            low.chunks_mut(2).zip(1..).for_each(|(c, digit)| c.fill(digit));
            high.chunks_mut(2).zip(5..).for_each(|(d, digit)| d.fill(digit));
        }
        run(&mut halves);
        let mut lines = [([0; 4], [0; 4]); 2];
        for ((lows, highs), (low, high)) in lines.iter_mut().zip(halves.groups()) {
            for (to, from) in [(lows, low), (highs, high)] {
                for (to, beside) in to.iter_mut().zip(from.chunks(2)) {
                    assert_eq!(beside[0], beside[1]);
                    *to = beside[0];
                }
            }
        }
        assert_eq!(lines[0], lines[1]);
        lines[0]
    }

    #[test]
    fn reflection() {
        let low = |n| visit(n, |halves| halves.each_low(Beyond::Nearest, |_, [a, b, _]| digits([a, b]))).0;
        assert_eq!(low(2), [55, 0, 0, 0]);
        assert_eq!(low(3), [55, 55, 0, 0]);
        assert_eq!(low(6), [55, 56, 67, 0]);
        assert_eq!(low(7), [55, 56, 67, 77]);
        let high = |n| visit(n, |halves| halves.each_high(|_, beside| digits(beside))).1;
        assert_eq!(high(2), [11, 0, 0, 0]);
        assert_eq!(high(3), [12, 0, 0, 0]);
        assert_eq!(high(6), [12, 23, 33, 0]);
        assert_eq!(high(7), [12, 23, 34, 0]);
    }

    #[test]
    fn zero_ends() {
        let low = |n| visit(n, |halves| halves.each_low(Beyond::Zero, |_, beside| digits(beside))).0;
        assert_eq!(low(2), [50, 0, 0, 0]);
        assert_eq!(low(3), [50, 500, 0, 0]);
        assert_eq!(low(4), [56, 560, 0, 0]);
        assert_eq!(low(5), [56, 560, 600, 0]);
        assert_eq!(low(6), [56, 567, 670, 0]);
        assert_eq!(low(7), [56, 567, 670, 700]);
    }

    #[test]
    fn groups_fill_the_scratch_and_no_more() {
        let mut scratch = [0; 23];
        let mut groups = |len, most| Halves::new(&mut scratch[..len], 1, 3, most).groups().count();
        assert_eq!(Halves::group_len(1, 3), 8);
        assert_eq!([groups(23, 9), groups(23, 1), groups(16, 9), groups(7, 1)], [2, 1, 2, 0]);
    }
}
