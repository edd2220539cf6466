//! Calls of the kernel's streams of slabs, with input and output in pieces.

use wavelift_kernel::stream::{SlabDecoder, SlabEncoder, SlabMemory, SlabPlan, Status};
use wavelift_kernel::{Codec, DecodeError, Effort as Lending, LengthError, Slice};

use crate::effort::Effort;
use crate::lent::Lent;

/// Samples of a slab for which memory is lent.
const MOST_SAMPLES: usize = 1 << 16;

/// The memory of an encoder or a decoder, with guards around it.
#[derive(Debug)]
pub struct Memory {
    /// For samples.
    pub samples: Lent<i32>,
    /// For scratch.
    pub scratch: Lent<i32>,
    /// For bytes.
    pub bytes: Lent<u8>,
}

impl Memory {
    /// As much as a plan asks for.
    #[must_use]
    pub fn new(plan: &SlabPlan) -> Self {
        let (samples, scratch) = (Lent::stale(plan.samples_len()), Lent::stale(plan.scratch_len()));
        Self { samples, scratch, bytes: Lent::new(plan.bytes_len(), 0xA5) }
    }

    /// To be lent.
    pub fn lend(&mut self) -> SlabMemory<'_> {
        let Self { samples, scratch, bytes } = self;
        SlabMemory { samples: samples.lend(), scratch: scratch.lend(), bytes: bytes.lend() }
    }

    /// Looks at the guards.
    ///
    /// # Panics
    ///
    /// If something was written around what was lent.
    fn take_back(self) {
        self.samples.take_back();
        self.scratch.take_back();
        self.bytes.take_back();
    }
}

/// The stream of slices, made in pieces of so many elements.
///
/// # Panics
///
/// If the encoder says what it must not.
pub fn encode(plan: &SlabPlan, effort: Effort, samples: &[i32], piece: usize) -> Vec<u8> {
    effort.lend(|effort| encode_lent(plan, effort, samples, piece))
}

fn encode_lent(plan: &SlabPlan, effort: Lending<'_>, samples: &[i32], piece: usize) -> Vec<u8> {
    let (mut memory, mut codec) = (Memory::new(plan), Codec::NEW);
    let mut encoder = SlabEncoder::new(plan, &mut codec, effort, memory.lend()).expect("memory for it");
    let (mut rest, mut stream, mut output) = (samples, Vec::new(), Lent::new(piece, 0xA5));
    loop {
        let input = &rest[..piece.min(rest.len())];
        let step = encoder.step(input, output.lend()).expect("samples of the type");
        stream.extend_from_slice(&output.lend()[..step.produced]);
        rest = &rest[step.consumed..];
        match step.status {
            Status::NeedInput if rest.is_empty() => encoder.finish().expect("whole slices"),
            Status::NeedInput => assert_eq!(step.consumed, input.len()),
            Status::NeedOutput => assert_eq!(step.produced, piece),
            Status::Done => break,
        }
    }
    memory.take_back();
    output.take_back();
    stream
}

/// The samples of a stream of slabs that are not too large, and the bytes after it, or why it ends.
///
/// # Panics
///
/// If the decoder says what it must not.
pub fn decode(stream: &[u8], piece: usize) -> (Vec<i32>, Result<usize, DecodeError>) {
    let (plan, header) = match SlabPlan::parse(stream) {
        Ok(parsed) => parsed,
        Err(error) => return (Vec::new(), Err(error)),
    };
    let expected = plan.samples_len();
    if expected > MOST_SAMPLES {
        let error = LengthError { slice: Slice::Samples, expected, actual: 0 };
        return (Vec::new(), Err(DecodeError::Length(error)));
    }
    let (mut memory, mut codec) = (Memory::new(&plan), Codec::NEW);
    let mut decoder = SlabDecoder::new(&plan, &mut codec, memory.lend()).expect("memory for it");
    let (mut rest, mut samples, mut output) = (&stream[header..], Vec::new(), Lent::stale(piece));
    let end = loop {
        let input = &rest[..piece.min(rest.len())];
        let step = match decoder.step(input, output.lend()) {
            Ok(step) => step,
            Err(error) => break Err(error),
        };
        samples.extend_from_slice(&output.lend()[..step.produced]);
        rest = &rest[step.consumed..];
        match step.status {
            Status::NeedInput if rest.is_empty() => break Err(DecodeError::Truncated),
            Status::NeedInput => assert_eq!(step.consumed, input.len()),
            Status::NeedOutput => {}
            Status::Done => break Ok(rest.len()),
        }
    };
    memory.take_back();
    output.take_back();
    (samples, end)
}
