//! Directories: where the samples of a page lie, and what they are.

use std::collections::HashSet;
use std::io::Read;
use std::path::{Path, PathBuf};

use ::tiff::Directory;
use ::tiff::decoder::ifd::Value;
use ::tiff::decoder::{Decoder, Limits};
use ::tiff::tags::{ByteOrder as CrateByteOrder, IfdPointer, Tag, Type, ValueBuffer};

use super::TiffError;
use super::chunk::{Chunk, Compression};
use crate::volume::input::Input;
use crate::volume::{ByteOrder, ElementType};

/// Bytes of one value of a directory that are read at most; no more than the file has either way.
const VALUE_BYTES: u64 = 1 << 26;

/// PhotometricInterpretation of red, green and blue.
const RGB: u16 = 2;

/// PhotometricInterpretation of brightness and two differences.
const YCBCR: u16 = 6;

/// A page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Page {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Values of a sample.
    pub(super) samples: u16,
    /// Bits of a value in the file.
    pub(super) bits: u16,
    /// Type of a value in memory: the smallest unsigned one for bits that make no bytes.
    pub(super) element: ElementType,
    pub(super) photometric: u16,
    /// Whether colours are stored as red, green and blue.
    is_rgb: bool,
    /// Whether each value of a sample has chunks of its own.
    is_planar: bool,
    pub(super) compression: Compression,
    /// Tables of JPEG that all chunks share.
    tables: Vec<u8>,
    predictor: u16,
    /// Samples along x and y of a strip or tile, and whether the last ones are as large as the others.
    chunk: [u32; 2],
    is_tiled: bool,
    offsets: Vec<u64>,
    counts: Vec<u64>,
}

impl Page {
    /// Bytes of the samples in memory.
    pub(super) fn bytes(&self) -> u64 {
        let samples = u64::from(self.width) * u64::from(self.height);
        samples.saturating_mul(u64::from(self.samples) * self.element.bytes() as u64)
    }

    fn shape(&self) -> String {
        let [width, height] = [self.width, self.height];
        format!("{width}x{height} {} of {} bits and {} components", self.element, self.bits, self.samples)
    }

    /// Values of a sample that lie together in a chunk.
    const fn together(&self) -> u16 {
        if self.is_planar { 1 } else { self.samples }
    }

    /// Chunks along x and y.
    fn chunks(&self) -> [u32; 2] {
        [self.width.div_ceil(self.chunk[0]), self.height.div_ceil(self.chunk[1])]
    }

    /// Rows in the file of a chunk that begins at row `y`.
    fn rows(&self, y: u32) -> u32 {
        if self.is_tiled { self.chunk[1] } else { self.chunk[1].min(self.height - y) }
    }

    /// Where the page is the first of many that lie one after another: page `index` of those.
    fn following(&self, index: u64) -> Self {
        let bytes = self.counts.iter().fold(0, |sum: u64, count| sum.saturating_add(*count));
        let offsets = self.offsets.iter().map(|offset| offset.saturating_add(bytes.saturating_mul(index)));
        Self { offsets: offsets.collect(), ..self.clone() }
    }
}

/// Pages that are a smaller picture of another one, or the mask of one (NewSubfileType, bits 0 and 2).
const SUBORDINATE: u64 = 1 | 4;

/// The pages of a file, but for smaller pictures of them, and masks.
pub(super) struct Pages {
    decoder: Decoder<Input>,
    directories: Vec<IfdPointer>,
    /// Number of pages that are left out.
    pub(super) left_out: usize,
    path: PathBuf,
    file_bytes: u64,
    /// The page that was looked at last.
    held: Option<(usize, Page)>,
}

