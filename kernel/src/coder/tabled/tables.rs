//! The frequencies of tokens, by class.

use super::bits::{BitReader, BitWriter};
use super::class::CLASSES;
use super::token::TOKENS;

/// Frequencies of a class sum up to 2^12.
pub(super) const SUM_BITS: u32 = 12;

/// The sum of the frequencies of a class.
const SUM: u16 = 1 << SUM_BITS;

/// Classes and tokens, rounded up so that masks keep indices in bounds.
pub(super) const CLASS_SLOTS: usize = 16;
/// As [`CLASS_SLOTS`].
const TOKEN_SLOTS: usize = 64;

/// Points that share an entry of the finder.
const FINDER_BITS: u32 = 6;

/// Entries of the finder.
const FINDER: usize = 1 << (SUM_BITS - FINDER_BITS);

/// Bits of the number of tokens of a class.
const NUMBER_BITS: u32 = 6;

/// Bits of a count.
const COUNT_BITS: u32 = 19;

/// Low ones among them.
pub(super) const LOW_BITS: u32 = 15;

/// All of these set.
const LOW: u16 = (1 << LOW_BITS) - 1;

const _: () = assert!(COUNT_BITS + SUM_BITS < u32::BITS);

const _: () = assert!(CLASSES <= CLASS_SLOTS && TOKENS < TOKEN_SLOTS);

/// How tables stand in the codestream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Bits of a frequency from the leading one on; all below are zero.
    digits: u32,
}

impl Layout {
    /// With classes by the nearest ranks: frequencies as they are.
    pub(super) const NEAREST: Self = Self { digits: SUM_BITS + 1 };

    /// With classes by more: what rounding costs is less than the bits that it saves.
    pub(super) const ROUNDED: Self = Self { digits: 4 };

    /// Low bits of a frequency of so many bits that are zero.
    const fn zeros(self, size: u32) -> u32 {
        size.saturating_sub(self.digits)
    }

    /// A frequency of no more digits, as near as can be; halves are rounded up.
    const fn rounded(self, frequency: u16) -> u16 {
        let zeros = self.zeros(u16::BITS.wrapping_sub(frequency.leading_zeros()));
        let half = (1_u16 << zeros) >> 1;
        frequency.wrapping_add(half) >> zeros << zeros
    }
}

/// For each class where the shares of its tokens begin, from 0 to 4096.
///
/// While tokens are counted, entry t holds the count of token t: the low 15 bits, and those above in the finder.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Tables {
    starts: [[u16; TOKEN_SLOTS]; CLASS_SLOTS],
    /// The token that the first of each 64 points belongs to.
    finder: [[u8; FINDER]; CLASS_SLOTS],
}

/// The part of the points that is a token's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    pub(super) start: u32,
    pub(super) frequency: u32,
}

impl Tables {
    #[cfg(any(feature = "tabled", test))]
    #[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
    pub(crate) const NEW: Self =
        Self { starts: [[0; TOKEN_SLOTS]; CLASS_SLOTS], finder: [[0; FINDER]; CLASS_SLOTS] };

