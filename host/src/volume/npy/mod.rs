//! NumPy's array files (`.npy`): ten or twelve bytes, a Python literal, then samples.
//!
//! Source: NumPy, module `numpy.lib.format`, versions 1.0, 2.0 and 3.0. NumPy names axes slowest first, so the last
//! axis of an array in C order is x; in Fortran order the first is. No sample is moved for either. Of four axes, that
//! which varies fastest holds components if it has at most four values, else the slowest is time; of five there are both.

mod archive;
mod literal;

use std::io::{self, Read, Write};
use std::path::Path;

pub(super) use archive::Npz;
use literal::Entries;

use super::axis::{Axis, guessed};
use super::error::excerpt;
use super::format::{Format, has_extension};
use super::half::Widened;
use super::input::Input;
use super::stored::{Encoding, Place, Stored, StoredSink};
use super::{
    ByteOrder, Created, ElementType, ExtentError, FileFormat, Header, Metadata, Origin, ReadError, Source,
    WriteError, WriteOptions, losses,
};
use crate::atomic::AtomicFile;

/// First bytes of every file.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// Longest literal that is read; those of volumes have about a hundred bytes.
const HEADER_BYTES: u32 = 1 << 16;

/// Most axes of an array that is read.
const MAX_AXES: usize = 32;

/// Header and samples start at a multiple of this.
const ALIGNMENT: usize = 64;

/// What keeps a `.npy` file from being read as a volume. Texts from the file are quoted and shortened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NpyError {
    /// The first bytes are others.
    #[error("no .npy file: it does not begin with \\x93NUMPY")]
    Magic,
    /// A version that this reader does not know.
    #[error("version {major}.{minor} of .npy is not known, only 1.0, 2.0 and 3.0 are")]
    Version {
        /// First number.
        major: u8,
        /// Second number.
        minor: u8,
    },
    /// The file ends before the header does.
    #[error("the file ends within its header")]
    Truncated,
    /// A header of more bytes than any volume's has.
    #[error("the header is {bytes} bytes long, more than that of any volume")]
    HeaderTooLong {
        /// Bytes according to the file.
        bytes: u32,
    },
    /// No dictionary of `descr`, `fortran_order` and `shape`.
    #[error("the header {text} is no dictionary of 'descr', 'fortran_order' and 'shape'")]
    Header {
        /// The header.
        text: String,
    },
    /// Samples of several parts.
    #[error("the samples are records of several fields: save the fields as arrays of their own")]
    Records,
    /// Samples that are no numbers of the types known here.
    #[error(
        "the samples are {meaning} ({descr}), not integers or floats of 8 to 64 bits: convert the array first, such \
         as with .astype"
    )]
    Element {
        /// The type as the file writes it.
        descr: String,
        /// The type in words.
        meaning: &'static str,
    },
    /// Samples of several bytes in an order that the file does not tell.
    #[error("the type {descr} does not say the order of its bytes: `<` or `>` is needed before it")]
    ByteOrder {
        /// The type as the file writes it.
        descr: String,
    },
    /// An array of no axes, or of more than NumPy once had.
    #[error("the array has {found} axes, not 1 to 32: give it another shape, such as with .reshape")]
    Axes {
        /// How many it has.
        found: usize,
    },
    /// An archive that cannot be read.
    #[error("no archive of arrays that can be read: {cause}")]
    Archive {
        /// What is wrong with it.
        cause: String,
    },
    /// An archive of several arrays, or of none of that name.
    #[error("it holds {names}: give one as FILE#NAME")]
    Arrays {
        /// The arrays that it holds.
        names: String,
    },
    /// Shapes that make no extent.
    #[error("the array's shape: {0}")]
    Extent(ExtentError),
}

/// NumPy's array file.
pub(super) struct Npy;

impl Format for Npy {
    fn format(&self) -> FileFormat {
        FileFormat::Npy
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(path, &["npy"])
    }

