//! PNG files, each of which is one slice. Samples and ancillary chunks are kept as they are.
//!
//! Source: *Portable Network Graphics (PNG) Specification*, third edition, W3C. Grey samples of 1, 2 and 4 bits are
//! not scaled; colours of a palette are looked up.

mod chunks;

use std::io;
use std::path::{Path, PathBuf};

use ::png::{BitDepth, ColorType, Decoder, DecodingError, Encoder, EncodingError, Limits, Transformations};

use super::element::reorder;
use super::format::{Format, has_extension};
use super::input::Input;
use super::planes::{PlaneSink, PlaneSource, PlaneWriter, Planes};
use super::{
    ByteOrder, Created, ElementType, FileFormat, Found, Header, HeaderLine, Metadata, ReadError, Source,
    WriteError, WriteOptions, losses,
};
use crate::atomic::AtomicFile;

/// First bytes of every file.
const MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Key of the bits of a sample, where they are fewer than 8.
const BITS: &str = "png.bits";

/// Most bytes that the decoder takes beside a plane.
const DECODER_BYTES: usize = 1 << 26;

/// Most bytes that one byte of a file can stand for (RFC 1951), when each stands for 8 samples of one bit.
const EXPANSION: u64 = 8 * 1032;

/// What keeps a file from being read as a slice.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PngError {
    /// The decoder's verdict.
    #[error("{0}")]
    Decode(DecodingError),
    /// Several pictures.
    #[error("an animation of {frames} frames, which is not read: take it apart into one file a frame")]
    Animation {
        /// Number of frames.
        frames: u32,
    },
    /// A chunk that goes beyond the end of the file, or is longer than any that is kept.
    #[error("the chunk {name:?} has {bytes} bytes, which cannot be")]
    Chunk {
        /// Its type.
        name: String,
        /// Its length.
        bytes: u32,
    },
}

/// Portable Network Graphics.
pub(super) struct Png;

impl Format for Png {
    fn format(&self) -> FileFormat {
        FileFormat::Png
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(path, &["png"])
    }

    fn begins(&self, first: &[u8]) -> bool {
        first.starts_with(MAGIC)
    }

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        open(input)
    }

    fn create(&self, path: &Path, header: &Header, _: &WriteOptions) -> Result<Created, WriteError> {
        create(path, header)
    }
}

/// How samples lie in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Layout {
    width: u32,
    height: u32,
    components: u32,
    /// Bits of a value.
    bits: u8,
    has_palette: bool,
}

impl Layout {
    const fn element(self) -> ElementType {
        if self.bits == 16 { ElementType::U16 } else { ElementType::U8 }
    }
}

fn decoder(input: &mut Input) -> Decoder<&mut Input> {
    Decoder::new_with_limits(input, Limits { bytes: DECODER_BYTES })
}

fn open(mut input: Input) -> Result<Box<dyn Source>, ReadError> {
    let path = input.path().to_owned();
    let layout = layout(&mut input)?;
    let mut metadata = Metadata::plain(2, FileFormat::Png);
    if layout.bits == 16 {
        metadata.source.byte_order = ByteOrder::Big;
    }
    if layout.bits < 8 && !layout.has_palette {
        metadata.lines.push(pair(BITS, layout.bits.to_string()));
    }
    input.seek(MAGIC.len() as u64)?;
    metadata.lines.extend(chunks::read(&mut input, layout.has_palette)?);
    let extent = [layout.width.into(), layout.height.into(), 1];
    let header =
        Header { components: layout.components, ..Header::scalar(extent, layout.element(), metadata) };
    let bytes = header.bytes().ok_or(ReadError::TooLarge { path: path.clone(), bytes: u64::MAX })?;
    let most = input.left().map(|left| (input.position() + left).saturating_mul(EXPANSION));
    if let Some(most) = most.filter(|most| *most < bytes) {
        return Err(ReadError::SampleBytes { path, expected: bytes, found: Found::AtMost(most) });
    }
    Ok(Box::new(PlaneSource::new(&path, header, Picture { input, layout })?))
}

fn layout(input: &mut Input) -> Result<Layout, ReadError> {
    let path = input.path().to_owned();
    let mut decoder = decoder(input);
    decoder.set_transformations(Transformations::EXPAND);
    let reader = decoder.read_info().map_err(|error| decoding(&path, error))?;
    let info = reader.info();
    if let Some(frames) =
        info.animation_control.map(|control| control.num_frames).filter(|frames| *frames > 1)
    {
        return Err(fault(&path, PngError::Animation { frames }));
    }
    let has_palette = info.color_type == ColorType::Indexed;
    let color = if has_palette { reader.output_color_type().0 } else { info.color_type };
    let bits = if has_palette { BitDepth::Eight } else { info.bit_depth };
    let components = color.samples() as u32;
    Ok(Layout { width: info.width, height: info.height, components, bits: bits as u8, has_palette })
}

fn fault(path: &Path, cause: PngError) -> ReadError {
    ReadError::Format { path: path.to_owned(), format: FileFormat::Png, cause: Box::new(cause) }
}

fn decoding(path: &Path, error: DecodingError) -> ReadError {
    match error {
        DecodingError::IoError(cause) if cause.raw_os_error().is_some() => {
            ReadError::Io { path: path.to_owned(), cause }
        }
        error => fault(path, PngError::Decode(error)),
    }
}

/// The picture in a file.
struct Picture {
    input: Input,
    layout: Layout,
}

