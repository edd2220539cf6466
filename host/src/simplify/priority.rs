//! A priority queue of buckets.
//!
//! Source: Vis2000 §4.1: about 10^5 buckets over log 1/E in [-10, 10] to the base 10, first in, first out within a bucket.

use std::ops::Range;

use super::corners::NONE;

/// Buckets an octave of E; the logarithm is straight between powers of two, so that it is the same on every machine.
const STEPS: u32 = 1 << STEP_BITS;
const STEP_BITS: u32 = 11;
/// Powers of two between which errors are told apart: 10^-10 and 10^10 lie between them.
const OCTAVES: [i32; 2] = [-34, 34];
const BUCKETS: u32 = (OCTAVES[1] - OCTAVES[0]) as u32 * STEPS;

/// Items 0, 1, …, each at most once in the queue, smallest error first, and first in, first out where errors are alike.
///
/// Cost: four bytes an item and a megabyte; constant time each way, but for the walk over empty buckets.
#[derive(Clone, Debug)]
pub(super) struct BucketQueue {
    /// First and last item of each bucket.
    buckets: Vec<[u32; 2]>,
    /// The item behind each item: [`NONE`] for the last of a bucket, [`ABSENT`] where the item is in no bucket.
    behind: Vec<u32>,
    /// No bucket before this one has an item.
    lowest: u32,
    /// No bucket after this one has an item.
    highest: u32,
}

/// Mark of an item that is not in the queue.
const ABSENT: u32 = NONE - 1;

/// Rank of an error: larger errors have larger ranks, or the same one.
pub(super) fn rank(error: f64) -> u32 {
    // The exponent and the first bits of the mantissa.
    let bits = (error.max(f64::MIN_POSITIVE).to_bits() >> (52 - STEP_BITS)) as i64;
    let first = i64::from((1023 + OCTAVES[0]) << STEP_BITS);
    (bits - first).clamp(0, i64::from(BUCKETS) - 1) as u32
}

impl BucketQueue {
    /// An empty queue for items below `items`.
    pub(super) fn new(items: u32) -> Self {
        Self {
            buckets: vec![[NONE; 2]; BUCKETS as usize],
            behind: vec![ABSENT; items as usize],
            lowest: BUCKETS,
            highest: 0,
        }
    }

    /// Whether an item waits.
    pub(super) fn contains(&self, item: u32) -> bool {
        self.behind[item as usize] != ABSENT
    }

    /// Puts an item behind all of its rank; nothing happens where it waits already.
    pub(super) fn push(&mut self, item: u32, rank: u32) {
        if self.contains(item) {
            return;
        }
        self.behind[item as usize] = NONE;
        let [first, last] = &mut self.buckets[rank as usize];
        if *first == NONE {
            *first = item;
        } else {
            self.behind[*last as usize] = item;
        }
        *last = item;
        self.lowest = self.lowest.min(rank);
        self.highest = self.highest.max(rank);
    }

    /// Takes all items out, none of which is outside of `items`.
    pub(super) fn clear(&mut self, items: Range<u32>) {
        self.buckets[self.lowest.min(self.highest) as usize..=self.highest as usize].fill([NONE; 2]);
        self.behind[items.start as usize..items.end as usize].fill(ABSENT);
        (self.lowest, self.highest) = (BUCKETS, 0);
    }

    /// Takes the first item of the smallest rank, and tells the rank.
    pub(super) fn pop(&mut self) -> Option<(u32, u32)> {
        while self.lowest <= self.highest {
            let [first, _] = &mut self.buckets[self.lowest as usize];
            if *first != NONE {
                let item = *first;
                *first = std::mem::replace(&mut self.behind[item as usize], ABSENT);
                return Some((item, self.lowest));
            }
            self.lowest += 1;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_grow_with_errors() {
        let errors = [-1.0, 0.0, 1e-10, 1.0001e-10, 0.5, 0.9999, 1.0, 1.001, 3.0, 1e9, 1e10];
        let ranks = errors.map(rank);
        assert!(ranks.is_sorted());
        assert_eq!(ranks[0], ranks[1]);
        assert!(ranks[4] < ranks[5] && ranks[5] < ranks[6] && ranks[6] < ranks[7]);
        assert_eq!([rank(f64::INFINITY), rank(1e300)], [BUCKETS - 1; 2]);
        assert_eq!(rank(2.0) - rank(1.0), STEPS);
    }

    #[test]
    fn smallest_first_and_then_first_in_first_out() {
        let mut queue = BucketQueue::new(6);
        for (item, rank) in [(3, 7), (1, 5), (0, 7), (5, 5), (2, 9), (1, 1)] {
            queue.push(item, rank);
        }
        assert_eq!(queue.pop(), Some((1, 5)));
        queue.push(4, 2);
        assert!(!queue.contains(1) && queue.contains(4));
        queue.push(1, 7);
        let rest: Vec<_> = std::iter::from_fn(|| queue.pop()).collect();
        assert_eq!(rest, [(4, 2), (5, 5), (3, 7), (0, 7), (1, 7), (2, 9)]);
        queue.push(4, 6);
        queue.push(5, 3);
        queue.clear(4..6);
        queue.push(2, 4);
        assert_eq!([queue.pop(), queue.pop()], [Some((2, 4)), None]);
        queue.clear(0..6);
        assert_eq!(queue.pop(), None);
    }
}
