//! Calls of the kernel in memory with guards around it, so that a write outside of what was lent shows.

use std::fmt::Debug;

use wavelift_kernel::{
    Codec, DecodeError, Dense, EncodeError, Header, Lattice, Near, Plan, SampleType, max_encoded_len,
};

use crate::effort::Effort;

/// Elements before and after what is lent.
const GUARD: usize = 32;

/// What samples and scratch hold before they are written.
const STALE: i32 = 0x5A5A_5A5A;

/// Memory to lend; it and the guards around it begin as a mark.
#[derive(Debug)]
pub struct Lent<T> {
    memory: Vec<T>,
    mark: T,
}

impl<T: Copy + PartialEq + Debug> Lent<T> {
    /// `len` elements.
    pub fn new(len: usize, mark: T) -> Self {
        Self { memory: vec![mark; len + 2 * GUARD], mark }
    }

    /// What is lent.
    pub fn lend(&mut self) -> &mut [T] {
        let end = self.memory.len() - GUARD;
        &mut self.memory[GUARD..end]
    }

    /// What was lent, back again.
    ///
    /// # Panics
    ///
    /// If something was written around it.
    pub fn take_back(mut self) -> Vec<T> {
        let (before, rest) = self.memory.split_at(GUARD);
        let (_, after) = rest.split_at(rest.len() - GUARD);
        assert!(
            before.iter().chain(after).all(|element| *element == self.mark),
            "written outside of what was lent"
        );
        self.lend().to_vec()
    }
}

impl Lent<i32> {
    /// A copy of `samples`.
    pub fn samples(samples: &[i32]) -> Self {
        let mut lent = Self::new(samples.len(), STALE);
        lent.lend().copy_from_slice(samples);
        lent
    }

    /// `len` elements that mean nothing.
    pub fn stale(len: usize) -> Self {
        Self::new(len, STALE)
    }
}

/// Encodes into `room` bytes: the codestream or the error, and what is left in the samples.
pub fn encode_within(
    codec: &mut Codec,
    effort: Effort,
    plan: &Plan,
    sample_type: SampleType,
    samples: &[i32],
    room: usize,
) -> (Result<Vec<u8>, EncodeError>, Vec<i32>) {
    let mut samples = Lent::samples(samples);
    let mut out = Lent::new(room, 0xA5);
    let encoded = effort.lend(|effort| {
        let mut scratch = Lent::stale(effort.scratch_len(plan));
        let encoded = codec.encode(effort, plan, sample_type, samples.lend(), scratch.lend(), out.lend());
        scratch.take_back();
        encoded
    });
    let out = out.take_back();
    (encoded.map(|len| out[..len].to_vec()), samples.take_back())
}

/// Encodes into as much memory as any codestream of the plan may take.
///
/// # Panics
///
/// If that fails, which it must not.
pub fn encode(
    codec: &mut Codec,
    effort: Effort,
    plan: &Plan,
    sample_type: SampleType,
    samples: &[i32],
) -> Vec<u8> {
    let room = max_encoded_len(plan.extent(), sample_type).expect("it fits memory, as the samples do");
    encode_within(codec, effort, plan, sample_type, samples, room)
        .0
        .expect("room for any codestream of the plan")
}

/// Encodes a lattice into as much memory as any may take.
///
/// # Panics
///
/// If that fails, which it must not, or if the samples are not what they were.
pub fn encode_near(near: Near, samples: &[i32]) -> Vec<u8> {
    let room = max_encoded_len(near.extent, near.sample_type).expect("it fits memory, as the samples do");
    let (mut lent, mut out) = (Lent::samples(samples), Lent::new(room, 0xA5));
    let mut scratch = Lent::stale(Lattice::encoding_scratch_len(near.extent));
    let mut lattice = Box::new(Lattice::NEW);
    let encoded = lattice.encode(near, lent.lend(), scratch.lend(), out.lend());
    scratch.take_back();
    assert_eq!(lent.take_back(), samples, "the samples changed");
    let len = encoded.expect("room for any codestream of the extent");
    out.take_back()[..len].to_vec()
}

/// [`decode`] of a codestream of any storage, by the codec for that of `lent_for`.
///
/// # Errors
///
/// Those of [`Codec::decode_dense`] and [`Lattice::decode_to_level`].
pub fn decode_any(bytes: &[u8], level: u8, lent_for: &Header) -> Result<Vec<i32>, DecodeError> {
    let mut samples = Lent::stale(lent_for.samples_len(level));
    let mut scratch = Lent::stale(lent_for.scratch_len());
    let decoded = if lent_for.slack().is_some() {
        let mut lattice = Box::new(Lattice::NEW);
        lattice.decode_to_level(bytes, level, samples.lend(), scratch.lend())
    } else {
        let (mut codec, mut dense) = (Box::new(Codec::NEW), Box::new(Dense::NEW));
        codec.decode_dense(&mut dense, bytes, level, samples.lend(), scratch.lend())
    };
    scratch.take_back();
    let mut samples = samples.take_back();
    samples.truncate(decoded?.extent_at(level).samples());
    Ok(samples)
}

/// Decodes `bytes` to a level in memory of the lengths that `lent_for` asks for: the samples of that level.
///
/// # Errors
///
/// Those of [`Codec::decode_to_level`].
pub fn decode(
    codec: &mut Codec,
    bytes: &[u8],
    level: u8,
    lent_for: &Header,
) -> Result<Vec<i32>, DecodeError> {
    let mut samples = Lent::stale(lent_for.samples_len(level));
    let mut scratch = Lent::stale(lent_for.scratch_len());
    let decoded = codec.decode_to_level(bytes, level, samples.lend(), scratch.lend());
    scratch.take_back();
    let mut samples = samples.take_back();
    samples.truncate(decoded?.extent_at(level).samples());
    Ok(samples)
}
