//! The container file: where its records are. Its bytes are described in `docs/container.md`.

use std::fs::File;
use std::io::{self, Read, Write};
use std::ops::Range;
use std::path::Path;
use std::sync::OnceLock;

use serde::de::DeserializeOwned;

use super::content::{Head, Index, Step, StepEntry, Summary, damaged};
use super::record::{self, Kind};
use super::{ContainerError, FileAt, Grid, ReadAt};
use crate::volume::{Header, Metadata};

/// Version of the container that is written, and the only one that is read.
pub(super) const VERSION: u16 = 3;

/// The first eight bytes: not text, and damaged by any conversion of line ends.
const MAGIC: [u8; 8] = *b"\x89WLIFT\r\n";

/// The last four bytes.
const END_MAGIC: [u8; 4] = *b"WEND";

/// Magic and version.
pub(super) const START_BYTES: usize = 10;

/// Length of the index, its checksum, the end magic.
pub(super) const FOOTER_BYTES: usize = 4 + 4 + 4;

/// Bytes of the shortest record of a time step there can be, or fewer.
const LEAST_STEP: u32 = 16;

/// What every container begins with.
pub(super) fn start() -> [u8; START_BYTES] {
    let mut start = [0; START_BYTES];
    start[..8].copy_from_slice(&MAGIC);
    start[8..].copy_from_slice(&VERSION.to_le_bytes());
    start
}

/// What every container with an index of so many bytes ends with.
pub(super) fn footer(index: u32) -> [u8; FOOTER_BYTES] {
    let mut footer = [0; FOOTER_BYTES];
    footer[..4].copy_from_slice(&index.to_le_bytes());
    footer[4..8].copy_from_slice(&crc32fast::hash(&index.to_le_bytes()).to_le_bytes());
    footer[8..].copy_from_slice(&END_MAGIC);
    footer
}

/// An open container: what it holds, and where.
///
/// Any number of threads read from one at once.
pub struct Container {
    pub(super) source: Box<dyn ReadAt>,
    head: Head,
    metadata: Record<Metadata>,
    steps: Vec<StepRecords>,
    summaries: Record<Vec<Vec<Summary>>>,
    /// `None` for what is left of a damaged file.
    index: Option<Index>,
}

/// The records of a time step.
#[derive(Debug)]
pub(super) struct StepRecords {
    step: Record<Step>,
    /// Where each brick lies; nowhere, for one that is lost.
    bricks: Vec<Range<u64>>,
    /// Where the copies behind the bricks lie.
    copies: Range<u64>,
}

impl std::fmt::Debug for Container {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Container")
            .field("head", &self.head)
            .field("steps", &self.steps)
            .finish_non_exhaustive()
    }
}