impl Pages {
    /// Finds all pages, which have to be alike.
    pub(super) fn open(input: Input) -> Result<Self, TiffError> {
        let path = input.path().to_owned();
        let file_bytes = input.left().unwrap_or(u64::MAX);
        let mut limits = Limits::default();
        limits.ifd_value_size = file_bytes.min(VALUE_BYTES) as usize;
        let mut decoder = Decoder::new(input).map_err(TiffError::Directory)?.with_limits(limits);
        let mut directories = Vec::new();
        let mut seen = HashSet::new();
        let mut next = decoder.ifd_pointer();
        while let Some(pointer) = next {
            if !seen.insert(pointer.0) {
                return Err(TiffError::Cycle);
            }
            let directory = decoder.read_directory(pointer).map_err(TiffError::Directory)?;
            next = directory.next();
            let mut tags = Tags { decoder: &mut decoder, directory: &directory, page: seen.len() };
            let is_subordinate = tags.number(Tag::NewSubfileType, 0)? & SUBORDINATE != 0;
            if !is_subordinate || directories.is_empty() {
                directories.push(pointer);
            }
        }
        let left_out = seen.len() - directories.len();
        let mut pages = Self { decoder, directories, left_out, path, file_bytes, held: None };
        let first = pages.page(0)?;
        for index in 1..pages.directories.len() {
            let [found, expected] = [pages.page(index)?.shape(), first.shape()];
            if found != expected {
                return Err(TiffError::Differs { page: index + 1, found, expected });
            }
        }
        Ok(pages)
    }

