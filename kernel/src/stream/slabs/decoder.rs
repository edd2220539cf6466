//! The decoder of slabs.

use super::super::header::Number;
use super::super::{Status, Step};
use super::{SlabMemory, SlabPlan};
use crate::extent::to_usize;
use crate::memory::copy;
use crate::{Codec, DecodeError, Feature, Header, LengthError, Malformed};

/// Makes slices of a stream of slabs whose bytes arrive one after another.
#[derive(Debug)]
pub struct SlabDecoder<'a> {
    plan: SlabPlan,
    codec: &'a mut Codec,
    memory: SlabMemory<'a>,
    phase: Phase,
    /// Samples of the slab that comes out, and how many are out.
    decoded: usize,
    given: usize,
    error: Option<DecodeError>,
}

/// What a decoder is at.
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// Reading the length of a codestream.
    Length(Number),
    /// Reading a codestream of that many bytes.
    Bytes { length: usize, filled: usize },
    /// Nothing: all is decoded.
    Done,
}

impl<'a> SlabDecoder<'a> {
    /// A decoder in lent memory. It takes the bytes that follow the header, which [`SlabPlan::parse`] reads.
    ///
    /// # Errors
    /// [`LengthError`] if part of `memory` is too short.
    pub fn new(plan: &SlabPlan, codec: &'a mut Codec, memory: SlabMemory<'a>) -> Result<Self, LengthError> {
        memory.check(plan)?;
        let phase = Phase::Length(Number::default());
        Ok(Self { plan: *plan, codec, memory, phase, decoded: 0, given: 0, error: None })
    }

    /// Takes bytes of the stream from the beginning of `input`, and gives samples to the beginning of `output`, x
    /// fastest, until one of them is used up, or nothing is left to do.
    ///
    /// What it gives does not depend on how input and output are cut into pieces. Where [`Status::NeedInput`] meets the end
    /// of the input, the stream is truncated; bytes after the stream are not taken.
    ///
    /// # Errors
    /// What is wrong with the stream, as soon as all samples before are given, and from then on always.
    pub fn step(&mut self, input: &[u8], output: &mut [i32]) -> Result<Step, DecodeError> {
        let (mut rest, mut produced) = (input, 0_usize);
        let status = loop {
            produced = produced.saturating_add(self.give(output.get_mut(produced..).unwrap_or_default()));
            if self.given < self.decoded {
                break Status::NeedOutput;
            }
            match self.error {
                None => {}
                Some(error) if produced == 0 && rest.len() == input.len() => return Err(error),
                Some(_) => break Status::NeedOutput,
            }
            if let Phase::Done = self.phase {
                break Status::Done;
            }
            match self.take(rest) {
                Ok(0) => break Status::NeedInput,
                Ok(taken) => rest = rest.get(taken..).unwrap_or_default(),
                Err(error) => self.error = Some(error),
            }
        };
        Ok(Step { consumed: input.len().saturating_sub(rest.len()), produced, status })
    }

    /// Gives samples that are ready.
    fn give(&mut self, output: &mut [i32]) -> usize {
        let samples = self.memory.samples.get(self.given..self.decoded).unwrap_or_default();
        let given = samples.len().min(output.len());
        copy(samples, output);
        self.given = self.given.saturating_add(given);
        given
    }

    /// Takes some bytes, and returns how many.
    fn take(&mut self, input: &[u8]) -> Result<usize, DecodeError> {
        match &mut self.phase {
            Phase::Length(number) => {
                let Some(&byte) = input.first() else { return Ok(0) };
                if let Some(length) = number.push(byte)? {
                    let length = to_usize(length);
                    if length > self.plan.bytes_len() {
                        return Err(Malformed::Slab.into());
                    }
                    self.phase = if length == 0 { Phase::Done } else { Phase::Bytes { length, filled: 0 } };
                }
                Ok(1)
            }
            Phase::Bytes { length, filled } => {
                let room = self.memory.bytes.get_mut(*filled..*length).unwrap_or_default();
                let taken = room.len().min(input.len());
                copy(input, room);
                *filled = filled.saturating_add(taken);
                if filled == length {
                    let length = *length;
                    self.phase = Phase::Length(Number::default());
                    self.decode(length)?;
                }
                Ok(taken)
            }
            Phase::Done => Ok(0),
        }
    }

    /// Decodes the codestream of a slab.
    fn decode(&mut self, length: usize) -> Result<(), DecodeError> {
        let SlabMemory { samples, scratch, bytes } = &mut self.memory;
        let bytes = bytes.get(..length).unwrap_or_default();
        // A codestream that ends before its length says is not the end of the stream, and no build decodes dense slabs.
        let within = |error| match error {
            DecodeError::Truncated
            | DecodeError::TrailingBytes
            | DecodeError::NotBuilt(Feature::Dense | Feature::Lattice) => Malformed::Slab.into(),
            error => error,
        };
        let header = Header::parse(bytes).map_err(within)?;
        let count = self.plan.accept(&header).ok_or(Malformed::Slab)?;
        let samples = samples.get_mut(..count).unwrap_or_default();
        self.codec.decode(bytes, samples, scratch).map_err(within)?;
        (self.given, self.decoded) = (0, count);
        Ok(())
    }
}