    fn begins(&self, first: &[u8]) -> bool {
        first.starts_with(MAGIC)
    }

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        open(input)
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        let order = options.byte_order.unwrap_or(header.metadata.source.byte_order);
        let mut axes = header.axes();
        axes.sort_by_key(|axis| axis.place());
        let counts: Vec<u64> = axes.iter().map(|axis| header.count(*axis)).collect();
        let create = || {
            let mut file = AtomicFile::create(path)?;
            file.write_all(&header_bytes(header, &counts, order))?;
            Ok(file)
        };
        let file = create().map_err(|cause| WriteError::Io { path: path.to_owned(), cause })?;
        let sink = StoredSink::new(file, path, header, Encoding::Raw, order);
        let mut losses = losses(&header.metadata);
        if guessed(&counts) != Some(axes) {
            losses.push("which axes hold components and time".to_owned());
        }
        Ok(Created { sink: Box::new(sink), losses })
    }
}

fn open(mut input: Input) -> Result<Box<dyn Source>, ReadError> {
    let text = read_literal(&mut input)?;
    let fault = |cause| ReadError::Npy { path: input.path().to_owned(), cause };
    let entries = Entries::parse(&text).map_err(fault)?;
    let Kind { element, byte_order, is_half, is_complex } = Kind::of(&entries.descr).map_err(fault)?;
    let mut axes = entries.shape;
    if !entries.fortran_order {
        axes.reverse();
    }
    if !(1..=MAX_AXES).contains(&axes.len()) {
        return Err(fault(NpyError::Axes { found: axes.len() }));
    }
    let origin = Origin { format: FileFormat::Npy, byte_order, fortran_order: entries.fortran_order };
    let mut guessed = guessed(&axes).ok_or_else(|| fault(NpyError::Extent(ExtentError::TooLarge)))?;
    if is_complex {
        axes.insert(0, 2);
        guessed.insert(0, Axis::Component(2));
    }
    let metadata = Metadata { axes: guessed, source: origin, lines: Vec::new() };
    let header = Header::of_axes(&axes, element, metadata).map_err(|cause| fault(NpyError::Extent(cause)))?;
    let place = Place { encoding: Encoding::Raw, byte_order, skip: 0, is_open_ended: false };
    let stored = Box::new(Stored::new(input, header, place)?);
    Ok(if is_half { Box::new(Widened::new(stored)) } else { stored })
}

/// Reads the bytes before the samples and returns the literal; bytes that are not UTF-8 stand as U+FFFD in it.
fn read_literal(input: &mut Input) -> Result<String, ReadError> {
    let path = input.path().to_owned();
    let fault = |cause| ReadError::Npy { path: path.clone(), cause };
    let mut fill = |bytes: &mut [u8]| match input.read_exact(bytes) {
        Err(cause) if cause.kind() == io::ErrorKind::UnexpectedEof => Err(fault(NpyError::Truncated)),
        Err(cause) => Err(input.io(cause)),
        Ok(()) => Ok(()),
    };
    let (mut magic, mut version) = ([0; 6], [0; 2]);
    fill(&mut magic)?;
    if magic != MAGIC {
        return Err(fault(NpyError::Magic));
    }
    fill(&mut version)?;
    let bytes = match version {
        [1, 0] => {
            let mut length = [0; 2];
            fill(&mut length)?;
            u32::from(u16::from_le_bytes(length))
        }
        [2 | 3, 0] => {
            let mut length = [0; 4];
            fill(&mut length)?;
            u32::from_le_bytes(length)
        }
        [major, minor] => return Err(fault(NpyError::Version { major, minor })),
    };
    if bytes > HEADER_BYTES {
        return Err(fault(NpyError::HeaderTooLong { bytes }));
    }
    let mut literal = vec![0; bytes as usize];
    fill(&mut literal)?;
    Ok(String::from_utf8_lossy(&literal).into_owned())
}

