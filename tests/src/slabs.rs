//! Calls of the kernel's streams of slabs, with input and output in pieces.

use wavelift_kernel::stream::{SlabDecoder, SlabEncoder, SlabMemory, SlabPlan, Status};
use wavelift_kernel::{Codec, DecodeError, Training};

/// Memory for one slab.
#[derive(Debug)]
pub struct Memory {
    /// For its samples.
    pub samples: Vec<i32>,
    /// For the transform.
    pub scratch: Vec<i32>,
    /// For its codestream.
    pub bytes: Vec<u8>,
}

impl Memory {
    /// As much as the plan says.
    #[must_use]
    pub fn new(plan: &SlabPlan) -> Self {
        let (samples, scratch) = (vec![0; plan.samples_len()], vec![0; plan.scratch_len()]);
        Self { samples, scratch, bytes: vec![0; plan.bytes_len()] }
    }

    /// All of it.
    pub fn lend(&mut self) -> SlabMemory<'_> {
        let Self { samples, scratch, bytes } = self;
        SlabMemory { samples, scratch, bytes }
    }
}

/// The stream of slices, made in pieces of so many elements.
///
/// # Panics
///
/// If the encoder says what it must not.
#[must_use]
pub fn encode(plan: &SlabPlan, training: Option<&mut Training>, samples: &[i32], piece: usize) -> Vec<u8> {
    let (mut memory, mut codec) = (Memory::new(plan), Codec::NEW);
    let mut encoder = SlabEncoder::new(plan, &mut codec, training, memory.lend()).expect("memory for it");
    let (mut rest, mut stream, mut output) = (samples, Vec::new(), vec![0; piece]);
    loop {
        let input = &rest[..piece.min(rest.len())];
        let step = encoder.step(input, &mut output).expect("samples of the type");
        stream.extend_from_slice(&output[..step.produced]);
        rest = &rest[step.consumed..];
        match step.status {
            Status::NeedInput if rest.is_empty() => encoder.finish().expect("whole slices"),
            Status::NeedInput => assert_eq!(step.consumed, input.len()),
            Status::NeedOutput => assert_eq!(step.produced, piece),
            Status::Done => return stream,
        }
    }
}

/// The samples of a stream, and how it ends: how many bytes are after it, `usize::MAX` where slabs are too large to
/// be tried.
///
/// # Panics
///
/// If the decoder says what it must not.
pub fn decode(stream: &[u8], piece: usize) -> (Vec<i32>, Result<usize, DecodeError>) {
    let (plan, header) = match SlabPlan::parse(stream) {
        Ok(parsed) => parsed,
        Err(error) => return (Vec::new(), Err(error)),
    };
    if plan.samples_len() > 1 << 16 {
        return (Vec::new(), Ok(usize::MAX));
    }
    let (mut memory, mut codec) = (Memory::new(&plan), Codec::NEW);
    let mut decoder = SlabDecoder::new(&plan, &mut codec, memory.lend()).expect("memory for it");
    let (mut rest, mut samples, mut output) = (&stream[header..], Vec::new(), vec![0; piece]);
    loop {
        let input = &rest[..piece.min(rest.len())];
        let step = match decoder.step(input, &mut output) {
            Ok(step) => step,
            Err(error) => return (samples, Err(error)),
        };
        samples.extend_from_slice(&output[..step.produced]);
        rest = &rest[step.consumed..];
        match step.status {
            Status::NeedInput if rest.is_empty() => return (samples, Err(DecodeError::Truncated)),
            Status::NeedInput => assert_eq!(step.consumed, input.len()),
            Status::NeedOutput => {}
            Status::Done => return (samples, Ok(rest.len())),
        }
    }
}
