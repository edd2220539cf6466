//! Data elements: what stands before the pixels of a file, and where those are.
//!
//! Source: DICOM PS3.5, sections 7 and A, and PS3.10, section 7. It is read here because readers in crates take the
//! memory that an element promises before its bytes are there, and hold all frames at once.

use std::collections::BTreeMap;
use std::io::{self, BufRead, Read, Seek, SeekFrom};

use flate2::read::DeflateDecoder;

use super::series::{ORIENTATION, RESCALE};
use super::{DicomError, POSITION};
use crate::volume::input::Input;
use crate::volume::{ByteOrder, in_words};

/// Bytes of the values of elements that are kept at most, of one and of all.
const VALUE_BYTES: u64 = 1 << 16;
const ALL_BYTES: u64 = 1 << 22;

/// Sequences within sequences that are followed.
const DEPTH: u32 = 32;

/// A length that is not known beforehand.
pub(super) const UNDEFINED: u32 = u32::MAX;

/// Group and element of a tag, as one number.
pub(super) type Tag = u32;

pub(super) const ITEM: Tag = 0xFFFE_E000;
const ITEM_END: Tag = 0xFFFE_E00D;
pub(super) const SEQUENCE_END: Tag = 0xFFFE_E0DD;
const PIXELS: Tag = 0x7FE0_0010;
const FLOATS: Tag = 0x7FE0_0008;
const DOUBLES: Tag = 0x7FE0_0009;
const TRANSFER_SYNTAX: Tag = 0x0002_0010;
pub(super) const SHARED: Tag = 0x5200_9229;
pub(super) const PER_FRAME: Tag = 0x5200_9230;

/// What may differ from frame to frame, and is kept of each.
const OF_FRAMES: [Tag; 4] = [POSITION, ORIENTATION, RESCALE[0], RESCALE[1]];

/// How the elements behind the first group, and pixels, are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Syntax {
    is_implicit: bool,
    /// Whether all behind the first group is compressed.
    pub(super) is_deflated: bool,
    pub(super) byte_order: ByteOrder,
    pub(super) packing: Packing,
}

/// How pixels are made smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    /// Not at all.
    None,
    /// Run lengths.
    Rle,
    /// Baseline, extended or lossless.
    Jpeg,
    /// Without loss or with.
    Jpeg2000,
}

impl Syntax {
    /// That of the first group.
    const PLAIN: Self = Self {
        is_implicit: false,
        is_deflated: false,
        byte_order: ByteOrder::Little,
        packing: Packing::None,
    };

    fn of(uid: &str) -> Result<Self, DicomError> {
        let plain = Self::PLAIN;
        let name = match uid.strip_prefix("1.2.840.10008.1.2").unwrap_or("?") {
            "" => return Ok(Self { is_implicit: true, ..plain }),
            ".1" => return Ok(plain),
            ".1.99" => return Ok(Self { is_deflated: true, ..plain }),
            ".2" => return Ok(Self { byte_order: ByteOrder::Big, ..plain }),
            ".5" => return Ok(Self { packing: Packing::Rle, ..plain }),
            ".4.50" | ".4.51" | ".4.57" | ".4.70" => return Ok(Self { packing: Packing::Jpeg, ..plain }),
            ".4.90" | ".4.91" => return Ok(Self { packing: Packing::Jpeg2000, ..plain }),
            ".4.80" | ".4.81" => "JPEG-LS",
            ".4.92" | ".4.93" => "JPEG 2000 of several components",
            ".4.201" | ".4.202" | ".4.203" => "High-Throughput JPEG 2000",
            rest if rest.starts_with(".4.11") => "JPEG XL",
            rest if rest.starts_with(".4.10") => "video",
            rest if rest.starts_with(".4.") => "JPEG",
            _ => "unknown",
        };
        Err(DicomError::Syntax { uid: uid.chars().take(64).collect(), name })
    }
}

/// A value, and how it is represented; two blanks where the file does not say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Value {
    pub(super) vr: [u8; 2],
    pub(super) bytes: Vec<u8>,
}

