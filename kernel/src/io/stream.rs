//! Streams of rows or slabs to `embedded_io` writers and from readers, sample by sample.

use core::fmt;

use embedded_io::{Read, Write};

use super::{ReadError, WriteError, fill, write};
use crate::DecodeError;
#[cfg(feature = "stream")]
use crate::stream::{RowDecoder, RowEncoder, RowPlan};
use crate::stream::{RowError, SlabDecoder, SlabEncoder, SlabPlan, Status, Step};

/// Bytes that are written at a time.
const PIECE: usize = 64;

/// An encoder that a [`SampleWriter`] drives: of rows, or [`SlabEncoder`].
pub trait StreamEncoder {
    /// Takes samples and gives bytes; see [`SlabEncoder::step`].
    ///
    /// # Errors
    /// [`RowError::SampleOutOfRange`].
    fn step(&mut self, input: &[i32], output: &mut [u8]) -> Result<Step, RowError>;

    /// Says that no more samples follow.
    ///
    /// # Errors
    /// [`RowError::UnfinishedRow`].
    fn finish(&mut self) -> Result<(), RowError>;
}

#[cfg(feature = "stream")]
impl StreamEncoder for RowEncoder<'_> {
    fn step(&mut self, input: &[i32], output: &mut [u8]) -> Result<Step, RowError> {
        RowEncoder::step(self, input, output)
    }

    fn finish(&mut self) -> Result<(), RowError> {
        RowEncoder::finish(self)
    }
}

impl StreamEncoder for SlabEncoder<'_> {
    fn step(&mut self, input: &[i32], output: &mut [u8]) -> Result<Step, RowError> {
        SlabEncoder::step(self, input, output)
    }

    fn finish(&mut self) -> Result<(), RowError> {
        SlabEncoder::finish(self)
    }
}

/// A decoder that a [`SampleReader`] drives: of rows, or [`SlabDecoder`].
pub trait StreamDecoder {
    /// Takes bytes and gives samples; see [`SlabDecoder::step`].
    ///
    /// # Errors
    /// What is wrong with the stream.
    fn step(&mut self, input: &[u8], output: &mut [i32]) -> Result<Step, DecodeError>;
}

#[cfg(feature = "stream")]
impl StreamDecoder for RowDecoder<'_> {
    fn step(&mut self, input: &[u8], output: &mut [i32]) -> Result<Step, DecodeError> {
        RowDecoder::step(self, input, output)
    }
}

impl StreamDecoder for SlabDecoder<'_> {
    fn step(&mut self, input: &[u8], output: &mut [i32]) -> Result<Step, DecodeError> {
        SlabDecoder::step(self, input, output)
    }
}

/// Why a [`SampleWriter`] gave up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SampleWriteError<E> {
    /// The encoder refuses the samples.
    Samples(RowError),
    /// The writer takes no more.
    Write(WriteError<E>),
}

/// Encodes samples as they come, to a writer.
#[derive(Debug)]
pub struct SampleWriter<S, W> {
    encoder: S,
    writer: W,
}

impl<S: StreamEncoder, W: Write> SampleWriter<S, W> {
    /// A new encoder's stream to `writer`.
    pub const fn new(encoder: S, writer: W) -> Self {
        Self { encoder, writer }
    }

    /// Encodes `samples`, x fastest, any number of them, and writes the bytes that are ready. Does not flush.
    ///
    /// # Errors
    /// [`SampleWriteError::Samples`] if one is outside its type: those before are encoded.
    /// [`SampleWriteError::Write`] if the writer gives up: the stream is not whole then.
    pub fn write(&mut self, samples: &[i32]) -> Result<(), SampleWriteError<W::Error>> {
        let mut rest = samples;
        loop {
            let step = self.step(rest)?;
            rest = rest.get(step.consumed..).unwrap_or_default();
            if step.status != Status::NeedOutput && rest.is_empty() {
                return Ok(());
            }
        }
    }

    /// Ends the stream, and returns the writer.
    ///
    /// # Errors
    /// As [`SampleWriter::write`]; [`SampleWriteError::Samples`] also if the last row or slice is not whole.
    pub fn finish(mut self) -> Result<W, SampleWriteError<W::Error>> {
        self.encoder.finish().map_err(SampleWriteError::Samples)?;
        while self.step(&[])?.status != Status::Done {}
        Ok(self.writer)
    }

