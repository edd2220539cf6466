//! Calls of the kernel's streams of rows: with input and output in pieces, in memory with guards around it.

use wavelift_kernel::stream::{RowCodec, RowDecoder, RowEncoder, RowPlan, Status};
use wavelift_kernel::{DecodeError, Malformed};

use crate::lent::Lent;
use crate::oracle::noise::Noise;

/// How input and output are cut into pieces.
#[derive(Debug)]
pub enum Pieces {
    /// All input at once, and more room than there is output.
    Whole,
    /// That many elements at a time.
    Of(usize),
    /// One to that many at a time.
    UpTo(usize, Noise),
}

impl Pieces {
    fn next(&mut self) -> usize {
        match self {
            Self::Whole => usize::MAX,
            Self::Of(count) => *count,
            Self::UpTo(most, noise) => 1 + (noise.bits() % *most as u64) as usize,
        }
    }
}

/// Samples, and the bytes after them, or the error that comes after them.
pub type Decoded = (Vec<i32>, Result<usize, DecodeError>);

/// Room for output where it does not come in pieces.
const ROOM: usize = 1 << 12;

/// The stream of the rows in `samples`.
///
/// # Panics
///
/// If the encoder says what it must not, or writes outside of what was lent.
pub fn encode(plan: &RowPlan, samples: &[i32], mut pieces: Pieces) -> Vec<u8> {
    let mut memory = Lent::stale(plan.encoder_memory_len());
    let mut codec = Box::new(RowCodec::NEW);
    let mut encoder = RowEncoder::new(plan, &mut codec, memory.lend()).expect("memory for it");
    let (mut rest, mut stream, mut finished) = (samples, Vec::new(), false);
    loop {
        let (input, room) = (pieces.next().min(rest.len()), pieces.next().min(ROOM));
        let mut output = Lent::new(room, 0xA5);
        let step = encoder.step(&rest[..input], output.lend()).expect("samples of the type");
        stream.extend_from_slice(&output.take_back()[..step.produced]);
        assert!(step.consumed <= input && step.produced <= room);
        rest = &rest[step.consumed..];
        match step.status {
            Status::NeedInput => {
                assert_eq!(step.consumed, input, "all input is taken");
                if rest.is_empty() && !finished {
                    encoder.finish().expect("whole rows");
                    finished = true;
                }
            }
            Status::NeedOutput => assert_eq!(step.produced, room, "all room is used"),
            Status::Done => break,
        }
    }
    assert!(rest.is_empty(), "samples are left");
    memory.take_back();
    stream
}

/// The samples of a stream, those before the error if there is one, and the bytes after it.
///
/// # Panics
///
/// If the decoder says what it must not, or writes outside of what was lent.
pub fn decode(stream: &[u8], most: usize, pieces: Pieces) -> Decoded {
    decode_in(RowPlan::decoder_memory_len, stream, most, pieces)
}

/// The same in as much memory as is fastest; of damaged streams it may give more samples.
///
/// # Panics
///
/// As [`decode`].
pub fn decode_fast(stream: &[u8], most: usize, pieces: Pieces) -> Decoded {
    decode_in(RowPlan::fast_decoder_memory_len, stream, most, pieces)
}

/// Whether two decoders may say this of one stream, the second in more memory: the same, but of samples outside the type
/// the second may know later.
#[must_use]
pub fn agree(least: &Decoded, fast: &Decoded) -> bool {
    let knows_later = least.1 == Err(Malformed::Sample.into()) && fast.0.starts_with(&least.0);
    least == fast || (knows_later && fast.1.is_err())
}

fn decode_in(
    memory_len: impl Fn(&RowPlan) -> usize,
    stream: &[u8],
    most: usize,
    mut pieces: Pieces,
) -> Decoded {
    let (plan, header) = match RowPlan::parse(stream) {
        Ok(parsed) => parsed,
        Err(error) => return (Vec::new(), Err(error)),
    };
    let mut memory = Lent::stale(memory_len(&plan));
    let mut codec = Box::new(RowCodec::NEW);
    let mut decoder = RowDecoder::new(&plan, &mut codec, memory.lend()).expect("memory for it");
    let (mut rest, mut samples) = (&stream[header..], Vec::new());
    let end = loop {
        let (input, room) = (pieces.next().min(rest.len()), pieces.next().min(ROOM));
        let mut output = Lent::stale(room);
        let step = match decoder.step(&rest[..input], output.lend()) {
            Ok(step) => step,
            Err(error) => break Err(error),
        };
        samples.extend_from_slice(&output.take_back()[..step.produced]);
        assert!(step.consumed <= input && step.produced <= room);
        rest = &rest[step.consumed..];
        match step.status {
            Status::NeedInput => {
                assert_eq!(step.consumed, input, "all input is taken");
                if rest.is_empty() {
                    break Err(DecodeError::Truncated);
                }
            }
            Status::NeedOutput => {}
            Status::Done => break Ok(rest.len()),
        }
        if samples.len() > most {
            break Ok(rest.len());
        }
    };
    memory.take_back();
    (samples, end)
}