    /// Counts a token of a class a number of times.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn count(&mut self, class: i32, token: u32, times: u16) {
        let Some(counts) = self.starts.get_mut(slot(class)) else { return };
        let Some(count) = counts.get_mut(low(token) & (TOKEN_SLOTS - 1)) else { return };
        *count = count.wrapping_add(times);
    }

    /// Brings the low bits of counts, all below 2^16, to below 2^15. With a count of 2^19, all of its class count half.
    pub(super) fn carry(&mut self) {
        for (lows, highs) in self.starts.iter_mut().zip(&mut self.finder) {
            let mut largest = 0;
            for (low, high) in lows.iter_mut().zip(&mut *highs) {
                *high = high.wrapping_add(u8::from(*low >= 1 << LOW_BITS));
                *low &= LOW;
                largest = largest.max(*high);
            }
            if largest >> (COUNT_BITS - LOW_BITS) > 0 {
                for (low, high) in lows.iter_mut().zip(highs) {
                    *low = low.wrapping_add(u16::from(*high & 1) << LOW_BITS).div_ceil(2);
                    *high >>= 1;
                }
            }
        }
    }

    /// Makes frequencies of counts: each token that was counted has one.
    pub(super) fn normalise(&mut self, layout: Layout) {
        for (counts, highs) in self.starts.iter_mut().zip(&self.finder).take(CLASSES) {
            let total = |(&low, &high): (&u16, &u8)| (u32::from(high) << LOW_BITS).wrapping_add(low.into());
            let sum = counts.iter().zip(highs).map(total).fold(0, u32::wrapping_add);
            for (count, high) in counts.iter_mut().zip(highs) {
                let total = total((count, high));
                let share = (total << SUM_BITS).wrapping_add(sum >> 1).checked_div(sum).unwrap_or(0);
                *count = u16::try_from(share).unwrap_or(SUM).max(u16::from(total > 0));
            }
            if layout == Layout::NEAREST {
                balance(counts);
            }
            counts.iter_mut().for_each(|frequency| *frequency = layout.rounded(*frequency));
        }
    }

    /// Writes the frequencies.
    pub(super) fn write(&self, layout: Layout, bits: &mut BitWriter<'_>) -> Option<()> {
        for frequencies in self.starts.iter().take(CLASSES) {
            let last = frequencies.iter().rposition(|&frequency| frequency > 0);
            let used = last.map_or(0, |last| last.wrapping_add(1));
            bits.put(u32::try_from(used).ok()?, NUMBER_BITS)?;
            let mut before = SUM_BITS;
            for &frequency in frequencies.iter().take(used) {
                let size = u16::BITS.wrapping_sub(frequency.leading_zeros());
                write_step(bits, size.cast_signed().wrapping_sub(before.cast_signed()))?;
                let zeros = layout.zeros(size);
                bits.put(u32::from(frequency) >> zeros, size.saturating_sub(1).saturating_sub(zeros))?;
                before = size;
            }
        }
        Some(())
    }

    /// Makes starts of shares of the frequencies.
    pub(super) fn share_out(&mut self) {
        for frequencies in self.starts.iter_mut().take(CLASSES) {
            balance(frequencies);
            accumulate(frequencies);
        }
    }

    /// Reads what [`Tables::write`] wrote; `None` if frequencies do not sum up, as rounded ones need not. In a class without tokens the first has
    /// all, so that damage which asks for one changes no state.
    pub(super) fn read(&mut self, layout: Layout, bits: &mut BitReader<'_>) -> Option<()> {
        for (starts, finder) in self.starts.iter_mut().zip(&mut self.finder).take(CLASSES) {
            let used = low(bits.take(NUMBER_BITS));
            if used > TOKENS {
                return None;
            }
            let mut before = SUM_BITS;
            let mut sum = 0_u16;
            for frequency in starts.iter_mut().take(used) {
                let size = u32::try_from(before.cast_signed().wrapping_add(read_step(bits)?)).ok()?;
                if size > SUM_BITS.wrapping_add(1) {
                    return None;
                }
                before = size;
                let zeros = layout.zeros(size);
                let below = bits.take(size.saturating_sub(1).saturating_sub(zeros)) << zeros;
                let leading = if size == 0 { 0 } else { 1_u32 << size.wrapping_sub(1) };
                *frequency = u16::try_from(below | leading).ok()?;
                sum = sum.checked_add(*frequency)?;
            }
            if used == 0 {
                let [first, ..] = starts;
                *first = SUM;
            } else if layout == Layout::NEAREST && sum != SUM || starts.get(used.wrapping_sub(1)) == Some(&0)
            {
                return None;
            }
            balance(starts);
            accumulate(starts);
            fill_finder(starts, finder);
        }
        Some(())
    }

    /// The share of a token.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn share(&self, class: i32, token: u32) -> Share {
        share(self.starts.get(slot(class)), low(token) & (TOKEN_SLOTS - 1))
    }

    /// The token whose share has `point`, below 4096.
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn find(&self, class: i32, point: u32) -> (u32, Share) {
        let class = slot(class);
        let finder =
            self.finder.get(class).and_then(|finder| finder.get(low(point >> FINDER_BITS) & (FINDER - 1)));
        let first = finder.copied().map_or(0, usize::from) & (TOKEN_SLOTS - 1);
        let starts = self.starts.get(class);
        let is_beyond = |token: usize| point >= start_of(starts, token.wrapping_add(1));
        // Mostly the first or the next: which of them costs no jump, but code.
        let mut token = first.wrapping_add(usize::from(!cfg!(feature = "small") && is_beyond(first)));
        if is_beyond(token) {
            token = (token..TOKENS).find(|&token| !is_beyond(token)).unwrap_or(TOKENS);
        }
        (u32::try_from(token).unwrap_or(0), share(starts, token))
    }
}

