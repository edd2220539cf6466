//! Numbers of few bits side by side in words.

use crate::extent::to_usize;
use crate::memory::copy;

/// Bits of a word.
const WORD: u32 = i32::BITS;

/// The same, as a length: so many numbers take as many words as each takes bits.
pub(crate) const ROUND: usize = 32;

/// Whether what can be quicker has code of its own.
pub(crate) const QUICK: bool = !cfg!(feature = "small");

/// Where numbers lie that take the same number of bits, 1 to 32, each beginning where the one before ends, from the
/// lowest bit of a word up.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Packed {
    /// The word that they begin with.
    start: usize,
    /// Numbers before the first of these.
    skipped: usize,
    bits: u32,
}

impl Packed {
    /// Numbers that begin with a word.
    pub(crate) const fn new(start: usize, bits: u32) -> Self {
        Self { start, skipped: 0, bits }
    }

    /// Numbers that take a word each.
    pub(crate) const fn words(start: usize) -> Self {
        Self::new(start, WORD)
    }

    /// Whether each number takes a word.
    pub(crate) const fn are_words(self) -> bool {
        self.bits == WORD
    }

    /// Words that `count` numbers of so many bits take.
    pub(crate) const fn len(count: usize, bits: u32) -> usize {
        let (bits, rest) = (to_usize(bits), count % ROUND);
        (count / ROUND).saturating_mul(bits).saturating_add(rest.wrapping_mul(bits).div_ceil(ROUND))
    }

    /// The numbers from the one in place `count` on.
    pub(crate) const fn skip(self, count: usize) -> Self {
        Self { skipped: self.skipped.wrapping_add(count), ..self }
    }

    /// The same, of memory that begins `words` later.
    pub(crate) const fn after(self, words: usize) -> Self {
        Self { start: self.start.wrapping_sub(words), ..self }
    }

    /// The number in a place; `None` if it is not all in memory.
    #[inline(always)]
    pub(crate) fn get(self, memory: &[i32], place: usize) -> Option<i32> {
        if QUICK && self.bits == WORD {
            return memory.get(self.word(place)).copied();
        }
        self.unpack(memory, place)
    }

    /// Puts a number in a place; `None` if it takes more bits, or if the place is not in memory.
    #[inline(always)]
    pub(crate) fn set(self, memory: &mut [i32], place: usize, number: i32) -> Option<()> {
        if QUICK && self.bits == WORD {
            *memory.get_mut(self.word(place))? = number;
            return Some(());
        }
        self.skip(place).store(memory, &[number])
    }

    /// The word of a number that takes one.
    const fn word(self, place: usize) -> usize {
        self.start.wrapping_add(self.skipped).wrapping_add(place)
    }

    #[cfg_attr(feature = "small", inline(never))]
    fn unpack(self, memory: &[i32], place: usize) -> Option<i32> {
        let (word, shift) = self.find(place);
        let left = WORD.wrapping_sub(self.bits);
        let mut bits = memory.get(word)?.cast_unsigned().wrapping_shr(shift);
        if shift > left {
            let high = memory.get(word.wrapping_add(1))?.cast_unsigned();
            bits |= high.wrapping_shl(WORD.wrapping_sub(shift));
        }
        Some(bits.wrapping_shl(left).cast_signed().wrapping_shr(left))
    }

    /// Fills `numbers` with those from the first on; where memory ends, with anything.
    #[cfg_attr(feature = "small", inline(never))]
    pub(crate) fn load(self, memory: &[i32], numbers: &mut [i32]) {
        if self.bits == WORD {
            copy(memory.get(self.word(0)..).unwrap_or_default(), numbers);
            return;
        }
        let (word, mut shift) = self.find(0);
        let mut words = memory.get(word..).unwrap_or_default().iter();
        let mut next = || words.next().map_or(0, |word| word.cast_unsigned());
        let (mut word, left) = (next(), WORD.wrapping_sub(self.bits));
        for number in numbers {
            let mut bits = word.wrapping_shr(shift);
            shift = shift.wrapping_add(self.bits);
            if shift >= WORD {
                (word, shift) = (next(), shift.wrapping_sub(WORD));
                bits |= word.wrapping_shl(self.bits.wrapping_sub(shift));
            }
            *number = bits.wrapping_shl(left).cast_signed().wrapping_shr(left);
        }
    }

