//! What a lifting step reads beyond the ends of a line.
//!
//! Steps of psi_1, psi_3, psi_5 and all but the last of psi_H, psi_Q, psi_D replace a missing neighbour by the nearest
//! one of its kind (which for the first three is whole-sample reflection); the last step of psi_H, psi_Q, psi_D
//! takes a missing wavelet coefficient as zero.

use core::num::Wrapping;

use super::Halves;

type Sample = Wrapping<i32>;

impl Halves<'_> {
    /// c_i <- update(c_i, d_{i-1}, d_i), with d_{-1} = d_0 and, for odd n, the last c reading d_{i-1} twice.
    #[inline(always)]
    pub(super) fn reflected_low(&mut self, update: impl Fn(Sample, Sample, Sample) -> Sample) {
        let lanes = self.lanes;
        let (first, rest) = self.low.split_at_mut(lanes.min(self.low.len()));
        for (c, &d) in first.iter_mut().zip(self.high.iter()) {
            *c = update(Wrapping(*c), Wrapping(d), Wrapping(d)).0;
        }
        let right = self.high.get(lanes..).unwrap_or(&[]);
        let (middle, last) = rest.split_at_mut(right.len().min(rest.len()));
        for ((c, &left), &right) in middle.iter_mut().zip(self.high.iter()).zip(right) {
            *c = update(Wrapping(*c), Wrapping(left), Wrapping(right)).0;
        }
        for (c, &d) in last.iter_mut().zip(self.high.get(right.len()..).unwrap_or(&[])) {
            *c = update(Wrapping(*c), Wrapping(d), Wrapping(d)).0;
        }
    }

    /// d_i <- update(d_i, c_i, c_{i+1}), with, for even n, the last d reading c_i twice.
    #[inline(always)]
    pub(super) fn reflected_high(&mut self, update: impl Fn(Sample, Sample, Sample) -> Sample) {
        let right = self.low.get(self.lanes..).unwrap_or(&[]);
        let (inner, last) = self.high.split_at_mut(right.len().min(self.high.len()));
        for ((d, &left), &right) in inner.iter_mut().zip(self.low.iter()).zip(right) {
            *d = update(Wrapping(*d), Wrapping(left), Wrapping(right)).0;
        }
        for (d, &c) in last.iter_mut().zip(self.low.get(right.len()..).unwrap_or(&[])) {
            *d = update(Wrapping(*d), Wrapping(c), Wrapping(c)).0;
        }
    }

    /// c_i <- update(c_i, d_{i-1}, d_i, d_{i+1}), with every missing d taken as zero.
    #[inline(always)]
    pub(super) fn zero_ended_low(&mut self, update: impl Fn(Sample, Sample, Sample, Sample) -> Sample) {
        const ZERO: Sample = Wrapping(0);
        let (lanes, highs) = (self.lanes, self.high.len());
        let here = self.high.get(lanes..).unwrap_or(&[]);
        let right = here.get(lanes..).unwrap_or(&[]);
        let (first, rest) = self.low.split_at_mut(lanes.min(self.low.len()));
        let (middle, rest) = rest.split_at_mut(right.len().min(rest.len()));
        let (last_pair, unpaired) = rest.split_at_mut(here.len().saturating_sub(right.len()).min(rest.len()));

        for (k, (c, &d)) in first.iter_mut().zip(self.high.iter()).enumerate() {
            let next = here.get(k).copied().unwrap_or(0);
            *c = update(Wrapping(*c), ZERO, Wrapping(d), Wrapping(next)).0;
        }
        for (((c, &left), &here), &right) in middle.iter_mut().zip(self.high.iter()).zip(here).zip(right) {
            *c = update(Wrapping(*c), Wrapping(left), Wrapping(here), Wrapping(right)).0;
        }
        let before_last = self.high.get(right.len()..).unwrap_or(&[]);
        let last = here.get(right.len()..).unwrap_or(&[]);
        for ((c, &left), &here) in last_pair.iter_mut().zip(before_last).zip(last) {
            *c = update(Wrapping(*c), Wrapping(left), Wrapping(here), ZERO).0;
        }
        let last = self.high.get(highs.saturating_sub(lanes)..).unwrap_or(&[]);
        for (c, &left) in unpaired.iter_mut().zip(last) {
            *c = update(Wrapping(*c), Wrapping(left), ZERO, ZERO).0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Records, as decimal digits, which neighbours each coefficient read.
    fn digits(samples: &[Sample]) -> Sample {
        samples.iter().fold(Wrapping(0), |number, &digit| number * Wrapping(10) + digit)
    }

    fn visit(lows: usize, highs: usize, run: impl Fn(&mut Halves<'_>)) -> ([i32; 4], [i32; 4]) {
        let (mut low, mut high) = ([1, 2, 3, 4], [5, 6, 7, 8]);
        run(&mut Halves::new(&mut low[..lows], &mut high[..highs], 1));
        (low, high)
    }

    #[test]
    fn reflection() {
        let low = |lows, highs| {
            visit(lows, highs, |halves| halves.reflected_low(|_, left, right| digits(&[left, right]))).0
        };
        assert_eq!(low(1, 1)[..1], [55]);
        assert_eq!(low(2, 1)[..2], [55, 55]);
        assert_eq!(low(3, 3)[..3], [55, 56, 67]);
        assert_eq!(low(4, 3)[..4], [55, 56, 67, 77]);
        let high = |lows, highs| {
            visit(lows, highs, |halves| halves.reflected_high(|_, left, right| digits(&[left, right]))).1
        };
        assert_eq!(high(1, 1)[..1], [11]);
        assert_eq!(high(2, 1)[..1], [12]);
        assert_eq!(high(3, 3)[..3], [12, 23, 33]);
        assert_eq!(high(4, 3)[..3], [12, 23, 34]);
    }

    #[test]
    fn zero_ends() {
        let low = |lows, highs| {
            visit(lows, highs, |halves| halves.zero_ended_low(|_, a, b, c| digits(&[a, b, c]))).0
        };
        assert_eq!(low(1, 1)[..1], [50]);
        assert_eq!(low(2, 1)[..2], [50, 500]);
        assert_eq!(low(2, 2)[..2], [56, 560]);
        assert_eq!(low(3, 2)[..3], [56, 560, 600]);
        assert_eq!(low(3, 3)[..3], [56, 567, 670]);
        assert_eq!(low(4, 3)[..4], [56, 567, 670, 700]);
    }
}