    pub(super) fn count(&self) -> u64 {
        self.directories.len() as u64
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn byte_order(&self) -> ByteOrder {
        match self.decoder.byte_order() {
            CrateByteOrder::LittleEndian => ByteOrder::Little,
            CrateByteOrder::BigEndian => ByteOrder::Big,
        }
    }

    /// Page `index`, counted from 0.
    pub(super) fn page(&mut self, index: usize) -> Result<Page, TiffError> {
        if let Some((held, page)) = &self.held
            && *held == index
        {
            return Ok(page.clone());
        }
        let pointer = *self.directories.get(index).ok_or(TiffError::Damaged { page: index + 1 })?;
        let directory = self.decoder.read_directory(pointer).map_err(TiffError::Directory)?;
        let page = self.parse(&directory, index + 1)?;
        self.held = Some((index, page.clone()));
        Ok(page)
    }

    fn parse(&mut self, directory: &Directory, page_number: usize) -> Result<Page, TiffError> {
        let mut tags = Tags { decoder: &mut self.decoder, directory, page: page_number };
        let positive = |value: u64| u32::try_from(value).ok().filter(|value| (1..1 << 31).contains(value));
        let width = positive(tags.number(Tag::ImageWidth, 0)?).ok_or(tags.missing("ImageWidth"))?;
        let height = positive(tags.number(Tag::ImageLength, 0)?).ok_or(tags.missing("ImageLength"))?;
        let samples = tags.number(Tag::SamplesPerPixel, 1)?;
        let samples = u16::try_from(samples).ok().filter(|samples| *samples > 0);
        let samples = samples.ok_or(tags.missing("SamplesPerPixel"))?;
        let bits = tags.same(Tag::BitsPerSample, 1)?.ok_or(tags.missing("BitsPerSample"))?;
        let format = tags.same(Tag::SampleFormat, 1)?.ok_or(tags.missing("SampleFormat"))?;
        let element = element(bits, format)?;
        let compression = Compression::of(tags.number(Tag::Compression, 1)? as u16)?;
        if tags.number(Tag::FillOrder, 1)? != 1 {
            return Err(TiffError::Samples { what: "bits in reverse order (FillOrder)".to_owned() });
        }
        let is_tiled = directory.contains(Tag::TileOffsets);
        let chunk = if is_tiled {
            let [x, y] = [tags.number(Tag::TileWidth, 0)?, tags.number(Tag::TileLength, 0)?].map(positive);
            [x.ok_or(tags.missing("TileWidth"))?, y.ok_or(tags.missing("TileLength"))?]
        } else {
            let rows = tags.number(Tag::RowsPerStrip, height.into())?.min(height.into());
            [width, positive(rows).ok_or(tags.missing("RowsPerStrip"))?]
        };
        let [offsets, counts] = match is_tiled {
            true => [Tag::TileOffsets, Tag::TileByteCounts],
            false => [Tag::StripOffsets, Tag::StripByteCounts],
        };
        let photometric = tags.number(Tag::PhotometricInterpretation, 1)? as u16;
        let is_jpeg = compression == Compression::Jpeg;
        let tables = if is_jpeg { tags.numbers(Tag::JPEGTables)? } else { Vec::new() };
        let page = Page {
            width,
            height,
            samples,
            bits: bits as u16,
            element,
            // Colours of JPEG come out as red, green and blue.
            photometric: if is_jpeg && photometric == YCBCR { RGB } else { photometric },
            is_rgb: photometric == RGB,
            is_planar: tags.number(Tag::PlanarConfiguration, 1)? == 2 && samples > 1,
            compression,
            tables: tables.into_iter().map(|byte| byte as u8).collect(),
            predictor: tags.number(Tag::Predictor, 1)? as u16,
            chunk,
            is_tiled,
            offsets: tags.numbers(offsets)?,
            counts: tags.numbers(counts)?,
        };
        let planes = if page.is_planar { u64::from(samples) } else { 1 };
        let needed = page.chunks().into_iter().map(u64::from).product::<u64>().checked_mul(planes);
        if [page.offsets.len(), page.counts.len()].iter().any(|count| Some(*count as u64) != needed) {
            return Err(tags.missing("place of its samples"));
        }
        let stored =
            page.counts.iter().fold(0, |sum: u64, count| sum.saturating_add(*count)).min(self.file_bytes);
        if page.bytes() > stored.saturating_mul(page.compression.expansion()).saturating_mul(8) {
            return Err(TiffError::Damaged { page: page_number });
        }
        Ok(page)
    }

    /// Text of a tag of the first page; Latin-1 where it is no UTF-8.
    pub(super) fn text(&mut self, tag: Tag) -> Option<String> {
        let bytes = self.bytes(tag)?;
        let text = bytes.split(|byte| *byte == 0).next()?.to_vec();
        let text = String::from_utf8(text);
        Some(text.unwrap_or_else(|error| error.as_bytes().iter().map(|&byte| char::from(byte)).collect()))
    }

    /// Numbers of a tag of the first page.
    pub(super) fn numbers(&mut self, tag: Tag) -> Option<Vec<u64>> {
        let directory = self.decoder.read_directory(*self.directories.first()?).ok()?;
        self.decoder.read_directory_tags(&directory).find_tag_unsigned_vec(tag).ok()?
    }

    /// Numerator and denominator of a tag of the first page.
    pub(super) fn ratio(&mut self, tag: Tag) -> Option<(u32, u32)> {
        let directory = self.decoder.read_directory(*self.directories.first()?).ok()?;
        match self.decoder.read_directory_tags(&directory).find_tag(tag).ok()?? {
            Value::Rational(numerator, denominator) => Some((numerator, denominator)),
            _ => None,
        }
    }

    fn bytes(&mut self, tag: Tag) -> Option<Vec<u8>> {
        let directory = self.decoder.read_directory(*self.directories.first()?).ok()?;
        let mut buffer = ValueBuffer::empty(Type::ASCII);
        self.decoder.read_directory_tags(&directory).find_tag_buf(tag, &mut buffer).ok()??;
        Some(buffer.as_bytes().to_vec())
    }

    /// Fills `out` with page `index`, or with what follows the only page, `index` times its length behind it.
    pub(super) fn read(&mut self, index: u64, is_contiguous: bool, out: &mut [u8]) -> Result<(), TiffError> {
        let page = match is_contiguous {
            true => self.page(0)?.following(index),
            false => self.page(index as usize)?,
        };
        let number = index as usize + 1;
        let [across, down] = page.chunks();
        let planes = if page.is_planar { page.samples } else { 1 };
        let mut at = 0;
        for plane in 0..planes {
            for row in 0..down {
                for column in 0..across {
                    let place = [column * page.chunk[0], row * page.chunk[1]];
                    self.read_chunk(&page, at, place, plane, out)
                        .ok_or(TiffError::Damaged { page: number })?;
                    at += 1;
                }
            }
        }
        Ok(())
    }

    /// Puts chunk `index` of a page, which begins at sample `place`, where it belongs in `out`.
    fn read_chunk(
        &mut self,
        page: &Page,
        index: usize,
        place: [u32; 2],
        plane: u16,
        out: &mut [u8],
    ) -> Option<()> {
        let (offset, count) = (page.offsets[index], page.counts[index]);
        if offset.checked_add(count)? > self.file_bytes {
            return None;
        }
        let mut stored = Vec::new();
        let input = self.decoder.inner();
        input.seek(offset).ok()?;
        input.take(count).read_to_end(&mut stored).ok()?;
        let chunk = Chunk {
            width: page.chunk[0] as usize,
            rows: page.rows(place[1]) as usize,
            samples: page.together().into(),
            bits: page.bits.into(),
            element: page.element,
            predictor: page.predictor,
            byte_order: self.byte_order(),
        };
        let values = match page.compression {
            Compression::Jpeg => chunk.decode_jpeg(&page.tables, &stored, page.is_rgb)?,
            Compression::Jpeg2000 => chunk.decode_jpeg2000(&stored)?,
            compression => chunk.decode(compression, &stored)?,
        };
        let bytes = page.element.bytes();
        let (sample, together) = (usize::from(page.samples) * bytes, chunk.samples * bytes);
        let (x, y) = (place[0] as usize, place[1] as usize);
        let width = chunk.width.min(page.width as usize - x);
        for (row, values) in values.chunks(chunk.width * together).enumerate().take(page.height as usize - y)
        {
            let line = &mut out[((y + row) * page.width as usize + x) * sample..][..width * sample];
            if together == sample {
                line.copy_from_slice(&values[..width * sample]);
            } else {
                let at = usize::from(plane) * bytes;
                for (to, from) in line.chunks_mut(sample).zip(values.chunks(bytes)) {
                    to[at..at + bytes].copy_from_slice(from);
                }
            }
        }
        Some(())
    }
}

/// Values of the tags of a directory.
struct Tags<'a> {
    decoder: &'a mut Decoder<Input>,
    directory: &'a Directory,
    page: usize,
}