    /// Puts all of `numbers` there; `None` as for [`Packed::set`], and nobody knows then what is there.
    #[cfg_attr(feature = "small", inline(never))]
    pub(crate) fn store(self, memory: &mut [i32], numbers: &[i32]) -> Option<()> {
        if self.bits == WORD {
            let places = memory.get_mut(self.word(0)..)?.get_mut(..numbers.len())?;
            copy(numbers, places);
            return Some(());
        }
        let ((mut word, mut shift), left) = (self.find(0), WORD.wrapping_sub(self.bits));
        let mut held = memory.get(word).map_or(0, |word| word.cast_unsigned() & low_bits(shift));
        for &number in numbers {
            if number.wrapping_shl(left).wrapping_shr(left) != number {
                return None;
            }
            let bits = number.cast_unsigned() & low_bits(self.bits);
            held |= bits.wrapping_shl(shift);
            shift = shift.wrapping_add(self.bits);
            if shift >= WORD {
                *memory.get_mut(word)? = held.cast_signed();
                (word, shift) = (word.wrapping_add(1), shift.wrapping_sub(WORD));
                held = bits.wrapping_shr(self.bits.wrapping_sub(shift));
            }
        }
        if shift > 0 {
            let last = memory.get_mut(word)?;
            *last = replace(*last, low_bits(shift), held);
        }
        Some(())
    }

    /// Puts the first `count` of these there too; `None` as for [`Packed::store`].
    pub(crate) fn copy_to(self, to: Self, count: usize, memory: &mut [i32]) -> Option<()> {
        (0..count).step_by(ROUND).try_for_each(|place| {
            let mut numbers = [0; ROUND];
            let numbers = numbers.get_mut(..count.wrapping_sub(place).min(ROUND))?;
            self.skip(place).load(memory, numbers);
            to.skip(place).store(memory, numbers)
        })
    }

    /// The word with the lowest bit of a number, and which of its bits that is.
    const fn find(self, place: usize) -> (usize, u32) {
        let place = self.skipped.wrapping_add(place);
        let bit = place.wrapping_mul(to_usize(self.bits));
        #[expect(clippy::as_conversions, reason = "below 32; what could fail would be code")]
        let shift = (bit % ROUND) as u32;
        (self.start.wrapping_add(bit / ROUND), shift)
    }
}

/// That many ones, fewer than a word has, from the lowest bit up.
const fn low_bits(count: u32) -> u32 {
    1_u32.wrapping_shl(count).wrapping_sub(1)
}

