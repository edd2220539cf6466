//! Codewords in chunks: a byte that says how many bytes follow; fewer than 255 follow in the last chunk of a codeword.

use crate::coder::{MOST_BYTES, Sink};
use crate::memory::{copy, move_within};

/// Bytes of a chunk that is not the last of its codeword.
const WHOLE: u8 = 255;

/// [`WHOLE`], as a length.
const WHOLE_BYTES: usize = 255;

/// Bytes that coding a coefficient may add beside those held back: as many, and two that a carry moves.
const SLACK: usize = MOST_BYTES + 3;

/// Bytes kept for output: a whole chunk, one that a carry may change, and room for a coefficient.
const KEPT: usize = WHOLE_BYTES + 1 + 2 * SLACK;

/// The bytes of a codeword on their way out.
#[derive(Debug)]
pub(super) struct ChunkWriter {
    bytes: [u8; KEPT],
    start: usize,
    end: usize,
    /// Bytes that were held back in large number, and where they belong.
    run: Run,
    /// Bytes left to give of a chunk whose length is out.
    left: u8,
    /// Whether the codeword is over.
    ended: bool,
}

/// Zeros, then bytes 0xFF, before byte `at` of the others.
#[derive(Clone, Copy, Debug, Default)]
struct Run {
    at: usize,
    zeros: usize,
    ones: usize,
}

impl Run {
    const fn len(self) -> usize {
        self.zeros.saturating_add(self.ones)
    }
}

impl ChunkWriter {
    pub(super) const fn new() -> Self {
        let run = Run { at: 0, zeros: 0, ones: 0 };
        Self { bytes: [0; KEPT], start: 0, end: 0, run, left: 0, ended: false }
    }

    /// Whether there is room for what a coefficient takes: unless a chunk is on its way out.
    pub(super) const fn has_room(&self) -> bool {
        !self.is_ready()
    }

    /// The codeword is over; the next can begin when all of it is out.
    pub(super) const fn end(&mut self) {
        self.ended = true;
    }

    /// Gives as many bytes to `out` as there are and it takes, and returns how many.
    pub(super) fn drain(&mut self, out: &mut [u8]) -> usize {
        let mut given = 0_usize;
        for slot in out {
            let Some(byte) = self.next() else { break };
            *slot = byte;
            given = given.wrapping_add(1);
        }
        if self.left == 0 && given > 0 {
            self.make_room();
        }
        given
    }

    /// Whether a byte could be given.
    pub(super) const fn is_ready(&self) -> bool {
        self.left > 0 || self.ended || self.available() >= WHOLE_BYTES
    }

    /// Bytes that no carry changes any more.
    const fn available(&self) -> usize {
        let all = self.end.saturating_sub(self.start).saturating_add(self.run.len());
        if self.ended { all } else { all.saturating_sub(1) }
    }

    fn next(&mut self) -> Option<u8> {
        if let Some(left) = self.left.checked_sub(1) {
            self.left = left;
            return self.pop();
        }
        if self.available() >= WHOLE_BYTES {
            self.left = WHOLE;
            return Some(WHOLE);
        }
        if !self.ended {
            return None;
        }
        // The last chunk of the codeword; an empty one if all before were whole.
        self.left = u8::try_from(self.available()).unwrap_or(WHOLE);
        self.ended = false;
        Some(self.left)
    }

    fn pop(&mut self) -> Option<u8> {
        if self.start == self.run.at && self.run.len() > 0 {
            return Some(match self.run.zeros.checked_sub(1) {
                Some(zeros) => {
                    self.run.zeros = zeros;
                    0
                }
                None => {
                    self.run.ones = self.run.ones.wrapping_sub(1);
                    0xFF
                }
            });
        }
        let byte = self.bytes.get(self.start).copied();
        self.start = self.start.wrapping_add(1);
        byte
    }

