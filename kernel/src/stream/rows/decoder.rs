//! The decoder of rows.

use super::chunks::ChunkReader;
use super::inverse::Inverse;
use super::outgoing::Outgoing;
use super::plan::{Layout, RowPlan};
use super::schedule::{Event, Pair, Schedule};
use super::{MORE, RowCodec, Status, Step};
use crate::coder::{Coder, Cursor, Decoder, MOST_BYTES, Row, Suspended, WINDOW};
use crate::error::at_least;
use crate::packed::QUICK;
use crate::{DecodeError, LengthError, Malformed, Slice};

/// Makes rows of a stream whose bytes arrive one after another.
#[derive(Debug)]
pub struct RowDecoder<'a> {
    plan: RowPlan,
    layout: Layout,
    codec: &'a mut RowCodec,
    memory: &'a mut [i32],
    schedule: Schedule,
    inverse: Inverse,
    reader: ChunkReader,
    /// Where the codeword stands, and zeros taken beyond its end.
    coder: Suspended,
    beyond: usize,
    phase: Phase,
    /// Rows in the strip so far.
    rows: u32,
    /// Whether a row of the low-pass part was coded.
    has_low: bool,
    /// Samples left to give of the row that comes out.
    left: usize,
    error: Option<DecodeError>,
}

/// What a decoder is at.
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// Waiting for the first bytes of a codeword.
    Begin,
    /// Asking whether a row follows.
    Announce,
    /// Asking what comes next.
    Next,
    /// Decoding the row of an orientation of a pair.
    Code(Option<Pair>, u8, Cursor),
    /// Waiting for the end of a codeword.
    EndStrip { is_last: bool },
    /// Nothing: all is decoded.
    Done,
}

impl<'a> RowDecoder<'a> {
    /// A decoder in `memory` of at least [`RowPlan::decoder_memory_len`] elements; the codec's models are reset.
    ///
    /// It takes the bytes that follow the header, which [`RowPlan::parse`] reads. With
    /// [`RowPlan::fast_decoder_memory_len`] elements or more it takes about a quarter less time.
    ///
    /// # Errors
    /// [`LengthError`] if `memory` is too short; nothing has changed then.
    #[expect(clippy::large_stack_frames, reason = "the lint counts every copy; the decoder has 1,844 bytes")]
    pub fn new(plan: &RowPlan, codec: &'a mut RowCodec, memory: &'a mut [i32]) -> Result<Self, LengthError> {
        at_least(Slice::Scratch, plan.decoder_memory_len(), memory.len())?;
        let layout = plan.layout(plan.decoder_in(memory.len()));
        memory.fill(0);
        codec.reset();
        Ok(Self {
            plan: *plan,
            layout,
            codec,
            memory,
            schedule: Schedule::new(plan),
            inverse: Inverse::new(plan),
            reader: ChunkReader::new(),
            coder: Suspended::NONE,
            beyond: 0,
            phase: Phase::Begin,
            rows: 0,
            has_low: false,
            left: 0,
            error: None,
        })
    }