/// The word with the bits of `mask` taken from `bits`.
const fn replace(word: i32, mask: u32, bits: u32) -> i32 {
    (word.cast_unsigned() & !mask | bits & mask).cast_signed()
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: usize = 67;

    /// Every number of so many bits, or some of them.
    fn numbers(bits: u32) -> impl Iterator<Item = i32> {
        let largest = i32::MAX >> (32 - bits);
        (0_i32..).map(move |place| {
            let noise = place.wrapping_mul(0x9E37_79B1_u32.cast_signed()) >> (32 - bits);
            [noise, largest, -1, -largest - 1][usize::try_from(place % 4).unwrap()]
        })
    }

    #[test]
    fn numbers_come_back_and_their_neighbours_stay() {
        for bits in 1..=32 {
            let mut memory = [-1; COUNT + 2];
            let packed = Packed::new(1, bits);
            for (place, number) in numbers(bits).take(COUNT).enumerate() {
                packed.set(&mut memory, place, 0).unwrap();
                packed.set(&mut memory, place, number).unwrap();
            }
            for (place, number) in numbers(bits).take(COUNT).enumerate() {
                assert_eq!(packed.get(&memory, place), Some(number), "{bits} bits, {place}");
                let from = packed.skip(place / 2);
                assert_eq!(from.after(1).get(&memory[1..], place - place / 2), Some(number));
            }
            let (len, last) = (Packed::len(COUNT, bits), Packed::len(COUNT - 1, bits));
            let needed = |count: usize| (count * to_usize(bits)).div_ceil(32);
            assert_eq!([len, last], [needed(COUNT), needed(COUNT - 1)]);
            assert!(memory[0] == -1 && memory[len + 1..].iter().all(|&word| word == -1));
        }
    }

    #[test]
    fn rows_are_loaded_and_stored_as_number_by_number() {
        for (bits, first) in (1..=32).flat_map(|bits| [0, 1, 5, 31, 32].map(|first| (bits, first))) {
            let packed = Packed::new(1, bits).skip(first);
            for count in [0, 1, 2, 31, 32, 33, COUNT - first] {
                let (mut one_by_one, mut at_once) = ([0x5A5A_A5A5; COUNT + 2], [0x5A5A_A5A5; COUNT + 2]);
                let (mut row, mut back) = ([0; COUNT], [7; COUNT]);
                row.iter_mut().zip(numbers(bits)).for_each(|(number, value)| *number = value);
                for (place, &number) in row[..count].iter().enumerate() {
                    packed.set(&mut one_by_one, place, number).unwrap();
                }
                packed.store(&mut at_once, &row[..count]).unwrap();
                assert_eq!(at_once, one_by_one, "{count} of {bits} bits from {first} on");
                packed.load(&at_once, &mut back[..count]);
                assert_eq!(back[..count], row[..count], "{count} of {bits} bits from {first} on");
                assert!(back[count..].iter().all(|&number| number == 7));
            }
        }
    }

    #[test]
    fn nothing_is_stored_beyond_memory() {
        for bits in [7, 32] {
            let (mut memory, mut row) = ([-1; 7], [5; 64]);
            let packed = Packed::new(0, bits);
            let inside = 7 * 32 / to_usize(bits);
            packed.load(&memory, &mut row[..inside + 1]);
            assert!(row[..inside].iter().all(|&number| number == -1));
            assert_eq!(packed.store(&mut memory, &[0; 64]), None);
            assert_eq!(packed.skip(1).store(&mut memory, &row[..inside]), None);
            assert_eq!(Packed::new(9, bits).store(&mut memory, &[0]), None);
            assert_eq!(Packed::new(7, bits).store(&mut memory, &[]), Some(()));
        }
    }

    #[test]
    fn what_takes_more_bits_is_refused_and_changes_nothing() {
        for bits in 1..32 {
            let mut memory = [0x5555_5555; 3];
            let (packed, limit) = (Packed::new(0, bits), 1 << (bits - 1));
            for number in [limit, -limit - 1, i32::MAX, i32::MIN] {
                assert_eq!(packed.set(&mut memory, 1, number), None, "{number} in {bits} bits");
                assert_eq!(packed.skip(1).store(&mut memory, &[number]), None, "{number} in {bits} bits");
            }
            assert_eq!(memory, [0x5555_5555; 3]);
            assert_eq!(packed.set(&mut memory, 96, 0), None);
        }
    }

    #[test]
    fn rows_move_between_widths() {
        let mut memory = [0; 3 * COUNT];
        let (narrow, wide) = (Packed::new(0, 11), Packed::words(COUNT));
        let mut row = [0; COUNT];
        for (number, value) in row.iter_mut().zip(numbers(11)) {
            *number = value;
        }
        narrow.store(&mut memory, &row).unwrap();
        narrow.skip(3).copy_to(wide.skip(3), COUNT - 3, &mut memory).unwrap();
        wide.copy_to(Packed::new(2 * COUNT, 12), COUNT, &mut memory).unwrap();
        let mut back = [0; COUNT];
        Packed::new(2 * COUNT, 12).load(&memory, &mut back);
        assert!(back[..3] == [0; 3] && back[3..] == row[3..]);
        assert_eq!(wide.copy_to(Packed::new(0, 10), COUNT, &mut memory), None);
    }
}