impl Planes for Picture {
    fn read(&mut self, _: u64, out: &mut [u8]) -> Result<(), ReadError> {
        self.input.seek(0)?;
        let path = self.input.path().to_owned();
        let layout = self.layout;
        let mut decoder = decoder(&mut self.input);
        if layout.has_palette {
            decoder.set_transformations(Transformations::EXPAND);
        }
        let decode = || {
            let mut reader = decoder.read_info()?;
            if layout.bits >= 8 {
                return reader.next_frame(out).map(|_| ());
            }
            let mut packed = vec![0; reader.output_buffer_size().unwrap_or(0)];
            reader.next_frame(&mut packed)?;
            unpack(&packed, out, layout);
            Ok(())
        };
        decode().map_err(|error| decoding(&path, error))?;
        reorder(out, layout.element(), ByteOrder::Big);
        Ok(())
    }
}

/// Takes samples of few bits, the first in the upper bits of its byte, apart.
fn unpack(packed: &[u8], out: &mut [u8], layout: Layout) {
    let (width, bits) = (layout.width as usize, usize::from(layout.bits));
    let row_bytes = (width * bits).div_ceil(8);
    let mask = (1 << bits) - 1;
    for (row, values) in packed.chunks(row_bytes).zip(out.chunks_mut(width)) {
        for (x, value) in values.iter_mut().enumerate() {
            *value = row[x * bits / 8] >> (8 - bits - x * bits % 8) & mask;
        }
    }
}

/// Puts samples of few bits together.
fn pack(values: &[u8], width: usize, bits: u8) -> Vec<u8> {
    let bits = usize::from(bits);
    let rows = values.chunks(width).flat_map(|row| {
        row.chunks(8 / bits).map(move |group| {
            let placed = group.iter().enumerate().map(|(place, value)| value << (8 - bits * (place + 1)));
            placed.fold(0, |byte, value| byte | value)
        })
    });
    rows.collect()
}

fn pair(key: &str, value: String) -> HeaderLine {
    HeaderLine::KeyValue { key: key.to_owned(), value }
}

fn create(path: &Path, header: &Header) -> Result<Created, WriteError> {
    let cannot = |what| WriteError::CannotHold { path: path.to_owned(), format: FileFormat::Png, what };
    if !matches!(header.element, ElementType::U8 | ElementType::U16) {
        return Err(cannot(format!("{}, only u8 and u16: write .tif or .nrrd", header.element)));
    }
    let color = match header.components {
        1 => ColorType::Grayscale,
        2 => ColorType::GrayscaleAlpha,
        3 => ColorType::Rgb,
        4 => ColorType::Rgba,
        count => return Err(cannot(format!("{count} components, only 1 to 4: write .tif or .nrrd"))),
    };
    if header.extent[2] > 1 || header.steps > 1 {
        return Err(cannot(
            "more than one slice: write a file for each, as in \"slice_%04d.png\"".to_owned(),
        ));
    }
    let [x, y, _] = header.extent.map(|axis| u32::try_from(axis).ok().filter(|axis| *axis < 1 << 31));
    let (Some(width), Some(height)) = (x, y) else {
        return Err(cannot("2^31 samples along an axis: write .nrrd".to_owned()));
    };
    let (chunks, left) = chunks::of(&header.metadata);
    let bits = header.metadata.key_value(BITS).and_then(|text| text.parse().ok());
    let bits = bits.filter(|bits| matches!(bits, 1 | 2 | 4) && color == ColorType::Grayscale);
    let bits = if header.element == ElementType::U8 { bits.unwrap_or(8) } else { 16 };
    let file = AtomicFile::create(path).map_err(|cause| WriteError::Io { path: path.to_owned(), cause })?;
    let writer = Writer { file, path: path.to_owned(), width, height, color, bits, chunks };
    Ok(Created { sink: Box::new(PlaneSink::new(path, header, Box::new(writer))), losses: losses(&left) })
}

/// A file that is being written.
struct Writer {
    file: AtomicFile,
    path: PathBuf,
    width: u32,
    height: u32,
    color: ColorType,
    bits: u8,
    chunks: Vec<chunks::Chunk>,
}

impl PlaneWriter for Writer {
    fn write(&mut self, plane: &[u8]) -> Result<(), WriteError> {
        // Samples may have grown since, in a decoder that is allowed an error.
        let fits = self.bits >= 8 || plane.iter().all(|value| value >> self.bits == 0);
        let bits = if fits { self.bits } else { 8 };
        let samples = match bits {
            8 => plane.to_vec(),
            16 => {
                let mut samples = plane.to_vec();
                reorder(&mut samples, ElementType::U16, ByteOrder::Big);
                samples
            }
            _ => pack(plane, self.width as usize, bits),
        };
        self.encode(&samples, bits).map_err(|error| {
            let cause = match error {
                EncodingError::IoError(cause) => cause,
                other => io::Error::other(other.to_string()),
            };
            WriteError::Io { path: self.path.clone(), cause }
        })
    }

    fn finish(self: Box<Self>) -> Result<(), WriteError> {
        let Self { file, path, .. } = *self;
        file.commit().map_err(|cause| WriteError::Io { path, cause })
    }
}

impl Writer {
    fn encode(&mut self, samples: &[u8], bits: u8) -> Result<(), EncodingError> {
        let mut encoder = Encoder::new(&mut self.file, self.width, self.height);
        encoder.set_color(self.color);
        encoder.set_depth(BitDepth::from_u8(bits).unwrap_or(BitDepth::Eight));
        let mut writer = encoder.write_header()?;
        for chunk in &self.chunks {
            writer.write_chunk(::png::chunk::ChunkType(chunk.name), &chunk.data)?;
        }
        writer.write_image_data(samples)?;
        writer.finish()
    }
}

#[cfg(test)]
mod tests;