impl Container {
    /// Opens a container: reads its two ends.
    ///
    /// # Errors
    /// [`ContainerError::Open`], for a file that cannot be read, is no container, or not a whole one.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ContainerError> {
        let path = path.as_ref();
        let opened = FileAt::open(path).map_err(ContainerError::from);
        opened
            .and_then(|file| Self::new(Box::new(file)))
            .map_err(|cause| ContainerError::Open { path: path.to_owned(), cause: Box::new(cause) })
    }

    /// As [`Container::open`], for bytes anywhere.
    ///
    /// # Errors
    /// [`ContainerError`], for bytes that are no container, or not a whole one.
    pub fn new(source: Box<dyn ReadAt>) -> Result<Self, ContainerError> {
        check_start(&*source)?;
        let (index, end) = read_index(&*source)?;
        // So that a step that takes memory takes bytes of the file as well.
        if index.steps.iter().any(|step| step.record < LEAST_STEP || step.bricks.is_empty()) {
            return Err(damaged("the index has a time step of nothing"));
        }
        let mut at = START_BYTES as u64;
        let head: Record<Head> = Record::next(Kind::Head, &mut at, index.head);
        let metadata = Record::next(Kind::Metadata, &mut at, index.metadata);
        let steps = index.steps.iter().map(|entry| StepRecords::next(&mut at, entry)).collect();
        let summaries = Record::next(Kind::Statistics, &mut at, index.statistics);
        if at != end {
            return Err(damaged("the records in the index do not fill the file"));
        }
        let check = |head: &Head| if head.is_sound() { Ok(()) } else { Err("it is contradictory") };
        let head = head.read(&*source, check)?.clone();
        Ok(Self { source, head, metadata, steps, summaries, index: Some(index) })
    }

    /// What was found of a damaged file; of statistics, the place of their record, which may be empty.
    pub(super) fn found(
        source: Box<dyn ReadAt>,
        head: Head,
        steps: Vec<StepRecords>,
        (metadata, statistics): (Metadata, Range<u64>),
    ) -> Self {
        let metadata = Record::found(Kind::Metadata, metadata);
        let (mut at, bytes) = (statistics.start, (statistics.end - statistics.start) as u32);
        let summaries = Record::next(Kind::Statistics, &mut at, bytes);
        Self { source, head, metadata, steps, summaries, index: None }
    }

    /// Whether a file begins like a container.
    pub fn is_container(path: impl AsRef<Path>) -> bool {
        let mut magic = [0; MAGIC.len()];
        File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok() && magic == MAGIC
    }

    /// Bytes of the file.
    pub fn bytes(&self) -> u64 {
        self.source.bytes()
    }

    /// What is the same for every time step.
    pub const fn head(&self) -> &Head {
        &self.head
    }

    /// Number of time steps.
    pub const fn steps(&self) -> u64 {
        self.steps.len() as u64
    }

    /// Number of bricks of all time steps and components.
    pub fn bricks(&self) -> u64 {
        self.steps.iter().map(|step| step.bricks.len() as u64).sum()
    }

    /// What the source said beside extent and type.
    ///
    /// # Errors
    /// [`ContainerError`], if that is damaged; samples can be read all the same.
    pub fn metadata(&self) -> Result<&Metadata, ContainerError> {
        self.metadata.read(&*self.source, |_| Ok(()))
    }

    /// How a time step is coded; it is read when first asked for.
    ///
    /// # Errors
    /// [`ContainerError`], for a step that is damaged, or not there.
    pub fn step(&self, number: u64) -> Result<&Step, ContainerError> {
        let no_such = || ContainerError::NoSuchStep { asked: number, steps: self.steps() };
        let records =
            usize::try_from(number).ok().and_then(|step| self.steps.get(step)).ok_or_else(no_such)?;
        let check = |step: &Step| {
            let bricks = step.grid(&self.head).is_sound().then(|| step.grid(&self.head).bricks());
            let bricks = bricks.and_then(|bricks| bricks.checked_mul(self.head.components.into()));
            match bricks == Some(records.bricks.len() as u64) && step.number == number {
                true => step.check(&self.head),
                false => Err("it has another number, or another number of bricks, than the index says"),
            }
        };
        records.step.read(&*self.source, check).map_err(|error| match error {
            ContainerError::Record { cause, .. } => ContainerError::Step { step: number, cause },
            other => other,
        })
    }

    /// How a time step is cut into bricks.
    ///
    /// # Errors
    /// As [`Container::step`].
    pub fn grid(&self, step: u64) -> Result<Grid, ContainerError> {
        Ok(self.step(step)?.grid(&self.head))
    }

    /// What the samples are like, of every component of every time step.
    ///
    /// # Errors
    /// [`ContainerError`], if that is damaged; samples can be read all the same.
    pub fn summaries(&self) -> Result<&[Vec<Summary>], ContainerError> {
        let bricks = |step: &StepRecords| step.bricks.len() / self.head.components as usize;
        let fits = |(step, summaries): (&StepRecords, &Vec<Summary>)| {
            summaries.len() == self.head.components as usize
                && summaries.iter().all(|summary| summary.bricks.len() == bricks(step))
        };
        let check = |all: &Vec<Vec<Summary>>| {
            let is_whole = all.len() == self.steps.len() && self.steps.iter().zip(all).all(fits);
            if is_whole { Ok(()) } else { Err("it is not of the bricks of the index") }
        };
        Ok(self.summaries.read(&*self.source, check)?)
    }

    /// The whole data set, without its values.
    ///
    /// # Errors
    /// As [`Container::metadata`].
    pub fn header(&self) -> Result<Header, ContainerError> {
        Ok(self.head.header(self.steps(), self.metadata()?.clone()))
    }

    /// The place of a brick in the file, with all that is stored of it. The brick is there.
    pub(super) fn brick_bytes(&self, step: u64, brick: u64, component: u32) -> Range<u64> {
        let number = (brick * u64::from(self.head.components) + u64::from(component)) as usize;
        self.steps[step as usize].bricks[number].clone()
    }

    /// Looks whether what is repeated behind the bricks of a step, if anything, is what it repeats.
    pub(super) fn check_copies(&self, step: u64) -> Result<(), ContainerError> {
        let records = &self.steps[step as usize];
        let Some(index) = &self.index else { return Ok(()) };
        let Range { start, end } = records.copies;
        let copies = read(&*self.source, start, (end - start) as u32)?;
        let mut rest = &copies[..];
        let places = [(START_BYTES as u64, index.head), self.metadata.place(), records.step.place()];
        for (position, len) in places {
            let original = if rest.is_empty() { Vec::new() } else { read(&*self.source, position, len)? };
            rest = rest.strip_prefix(&original[..]).unwrap_or(rest);
        }
        let cause = "it is not what stands before its bricks";
        if rest.is_empty() {
            Ok(())
        } else {
            Err(ContainerError::Record { what: "copy behind a time step", cause })
        }
    }

    /// Copies bytes of the file.
    pub(super) fn copy(&self, mut bytes: Range<u64>, out: &mut impl Write) -> io::Result<()> {
        while !bytes.is_empty() {
            let piece = (bytes.end - bytes.start).min(1 << 20) as u32;
            out.write_all(&read(&*self.source, bytes.start, piece)?)?;
            bytes.start += u64::from(piece);
        }
        Ok(())
    }

    /// Bytes before the last two records, and what these said.
    pub(super) fn for_appending(&self) -> Result<(u64, Index, Vec<Vec<Summary>>), ContainerError> {
        let index = self.index.clone().ok_or(damaged("repair it before time steps are appended"))?;
        Ok((self.summaries.position, index, self.summaries()?.to_vec()))
    }
}