#[cfg_attr(not(feature = "small"), inline(always))]
fn share(starts: Option<&[u16; TOKEN_SLOTS]>, token: usize) -> Share {
    let (start, end) = (start_of(starts, token), start_of(starts, token.wrapping_add(1)));
    Share { start, frequency: end.wrapping_sub(start) }
}

/// Where the share of a token starts.
#[cfg_attr(not(feature = "small"), inline(always))]
fn start_of(starts: Option<&[u16; TOKEN_SLOTS]>, token: usize) -> u32 {
    starts.and_then(|starts| starts.get(token & (TOKEN_SLOTS - 1))).copied().map_or(0, u32::from)
}

#[cfg_attr(not(feature = "small"), inline(always))]
fn slot(class: i32) -> usize {
    low(class.cast_unsigned()) & (CLASS_SLOTS - 1)
}

#[cfg_attr(not(feature = "small"), inline(always))]
const fn low(number: u32) -> usize {
    crate::extent::to_usize(number)
}

/// Makes shares sum up to 2^12, at the cost of the largest: of more than that, it is never a single point.
fn balance(shares: &mut [u16]) {
    let mut sum = shares.iter().fold(0_u16, |sum, &share| sum.wrapping_add(share));
    while sum != SUM && sum > 0 {
        let Some(largest) = shares.iter_mut().max_by_key(|share| **share) else { return };
        // More than its half is never taken, so that no token loses its share.
        let change = if sum > SUM {
            sum.wrapping_sub(SUM).min(*largest >> 1).wrapping_neg()
        } else {
            SUM.wrapping_sub(sum)
        };
        *largest = largest.wrapping_add(change);
        sum = sum.wrapping_add(change);
    }
}

/// Makes starts of frequencies.
fn accumulate(frequencies: &mut [u16]) {
    let mut start = 0_u16;
    for slot in frequencies {
        let frequency = *slot;
        *slot = start;
        start = start.wrapping_add(frequency);
    }
}

fn fill_finder(starts: &[u16; TOKEN_SLOTS], finder: &mut [u8; FINDER]) {
    let mut token = 0_u8;
    for (entry, point) in finder.iter_mut().zip((0..SUM).step_by(1 << FINDER_BITS)) {
        let next = |token: u8| starts.get(usize::from(token).wrapping_add(1)).copied();
        while usize::from(token) < TOKENS && next(token).is_some_and(|start| start <= point) {
            token = token.wrapping_add(1);
        }
        *entry = token;
    }
}

/// Writes a small change of size: as many ones as its rank, and a zero.
fn write_step(bits: &mut BitWriter<'_>, step: i32) -> Option<()> {
    (0..crate::coder::rank::rank(step)).try_for_each(|_| bits.put(1, 1))?;
    bits.put(0, 1)
}

