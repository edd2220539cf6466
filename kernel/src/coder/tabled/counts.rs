//! How often tokens come, by class.

use super::tables::{CLASS_SLOTS, LOW_BITS, Tables};
use super::token::DIRECT;
use crate::extent::to_usize as index;

/// Samples after which counts carry.
pub(super) const PIECE: usize = 1 << 13;

/// Counts of the first tokens, which nearly all are.
type First = [[u16; index(DIRECT)]; CLASS_SLOTS];

/// Counts that take turns, so that no sample waits for the count of the one before; small builds count in the tables.
const LANES: usize = if cfg!(feature = "small") { 0 } else { 4 };

/// None overflows before it carries.
const _: () = assert!((1 << LOW_BITS) + 2 * PIECE <= 1 << u16::BITS);

/// Counts on their way to tables.
pub(super) struct Counts<'a> {
    tables: &'a mut Tables,
    lanes: [First; LANES],
    /// Samples since counts carried.
    since: usize,
}

impl<'a> Counts<'a> {
    pub(super) const fn new(tables: &'a mut Tables) -> Self {
        Self { tables, lanes: [[[0; _]; _]; _], since: 0 }
    }

    /// Counts a token of a class, in some column.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn count(&mut self, column: usize, class: i32, token: u32) {
        let first = self.lanes.get_mut(column & LANES.wrapping_sub(1));
        let of_class =
            first.and_then(|first| first.get_mut(index(class.cast_unsigned()) & (CLASS_SLOTS - 1)));
        match of_class.and_then(|counts| counts.get_mut(index(token))) {
            Some(count) => *count = count.wrapping_add(1),
            None => self.tables.count(class, token, 1),
        }
    }

    /// Lets counts carry if many samples were counted since; to be called after [`PIECE`] samples at most.
    pub(super) fn carry(&mut self, counted: usize) {
        self.since = self.since.wrapping_add(counted);
        if self.since >= PIECE {
            self.since = 0;
            self.gather();
        }
    }

    /// Hands all counts to the tables.
    pub(super) fn finish(mut self) -> &'a mut Tables {
        self.gather();
        self.tables
    }

    fn gather(&mut self) {
        for (class, counts) in self.lanes.iter_mut().flat_map(|first| (0..).zip(first)) {
            for (token, count) in (0..).zip(counts) {
                self.tables.count(class, token, core::mem::take(count));
            }
        }
        self.tables.carry();
    }
}

#[cfg(test)]
mod tests {
    use super::super::tables::Layout;
    use super::*;

    /// Shares of tokens 0, 3 and 12 that come so often, in turn.
    fn shares(times: [usize; 3]) -> [u32; 3] {
        let mut tables = Tables::NEW;
        let mut counts = Counts::new(&mut tables);
        let most = times.into_iter().max().unwrap();
        for number in 0..most {
            for (column, (token, times)) in [0, 3, 12].into_iter().zip(times).enumerate() {
                if number < times {
                    counts.count(number + column, 5, token);
                }
            }
            counts.carry(3);
        }
        counts.finish().normalise(Layout::NEAREST);
        tables.share_out();
        [0, 3, 12].map(|token| tables.share(5, token).frequency)
    }

    #[test]
    fn many_are_counted_as_well_as_few() {
        assert_eq!(shares([10, 5, 1]), [2560, 1280, 256]);
        assert_eq!(shares([100_000, 50_000, 10_000]), [2560, 1280, 256]);
        assert_eq!(shares([1 << 19, 1 << 18, 0]), [2731, 1365, 0]);
        // Halved once, so that what came after counts twice.
        assert_eq!(shares([3 << 18, 0, 0]), [4096, 0, 0]);
        let [first, second, _] = shares([3 << 18, 1 << 18, 0]);
        assert!((3180..3280).contains(&first) && first + second == 4096, "{first} {second}");
    }
}
