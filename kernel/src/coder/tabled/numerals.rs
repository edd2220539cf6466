//! Asymmetric numeral systems: tokens as digits of four numbers that take turns, in bases that fit their frequencies.
//!
//! The last token written is the first read.

use super::tables::{SUM_BITS, Share, Tables};
use super::{class, token};
use crate::extent::to_usize;
use crate::memory::{copy, move_within};

/// Numbers that take turns along a row.
const STATES: usize = 4;

/// Where a number starts, and the least that it is between tokens; the most is below 2^32.
const LEAST: u32 = 1 << 16;

/// Bytes that are written or read at once.
const WORD: usize = 2;

/// Bytes of the numbers.
const STATE_BYTES: usize = 4 * STATES;

/// Writes tokens from the last to the first, from the end of lent bytes towards their beginning.
#[derive(Debug)]
pub(super) struct NumeralWriter<'a> {
    states: [u32; STATES],
    out: &'a mut [u8],
    start: usize,
}

impl<'a> NumeralWriter<'a> {
    pub(super) fn new(out: &'a mut [u8]) -> Self {
        let start = out.len();
        Self { states: [LEAST; STATES], out, start }
    }

    /// Writes the tokens of a row of ranks, whose classes stand above them; `None` if they do not fit.
    pub(super) fn write_row(&mut self, tables: &Tables, values: &[i32]) -> Option<()> {
        if cfg!(feature = "small") {
            for (x, &value) in values.iter().enumerate().rev() {
                let state = self.states.get_mut(x & (STATES - 1))?;
                self.start = write_token(self.out, self.start, share_of(tables, value), state);
            }
            return (self.start <= self.out.len()).then_some(());
        }
        let (mut states, mut start) = (self.states, self.start);
        let out = &mut *self.out;
        let (whole, last) = values.as_chunks::<STATES>();
        for (state, &value) in states.iter_mut().zip(last).rev() {
            start = write_token(out, start, share_of(tables, value), state);
        }
        for values in whole.iter().rev() {
            for (state, &value) in states.iter_mut().zip(values).rev() {
                start = write_token(out, start, share_of(tables, value), state);
            }
        }
        (self.states, self.start) = (states, start);
        (start <= self.out.len()).then_some(())
    }

    /// Moves all to the beginning, the numbers first; returns how many bytes there are.
    pub(super) fn finish(self) -> Option<usize> {
        let words = self.start..self.out.len();
        let len = words.len().wrapping_add(STATE_BYTES);
        if self.start < STATE_BYTES {
            return None;
        }
        move_within(self.out, words, STATE_BYTES);
        for (bytes, state) in self.out.chunks_exact_mut(4).zip(self.states) {
            copy(&state.to_le_bytes(), bytes);
        }
        Some(len)
    }
}

/// The share of the token of a rank, whose class stands above it.
#[inline(always)]
fn share_of(tables: &Tables, value: i32) -> Share {
    tables.share(value >> class::PLACE, token::of_rank((value & class::RANKS).cast_unsigned()).0)
}

/// Writes a token by its share before `start`; returns where the words begin then, which is beyond the end of `out`
/// where there was no room.
///
/// The word is stored whether it is due or not, as no processor foresees which.
#[cfg_attr(not(feature = "small"), inline(always))]
fn write_token(out: &mut [u8], start: usize, share: Share, state: &mut u32) -> usize {
    let due = u32::from(*state >> (u32::BITS - SUM_BITS) >= share.frequency);
    let [low, high, ..] = state.to_le_bytes();
    if (due == 1 || !cfg!(feature = "small"))
        && let Some(word) = out.get_mut(start.wrapping_sub(WORD)..).and_then(<[u8]>::first_chunk_mut)
    {
        *word = [low, high];
    }
    let carried = *state >> (due << 4);
    let quotient = carried.checked_div(share.frequency).unwrap_or(0);
    let digit = carried.wrapping_sub(quotient.wrapping_mul(share.frequency)).wrapping_add(share.start);
    *state = (quotient << SUM_BITS).wrapping_add(digit);
    start.wrapping_sub(to_usize(due) << 1)
}

/// Reads tokens.
#[derive(Debug)]
pub(super) struct NumeralReader<'a> {
    states: [u32; STATES],
    words: &'a [u8],
    read: usize,
}

impl<'a> NumeralReader<'a> {
    /// `None` if there are not even the numbers, or one is too small.
    pub(super) fn new(bytes: &'a [u8]) -> Option<Self> {
        let (start, words) = bytes.split_at_checked(STATE_BYTES)?;
        let mut states = [0; STATES];
        for (state, bytes) in states.iter_mut().zip(start.as_chunks::<4>().0) {
            *state = u32::from_le_bytes(*bytes);
        }
        states.iter().all(|&state| state >= LEAST).then_some(Self { states, words, read: 0 })
    }