    /// Takes bytes of the stream from the beginning of `input`, and gives samples to the beginning of `output`, x
    /// fastest, until one of them is used up, or nothing is left to do.
    ///
    /// What it gives does not depend on how input and output are cut into pieces.
    /// [`Status::NeedInput`] if all input is taken and the stream goes on: where there is no more input, it is
    /// truncated. [`Status::NeedOutput`] if more samples are ready, [`Status::Done`] if the stream is complete; bytes
    /// after it are not taken.
    ///
    /// # Errors
    /// What is wrong with the stream, as soon as all samples before are given, and from then on always.
    pub fn step(&mut self, input: &[u8], output: &mut [i32]) -> Result<Step, DecodeError> {
        let (mut rest, mut produced) = (input, 0_usize);
        let status = loop {
            produced = produced.saturating_add(self.give(output.get_mut(produced..).unwrap_or_default()));
            if self.left > 0 {
                break Status::NeedOutput;
            }
            match self.error {
                None => {}
                Some(error) if produced == 0 && rest.len() == input.len() => return Err(error),
                Some(_) => break Status::NeedOutput,
            }
            // While the rows of a pair are decoded nothing new is known.
            if !matches!(self.phase, Phase::Code(..)) && self.pull() {
                continue;
            }
            if let Phase::Done = self.phase {
                break Status::Done;
            }
            rest = rest.get(self.reader.fill(rest)..).unwrap_or_default();
            match self.proceed() {
                Ok(Some(phase)) => self.phase = phase,
                Ok(None) if rest.is_empty() => break Status::NeedInput,
                Ok(None) => {}
                Err(malformed) => self.error = Some(malformed.into()),
            }
        };
        Ok(Step { consumed: input.len().saturating_sub(rest.len()), produced, status })
    }

    /// Gives samples of the row that comes out.
    fn give(&mut self, output: &mut [i32]) -> usize {
        let given = self.left.min(output.len());
        if given > 0 {
            let first = self.plan.width_at(0).saturating_sub(self.left);
            self.outgoing().give(first, output.get_mut(..given).unwrap_or_default());
            self.left = self.left.saturating_sub(given);
        }
        given
    }

