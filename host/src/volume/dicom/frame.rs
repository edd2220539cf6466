//! Frames: how their pixels are stored, and the values that they stand for.

use std::io::Read;

use super::DicomError;
use super::dataset::{DataSet, Packing, Pixels};
use crate::volume::element::reorder;
use crate::volume::input::Input;
use crate::volume::packbits::unpack_bits;
use crate::volume::raster::Raster;
use crate::volume::{ByteOrder, ElementType};
use crate::volume::{jpeg, jpeg2000};

pub(super) const SAMPLES: u32 = 0x0028_0002;
pub(super) const PHOTOMETRIC: u32 = 0x0028_0004;
pub(super) const PLANAR: u32 = 0x0028_0006;
pub(super) const FRAMES: u32 = 0x0028_0008;
pub(super) const ROWS: u32 = 0x0028_0010;
pub(super) const COLUMNS: u32 = 0x0028_0011;
pub(super) const ALLOCATED: u32 = 0x0028_0100;
pub(super) const STORED: u32 = 0x0028_0101;
pub(super) const HIGH_BIT: u32 = 0x0028_0102;
pub(super) const SIGNED: u32 = 0x0028_0103;

/// How the frames of a file are stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) columns: u16,
    pub(super) rows: u16,
    pub(super) samples: u16,
    pub(super) frames: u64,
    pub(super) element: ElementType,
    /// Whether the values of a sample lie apart.
    is_planar: bool,
    /// Bits that count, and the highest of them.
    stored: u32,
    high_bit: u32,
    pub(super) byte_order: ByteOrder,
    /// Bytes that lie in words of the other order.
    is_swapped: bool,
    packing: Packing,
    /// Whether eight values share a byte, the first in its lowest bit, and frames follow each other within bytes.
    is_bits: bool,
    /// Whether colours are red, green and blue.
    is_rgb: bool,
    /// Whether two pixels share their differences of colour: two brightnesses, then one of each.
    is_halved: bool,
    /// Whether the file is deflated.
    pub(super) is_deflated: bool,
    pixels: Pixels,
}

impl Layout {
    pub(super) fn of(set: &DataSet) -> Result<Self, DicomError> {
        let number =
            |tag, what| set.number(tag).filter(|number| *number > 0).ok_or(DicomError::Damaged { what });
        let [columns, rows] =
            [number(COLUMNS, "the number of columns")?, number(ROWS, "the number of rows")?];
        let samples = set.number(SAMPLES).unwrap_or(1);
        let frames = set.text(FRAMES).map_or(Some(1), |text| text.parse().ok()).filter(|frames| *frames > 0);
        let frames: u64 = frames.ok_or(DicomError::Damaged { what: "the number of frames" })?;
        if !matches!(samples, 1 | 3 | 4) {
            return Err(DicomError::Pixels { what: format!("{samples} values a sample") });
        }
        let allocated = u32::from(number(ALLOCATED, "the number of bits")?);
        let is_signed = set.number(SIGNED) == Some(1);
        let float_bits = match set.pixels {
            Pixels::Native { float_bits, .. } => float_bits,
            Pixels::Frames(_) => 0,
        };
        let element = match (float_bits, allocated, is_signed) {
            (32, 32, _) => ElementType::F32,
            (64, 64, _) => ElementType::F64,
            (0, 1 | 8, false) => ElementType::U8,
            (0, 8, true) => ElementType::I8,
            (0, 16, false) => ElementType::U16,
            (0, 16, true) => ElementType::I16,
            (0, 32, false) => ElementType::U32,
            (0, 32, true) => ElementType::I32,
            _ => return Err(DicomError::Pixels { what: format!("{allocated} bits") }),
        };
        let stored = set.number(STORED).map_or(allocated, u32::from);
        let high_bit = set.number(HIGH_BIT).map_or(stored.wrapping_sub(1), u32::from);
        if float_bits == 0 && (stored == 0 || stored > high_bit + 1 || high_bit >= allocated) {
            return Err(DicomError::Damaged { what: "the number of bits" });
        }
        let [stored, high_bit] =
            if float_bits == 0 { [stored, high_bit] } else { [allocated, allocated - 1] };
        let byte_order = set.syntax.byte_order;
        let is_native = matches!(set.pixels, Pixels::Native { .. });
        let is_words = matches!(set.pixels, Pixels::Native { vr, .. } if &vr == b"OW");
        let is_bits = allocated == 1;
        let layout = Self {
            columns,
            rows,
            samples,
            frames,
            element,
            is_planar: samples > 1 && set.number(PLANAR) == Some(1),
            stored,
            high_bit,
            byte_order,
            packing: set.syntax.packing,
            is_bits,
            is_rgb: set.text(PHOTOMETRIC).is_some_and(|name| name == "RGB"),
            is_halved: is_native && set.text(PHOTOMETRIC).is_some_and(|name| name.ends_with("_422")),
            is_deflated: set.syntax.is_deflated,
            is_swapped: byte_order == ByteOrder::Big && allocated == 8 && is_words,
            pixels: set.pixels.clone(),
        };
        layout.check()?;
        Ok(layout)
    }