    /// Reads the tokens of a row; beyond the end there are zeros.
    pub(super) fn read_row(&mut self, tables: &Tables, classes: &[i32], tokens: &mut [i32]) {
        if cfg!(feature = "small") {
            for (x, (&class, token)) in classes.iter().zip(tokens).enumerate() {
                let Some(state) = self.states.get_mut(x & (STATES - 1)) else { return };
                let mut ahead = Ahead::at(self.words, self.read);
                *token = read_token(&mut ahead, tables, class, state);
                self.read = ahead.read;
            }
            return;
        }
        let Self { words, mut states, mut read } = *self;
        let (whole_classes, last_classes) = classes.as_chunks::<STATES>();
        let (whole_tokens, last_tokens) = tokens.as_chunks_mut::<STATES>();
        for (classes, tokens) in whole_classes.iter().zip(whole_tokens) {
            let mut ahead = Ahead::at(words, read);
            for (state, (&class, token)) in states.iter_mut().zip(classes.iter().zip(tokens)) {
                *token = read_token(&mut ahead, tables, class, state);
            }
            read = ahead.read;
        }
        let mut ahead = Ahead::at(words, read);
        for (state, (&class, token)) in states.iter_mut().zip(last_classes.iter().zip(last_tokens)) {
            *token = read_token(&mut ahead, tables, class, state);
        }
        (self.states, self.read) = (states, ahead.read);
    }

    /// Whether all words are read, and no more, and the numbers are back at their start.
    pub(super) fn is_finished(&self) -> bool {
        self.read == self.words.len() && self.states == [LEAST; STATES]
    }
}

/// As many words as the states may take in turn, or in small builds one; beyond the end there are zeros.
struct Ahead {
    words: u64,
    read: usize,
}

impl Ahead {
    #[inline(always)]
    fn at(words: &[u8], read: usize) -> Self {
        let rest = words.get(read..).unwrap_or(&[]);
        if cfg!(feature = "small") {
            let word = rest.first_chunk().copied().unwrap_or_default();
            return Self { words: u16::from_le_bytes(word).into(), read };
        }
        let next = rest.first_chunk().copied().unwrap_or_else(|| {
            let mut next = [0; WORD * STATES];
            copy(rest, &mut next);
            next
        });
        Self { words: u64::from_le_bytes(next), read }
    }

    /// `left` if it is large enough, or else with the next word below it: no processor foresees which, so it costs no
    /// jump.
    #[inline(always)]
    fn fill(&mut self, left: u32) -> u32 {
        let [low, high, ..] = self.words.to_le_bytes();
        let is_due = left < LEAST;
        let filled = left << 16 | u32::from_le_bytes([low, high, 0, 0]);
        self.words >>= u32::from(is_due) << 4;
        self.read = self.read.wrapping_add(usize::from(is_due) << 1);
        if is_due { filled } else { left }
    }
}

/// Reads a token.
#[cfg_attr(not(feature = "small"), inline(always))]
fn read_token(ahead: &mut Ahead, tables: &Tables, class: i32, state: &mut u32) -> i32 {
    const POINTS: u32 = (1 << SUM_BITS) - 1;
    let point = *state & POINTS;
    let (token, share) = tables.find(class, point);
    let left = share.frequency.wrapping_mul(*state >> SUM_BITS).wrapping_add(point.wrapping_sub(share.start));
    *state = ahead.fill(left);
    token.cast_signed()
}

#[cfg(test)]
mod tests {
    use super::super::tables::Layout;
    use super::*;

    /// Half the points of class 0 are of each of the tokens 0 and 1.
    fn halves() -> Tables {
        let mut tables = Tables::NEW;
        tables.count(0, 0, 1);
        tables.count(0, 1, 1);
        tables.normalise(Layout::NEAREST);
        tables.share_out();
        tables
    }

    #[test]
    fn a_token_by_hand() {
        let (tables, mut out) = (halves(), [0; 16]);
        let mut writer = NumeralWriter::new(&mut out);
        writer.write_row(&tables, &[1]).unwrap();
        assert_eq!(writer.finish(), Some(16));
        // 65536 / 2048 = 32: 32 * 4096 + 0 + 2048, and three that coded nothing.
        assert_eq!(out[..4], (32_u32 * 4096 + 2048).to_le_bytes());
        assert_eq!(out[4..8], LEAST.to_le_bytes());
    }

    #[test]
    fn a_state_that_grows_writes_a_word() {
        let (tables, mut out) = (halves(), [0; 20]);
        let mut writer = NumeralWriter::new(&mut out);
        // A bit a token: from 2^16 to 2^31 in fifteen, and a word before the sixteenth.
        for count in 0..16 {
            writer.write_row(&tables, &[0]).unwrap();
            assert_eq!(20 - writer.start, if count < 15 { 0 } else { 2 }, "{count}");
        }
        assert_eq!(writer.finish(), Some(18));
    }

    #[test]
    fn small_states_are_refused() {
        assert!(NumeralReader::new(&[0; 16]).is_none() && NumeralReader::new(&[1; 15]).is_none());
        assert!(NumeralReader::new(&[1; 16]).is_some());
    }
}
