//! The container file: codestreams, then an index, then a footer. Its bytes are described in `docs/container.md`.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::Mutex;

use serde::{Deserialize, Serialize};
use wavelift_kernel::Wavelet;

use super::brick::Encoded;
use super::choice::Transform;
use super::{ContainerError, Effort, Form, Grid};
use crate::bound::Bound;
use crate::volume::{ElementType, Metadata};

/// Version of the container that is written, and the only one that is read.
const VERSION: u16 = 2;

/// The first eight bytes: not text, and damaged by any conversion of line ends.
const MAGIC: [u8; 8] = *b"\x89WLIFT\r\n";

/// The last eight bytes.
const END_MAGIC: [u8; 8] = *b"WLIFTEND";

/// Magic, version, two reserved bytes.
const HEADER_BYTES: usize = 12;

/// Position and length of the index, its checksum, the checksum of these three, the end magic.
const FOOTER_BYTES: usize = 8 + 8 + 4 + 4 + 8;

/// What a container says about its volume, and where its bricks are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Index {
    /// Extent and bricks.
    pub grid: Grid,
    /// Type of a sample.
    pub element: ElementType,
    /// The effort of the encoder; a reader has no use for it.
    pub effort: Effort,
    /// The wavelet, or none.
    pub wavelet: Option<Wavelet>,
    /// Levels of the transform of a whole brick.
    pub levels: u8,
    /// The coarsest level that can be read; 0 is full resolution.
    pub readable_levels: u8,
    /// What its integers stand for.
    pub form: Form,
    /// The bound that samples were kept to; `None` for every bit.
    pub bound: Option<Bound>,
    /// What the source said beside extent and type.
    pub metadata: Metadata,
    /// One entry per brick, in the order of [`Grid`], which is also that of the file.
    pub bricks: Vec<BrickEntry>,
}

/// Where one brick is, and how to tell whether it is whole.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BrickEntry {
    /// Bytes of each of its codestreams.
    pub lengths: Vec<u32>,
    /// What follows them in a volume on a scale; `None` for a brick that is coded exactly, without a transform.
    pub exceptions: Option<Kept>,
    /// CRC-32 of its codestreams and exceptions.
    pub stored_crc: u32,
    /// CRC-32 of its samples as they are decoded, little-endian in their own type, x fastest.
    pub samples_crc: u32,
}

/// The samples of a brick whose bits are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Kept {
    /// How many there are.
    pub samples: u32,
    /// Bytes that their [`Exceptions`](crate::bound::Exceptions) take, 0 if there are none.
    pub bytes: u32,
}

impl Index {
    /// Samples whose bits are kept beside a scale.
    pub fn exceptions(&self) -> u64 {
        self.bricks.iter().filter_map(|brick| brick.exceptions).map(|kept| u64::from(kept.samples)).sum()
    }

    /// Bricks that are coded exactly, though the volume is on a scale.
    pub fn exact_bricks(&self) -> usize {
        let exact = self.bricks.iter().filter(|brick| brick.exceptions.is_none());
        if self.form.scale().is_some() { exact.count() } else { 0 }
    }
}

impl BrickEntry {
    /// Bytes of its codestreams together, and of its exceptions.
    pub fn bytes(&self) -> u64 {
        let exceptions = self.exceptions.map(|kept| kept.bytes);
        self.lengths.iter().copied().chain(exceptions).map(u64::from).sum()
    }
}

/// Writes a container from front to back.
#[derive(Debug)]
pub(super) struct Writer<'a, W> {
    out: &'a mut W,
    written: u64,
    index: Index,
}

impl<'a, W: Write> Writer<'a, W> {
    /// Starts a container with all that `index` says but its bricks.
    pub(super) fn new(out: &'a mut W, index: Index) -> io::Result<Self> {
        out.write_all(&header())?;
        Ok(Self { out, written: HEADER_BYTES as u64, index })
    }

