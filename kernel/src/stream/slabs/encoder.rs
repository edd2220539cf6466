//! The encoder of slabs.

use super::super::header::{Bytes, push_number};
use super::super::{RowError, Status, Step};
use super::{SlabMemory, SlabPlan};
use crate::error::at_least;
use crate::memory::copy;
use crate::{Codec, Effort, EncodeError, LengthError, Slice};

/// Makes a stream of slabs of slices that arrive one after another.
#[derive(Debug)]
pub struct SlabEncoder<'a> {
    plan: SlabPlan,
    codec: &'a mut Codec,
    effort: Effort<'a>,
    memory: SlabMemory<'a>,
    /// The header, or the length of a codestream, and how much of it is out.
    first: Bytes,
    first_given: usize,
    /// The codestream that is on its way out, and how much of it is.
    encoded: usize,
    encoded_given: usize,
    /// Samples of the slab that is arriving.
    filled: usize,
    is_finished: bool,
    is_ended: bool,
}

impl<'a> SlabEncoder<'a> {
    /// An encoder in lent memory, of any effort; no slab is dense, so [`Effort::Dense`] is [`Effort::Default`] here.
    ///
    /// # Errors
    /// [`EncodeError::Length`] if part of `memory` is too short, [`EncodeError::NotBuilt`] if this build lacks the effort.
    pub fn new(
        plan: &SlabPlan,
        codec: &'a mut Codec,
        effort: Effort<'a>,
        memory: SlabMemory<'a>,
    ) -> Result<Self, EncodeError> {
        memory.check(plan)?;
        let effort = match effort {
            Effort::Dense(_, training) => Effort::Default(training),
            effort => effort,
        };
        if let Some(part) = effort.missing() {
            return Err(EncodeError::NotBuilt(part));
        }
        Ok(Self {
            plan: *plan,
            codec,
            effort,
            memory,
            first: plan.header(),
            first_given: 0,
            encoded: 0,
            encoded_given: 0,
            filled: 0,
            is_finished: false,
            is_ended: false,
        })
    }

    /// Takes samples from the beginning of `input`, x fastest, and gives bytes of the stream to the beginning of
    /// `output`, until one of them is used up, or nothing is left to do.
    ///
    /// What it gives does not depend on how input and output are cut into pieces. A slab is encoded when its last
    /// sample is there, and its bytes leave before the samples of the next are taken.
    ///
    /// # Errors
    /// [`RowError::SampleOutOfRange`] if the first sample is outside its type; nothing is taken or given then.
    pub fn step(&mut self, input: &[i32], output: &mut [u8]) -> Result<Step, RowError> {
        let (mut rest, mut produced) = (input, 0_usize);
        let status = loop {
            produced = produced.saturating_add(self.give(output.get_mut(produced..).unwrap_or_default()));
            if self.first_given < self.first.len() || self.encoded_given < self.encoded {
                break Status::NeedOutput;
            }
            if self.is_ended {
                break Status::Done;
            }
            if self.filled == self.plan.samples_len() || (self.is_finished && self.filled > 0) {
                self.encode();
                continue;
            }
            if self.is_finished {
                self.announce(0);
                self.is_ended = true;
                continue;
            }
            match self.fill(rest) {
                Some(taken) if taken > 0 => rest = rest.get(taken..).unwrap_or_default(),
                None if produced == 0 && rest.len() == input.len() => {
                    return Err(RowError::SampleOutOfRange { index: 0 });
                }
                _ => break Status::NeedInput,
            }
        };
        Ok(Step { consumed: input.len().saturating_sub(rest.len()), produced, status })
    }

    /// Says that no more slices follow; [`SlabEncoder::step`] then gives the rest of the stream.
    ///
    /// # Errors
    /// [`RowError::UnfinishedRow`] if the last slice lacks samples; nothing has changed then.
    pub fn finish(&mut self) -> Result<(), RowError> {
        let slice = self.plan.slice();
        match self.filled.checked_rem(slice).unwrap_or(0) {
            0 => self.is_finished = true,
            part => return Err(RowError::UnfinishedRow { missing: slice.saturating_sub(part) }),
        }
        Ok(())
    }

    /// Gives bytes that are ready.
    fn give(&mut self, output: &mut [u8]) -> usize {
        let first = self.first.get(self.first_given..).unwrap_or_default();
        let taken = first.len().min(output.len());
        copy(first, output);
        self.first_given = self.first_given.saturating_add(taken);
        let output = output.get_mut(taken..).unwrap_or_default();
        let encoded = self.memory.bytes.get(self.encoded_given..self.encoded).unwrap_or_default();
        let given = encoded.len().min(output.len());
        copy(encoded, output);
        self.encoded_given = self.encoded_given.saturating_add(given);
        taken.saturating_add(given)
    }

    /// Takes samples of one slab, and returns how many; `None` if the first is outside its type.
    fn fill(&mut self, input: &[i32]) -> Option<usize> {
        let room = self.plan.samples_len().saturating_sub(self.filled).min(input.len());
        let wanted = input.get(..room).unwrap_or_default();
        let taken = match self.plan.sample_type().first_outside(wanted) {
            Some(0) => return None,
            Some(index) => index,
            None => room,
        };
        let to = self.memory.samples.get_mut(self.filled..).unwrap_or_default();
        copy(wanted.get(..taken).unwrap_or_default(), to);
        self.filled = self.filled.saturating_add(taken);
        Some(taken)
    }

    /// Encodes the slab that has arrived.
    fn encode(&mut self) {
        let slices = self.filled.checked_div(self.plan.slice()).unwrap_or(0);
        let plan = u32::try_from(slices).ok().and_then(|slices| self.plan.plan_of(slices));
        let SlabMemory { samples, scratch, bytes } = &mut self.memory;
        let samples = samples.get_mut(..self.filled).unwrap_or_default();
        let (effort, sample_type) = (self.effort.lend(), self.plan.sample_type());
        let encoded = plan.map(|plan| self.codec.encode(effort, &plan, sample_type, samples, scratch, bytes));
        // It cannot fail: effort, samples and memory were checked.
        self.encoded = encoded.and_then(Result::ok).unwrap_or(0);
        (self.encoded_given, self.filled) = (0, 0);
        self.announce(u32::try_from(self.encoded).unwrap_or(0));
    }

    /// Writes the length of a codestream.
    fn announce(&mut self, length: u32) {
        self.first.clear();
        self.first_given = 0;
        push_number(length, |byte| {
            // There is room for more than a number.
            let _ = self.first.push(byte);
        });
    }
}

impl SlabMemory<'_> {
    /// Whether there is enough of it.
    pub(super) fn check(&self, plan: &SlabPlan) -> Result<(), LengthError> {
        at_least(Slice::Samples, plan.samples_len(), self.samples.len())?;
        at_least(Slice::Scratch, plan.scratch_len(), self.scratch.len())?;
        at_least(Slice::Bytes, plan.bytes_len(), self.bytes.len())
    }
}