    /// One step; what it gives is written.
    fn step(&mut self, samples: &[i32]) -> Result<Step, SampleWriteError<W::Error>> {
        let mut bytes = [0; PIECE];
        let step = self.encoder.step(samples, &mut bytes).map_err(SampleWriteError::Samples)?;
        let bytes = bytes.get(..step.produced).unwrap_or_default();
        write(bytes, &mut self.writer).map_err(SampleWriteError::Write)?;
        Ok(step)
    }
}

/// Decodes samples as they are asked for, from a reader.
///
/// It reads byte by byte, so that the next byte of the reader is the one after the stream; a reader to which a call is
/// dear wants a buffer.
#[derive(Debug)]
pub struct SampleReader<S, R> {
    decoder: S,
    reader: R,
    is_done: bool,
}

impl<S: StreamDecoder, R: Read> SampleReader<S, R> {
    /// A new decoder's stream from `reader`, whose header is read.
    pub const fn new(decoder: S, reader: R) -> Self {
        Self { decoder, reader, is_done: false }
    }

    /// Fills `samples` and returns how many there were: fewer than it holds only at the end of the stream.
    ///
    /// # Errors
    /// [`ReadError::Decode`] if the stream is wrong or the reader ends early ([`DecodeError::Truncated`]),
    /// [`ReadError::Io`] if the reader fails.
    pub fn read(&mut self, samples: &mut [i32]) -> Result<usize, ReadError<R::Error>> {
        let (mut byte, mut waiting, mut filled) = ([0], 0, 0_usize);
        while !self.is_done && filled < samples.len() {
            let input = byte.get(..waiting).unwrap_or_default();
            let output = samples.get_mut(filled..).unwrap_or_default();
            let step = self.decoder.step(input, output).map_err(ReadError::Decode)?;
            filled = filled.saturating_add(step.produced);
            waiting = waiting.saturating_sub(step.consumed);
            match step.status {
                Status::Done => self.is_done = true,
                Status::NeedInput => {
                    fill(&mut self.reader, &mut byte)?;
                    waiting = 1;
                }
                Status::NeedOutput => {}
            }
        }
        Ok(filled)
    }

    /// The reader: where the stream ends, if all of it was read.
    pub fn into_reader(self) -> R {
        self.reader
    }
}

/// Reads the header of a stream of rows, byte by byte, and nothing after it.
///
/// # Errors
/// [`ReadError::Decode`] if it is wrong or the reader ends early, [`ReadError::Io`] if the reader fails.
#[cfg(feature = "stream")]
pub fn read_row_plan<R: Read>(reader: &mut R) -> Result<RowPlan, ReadError<R::Error>> {
    read_header(reader, RowPlan::parse)
}

/// Reads the header of a stream of slabs, byte by byte, and nothing after it.
///
/// # Errors
/// [`ReadError::Decode`] if it is wrong or the reader ends early, [`ReadError::Io`] if the reader fails.
pub fn read_slab_plan<R: Read>(reader: &mut R) -> Result<SlabPlan, ReadError<R::Error>> {
    read_header(reader, SlabPlan::parse)
}

fn read_header<R: Read, P>(
    reader: &mut R,
    parse: impl Fn(&[u8]) -> Result<(P, usize), DecodeError>,
) -> Result<P, ReadError<R::Error>> {
    let mut bytes = [0; SlabPlan::MAX_HEADER_BYTES];
    let mut filled = 0_usize;
    loop {
        match parse(bytes.get(..filled).unwrap_or_default()) {
            Ok((plan, _)) => return Ok(plan),
            Err(DecodeError::Truncated) => {}
            Err(error) => return Err(ReadError::Decode(error)),
        }
        // No header is longer than there is room for.
        let end = filled.saturating_add(1);
        fill(reader, bytes.get_mut(filled..end).unwrap_or_default())?;
        filled = end;
    }
}

impl<E: fmt::Display> fmt::Display for SampleWriteError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Samples(error) => error.fmt(f),
            Self::Write(error) => error.fmt(f),
        }
    }
}

impl<E: fmt::Debug + fmt::Display> core::error::Error for SampleWriteError<E> {}

#[cfg(all(test, feature = "stream"))]
mod tests {
    use super::*;
    use crate::stream::{RowCodec, SlabMemory};
    use crate::{Codec, Effort, Extent, SampleType, Wavelet};

    const ROWS: RowPlan = match RowPlan::new(Wavelet::Linear, 12, 2, SampleType::U8) {
        Ok(plan) => plan,
        Err(_) => panic!(),
    };