    /// Writes the next brick.
    pub(super) fn brick(&mut self, brick: Encoded) -> io::Result<()> {
        self.out.write_all(&brick.bytes)?;
        self.written += brick.bytes.len() as u64;
        self.index.bricks.push(BrickEntry {
            lengths: brick.lengths,
            exceptions: brick.exceptions,
            stored_crc: crc32fast::hash(&brick.bytes),
            samples_crc: brick.samples_crc,
        });
        Ok(())
    }

    /// Writes index and footer; returns the bytes of the whole container, and what it says.
    pub(super) fn finish(self) -> io::Result<(u64, Index)> {
        let index = postcard::to_allocvec(&self.index).map_err(io::Error::other)?;
        self.out.write_all(&index)?;
        self.out.write_all(&footer(self.written, &index))?;
        self.out.flush()?;
        Ok((self.written + (index.len() + FOOTER_BYTES) as u64, self.index))
    }
}

fn header() -> [u8; HEADER_BYTES] {
    let mut header = [0; HEADER_BYTES];
    header[..8].copy_from_slice(&MAGIC);
    header[8..10].copy_from_slice(&VERSION.to_le_bytes());
    header
}

pub(super) fn footer(position: u64, index: &[u8]) -> [u8; FOOTER_BYTES] {
    let mut footer = [0; FOOTER_BYTES];
    footer[..8].copy_from_slice(&position.to_le_bytes());
    footer[8..16].copy_from_slice(&(index.len() as u64).to_le_bytes());
    footer[16..20].copy_from_slice(&crc32fast::hash(index).to_le_bytes());
    let crc = crc32fast::hash(&footer[..20]);
    footer[20..24].copy_from_slice(&crc.to_le_bytes());
    footer[24..].copy_from_slice(&END_MAGIC);
    footer
}

/// An open container. Everything but the bricks has been read and checked.
#[derive(Debug)]
pub struct Container {
    file: Mutex<File>,
    bytes: u64,
    index: Index,
    /// Where each brick begins; one more, where the last one ends.
    positions: Vec<u64>,
}

impl Container {
    /// Opens a container: reads header, footer and index.
    ///
    /// # Errors
    /// [`ContainerError`], for a file that is not a container, or not a whole one.
    pub fn open(path: &Path) -> Result<Self, ContainerError> {
        let mut file = File::open(path)?;
        let bytes = file.seek(SeekFrom::End(0))?;
        check_header(&mut file)?;
        let (position, index) = read_index(&mut file, bytes)?;
        let positions = check_index(&index, position)?;
        Ok(Self { file: Mutex::new(file), bytes, index, positions })
    }

    /// What the container says about its volume and bricks.
    pub const fn index(&self) -> &Index {
        &self.index
    }

    /// Bytes of the file.
    pub const fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Whether a file begins like a container.
    pub fn is_container(path: &Path) -> bool {
        let mut magic = [0; MAGIC.len()];
        File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok() && magic == MAGIC
    }

    /// The transform of the bricks.
    pub(super) const fn transform(&self) -> Transform {
        Transform { wavelet: self.index.wavelet, levels: self.index.levels }
    }

    /// Reads the codestreams and exceptions of brick `index`, which is below the number of bricks.
    pub(super) fn read_brick(&self, index: u64) -> io::Result<Vec<u8>> {
        let entry = index as usize;
        let mut bytes = vec![0; (self.positions[entry + 1] - self.positions[entry]) as usize];
        let mut file = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        file.seek(SeekFrom::Start(self.positions[entry]))?;
        file.read_exact(&mut bytes)?;
        Ok(bytes)
    }
}

fn check_header(file: &mut File) -> Result<(), ContainerError> {
    let mut found = [0; HEADER_BYTES];
    file.seek(SeekFrom::Start(0))?;
    let read = read_up_to(file, &mut found)?;
    if !MAGIC.starts_with(&found[..read.min(MAGIC.len())]) || read == 0 {
        return Err(ContainerError::NotAContainer);
    }
    if read < HEADER_BYTES {
        return Err(ContainerError::Truncated);
    }
    let version = u16::from_le_bytes([found[8], found[9]]);
    if version != VERSION {
        return Err(ContainerError::UnsupportedVersion { found: version });
    }
    if found != header() {
        return Err(ContainerError::Damaged("reserved bytes of the header are not zero"));
    }
    Ok(())
}