/// Where pixels lie.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Pixels {
    /// One after another from that byte on, as integers or floats of that many bits, 0 for integers.
    Native { start: u64, bytes: u64, vr: [u8; 2], float_bits: u32 },
    /// Each frame in that place, so many bytes long.
    Frames(Vec<(u64, u64)>),
}

/// What a file says, and where its pixels are.
#[derive(Clone, Debug)]
pub(super) struct DataSet {
    pub(super) syntax: Syntax,
    pub(super) elements: BTreeMap<Tag, Value>,
    /// Elements of the functional groups that hold for all frames or the first.
    pub(super) shared: BTreeMap<Tag, Value>,
    /// Some elements of each frame.
    of_frames: BTreeMap<Tag, Vec<Value>>,
    pub(super) pixels: Pixels,
}

impl DataSet {
    /// Reads all that stands before the pixels. Where the file is deflated, `input` becomes one of what it holds, with
    /// each byte at the place that [`Pixels`] says.
    pub(super) fn read(input: &mut Input) -> Result<Self, DicomError> {
        input.seek(128).map_err(|_| DicomError::Magic)?;
        let mut magic = [0; 4];
        if input.read_exact(&mut magic).is_err() || &magic != b"DICM" {
            return Err(DicomError::Magic);
        }
        let syntax = Syntax::PLAIN;
        let mut reader = Reader {
            input,
            syntax,
            set: BTreeMap::new(),
            shared: BTreeMap::new(),
            of_frames: BTreeMap::new(),
            kept: 0,
        };
        reader.meta()?;
        let uid =
            reader.set.get(&TRANSFER_SYNTAX).ok_or(DicomError::Damaged { what: "the transfer syntax" })?;
        reader.syntax = Syntax::of(&text(&uid.bytes))?;
        if reader.syntax.is_deflated {
            *reader.input = inflated(reader.input)?;
        }
        let pixels = reader.elements(None, 0, None)?.ok_or(DicomError::NoPixels)?;
        let Reader { syntax, set, shared, of_frames, .. } = reader;
        Ok(Self { syntax, elements: set, shared, of_frames, pixels })
    }

    /// Value of an element of the file, or of what holds for its frames.
    pub(super) fn value(&self, tag: Tag) -> Option<&Value> {
        self.elements.get(&tag).or_else(|| self.shared.get(&tag))
    }

    /// The value of each of so many frames, if each has one.
    pub(super) fn of_frames(&self, tag: Tag, count: u64) -> Option<&[Value]> {
        self.of_frames.get(&tag).map(Vec::as_slice).filter(|values| values.len() as u64 == count)
    }

    /// An unsigned number of 16 bits.
    pub(super) fn number(&self, tag: Tag) -> Option<u16> {
        let bytes = self.value(tag)?.bytes.first_chunk::<2>()?;
        Some(match self.syntax.byte_order {
            ByteOrder::Little => u16::from_le_bytes(*bytes),
            ByteOrder::Big => u16::from_be_bytes(*bytes),
        })
    }

    pub(super) fn text(&self, tag: Tag) -> Option<String> {
        Some(text(&self.value(tag)?.bytes))
    }

    /// Decimal numbers between backslashes.
    pub(super) fn decimals(&self, tag: Tag) -> Option<Vec<f64>> {
        decimals(self.value(tag)?)
    }
}

/// A temporary file of what comes next, decompressed, from the same place on (PS3.5, A.5).
fn inflated(input: &mut Input) -> Result<Input, DicomError> {
    let unusable = |cause: &io::Error| DicomError::Temporary { cause: in_words(cause) };
    let mut file = tempfile::tempfile().map_err(|cause| unusable(&cause))?;
    let position = input.position();
    let path = input.path().to_owned();
    let copied = file
        .seek(SeekFrom::Start(position))
        .and_then(|_| io::copy(&mut DeflateDecoder::new(input), &mut file));
    copied.and_then(|_| file.rewind()).map_err(|cause| match cause.kind() {
        io::ErrorKind::InvalidInput | io::ErrorKind::InvalidData | io::ErrorKind::UnexpectedEof => {
            DicomError::Damaged { what: "what is deflated" }
        }
        _ => unusable(&cause),
    })?;
    let mut inflated =
        Input::of_file(file, &path).map_err(|_| DicomError::Damaged { what: "what is deflated" })?;
    inflated.seek(position).map_err(|_| DicomError::Damaged { what: "what is deflated" })?;
    Ok(inflated)
}

