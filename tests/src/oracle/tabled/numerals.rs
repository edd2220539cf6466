//! Four states that take turns, and the words they are filled up with.

use super::model::SUM;
use crate::oracle::coder::Reject;

/// What each state ends as; they never are below.
const LEAST: i64 = 1 << 16;

/// The numerals of a decoder.
#[derive(Debug)]
pub(super) struct Numerals<'a> {
    states: [i64; 4],
    words: &'a [u16],
}

impl<'a> Numerals<'a> {
    pub(super) fn new(states: [u32; 4], words: &'a [u16]) -> Result<Self, Reject> {
        let states = states.map(i64::from);
        if states.iter().all(|&v| v >= LEAST) { Ok(Self { states, words }) } else { Err(Reject::Segment) }
    }

    /// The next token under a table.
    pub(super) fn token(&mut self, turn: usize, table: &[i64]) -> Result<usize, Reject> {
        let v = &mut self.states[turn];
        let point = *v % SUM;
        let mut start = 0;
        for (token, &f) in table.iter().enumerate() {
            if point < start + f {
                *v = f * (*v / SUM) + point - start;
                if *v < LEAST {
                    let (&word, rest) = self.words.split_first().ok_or(Reject::Segment)?;
                    *v = LEAST * *v + i64::from(word);
                    self.words = rest;
                }
                return Ok(token);
            }
            start += f;
        }
        unreachable!("frequencies sum up")
    }

    pub(super) fn finish(self) -> Result<(), Reject> {
        let done = self.words.is_empty() && self.states == [LEAST; 4];
        if done { Ok(()) } else { Err(Reject::Segment) }
    }
}

/// What an encoder codes.
#[derive(Debug)]
pub(super) struct Symbol {
    turn: usize,
    start: i64,
    f: i64,
}

impl Symbol {
    /// A token under a table. Panics if it has no frequency.
    pub(super) fn new(turn: usize, table: &[i64], token: usize) -> Self {
        let f = table.get(token).copied().unwrap_or(0);
        assert!(f > 0, "token {token} has no frequency");
        Self { turn, start: table[..token].iter().sum(), f }
    }
}

/// The states and words of all symbols, as a decoder begins and reads them.
pub(super) fn encode(symbols: &[Symbol]) -> ([u32; 4], Vec<u16>) {
    let (mut states, mut words) = ([LEAST; 4], Vec::new());
    for &Symbol { turn, start, f } in symbols.iter().rev() {
        let v = &mut states[turn];
        while *v >= (1 << 20) * f {
            words.push((*v % LEAST) as u16);
            *v /= LEAST;
        }
        *v = SUM * (*v / f) + *v % f + start;
    }
    words.reverse();
    (states.map(|v| v as u32), words)
}