    /// Moves the bytes to the beginning of their place, and the run among them where it fits.
    fn make_room(&mut self) {
        move_within(&mut self.bytes, self.start..self.end, 0);
        self.end = self.end.saturating_sub(self.start);
        self.run.at = self.run.at.saturating_sub(self.start);
        self.start = 0;
        let Run { at, zeros, .. } = self.run;
        let (filled, end) = (at.saturating_add(self.run.len()), self.end.saturating_add(self.run.len()));
        if self.run.len() > 0 && end <= KEPT - SLACK {
            move_within(&mut self.bytes, at..self.end, filled);
            let run = self.bytes.get_mut(at..filled).unwrap_or_default();
            let (before, after) = run.split_at_mut_checked(zeros).unwrap_or_default();
            before.fill(0);
            after.fill(0xFF);
            (self.end, self.run) = (end, Run { at: 0, zeros: 0, ones: 0 });
        }
    }
}

impl Sink for ChunkWriter {
    #[inline(always)]
    fn write(&mut self, byte: u8) {
        if let Some(slot) = self.bytes.get_mut(self.end) {
            *slot = byte;
            self.end = self.end.wrapping_add(1);
        }
    }

    fn repeat(&mut self, byte: u8, count: usize) {
        let is_run = self.run.len() > 0;
        if !is_run && self.end.saturating_add(count) > KEPT - SLACK {
            self.run = Run { at: self.end, zeros: 0, ones: 0 };
        } else if !is_run || self.run.at < self.end || (byte == 0 && self.run.ones > 0) {
            // What follows a run, within the same coefficient, is short.
            for _ in 0..count {
                self.write(byte);
            }
            return;
        }
        let counted = if byte == 0 { &mut self.run.zeros } else { &mut self.run.ones };
        *counted = counted.saturating_add(count);
    }

    fn carry(&mut self) {
        if let Some(last) = self.end.checked_sub(1).and_then(|last| self.bytes.get_mut(last)) {
            *last = last.wrapping_add(1);
        }
    }
}

/// Bytes kept of a codeword on its way in.
const WAITING: usize = 256;

/// The bytes of a codeword on their way in.
#[derive(Debug)]
pub(super) struct ChunkReader {
    bytes: [u8; WAITING],
    start: usize,
    end: usize,
    /// Bytes left of a chunk.
    left: u8,
    /// Whether the chunk is the last of its codeword.
    is_last: bool,
    /// The byte before.
    last: u8,
}

impl ChunkReader {
    pub(super) const fn new() -> Self {
        let bytes = [0; WAITING];
        Self { bytes, start: 0, end: 0, left: 0, is_last: false, last: 1 }
    }

    /// Takes bytes of the codeword, as many as there is room for, and returns how many.
    pub(super) fn fill(&mut self, input: &[u8]) -> usize {
        if self.end > WAITING / 2 {
            move_within(&mut self.bytes, self.start..self.end, 0);
            (self.start, self.end) = (0, self.end.saturating_sub(self.start));
        }
        let mut rest = input;
        while !self.is_whole() {
            if self.left == 0 {
                let Some((&length, after)) = rest.split_first() else { break };
                (self.left, self.is_last, rest) = (length, length < WHOLE, after);
                continue;
            }
            let room = self.bytes.get_mut(self.end..).unwrap_or_default();
            let count = room.len().min(rest.len()).min(self.left.into());
            let (taken, after) = rest.split_at_checked(count).unwrap_or_default();
            let Some(&last) = taken.last() else { break };
            copy(taken, room);
            (self.last, rest) = (last, after);
            self.end = self.end.saturating_add(count);
            self.left = self.left.saturating_sub(u8::try_from(count).unwrap_or(0));
        }
        input.len().saturating_sub(rest.len())
    }

    /// Whether all of the codeword is here.
    pub(super) const fn is_whole(&self) -> bool {
        self.is_last && self.left == 0
    }

    /// Bytes that are here and not taken.
    pub(super) fn waiting(&self) -> &[u8] {
        self.bytes.get(self.start..self.end).unwrap_or_default()
    }

