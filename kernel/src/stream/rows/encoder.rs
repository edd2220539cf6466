//! The encoder of rows.

use super::bands::{Place, copy_within, lift_row};
use super::chunks::ChunkWriter;
use super::header::Bytes;
use super::plan::{Layout, Role, RowPlan};
use super::schedule::{Event, Pair, Schedule};
use super::{MORE, RowCodec, RowError, Status, Step};
use crate::coder::{Coder, Cursor, Interval, Row};
use crate::error::at_least;
use crate::memory::copy;
use crate::{LengthError, Slice};

/// Makes a stream of rows that arrive one after another.
#[derive(Debug)]
pub struct RowEncoder<'a> {
    plan: RowPlan,
    layout: Layout,
    codec: &'a mut RowCodec,
    memory: &'a mut [i32],
    schedule: Schedule,
    coder: Interval<ChunkWriter>,
    header: Bytes,
    /// Bytes of the header that are out.
    header_given: usize,
    phase: Phase,
    /// Samples of the row that is arriving.
    filled: usize,
    /// Rows in the strip so far.
    rows: u32,
    /// Whether a row of the low-pass part was coded.
    has_low: bool,
    is_finished: bool,
}

/// What an encoder is at.
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// Taking samples.
    Fill,
    /// Saying that a row follows, or none.
    Announce,
    /// Asking what comes next.
    Next,
    /// Coding the row of an orientation of a pair.
    Code(Option<Pair>, u8, Cursor),
    /// Ending a strip, which may be the last.
    EndStrip { is_last: bool },
    /// Nothing: all is coded.
    Done,
}

impl<'a> RowEncoder<'a> {
    /// An encoder in `memory` of at least [`RowPlan::encoder_memory_len`] elements; the codec's models are reset.
    ///
    /// # Errors
    /// [`LengthError`] if `memory` is too short; nothing has changed then.
    pub fn new(plan: &RowPlan, codec: &'a mut RowCodec, memory: &'a mut [i32]) -> Result<Self, LengthError> {
        let layout = plan.layout(Role::Encoder);
        at_least(Slice::Scratch, plan.encoder_memory_len(), memory.len())?;
        memory.fill(0);
        codec.reset();
        Ok(Self {
            plan: *plan,
            layout,
            codec,
            memory,
            schedule: Schedule::new(plan),
            coder: Interval::over(ChunkWriter::new()),
            header: plan.header(),
            header_given: 0,
            phase: Phase::Fill,
            filled: 0,
            rows: 0,
            has_low: false,
            is_finished: false,
        })
    }

    /// Takes samples from the beginning of `input`, x fastest, and gives bytes of the stream to the beginning of
    /// `output`, until one of them is used up, or nothing is left to do.
    ///
    /// What it gives does not depend on how input and output are cut into pieces.
    /// [`Status::NeedInput`] if all input is taken, [`Status::NeedOutput`] if more bytes are ready, [`Status::Done`] if
    /// the stream is complete, after [`RowEncoder::finish`].
    ///
    /// # Errors
    /// [`RowError::SampleOutOfRange`] if the first sample is outside its type; nothing is taken or given then.
    pub fn step(&mut self, input: &[i32], output: &mut [u8]) -> Result<Step, RowError> {
        let (mut rest, mut produced) = (input, 0_usize);
        let status = loop {
            produced = produced.saturating_add(self.give(output.get_mut(produced..).unwrap_or_default()));
            if self.header_given < self.header.len() || !self.coder.sink().has_room() {
                break Status::NeedOutput;
            }
            match self.phase {
                Phase::Fill if !self.is_finished => match self.fill(rest) {
                    Some(taken) if taken > 0 => rest = rest.get(taken..).unwrap_or_default(),
                    Some(_) => break Status::NeedInput,
                    None if produced == 0 && rest.len() == input.len() => {
                        return Err(RowError::SampleOutOfRange { index: 0 });
                    }
                    None => break Status::NeedInput,
                },
                Phase::Done => break Status::Done,
                _ => self.proceed(),
            }
        };
        Ok(Step { consumed: input.len().saturating_sub(rest.len()), produced, status })
    }

    /// Says that no more rows follow; [`RowEncoder::step`] then gives the rest of the stream.
    ///
    /// # Errors
    /// [`RowError::UnfinishedRow`] if the last row lacks samples; nothing has changed then.
    pub fn finish(&mut self) -> Result<(), RowError> {
        if self.filled > 0 && matches!(self.phase, Phase::Fill) {
            return Err(RowError::UnfinishedRow { missing: self.columns().saturating_sub(self.filled) });
        }
        self.is_finished = true;
        Ok(())
    }

    fn columns(&self) -> usize {
        self.plan.width_at(0)
    }

    /// Gives bytes that are ready.
    fn give(&mut self, output: &mut [u8]) -> usize {
        let header = self.header.get(self.header_given..).unwrap_or_default();
        let first = header.len().min(output.len());
        copy(header, output);
        self.header_given = self.header_given.saturating_add(first);
        first.saturating_add(self.coder.sink().drain(output.get_mut(first..).unwrap_or_default()))
    }