    fn hill(i: usize) -> i32 {
        let (x, y) = (i32::try_from(i % 12).unwrap(), i32::try_from(i / 12).unwrap());
        200 - (x - 7).pow(2) - 3 * (y - 4).pow(2)
    }

    #[test]
    fn rows_go_to_a_device_and_come_back() {
        let samples: [i32; 108] = core::array::from_fn(hill);
        let mut device = [0; 200];
        let (mut codec, mut memory) = (RowCodec::NEW, [0; ROWS.encoder_memory_len()]);
        let encoder = RowEncoder::new(&ROWS, &mut codec, &mut memory).unwrap();
        let mut writer = SampleWriter::new(encoder, &mut device[..]);
        for samples in samples.chunks(5) {
            writer.write(samples).unwrap();
        }
        let left = writer.finish().unwrap().len();
        let len = 200 - left;
        let mut reader = &device[..len + 3];
        let plan = read_row_plan(&mut reader).unwrap();
        assert_eq!(plan, ROWS);
        let mut memory = [0; ROWS.decoder_memory_len()];
        let decoder = RowDecoder::new(&plan, &mut codec, &mut memory).unwrap();
        let mut reader = SampleReader::new(decoder, reader);
        let mut back = [0; 120];
        for back in back.chunks_mut(40) {
            reader.read(back).unwrap();
        }
        assert_eq!(back[..108], samples);
        assert_eq!(reader.read(&mut back).unwrap(), 0);
        assert_eq!(reader.into_reader().len(), 3, "what follows is not read");
        for len in 0..len {
            let mut reader = &device[..len];
            let truncated = ReadError::Decode(DecodeError::Truncated);
            let Ok(plan) = read_row_plan(&mut reader) else { continue };
            let decoder = RowDecoder::new(&plan, &mut codec, &mut memory).unwrap();
            assert_eq!(SampleReader::new(decoder, reader).read(&mut back), Err(truncated));
        }
    }

    #[test]
    fn samples_that_are_refused_and_a_device_that_is_full() {
        let (mut codec, mut memory, mut device) = (RowCodec::NEW, [0; ROWS.encoder_memory_len()], [0; 4]);
        let encoder = RowEncoder::new(&ROWS, &mut codec, &mut memory).unwrap();
        let mut writer = SampleWriter::new(encoder, &mut device[..]);
        let full = SampleWriteError::Write(WriteError::Io(embedded_io::SliceWriteError::Full));
        assert_eq!(writer.write(&[1]), Err(full));
        let mut device = [0; 100];
        let encoder = RowEncoder::new(&ROWS, &mut codec, &mut memory).unwrap();
        let mut writer = SampleWriter::new(encoder, &mut device[..]);
        let outside = SampleWriteError::Samples(RowError::SampleOutOfRange { index: 0 });
        assert_eq!(writer.write(&[1, 256]), Err(outside));
        let unfinished = SampleWriteError::Samples(RowError::UnfinishedRow { missing: 11 });
        assert_eq!(writer.finish().map(|_| ()), Err(unfinished));
    }

    #[test]
    fn slabs_go_to_a_device_and_come_back() {
        let plan = SlabPlan::new(Wavelet::Haar, Extent::brick(3, 2, 2).unwrap(), 1, SampleType::U8).unwrap();
        let samples: [i32; 18] = core::array::from_fn(hill);
        let (mut lent, mut scratch, mut bytes, mut device) = ([0; 12], [0; 64], [0; 64], [0; 100]);
        let mut codec = Codec::NEW;
        let memory = SlabMemory { samples: &mut lent, scratch: &mut scratch, bytes: &mut bytes };
        let encoder = SlabEncoder::new(&plan, &mut codec, Effort::Fast, memory).unwrap();
        let mut writer = SampleWriter::new(encoder, &mut device[..]);
        writer.write(&samples).unwrap();
        let left = writer.finish().unwrap().len();
        let mut reader = &device[..100 - left];
        assert_eq!(read_slab_plan(&mut reader), Ok(plan));
        let memory = SlabMemory { samples: &mut lent, scratch: &mut scratch, bytes: &mut bytes };
        let mut reader = SampleReader::new(SlabDecoder::new(&plan, &mut codec, memory).unwrap(), reader);
        let mut back = [0; 30];
        assert_eq!(reader.read(&mut back), Ok(18));
        assert_eq!(back[..18], samples);
    }
}