/// Decimal numbers between backslashes.
pub(super) fn decimals(value: &Value) -> Option<Vec<f64>> {
    let numbers = text(&value.bytes);
    numbers.split('\\').map(|word| word.trim().parse().ok().filter(|value: &f64| value.is_finite())).collect()
}

/// Text without the byte that makes its length even; Latin-1 where it is no UTF-8.
pub(super) fn text(bytes: &[u8]) -> String {
    let text = match str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    };
    text.trim_matches(['\0', ' ']).to_owned()
}

struct Reader<'a> {
    input: &'a mut Input,
    syntax: Syntax,
    set: BTreeMap<Tag, Value>,
    shared: BTreeMap<Tag, Value>,
    of_frames: BTreeMap<Tag, Vec<Value>>,
    kept: u64,
}

impl Reader<'_> {
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], DicomError> {
        let mut bytes = [0; N];
        self.input.read_exact(&mut bytes).map_err(|_| DicomError::Damaged { what: "an element" })?;
        Ok(bytes)
    }

    fn short(&mut self) -> Result<u16, DicomError> {
        let bytes = self.bytes()?;
        Ok(match self.syntax.byte_order {
            ByteOrder::Little => u16::from_le_bytes(bytes),
            ByteOrder::Big => u16::from_be_bytes(bytes),
        })
    }

    fn long(&mut self) -> Result<u32, DicomError> {
        let bytes = self.bytes()?;
        Ok(match self.syntax.byte_order {
            ByteOrder::Little => u32::from_le_bytes(bytes),
            ByteOrder::Big => u32::from_be_bytes(bytes),
        })
    }

    fn tag(&mut self) -> Result<Tag, DicomError> {
        Ok(u32::from(self.short()?) << 16 | u32::from(self.short()?))
    }

    /// Whether another element follows.
    fn has_more(&mut self) -> bool {
        self.input.fill_buf().is_ok_and(|bytes| !bytes.is_empty())
    }

    /// The elements of group 2.
    fn meta(&mut self) -> Result<(), DicomError> {
        loop {
            let start = self.input.position();
            if self.tag()? >> 16 != 2 {
                return self.input.seek(start).map_err(|_| DicomError::Damaged { what: "the first group" });
            }
            self.input.seek(start).map_err(|_| DicomError::Damaged { what: "the first group" })?;
            let tag = self.tag()?;
            let (vr, length) = self.head()?;
            self.value(tag, vr, length, None)?;
        }
    }

    /// Representation and length of an element, which follow its tag.
    fn head(&mut self) -> Result<([u8; 2], u32), DicomError> {
        if self.syntax.is_implicit {
            return Ok((*b"  ", self.long()?));
        }
        let vr = self.bytes::<2>()?;
        let is_long = matches!(
            &vr,
            b"OB"
                | b"OD"
                | b"OF"
                | b"OL"
                | b"OV"
                | b"OW"
                | b"SQ"
                | b"SV"
                | b"UC"
                | b"UN"
                | b"UR"
                | b"UT"
                | b"UV"
        );
        if is_long {
            self.short()?;
            return Ok((vr, self.long()?));
        }
        Ok((vr, self.short()?.into()))
    }

    /// Elements up to byte `end`, or a mark of the end, or the pixels of the file.
    fn elements(
        &mut self,
        end: Option<u64>,
        depth: u32,
        root: Option<Tag>,
    ) -> Result<Option<Pixels>, DicomError> {
        loop {
            let has_more = match end {
                Some(end) => self.input.position() < end,
                None => self.has_more(),
            };
            if !has_more {
                return Ok(None);
            }
            let tag = self.tag()?;
            if tag == ITEM_END || tag == SEQUENCE_END {
                self.long()?;
                return Ok(None);
            }
            let (vr, length) = self.head()?;
            if depth == 0 && matches!(tag, PIXELS | FLOATS | DOUBLES) {
                return self.pixels(tag, vr, length).map(Some);
            }
            if &vr == b"SQ" || length == UNDEFINED {
                self.sequence(tag, vr, length, depth + 1, root)?;
            } else {
                self.value(tag, vr, length, root)?;
            }
        }
    }

    fn sequence(
        &mut self,
        tag: Tag,
        vr: [u8; 2],
        length: u32,
        depth: u32,
        root: Option<Tag>,
    ) -> Result<(), DicomError> {
        if depth > DEPTH {
            return Err(DicomError::Damaged { what: "a sequence" });
        }
        let syntax = self.syntax;
        // Of unknown representation, what is in it is implicit (PS3.5, 6.2.2).
        self.syntax.is_implicit |= &vr == b"UN";
        let root = root.or(Some(tag));
        let end = (length != UNDEFINED).then(|| self.input.position() + u64::from(length));
        while end.is_none_or(|end| self.input.position() < end) {
            let (tag, length) = (self.tag()?, self.long()?);
            match tag {
                SEQUENCE_END => break,
                ITEM => {
                    let end = (length != UNDEFINED).then(|| self.input.position() + u64::from(length));
                    self.elements(end, depth, root)?;
                }
                _ => return Err(DicomError::Damaged { what: "a sequence" }),
            }
        }
        self.syntax = syntax;
        Ok(())
    }

    /// Keeps a value if it is a small one of the file, or one that tells of frames; else passes over it.
    fn value(&mut self, tag: Tag, vr: [u8; 2], length: u32, root: Option<Tag>) -> Result<(), DicomError> {
        let length = u64::from(length);
        let damaged = DicomError::Damaged { what: "an element" };
        if self.input.left().is_some_and(|left| left < length) {
            return Err(damaged);
        }
        let is_of_frames = root.is_some_and(|root| [SHARED, PER_FRAME].contains(&root));
        let is_kept =
            (root.is_none() || is_of_frames) && length <= VALUE_BYTES && self.kept + length <= ALL_BYTES;
        if !is_kept {
            return self.input.seek(self.input.position() + length).map_err(|_| damaged);
        }
        let mut bytes = Vec::new();
        let read = self.input.take(length).read_to_end(&mut bytes);
        if read.ok() != Some(length as usize) {
            return Err(damaged);
        }
        self.kept += length;
        let value = Value { vr, bytes };
        if root.is_none() {
            self.set.insert(tag, value);
            return Ok(());
        }
        if root == Some(PER_FRAME) && OF_FRAMES.contains(&tag) {
            self.of_frames.entry(tag).or_default().push(value.clone());
        }
        self.shared.entry(tag).or_insert(value);
        Ok(())
    }

    fn pixels(&mut self, tag: Tag, vr: [u8; 2], length: u32) -> Result<Pixels, DicomError> {
        if length != UNDEFINED {
            let float_bits = match tag {
                FLOATS => 32,
                DOUBLES => 64,
                _ => 0,
            };
            return Ok(Pixels::Native { start: self.input.position(), bytes: length.into(), vr, float_bits });
        }
        let mut frames = Vec::new();
        // The first item lists places, and is often empty.
        for is_table in [true].into_iter().chain(std::iter::repeat(false)) {
            let (tag, length) = (self.tag()?, u64::from(self.long()?));
            if tag == SEQUENCE_END {
                break;
            }
            if tag != ITEM || self.input.left().is_some_and(|left| left < length) {
                return Err(DicomError::Damaged { what: "the list of frames" });
            }
            let start = self.input.position();
            if !is_table {
                frames.push((start, length));
            }
            self.input
                .seek(start + length)
                .map_err(|_| DicomError::Damaged { what: "the list of frames" })?;
        }
        Ok(Pixels::Frames(frames))
    }
}