    /// Takes samples of one row, and returns how many; `None` if the first is outside its type.
    fn fill(&mut self, input: &[i32]) -> Option<usize> {
        let room = self.columns().saturating_sub(self.filled).min(input.len());
        let wanted = input.get(..room).unwrap_or_default();
        let taken = match self.plan.sample_type().first_outside(wanted) {
            Some(0) => return None,
            Some(index) => index,
            None => room,
        };
        let start = self.arriving().saturating_add(self.filled);
        copy(wanted.get(..taken).unwrap_or_default(), self.memory.get_mut(start..).unwrap_or_default());
        self.filled = self.filled.saturating_add(taken);
        if self.filled == self.columns() {
            self.phase = Phase::Announce;
        }
        Some(taken)
    }

    /// Where the row begins that is arriving.
    fn arriving(&self) -> usize {
        match self.schedule.fronts(0) {
            Some(fronts) if self.plan.levels() > 0 => self.place(0).row(fronts.received()),
            _ => self.layout.low_row,
        }
    }

    fn place(&self, level: u8) -> Place {
        self.plan.rows_at(level)
    }

    /// Does what comes next; there is room for the bytes of a coefficient.
    fn proceed(&mut self) {
        self.phase = match self.phase {
            Phase::Fill => Phase::Announce,
            Phase::Announce => self.announce(),
            Phase::Next => self.next(),
            Phase::Code(pair, orientation, cursor) => self.code(pair, orientation, cursor),
            Phase::EndStrip { is_last } => {
                self.coder.end();
                self.coder.sink().end();
                self.rows = 0;
                if is_last { Phase::Done } else { Phase::Fill }
            }
            Phase::Done => Phase::Done,
        };
    }

    fn announce(&mut self) -> Phase {
        let is_row = self.filled > 0;
        self.coder.decide(is_row, MORE);
        if !is_row {
            self.schedule.end();
            return Phase::Next;
        }
        self.filled = 0;
        self.rows = self.rows.saturating_add(1);
        if self.plan.levels() == 0 {
            return Phase::Code(None, 0, Cursor::default());
        }
        self.receive(0);
        Phase::Next
    }

    /// A row has arrived at a level: transforms it along x.
    fn receive(&mut self, level: u8) {
        let place = self.place(level);
        let row = place.row(self.schedule.receive(level));
        lift_row(&self.plan, self.layout.scratch, (row, place.width), self.memory);
    }

    fn next(&mut self) -> Phase {
        match self.schedule.next() {
            Event::Change(level, change) => {
                self.place(level).change(change, self.memory);
                Phase::Next
            }
            Event::Pair(pair) => Phase::Code(Some(pair), 1, Cursor::default()),
            Event::Row if self.rows >= self.plan.strip() => Phase::EndStrip { is_last: false },
            Event::Row => Phase::Fill,
            Event::Done => Phase::EndStrip { is_last: true },
        }
    }

    fn code(&mut self, pair: Option<Pair>, orientation: u8, mut cursor: Cursor) -> Phase {
        let row = self.row(pair, orientation);
        let has_room = |coder: &Interval<ChunkWriter>| coder.peek().has_room();
        let models = self.codec.models(pair.map(|pair| pair.level), orientation);
        // All of a row is in memory, and words hold every coefficient.
        if cursor.code(&mut self.coder, models, &row, self.memory, has_room) == Some(false) {
            return Phase::Code(pair, orientation, cursor);
        }
        let Some(pair) = pair.filter(|_| orientation > 0) else {
            self.has_low = true;
            return Phase::Next;
        };
        let last = if pair.d.is_some() { 3 } else { 1 };
        if orientation < last {
            return Phase::Code(Some(pair), orientation.wrapping_add(1), Cursor::default());
        }
        let coarser = pair.level.wrapping_add(1);
        if coarser == self.plan.levels() {
            return Phase::Code(Some(pair), 0, Cursor::default());
        }
        let (from, place) = (self.place(pair.level), self.place(coarser));
        let to = place.row(self.schedule.fronts(coarser).map_or(0, |fronts| fronts.received()));
        copy_within(self.memory, from.row(pair.c), place.width, to);
        self.receive(coarser);
        Phase::Next
    }

    /// The row of an orientation; of 0, that of the low-pass part.
    fn row(&self, pair: Option<Pair>, orientation: u8) -> Row {
        let Some(Pair { level, c, d }) = pair else { return self.low_row(self.layout.low_row) };
        let place = self.place(level);
        match orientation {
            0 => self.low_row(place.row(c)),
            _ => place.band(place.of_rows(c, d.unwrap_or(c)), orientation),
        }
    }

    fn low_row(&self, values: usize) -> Row {
        let Layout { north, above, .. } = self.layout;
        let width = self.plan.width_at(self.plan.levels());
        Row::of_low_pass((values, width), above, north, !self.has_low)
    }
}

#[cfg(test)]
mod tests;