impl StepRecords {
    fn next(at: &mut u64, entry: &StepEntry) -> Self {
        let step = Record::next(Kind::Step, at, entry.record);
        let mut next = |bytes: u32| {
            let start = *at;
            *at += u64::from(bytes);
            start..*at
        };
        let bricks = entry.bricks.iter().map(|&bytes| next(bytes)).collect();
        Self { step, bricks, copies: next(entry.copies) }
    }

    /// A step that was found, and where its bricks were.
    pub(super) fn found(step: Step, bricks: Vec<Range<u64>>) -> Self {
        Self { step: Record::found(Kind::Step, step), bricks, copies: 0..0 }
    }
}

/// A record that is read when it is needed.
#[derive(Debug)]
struct Record<T> {
    kind: Kind,
    position: u64,
    bytes: u32,
    content: OnceLock<T>,
}

impl<T: DeserializeOwned> Record<T> {
    /// A record of so many bytes at `at`, which moves to its end.
    fn next(kind: Kind, at: &mut u64, bytes: u32) -> Self {
        let position = *at;
        *at += u64::from(bytes);
        Self { kind, position, bytes, content: OnceLock::new() }
    }

    /// A record that was read already.
    fn found(kind: Kind, content: T) -> Self {
        Self { kind, position: 0, bytes: 0, content: OnceLock::from(content) }
    }

    const fn place(&self) -> (u64, u32) {
        (self.position, self.bytes)
    }

    /// Its content, which is checked when it is read.
    fn read(
        &self,
        source: &dyn ReadAt,
        check: impl Fn(&T) -> Result<(), &'static str>,
    ) -> Result<&T, ContainerError> {
        if let Some(content) = self.content.get() {
            return Ok(content);
        }
        let bytes = read(source, self.position, self.bytes)?;
        let fault = |cause| ContainerError::Record { what: self.kind.name(), cause };
        let content = match record::from_bytes(self.kind, &bytes) {
            Some((content, len)) if len == bytes.len() => content,
            _ => return Err(fault("its record contradicts its checksum, or cannot be read")),
        };
        check(&content).map_err(fault)?;
        Ok(self.content.get_or_init(|| content))
    }
}

/// Reads bytes that lie within the file.
pub(super) fn read(source: &dyn ReadAt, position: u64, len: u32) -> io::Result<Vec<u8>> {
    let mut bytes = vec![0; len as usize];
    source.read_at(position, &mut bytes)?;
    Ok(bytes)
}

fn check_start(source: &dyn ReadAt) -> Result<(), ContainerError> {
    let mut found = [0; START_BYTES];
    let len = source.bytes().min(START_BYTES as u64) as usize;
    source.read_at(0, &mut found[..len])?;
    if !MAGIC.starts_with(&found[..len.min(MAGIC.len())]) || len == 0 {
        return Err(ContainerError::NotAContainer);
    }
    if len < START_BYTES {
        return Err(ContainerError::Truncated);
    }
    match u16::from_le_bytes([found[8], found[9]]) {
        VERSION => Ok(()),
        found => Err(ContainerError::UnsupportedVersion { found }),
    }
}

/// Reads footer and index; returns the position of the index too.
pub(super) fn read_index(source: &dyn ReadAt) -> Result<(Index, u64), ContainerError> {
    let end = source.bytes().checked_sub(FOOTER_BYTES as u64).filter(|&end| end >= START_BYTES as u64);
    let end = end.ok_or(ContainerError::Truncated)?;
    let mut found = [0; FOOTER_BYTES];
    source.read_at(end, &mut found)?;
    if !found.ends_with(&END_MAGIC) {
        return Err(ContainerError::Truncated);
    }
    let len = u32::from_le_bytes(std::array::from_fn(|i| found[i]));
    if footer(len) != found {
        return Err(damaged("the footer contradicts its checksum"));
    }
    let position = end.checked_sub(len.into()).filter(|&position| position >= START_BYTES as u64);
    let position = position.ok_or(damaged("the index is not where the footer says"))?;
    let bytes = read(source, position, len)?;
    match record::from_bytes(Kind::Index, &bytes) {
        Some((index, len)) if len == bytes.len() => Ok((index, position)),
        _ => Err(damaged("the index contradicts its checksum, or cannot be read")),
    }
}