impl Tags<'_> {
    fn missing(&self, tag: &'static str) -> TiffError {
        TiffError::Tag { page: self.page, tag }
    }

    /// The numbers of a tag, none if it is missing.
    fn numbers(&mut self, tag: Tag) -> Result<Vec<u64>, TiffError> {
        let found = self.decoder.read_directory_tags(self.directory).find_tag_unsigned_vec(tag);
        Ok(found.map_err(TiffError::Directory)?.unwrap_or_default())
    }

    /// The first number of a tag.
    fn number(&mut self, tag: Tag, default: u64) -> Result<u64, TiffError> {
        Ok(self.numbers(tag)?.first().copied().unwrap_or(default))
    }

    /// The number of a tag whose numbers are all the same.
    fn same(&mut self, tag: Tag, default: u64) -> Result<Option<u64>, TiffError> {
        let numbers = self.numbers(tag)?;
        let first = numbers.first().copied().unwrap_or(default);
        Ok(numbers.iter().all(|number| *number == first).then_some(first))
    }
}

/// The type in memory of values of so many bits; the format is unsigned, signed, float, or unknown (1 to 4).
fn element(bits: u64, format: u64) -> Result<ElementType, TiffError> {
    Ok(match (bits, format) {
        (1..=8, 1 | 4) => ElementType::U8,
        (9..=16, 1 | 4) => ElementType::U16,
        (32, 1 | 4) => ElementType::U32,
        (64, 1 | 4) => ElementType::U64,
        (8, 2) => ElementType::I8,
        (16, 2) => ElementType::I16,
        (32, 2) => ElementType::I32,
        (64, 2) => ElementType::I64,
        (16 | 32, 3) => ElementType::F32,
        (64, 3) => ElementType::F64,
        (bits, 2) => return Err(TiffError::Samples { what: format!("signed integers of {bits} bits") }),
        (bits, 3) => return Err(TiffError::Samples { what: format!("floats of {bits} bits") }),
        (bits, 5 | 6) => return Err(TiffError::Samples { what: format!("complex numbers of {bits} bits") }),
        (bits, _) => return Err(TiffError::Samples { what: format!("of {bits} bits") }),
    })
}
