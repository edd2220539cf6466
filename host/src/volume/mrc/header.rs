//! Headers of MRC as bytes, and their fields by place.

use std::io::{self, Read};

use super::MrcError;
use crate::volume::{ByteOrder, ElementType};

/// Bytes before the extended header.
pub(super) const BYTES: usize = 1024;

/// Most bytes of an extended header that are read. One of a tilt series has some hundred KiB.
const MOST_EXTENSION: u32 = 1 << 26;

/// Where fields of four bytes begin.
pub(super) mod field {
    pub(in super::super) const COUNTS: usize = 0;
    pub(in super::super) const MODE: usize = 12;
    pub(in super::super) const STARTS: usize = 16;
    pub(in super::super) const SAMPLING: usize = 28;
    pub(in super::super) const CELL: usize = 40;
    pub(in super::super) const ANGLES: usize = 52;
    pub(in super::super) const AXES: usize = 64;
    pub(in super::super) const RANGE: usize = 76;
    pub(in super::super) const SPACE_GROUP: usize = 88;
    pub(in super::super) const EXTENSION: usize = 92;
    pub(in super::super) const VERSION: usize = 108;
    pub(in super::super) const IMOD_STAMP: usize = 152;
    pub(in super::super) const IMOD_FLAGS: usize = 156;
    pub(in super::super) const ORIGIN: usize = 196;
    pub(in super::super) const MAP: usize = 208;
    pub(in super::super) const MACHINE: usize = 212;
    pub(in super::super) const DEVIATION: usize = 216;
}

/// What IMOD writes to say that its flags are there; the first of them says that bytes are signed.
const IMOD: i32 = 1_146_047_817;

/// A header with its extension.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MrcHeader {
    pub(super) order: ByteOrder,
    pub(super) bytes: Vec<u8>,
}

/// Why a header could not be read: what is wrong with it, or with the file.
#[derive(Debug)]
pub(super) enum HeaderFault {
    Mrc(MrcError),
    Io(io::Error),
}

impl MrcHeader {
    /// A header that says nothing, in that order of bytes.
    pub(super) fn empty(order: ByteOrder) -> Self {
        let mut header = Self { order, bytes: vec![0; BYTES] };
        header.set_reals(field::ANGLES, [90.0; 3]);
        header.set_integers(field::AXES, [1, 2, 3]);
        header.set_integers(field::SPACE_GROUP, [1]);
        header.set_integers(field::VERSION, [20_140]);
        header.bytes[field::MAP..field::MAP + 4].copy_from_slice(b"MAP ");
        let stamp = if order == ByteOrder::Little { [0x44, 0x44, 0, 0] } else { [0x11, 0x11, 0, 0] };
        header.bytes[field::MACHINE..field::MACHINE + 4].copy_from_slice(&stamp);
        header
    }

    /// A header that was kept, of which zeros at the end may be missing. `None` for bytes that are none.
    pub(super) fn kept(mut bytes: Vec<u8>) -> Option<Self> {
        let end = bytes.len();
        bytes.resize(end.max(BYTES), 0);
        let mut header = Self { order: order_of(&bytes), bytes };
        let extension = header.extension().ok()?;
        header.bytes.resize(BYTES + extension as usize, 0);
        (end <= header.bytes.len()).then_some(header)
    }

    /// Reads a header and what extends it.
    pub(super) fn read(input: &mut dyn Read) -> Result<Self, HeaderFault> {
        let mut bytes = vec![0; BYTES];
        fill(input, &mut bytes)?;
        let mut header = Self { order: order_of(&bytes), bytes };
        let extension = header.extension().map_err(HeaderFault::Mrc)?;
        // Memory is taken as bytes arrive.
        let found = input.take(extension.into()).read_to_end(&mut header.bytes).map_err(HeaderFault::Io)?;
        if found as u64 == u64::from(extension) {
            Ok(header)
        } else {
            Err(HeaderFault::Mrc(MrcError::Truncated))
        }
    }

    /// Bytes of what extends it.
    fn extension(&self) -> Result<u32, MrcError> {
        let [bytes] = self.integers(field::EXTENSION);
        u32::try_from(bytes).ok().filter(|bytes| *bytes <= MOST_EXTENSION).ok_or(MrcError::Extension)
    }

    pub(super) fn integers<const N: usize>(&self, place: usize) -> [i32; N] {
        self.words(place).map(i32::from_le_bytes)
    }

    pub(super) fn reals<const N: usize>(&self, place: usize) -> [f32; N] {
        self.words(place).map(f32::from_le_bytes)
    }

    pub(super) fn set_integers<const N: usize>(&mut self, place: usize, values: [i32; N]) {
        self.set_words(place, values.map(i32::to_le_bytes));
    }

    pub(super) fn set_reals<const N: usize>(&mut self, place: usize, values: [f32; N]) {
        self.set_words(place, values.map(f32::to_le_bytes));
    }

    fn words<const N: usize>(&self, place: usize) -> [[u8; 4]; N] {
        std::array::from_fn(|number| {
            let mut word = [0; 4];
            word.copy_from_slice(&self.bytes[place + 4 * number..][..4]);
            if self.order == ByteOrder::Big {
                word.reverse();
            }
            word
        })
    }

    fn set_words<const N: usize>(&mut self, place: usize, words: [[u8; 4]; N]) {
        for (number, mut word) in words.into_iter().enumerate() {
            if self.order == ByteOrder::Big {
                word.reverse();
            }
            self.bytes[place + 4 * number..][..4].copy_from_slice(&word);
        }
    }

    /// What a sample is.
    pub(super) fn mode(&self) -> Result<Mode, MrcError> {
        let [mode] = self.integers(field::MODE);
        let [stamp, flags] = [field::IMOD_STAMP, field::IMOD_FLAGS].map(|place| self.integers::<1>(place)[0]);
        let is_unsigned = stamp == IMOD && flags & 1 == 0;
        let (element, components, is_half) = match mode {
            0 if is_unsigned => (ElementType::U8, 1, false),
            0 => (ElementType::I8, 1, false),
            1 => (ElementType::I16, 1, false),
            2 => (ElementType::F32, 1, false),
            3 => (ElementType::I16, 2, false),
            4 => (ElementType::F32, 2, false),
            6 => (ElementType::U16, 1, false),
            12 => (ElementType::U16, 1, true),
            mode => return Err(MrcError::Mode { mode }),
        };
        Ok(Mode { element, components, is_half })
    }
}

/// What a sample is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Mode {
    /// Of a value; of floats of 16 bits, that of their bits.
    pub(super) element: ElementType,
    /// Values of a sample: two of complex numbers.
    pub(super) components: u32,
    pub(super) is_half: bool,
}

/// The order that the stamp of the machine says; without one, that in which the mode is one of the first hundred.
fn order_of(bytes: &[u8]) -> ByteOrder {
    let mode = &bytes[field::MODE..field::MODE + 4];
    match bytes[field::MACHINE] {
        0x44 => ByteOrder::Little,
        0x11 => ByteOrder::Big,
        _ if mode[1..] == [0; 3] => ByteOrder::Little,
        _ => ByteOrder::Big,
    }
}

fn fill(input: &mut dyn Read, bytes: &mut [u8]) -> Result<(), HeaderFault> {
    input.read_exact(bytes).map_err(|cause| match cause.kind() {
        io::ErrorKind::UnexpectedEof => HeaderFault::Mrc(MrcError::Truncated),
        _ => HeaderFault::Io(cause),
    })
}