    /// The row that comes out.
    fn outgoing(&mut self) -> Outgoing<'_> {
        Outgoing::new(&self.plan, self.layout, self.memory)
    }

    /// Makes the next row come out, if enough is known.
    fn pull(&mut self) -> bool {
        let plan = self.plan;
        match self.inverse.pull(&plan, self.layout, &self.schedule, self.memory) {
            Some(false) => return false,
            Some(true) if self.outgoing().is_inside(&plan) => self.left = plan.width_at(0),
            _ => self.error = Some(Malformed::Sample.into()),
        }
        true
    }

    /// Does what comes next; `None` if it takes more input.
    fn proceed(&mut self) -> Result<Option<Phase>, Malformed> {
        let (reader, plan) = (&self.reader, &self.plan);
        let enough = if let Phase::Begin = self.phase { WINDOW } else { MOST_BYTES };
        let has_enough = reader.is_whole() || reader.waiting().len() >= enough;
        match self.phase {
            Phase::Begin | Phase::Announce | Phase::Code(..) if !has_enough => Ok(None),
            Phase::Begin => {
                let decoder = Decoder::begin(reader.waiting()).ok_or(Malformed::Segment)?;
                self.beyond = 0;
                self.put_back(decoder.suspend());
                Ok(Some(Phase::Announce))
            }
            Phase::Announce => Ok(Some(self.announce())),
            Phase::Next => Ok(Some(match self.schedule.next() {
                Event::Change(..) => Phase::Next,
                Event::Pair(pair) => self.begin(pair, 1),
                Event::Row if self.rows >= plan.strip() => Phase::EndStrip { is_last: false },
                Event::Row => Phase::Announce,
                Event::Done => Phase::EndStrip { is_last: true },
            })),
            Phase::Code(pair, orientation, cursor) => self.code(pair, orientation, cursor).map(Some),
            Phase::EndStrip { is_last } => self.end_strip(is_last),
            Phase::Done => Ok(Some(Phase::Done)),
        }
    }

    /// Takes the bytes that a decoder took.
    fn put_back(&mut self, (coder, taken): (Suspended, usize)) {
        self.coder = coder;
        self.beyond = self.beyond.saturating_add(taken.saturating_sub(self.reader.waiting().len()));
        self.reader.take(taken);
    }

    fn announce(&mut self) -> Phase {
        let mut decoder = Decoder::resume(self.coder, self.reader.waiting());
        let is_row = decoder.decide(false, MORE);
        self.put_back(decoder.suspend());
        if !is_row {
            self.schedule.end();
            return Phase::Next;
        }
        self.rows = self.rows.saturating_add(1);
        if self.plan.levels() == 0 {
            return Phase::Code(None, 0, Cursor::default());
        }
        self.schedule.receive(0);
        Phase::Next
    }

    /// Begins with the row of an orientation, 1 to 3.
    fn begin(&mut self, pair: Pair, orientation: u8) -> Phase {
        if QUICK && let Some((scratch, rest)) = self.memory.split_at_mut_checked(self.layout.scratch) {
            let shelf = self.plan.shelf_at(self.layout, pair.level);
            shelf.unpack(self.inverse.next_waiting(pair.level), orientation, (scratch, rest));
        }
        Phase::Code(Some(pair), orientation, Cursor::default())
    }

    /// Ends the row of an orientation, 1 to 3; `None` if a number takes more bits than there are for it.
    fn pack(&mut self, level: u8, orientation: u8) -> Option<()> {
        if !QUICK {
            return Some(());
        }
        let (scratch, rest) = self.memory.split_at_mut_checked(self.layout.scratch)?;
        let shelf = self.plan.shelf_at(self.layout, level);
        shelf.pack(self.inverse.next_waiting(level), orientation, (scratch, rest))
    }

    fn code(&mut self, pair: Option<Pair>, orientation: u8, mut cursor: Cursor) -> Result<Phase, Malformed> {
        let row = self.row(pair, orientation);
        let is_whole = self.reader.is_whole();
        let mut decoder = Decoder::resume(self.coder, self.reader.waiting());
        let has_enough = |decoder: &Decoder<'_>| is_whole || decoder.left() >= MOST_BYTES;
        let models = self.codec.models(pair.map(|pair| pair.level), orientation);
        let is_done = cursor.code(&mut decoder, models, &row, self.memory, has_enough);
        self.put_back(decoder.suspend());
        if !is_done.ok_or(Malformed::Sample)? {
            return Ok(Phase::Code(pair, orientation, cursor));
        }
        let Some(pair) = pair.filter(|_| orientation > 0) else {
            self.has_low = true;
            self.inverse.receive();
            return Ok(Phase::Next);
        };
        self.pack(pair.level, orientation).ok_or(Malformed::Sample)?;
        let last = if pair.d.is_some() { 3 } else { 1 };
        if orientation < last {
            return Ok(self.begin(pair, orientation.wrapping_add(1)));
        }
        self.inverse.wait(pair.level);
        let coarser = pair.level.wrapping_add(1);
        if coarser == self.plan.levels() {
            return Ok(Phase::Code(Some(pair), 0, Cursor::default()));
        }
        self.schedule.receive(coarser);
        Ok(Phase::Next)
    }

    /// The row of an orientation; of 0, that of the low-pass part.
    fn row(&self, pair: Option<Pair>, orientation: u8) -> Row {
        match pair {
            Some(Pair { level, .. }) if orientation > 0 => {
                let shelf = self.plan.shelf_at(self.layout, level);
                shelf.band(self.inverse.next_waiting(level), orientation)
            }
            _ => {
                let Layout { north, above, low_row, .. } = self.layout;
                let width = self.plan.width_at(self.plan.levels());
                Row::of_low_pass((low_row, width), above, north, !self.has_low)
            }
        }
    }

    /// Ends a codeword, when all of it is here; it must be as an encoder ends one.
    fn end_strip(&mut self, is_last: bool) -> Result<Option<Phase>, Malformed> {
        if !self.reader.waiting().is_empty() {
            return Err(Malformed::Segment);
        }
        if !self.reader.is_whole() {
            return Ok(None);
        }
        if self.beyond < WINDOW - 1 || !self.reader.ends_well() {
            return Err(Malformed::Segment);
        }
        self.reader.next_codeword();
        self.rows = 0;
        Ok(Some(if is_last { Phase::Done } else { Phase::Begin }))
    }
}

#[cfg(test)]
mod tests;