    /// Takes that many of the bytes that are here, or all.
    pub(super) fn take(&mut self, count: usize) {
        self.start = self.start.saturating_add(count).min(self.end);
    }

    /// Whether the codeword, which is all here, ends as an encoder ends one: not with a zero byte.
    pub(super) const fn ends_well(&self) -> bool {
        self.last != 0
    }

    /// The next codeword begins.
    pub(super) const fn next_codeword(&mut self) {
        (self.is_last, self.last) = (false, 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::to_usize;

    type Bytes = heapless::Vec<u8, 8192>;

    /// Numbers below `below`, repeatable.
    fn random(seed: &mut u32, below: u32) -> u32 {
        *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (*seed >> 8) % below
    }

    /// Writes what coders of coefficients may, also runs that no room holds; returns the codeword and its chunks.
    fn codeword(seed: &mut u32, piece: usize) -> (Bytes, Bytes) {
        let (mut writer, mut expected, mut chunks) = (ChunkWriter::new(), Bytes::new(), Bytes::new());
        let drain = |writer: &mut ChunkWriter, chunks: &mut Bytes| {
            while writer.is_ready() {
                let mut out = [0; 300];
                let given = writer.drain(&mut out[..piece]);
                chunks.extend_from_slice(&out[..given]).unwrap();
            }
        };
        for _ in 0..random(seed, 200) {
            drain(&mut writer, &mut chunks);
            assert!(writer.has_room());
            let run = [0, 1, 20, 700][to_usize(random(seed, 4))];
            let (zeros, ones) = (to_usize(random(seed, run + 1)), to_usize(random(seed, run + 1)));
            writer.repeat(0, zeros);
            writer.repeat(0xFF, ones);
            expected.extend(core::iter::repeat_n(0, zeros));
            expected.extend(core::iter::repeat_n(0xFF, ones));
            for _ in 0..random(seed, 3) {
                writer.repeat(0, 1);
                writer.repeat(0xFF, 1);
                writer.write(7);
                expected.extend_from_slice(&[0, 0xFF, 7]).unwrap();
                if random(seed, 3) == 0 {
                    writer.carry();
                    *expected.last_mut().unwrap() += 1;
                }
            }
            if expected.len() > if cfg!(miri) { 600 } else { 6000 } {
                break;
            }
        }
        drain(&mut writer, &mut chunks);
        writer.end();
        drain(&mut writer, &mut chunks);
        (expected, chunks)
    }

    #[test]
    fn runs_of_any_length_leave_in_order() {
        let mut seed = 1;
        for round in 0..if cfg!(miri) { 3 } else { 300 } {
            let (expected, chunks) = codeword(&mut seed, [1, 7, 300][round % 3]);
            let (mut reader, mut found, mut rest) = (ChunkReader::new(), Bytes::new(), &chunks[..]);
            while !reader.is_whole() {
                let taken = reader.fill(&rest[..rest.len().min(1 + round % 50)]);
                rest = &rest[taken..];
                found.extend_from_slice(reader.waiting()).unwrap();
                reader.take(usize::MAX);
            }
            assert!(rest.is_empty() && found == expected, "round {round}");
            assert_eq!(reader.ends_well(), expected.last() != Some(&0));
        }
    }

    #[test]
    fn chunks_by_hand() {
        let chunks_of = |count: usize| {
            let mut writer = ChunkWriter::new();
            (0..count).for_each(|_| writer.write(9));
            writer.end();
            let mut out = [0; 300];
            let given = writer.drain(&mut out);
            (out, given)
        };
        let (out, given) = chunks_of(2);
        assert_eq!(out[..given], [2, 9, 9]);
        assert_eq!(chunks_of(0).1, 1);
        let (out, given) = chunks_of(255);
        assert_eq!((given, out[0], out[1], out[255], out[256]), (257, 255, 9, 9, 0));
    }
}
