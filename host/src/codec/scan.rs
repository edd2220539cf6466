//! The records of a file as they lie there, without its index: of one that is damaged, cut short, or not yet written.

use std::collections::VecDeque;
use std::io;
use std::ops::Range;

use super::ReadAt;
use super::container::{read, start};
use super::content::{BrickLabel, Head, Step};
use super::record::{self, Frame, Kind};
use crate::volume::Metadata;

/// A stretch of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The bytes, with all that is stored of a brick.
    pub bytes: Range<u64>,
    /// What they are; `None` for bytes that are no whole record.
    pub content: Option<Content>,
}

/// What a whole record holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// A head, or a copy of it.
    Head(Head),
    /// Metadata, or a copy of them.
    Metadata(Metadata),
    /// A time step, or a copy of it.
    Step(Step),
    /// A brick, whose codestreams and exceptions agree with their checksum.
    Brick {
        /// Its record.
        label: BrickLabel,
        /// Its codestreams, one after another, then its exceptions.
        stored: Vec<u8>,
    },
    /// Statistics or an index, which are made anew when a file is repaired.
    Other(Kind),
}

/// Finds the records of a file from front to back, whatever is between them; an iterator of [`Found`].
///
/// Bytes that are no record, or one whose checksum is wrong, are passed over until the next that is whole. What is
/// found has been checked byte by byte, but not against anything else in the file.
///
/// Memory: one record. Time: that of reading the file twice at most, and more only where much in it looks like the
/// beginning of a record, without being one.
pub struct Scanner<'a> {
    source: &'a dyn ReadAt,
    at: u64,
    /// Bytes whose checksums may still be computed for nothing.
    patience: u64,
    /// What comes after the gap that was found last.
    ahead: VecDeque<Found>,
}

impl std::fmt::Debug for Scanner<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scanner").field("at", &self.at).finish_non_exhaustive()
    }
}

/// Bytes that are looked through at a time.
const WINDOW: u64 = 1 << 16;

/// Bytes of checksums that may be computed for nothing, for each byte of the file, and at least.
const PATIENCE: (u64, u64) = (8, 1 << 26);

impl<'a> Scanner<'a> {
    /// Scans from the beginning, which need not be that of a container.
    pub fn new(source: &'a dyn ReadAt) -> Self {
        let patience = source.bytes().saturating_mul(PATIENCE.0).saturating_add(PATIENCE.1);
        let mut scanner = Self { source, at: 0, patience, ahead: VecDeque::new() };
        let mut first = start();
        if source.read_at(0, &mut first).is_ok() && first == start() {
            scanner.at = first.len() as u64;
        }
        scanner
    }

    /// The whole record at a place of `source`, if there is one.
    ///
    /// # Errors
    /// What the system says.
    pub fn record_at(source: &'a dyn ReadAt, at: u64) -> io::Result<Option<Found>> {
        Self::new(source).record(at)
    }

    /// The record at `at`, if there is one.
    fn record(&mut self, at: u64) -> io::Result<Option<Found>> {
        let left = self.source.bytes().saturating_sub(at);
        let first = read(self.source, at, left.min(WINDOW / 64) as u32)?;
        let Some(frame) = Frame::parse(&first).filter(|frame| frame.bytes() as u64 <= left) else {
            return Ok(None);
        };
        if frame.bytes() as u64 > self.patience {
            return Ok(None);
        }
        let bytes =
            if frame.bytes() <= first.len() { first } else { read(self.source, at, frame.bytes() as u32)? };
        let content = frame
            .content(&bytes)
            .and_then(|content| self.content(frame.kind, content, at + frame.bytes() as u64));
        match content {
            Some((content, end)) => Ok(Some(Found { bytes: at..end, content: Some(content) })),
            None => {
                self.patience = self.patience.saturating_sub(frame.bytes() as u64);
                Ok(None)
            }
        }
    }

    /// What a record holds whose own bytes end at `end`, and where all of it ends.
    fn content(&mut self, kind: Kind, content: &[u8], end: u64) -> Option<(Content, u64)> {
        let found = match kind {
            Kind::Head => Content::Head(record::parse::<Head>(content).filter(Head::is_sound)?),
            Kind::Metadata => Content::Metadata(record::parse(content)?),
            Kind::Step => Content::Step(record::parse(content)?),
            Kind::Statistics | Kind::Index => Content::Other(kind),
            Kind::Brick => {
                let label: BrickLabel = record::parse(content)?;
                let len = u32::try_from(label.bytes()).ok()?;
                if u64::from(len) > self.patience {
                    return None;
                }
                let after = end.checked_add(len.into()).filter(|&after| after <= self.source.bytes())?;
                let stored = read(self.source, end, len).ok()?;
                if crc32fast::hash(&stored) != label.stored_crc {
                    self.patience -= u64::from(len);
                    return None;
                }
                return Some((Content::Brick { label, stored }, after));
            }
        };
        Some((found, end))
    }

    /// The next record at `from` or behind.
    fn next_record(&mut self, mut from: u64) -> io::Result<Option<Found>> {
        while from < self.source.bytes() {
            let window = read(self.source, from, (self.source.bytes() - from).min(WINDOW) as u32)?;
            for (offset, _) in window.iter().enumerate().filter(|(_, byte)| **byte == record::MARKER) {
                if let Some(found) = self.record(from + offset as u64)? {
                    return Ok(Some(found));
                }
            }
            from += window.len() as u64;
        }
        Ok(None)
    }

    fn advance(&mut self) -> io::Result<Option<Found>> {
        if let Some(found) = self.ahead.pop_front() {
            return Ok(Some(found));
        }
        let (start, end) = (self.at, self.source.bytes());
        if start >= end {
            return Ok(None);
        }
        let found = match self.record(start)? {
            Some(found) => Some(found),
            None => self.next_record(start + 1)?,
        };
        self.at = found.as_ref().map_or(end, |found| found.bytes.end);
        let gap = found.as_ref().map_or(end, |found| found.bytes.start);
        if gap > start {
            self.ahead.extend(found);
            return Ok(Some(Found { bytes: start..gap, content: None }));
        }
        Ok(found)
    }
}

impl Iterator for Scanner<'_> {
    type Item = io::Result<Found>;

    fn next(&mut self) -> Option<Self::Item> {
        self.advance().transpose()
    }
}
