//! A container from front to back.

use std::io::{self, Write};

use super::Statistics;
use super::container::{footer, start};
use super::content::{BrickLabel, Head, Index, Step, StepEntry, Summary};
use super::record::{self, Kind};
use crate::volume::Metadata;

/// Writes a container, one record after another, without ever going back.
#[derive(Debug)]
pub(super) struct Writer<W> {
    out: W,
    written: u64,
    index: Index,
    summaries: Vec<Vec<Summary>>,
    /// The records of head, metadata and current step.
    first: [Vec<u8>; 3],
    /// Bytes of the bricks of the current step.
    bricks: u64,
}

/// A record is repeated behind the bricks of a step if it has at most one in so many of their bytes.
const COPIED: u64 = 1 << 10;

/// Or if it has at most so many bytes, and nothing can be decoded without it.
const COPIED_ALWAYS: usize = 128;

impl<W: Write> Writer<W> {
    /// Begins a container.
    pub(super) fn new(mut out: W, head: &Head, metadata: &Metadata) -> io::Result<Self> {
        out.write_all(&start())?;
        let mut writer =
            Self::resumed(out, start().len() as u64, Index::default(), Vec::new(), (head, metadata))?;
        let [head, metadata, _] = writer.first.clone();
        writer.index.head = writer.record(&head)?;
        writer.index.metadata = writer.record(&metadata)?;
        Ok(writer)
    }

    /// Goes on where all records but the last two are written: `written` bytes, of which `index` and `summaries` tell.
    pub(super) fn resumed(
        out: W,
        written: u64,
        index: Index,
        summaries: Vec<Vec<Summary>>,
        (head, metadata): (&Head, &Metadata),
    ) -> io::Result<Self> {
        let first =
            [record::to_bytes(Kind::Head, head)?, record::to_bytes(Kind::Metadata, metadata)?, Vec::new()];
        Ok(Self { out, written, index, summaries, first, bricks: 0 })
    }

    /// The number of the step that would be begun next.
    pub(super) const fn next_step(&self) -> u64 {
        self.index.steps.len() as u64
    }

    /// Begins the next time step, whose number is [`Writer::next_step`].
    pub(super) fn step(&mut self, step: &Step) -> io::Result<()> {
        self.first[2] = record::to_bytes(Kind::Step, step)?;
        let record = self.record(&self.first[2].clone())?;
        self.index.steps.push(StepEntry { record, ..StepEntry::default() });
        self.summaries.push(vec![Summary::default(); step.channels.len()]);
        self.bricks = 0;
        Ok(())
    }

    /// Writes the next brick of the step: all components of the first, then of the second, and so on. What is stored of
    /// a brick follows its record.
    pub(super) fn brick(
        &mut self,
        step: &Step,
        label: &BrickLabel,
        stored: &[u8],
        statistics: Option<Statistics>,
    ) -> io::Result<()> {
        let mut bytes = record::to_bytes(Kind::Brick, label)?;
        bytes.extend_from_slice(stored);
        let bytes = self.record(&bytes)?;
        self.bricks += u64::from(bytes);
        let component = label.place.component as usize;
        if let (Some(entry), Some(summaries)) = (self.index.steps.last_mut(), self.summaries.last_mut()) {
            entry.bricks.push(bytes);
            summaries[component].add(&step.channels[component].form, label.exceptions, statistics);
        }
        Ok(())
    }

    /// Marks the next brick of the step as lost.
    pub(super) fn lost_brick(&mut self, component: u32) {
        if let (Some(entry), Some(summaries)) = (self.index.steps.last_mut(), self.summaries.last_mut()) {
            entry.bricks.push(0);
            summaries[component as usize].bricks.push(None);
        }
    }

    /// Ends a time step: repeats what comes before its bricks, so that one damaged place cannot make all of them useless.
    pub(super) fn end_step(&mut self) -> io::Result<()> {
        let is_first = self.index.steps.len() == 1;
        let copied = self.first.iter().zip([is_first, false, true]).filter(|(record, is_needed)| {
            record.len() as u64 <= self.bricks / COPIED || *is_needed && record.len() <= COPIED_ALWAYS
        });
        let copies = copied.flat_map(|(record, _)| record).copied().collect::<Vec<u8>>();
        let copies = self.record(&copies)?;
        if let Some(entry) = self.index.steps.last_mut() {
            entry.copies = copies;
        }
        Ok(())
    }

    /// What was written of every step and component so far.
    pub(super) fn summaries(&self) -> &[Vec<Summary>] {
        &self.summaries
    }

    /// Writes what comes last; returns the bytes of the whole container, and where they went.
    pub(super) fn finish(mut self) -> io::Result<(u64, W)> {
        self.index.statistics = self.record(&record::to_bytes(Kind::Statistics, &self.summaries)?)?;
        let index = record::to_bytes(Kind::Index, &self.index)?;
        let bytes = self.record(&index)?;
        self.record(&footer(bytes))?;
        self.out.flush()?;
        Ok((self.written, self.out))
    }

    /// Writes a record; returns its length.
    fn record(&mut self, bytes: &[u8]) -> io::Result<u32> {
        let len = u32::try_from(bytes.len()).map_err(|_| io::Error::other("a brick of 4 GiB and more"))?;
        self.out.write_all(bytes)?;
        self.written += u64::from(len);
        Ok(len)
    }
}