fn read_step(bits: &mut BitReader<'_>) -> Option<i32> {
    let mut rank = 0;
    while bits.take(1) == 1 {
        rank = i32::wrapping_add(rank, 1);
        if rank > MOST_RANK {
            return None;
        }
    }
    Some(crate::coder::rank::of_rank(rank))
}

/// The rank of the largest change of size, from 13 bits to none.
const MOST_RANK: i32 = 26;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_are_in_proportion_and_come_back() {
        let mut tables = Tables::NEW;
        for _ in 0..3 {
            tables.count(2, 0, 1);
        }
        tables.count(2, 5, 1);
        tables.normalise(Layout::NEAREST);
        let mut out = [0; 64];
        let mut bits = BitWriter::new(&mut out);
        tables.write(Layout::NEAREST, &mut bits).unwrap();
        // 14 counts; of sizes 12, 0, 0, 0, 0, 11 the steps 0, -12, 0, 0, 0, 11; 11 + 10 bits below leading ones.
        let len = (14 * 6 + 1 + 25 + 3 + 22 + 11 + 10_usize).div_ceil(8);
        assert_eq!(bits.finish(), Some(len));
        let mut read = Tables::NEW;
        read.read(Layout::NEAREST, &mut BitReader::new(&out)).unwrap();
        let find = |class, point| {
            let (token, Share { start, frequency }) = read.find(class, point);
            (token, start, frequency)
        };
        assert_eq!([find(2, 0), find(2, 3071)], [(0, 0, 3072); 2]);
        assert_eq!([find(2, 3072), find(2, 4095)], [(5, 3072, 1024); 2]);
        assert_eq!([find(7, 0), find(7, 4095)], [(0, 0, 4096); 2], "a class without tokens");
    }

    #[test]
    fn frequencies_are_rounded_to_four_digits() {
        let round = |frequency| Layout::ROUNDED.rounded(frequency);
        assert_eq!([1, 15, 16, 17, 18, 31, 2303, 4000].map(round), [1, 15, 16, 18, 18, 32, 2304, 4096]);
        assert_eq!(Layout::NEAREST.rounded(4095), 4095);
        let mut tables = Tables::NEW;
        for (token, count) in [(0, 700), (1, 300), (2, 17)] {
            tables.count(3, token, count);
        }
        tables.normalise(Layout::ROUNDED);
        let mut out = [0; 64];
        let mut bits = BitWriter::new(&mut out);
        tables.write(Layout::ROUNDED, &mut bits).unwrap();
        // 14 counts; of sizes 12, 11, 7 the steps 0, -1, -4; three bits each below leading ones.
        assert_eq!(bits.finish(), Some((14 * 6 + 1 + 3 + 9 + 9_usize).div_ceil(8)));
        tables.share_out();
        let mut read = Tables::NEW;
        read.read(Layout::ROUNDED, &mut BitReader::new(&out)).unwrap();
        // 2819, 1208 and 68 of 4096 become 2816, 1152 and 72; the largest gets what is missing.
        let frequencies = [0, 1, 2].map(|token| read.share(3, token).frequency);
        assert_eq!(frequencies, [2872, 1152, 72]);
        assert_eq!(frequencies, [0, 1, 2].map(|token| tables.share(3, token).frequency));
    }

    #[test]
    fn every_counted_token_has_a_share() {
        let mut shares = [4000, 1, 0, 90, 40];
        balance(&mut shares);
        assert_eq!(shares, [3965, 1, 0, 90, 40]);
        let mut shares = [0; 3];
        balance(&mut shares);
        assert_eq!(shares, [0; 3]);
    }

    #[test]
    fn a_wrong_sum_is_refused() {
        // One token of size 12, which is no change: 2048 of 4096.
        let [low, high] = 1_u16.to_le_bytes();
        let read = |layout| { Tables::NEW }.read(layout, &mut BitReader::new(&[low, high, 0, 0]));
        assert_eq!(read(Layout::NEAREST), None);
        // Of rounded ones it is made right.
        assert_eq!(read(Layout::ROUNDED), Some(()));
    }
}