/// What values are, and how they are stored.
struct Kind {
    /// Type of a value in memory; of floats of 16 bits, that of their bits.
    element: ElementType,
    byte_order: ByteOrder,
    is_half: bool,
    /// Whether a sample has two values.
    is_complex: bool,
}

impl Kind {
    /// Understands `<f4`: order of bytes, kind, bytes. Truth values are bytes of 0 and 1.
    fn of(descr: &str) -> Result<Self, NpyError> {
        let kind = descr.trim_start_matches(['<', '>', '|', '=']);
        let order = &descr[..descr.len() - kind.len()];
        let (stored, is_half, is_complex) = match kind {
            "b1" => ("u1", false, false),
            "f2" => ("u2", true, false),
            "c8" => ("f4", false, true),
            "c16" => ("f8", false, true),
            kind => (kind, false, false),
        };
        let named = ElementType::ALL.into_iter().find(|element| kind_of(*element) == stored);
        let Some(element) = named else {
            return Err(NpyError::Element { descr: excerpt(descr), meaning: meaning_of(kind) });
        };
        let byte_order = match order {
            "<" => ByteOrder::Little,
            ">" if element.bytes() > 1 => ByteOrder::Big,
            ">" | "|" | "=" | "" if element.bytes() == 1 => ByteOrder::Little,
            _ => return Err(NpyError::ByteOrder { descr: excerpt(descr) }),
        };
        Ok(Self { element, byte_order, is_half, is_complex })
    }
}

const fn kind_of(element: ElementType) -> &'static str {
    match element {
        ElementType::U8 => "u1",
        ElementType::I8 => "i1",
        ElementType::U16 => "u2",
        ElementType::I16 => "i2",
        ElementType::U32 => "u4",
        ElementType::I32 => "i4",
        ElementType::U64 => "u8",
        ElementType::I64 => "i8",
        ElementType::F32 => "f4",
        ElementType::F64 => "f8",
    }
}

fn meaning_of(kind: &str) -> &'static str {
    match kind.bytes().next() {
        Some(b'b' | b'?') => "truth values",
        Some(b'f') => "floats of another width",
        Some(b'c') => "complex numbers of another width",
        Some(b'S' | b'a' | b'U') => "texts",
        Some(b'O') => "Python objects",
        Some(b'M' | b'm') => "times",
        Some(b'V') => "bytes without a meaning",
        _ => "of an unknown type",
    }
}

/// Header of version 1.0 for values that follow in `order`, with axes of `counts`, fastest first.
///
/// Its length, with all bytes before it, is a multiple of 64. The shape names the axes as the source did.
fn header_bytes(header: &Header, counts: &[u64], order: ByteOrder) -> Vec<u8> {
    let sign = match order {
        _ if header.element.bytes() == 1 => '|',
        ByteOrder::Little => '<',
        ByteOrder::Big => '>',
    };
    let fortran_order = header.metadata.source.fortran_order;
    let mut axes: Vec<String> = counts.iter().map(u64::to_string).collect();
    if !fortran_order {
        axes.reverse();
    }
    let shape = axes.join(", ") + if axes.len() == 1 { "," } else { "" };
    let truth = if fortran_order { "True" } else { "False" };
    let kind = kind_of(header.element);
    let literal = format!("{{'descr': '{sign}{kind}', 'fortran_order': {truth}, 'shape': ({shape}), }}");

    let before = MAGIC.len() + 4;
    let end = (before + literal.len() + 1).next_multiple_of(ALIGNMENT);
    let length = (end - before) as u16;
    let mut bytes = Vec::with_capacity(end);
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&[1, 0]);
    bytes.extend_from_slice(&length.to_le_bytes());
    bytes.extend_from_slice(literal.as_bytes());
    bytes.resize(end - 1, b' ');
    bytes.push(b'\n');
    bytes
}

#[cfg(test)]
mod tests;