fn read_up_to(file: &mut File, buffer: &mut [u8]) -> io::Result<usize> {
    let mut bytes = Vec::new();
    file.take(buffer.len() as u64).read_to_end(&mut bytes)?;
    buffer[..bytes.len()].copy_from_slice(&bytes);
    Ok(bytes.len())
}

/// Reads footer and index; returns the position of the index too.
fn read_index(file: &mut File, bytes: u64) -> Result<(u64, Index), ContainerError> {
    let end = bytes.checked_sub(FOOTER_BYTES as u64).filter(|&end| end >= HEADER_BYTES as u64);
    let end = end.ok_or(ContainerError::Truncated)?;
    let mut found = [0; FOOTER_BYTES];
    file.seek(SeekFrom::Start(end))?;
    file.read_exact(&mut found)?;
    if !found.ends_with(&END_MAGIC) {
        return Err(ContainerError::Truncated);
    }
    let [position, len] = [0, 8].map(|at| u64::from_le_bytes(std::array::from_fn(|i| found[at + i])));
    if crc32fast::hash(&found[..20]) != u32::from_le_bytes(std::array::from_fn(|i| found[20 + i])) {
        return Err(ContainerError::Damaged("the footer contradicts its checksum"));
    }
    if position < HEADER_BYTES as u64 || position.checked_add(len) != Some(end) {
        return Err(ContainerError::Damaged("the index is not where the footer says"));
    }
    let mut index = Vec::new();
    file.seek(SeekFrom::Start(position))?;
    file.take(len).read_to_end(&mut index)?;
    if footer(position, &index) != found {
        return Err(ContainerError::Damaged("the index contradicts its checksum"));
    }
    match postcard::take_from_bytes(&index) {
        Ok((index, [])) => Ok((position, index)),
        _ => Err(ContainerError::Damaged("the index cannot be read")),
    }
}

/// Checks an index against itself and the bytes before it; returns the positions of its bricks.
fn check_index(index: &Index, end: u64) -> Result<Vec<u64>, ContainerError> {
    if !index.grid.is_sound() || index.grid.bricks() != index.bricks.len() as u64 {
        return Err(ContainerError::Damaged("the index has another number of bricks than its extent"));
    }
    let deepest = index.grid.max_levels();
    let transformed = if index.wavelet.is_some() { index.levels } else { deepest };
    if index.levels > deepest
        || index.readable_levels > transformed.min(index.grid.aligned_levels())
        || index.readable_levels > 0 && !index.form.has_levels(index.element)
        || (index.levels > 0) != index.wavelet.is_some()
        || (index.form.values().is_some() || index.form.slack().is_some()) && index.wavelet.is_some()
    {
        return Err(ContainerError::Damaged("what the index says of levels and form is contradictory"));
    }
    let may_be_kept = |brick: &BrickEntry| brick.exceptions.is_none() || index.form.scale().is_some();
    if !index.form.suits(index.element)
        || !index.bound.is_none_or(Bound::is_sound)
        || !index.bricks.iter().all(may_be_kept)
    {
        return Err(ContainerError::Damaged("what the index says of bound and scale is contradictory"));
    }
    let mut positions = vec![HEADER_BYTES as u64];
    for brick in &index.bricks {
        let next = positions.last().and_then(|last| last.checked_add(brick.bytes()));
        positions.push(next.ok_or(ContainerError::Damaged("the bricks in the index are too long"))?);
    }
    if positions.last() != Some(&end) {
        return Err(ContainerError::Damaged("the bricks in the index do not fill the file"));
    }
    Ok(positions)
}