    /// Bytes of a frame.
    fn bytes(&self) -> u64 {
        u64::from(self.columns) * u64::from(self.rows) * u64::from(self.samples) * self.element.bytes() as u64
    }

    /// What colours mean where it is something else than the file says: those of JPEG are decoded, and those that two
    /// pixels share are given to both.
    pub(super) const fn meaning(&self) -> Option<&'static str> {
        match self.packing {
            Packing::Jpeg | Packing::Jpeg2000 if self.samples == 3 => Some("RGB"),
            _ if self.is_halved => Some("YBR_FULL"),
            _ => None,
        }
    }

    /// Bytes that it is stored in, if it is not compressed.
    fn stored_bytes(&self) -> u64 {
        if self.is_halved { self.bytes() / 3 * 2 } else { self.bytes() }
    }

    /// Whether pixels are as many as frames need, as far as lengths tell.
    fn check(&self) -> Result<(), DicomError> {
        if self.is_halved
            && (self.samples != 3 || self.element.bytes() != 1 || !self.columns.is_multiple_of(2))
        {
            return Err(DicomError::Pixels {
                what: "colours that pixels share, but no pairs of bytes".to_owned(),
            });
        }
        let values = self.stored_bytes().saturating_mul(self.frames);
        let expected = if self.is_bits { values.div_ceil(8) } else { values };
        match &self.pixels {
            // A byte may follow to make the length even.
            Pixels::Native { bytes, .. } if *bytes < expected || *bytes > expected.saturating_add(1) => {
                Err(DicomError::PixelBytes { found: *bytes, expected })
            }
            Pixels::Native { .. } if self.packing == Packing::None => Ok(()),
            Pixels::Frames(frames) if self.packing != Packing::None && !self.is_bits => {
                // A single frame of JPEG may come in several parts.
                let is_jpeg = matches!(self.packing, Packing::Jpeg | Packing::Jpeg2000);
                let is_in_parts = is_jpeg && self.frames == 1 && !frames.is_empty();
                match frames.len() as u64 == self.frames || is_in_parts {
                    true => Ok(()),
                    false => Err(DicomError::Frames { found: frames.len() as u64, expected: self.frames }),
                }
            }
            _ => Err(DicomError::Damaged { what: "the transfer syntax" }),
        }
    }

    /// What two files of a volume have to have in common, in words.
    pub(super) fn shape(&self) -> String {
        format!("{}x{} {} of {} components", self.columns, self.rows, self.element, self.samples)
    }

    /// Fills `out` with a frame.
    pub(super) fn read(&self, input: &mut Input, frame: u64, out: &mut [u8]) -> Result<(), DicomError> {
        let damaged = || DicomError::Damaged { what: "a frame" };
        match &self.pixels {
            Pixels::Native { start, .. } if self.is_bits => {
                let first = frame * self.bytes();
                let end = first + out.len() as u64;
                input.seek(start + first / 8).map_err(|_| damaged())?;
                let mut stored = vec![0; (end.div_ceil(8) - first / 8) as usize];
                input.read_exact(&mut stored).map_err(|_| damaged())?;
                let bits = stored.iter().flat_map(|byte| (0..8).map(move |bit| byte >> bit & 1));
                out.iter_mut().zip(bits.skip((first % 8) as usize)).for_each(|(value, bit)| *value = bit);
                return Ok(());
            }
            Pixels::Native { start, .. } => {
                let at = start + frame * self.stored_bytes();
                // Words of two bytes may begin in the frame before.
                let odd = if self.is_swapped { (at - start) & 1 } else { 0 };
                input.seek(at - odd).map_err(|_| damaged())?;
                let mut stored = vec![0; (self.stored_bytes() + odd) as usize];
                input.read_exact(&mut stored).map_err(|_| damaged())?;
                if self.is_swapped {
                    if stored.len() % 2 == 1 {
                        let mut last = [0];
                        let _end_of_file = input.read(&mut last).map_err(|_| damaged())?;
                        stored.push(last[0]);
                    }
                    stored.as_chunks_mut::<2>().0.iter_mut().for_each(|word| word.reverse());
                }
                let stored = &stored[odd as usize..][..self.stored_bytes() as usize];
                if self.is_halved {
                    spread(stored, out);
                    return Ok(());
                }
                out.copy_from_slice(stored);
                reorder(out, self.element, self.byte_order);
                if self.is_planar {
                    self.put_together(out);
                }
            }
            Pixels::Frames(frames) => {
                let parts = match frames.len() as u64 == self.frames {
                    true => frames.get(frame as usize..=frame as usize).ok_or_else(damaged)?,
                    false => &frames[..],
                };
                let mut stored = Vec::new();
                for &(start, bytes) in parts {
                    input.seek(start).map_err(|_| damaged())?;
                    input.take(bytes).read_to_end(&mut stored).map_err(|_| damaged())?;
                }
                match self.packing {
                    Packing::Jpeg | Packing::Jpeg2000 => out.copy_from_slice(&self.decode(&stored)?),
                    _ => self.unpack(&stored, out).ok_or_else(damaged)?,
                }
            }
        }
        self.clear(out);
        Ok(())
    }

    /// Values of a sample that lie apart, side by side.
    fn put_together(&self, out: &mut [u8]) {
        let (bytes, samples) = (self.element.bytes(), usize::from(self.samples));
        let apart = out.to_vec();
        for (plane, values) in apart.chunks(apart.len() / samples).enumerate() {
            for (sample, value) in out.chunks_mut(bytes * samples).zip(values.chunks(bytes)) {
                sample[plane * bytes..][..bytes].copy_from_slice(value);
            }
        }
    }

    /// A frame that is a picture itself.
    fn decode(&self, stored: &[u8]) -> Result<Vec<u8>, DicomError> {
        let raster = Raster {
            width: self.columns.into(),
            height: self.rows.into(),
            components: self.samples.into(),
            bytes: self.element.bytes(),
        };
        let decoded = match self.packing {
            Packing::Jpeg2000 => jpeg2000::decode(stored, raster),
            _ => jpeg::decode(stored, raster, Some(self.is_rgb)),
        };
        decoded.map_err(|cause| DicomError::Jpeg { cause })
    }

    /// A frame of run lengths: a segment for each byte of a value, the most significant one first.
    fn unpack(&self, stored: &[u8], out: &mut [u8]) -> Option<()> {
        let (head, _) = stored.split_first_chunk::<64>()?;
        let numbers = head.as_chunks::<4>().0;
        let bytes = self.element.bytes();
        let sample = bytes * usize::from(self.samples);
        if u32::from_le_bytes(numbers[0]) as usize != sample {
            return None;
        }
        for segment in 0..sample {
            let start = u32::from_le_bytes(*numbers.get(segment + 1)?) as usize;
            let plane = unpack_bits(stored.get(start..)?, out.len() / sample)?;
            let at = segment / bytes * bytes + (bytes - 1 - segment % bytes);
            out.chunks_mut(sample).zip(plane).for_each(|(value, byte)| value[at] = byte);
        }
        Some(())
    }

    /// Leaves of each value the bits that count, which other bits may share a word with.
    fn clear(&self, out: &mut [u8]) {
        let bytes = self.element.bytes();
        let bits = bytes as u32 * 8;
        if self.stored == bits || self.element.is_float() {
            return;
        }
        for value in out.chunks_mut(bytes) {
            let word = value.iter().rev().fold(0, |word: u64, byte| word << 8 | u64::from(*byte));
            let top = word << (63 - self.high_bit);
            let right = 64 - self.stored;
            let number = if self.element.is_signed_integer() {
                (top.cast_signed() >> right).cast_unsigned()
            } else {
                top >> right
            };
            value.copy_from_slice(&number.to_le_bytes()[..bytes]);
        }
    }
}

/// Gives each of two pixels the differences of colour that they share (PS3.3, C.7.6.3.1.2, YBR_FULL_422).
fn spread(stored: &[u8], out: &mut [u8]) {
    for (pair, two) in stored.as_chunks::<4>().0.iter().zip(out.as_chunks_mut::<6>().0) {
        let [first, second, blue, red] = *pair;
        *two = [first, blue, red, second, blue, red];
    }
}
