//! One brick, from the file to samples.

use std::ops::Range;

use wavelift_kernel::{Extent, Header};

use super::brick::{Decoded, Expected, Worker, check, read_exceptions};
use super::choice::Transform;
use super::container::read;
use super::content::{BrickLabel, Channel, Place};
use super::record::{self, Kind, MOST_BRICK_BYTES};
use super::{Brick, Container, ContainerError, Form, level, planes, scaled};
use crate::volume::ElementType;

/// Bytes that are read at first for a level: a record, and the header of a codestream.
const FIRST_BYTES: u64 = (MOST_BRICK_BYTES + Header::MAX_BYTES) as u64;

/// What was read of a brick.
struct Stored {
    label: BrickLabel,
    /// All that follows its record, or, for a level, as much as that needs: the exceptions stand alone then.
    codestreams: Vec<u8>,
    exceptions: Vec<u8>,
}

impl Container {
    /// Reads and decodes one brick of a step that is there; the result is little-endian samples of its level.
    pub(super) fn decode(
        &self,
        worker: &mut Worker,
        place: Place,
        level: u8,
    ) -> Result<Vec<u8>, ContainerError> {
        let step = self.step(place.step)?;
        let channel = &step.channels[place.component as usize];
        let brick = step.grid(self.head()).brick(place.brick);
        let damage = |cause: String| ContainerError::Brick { place, brick, cause };
        let stored = self.read_brick(place, channel, level).map_err(|fault| match fault {
            Fault::Io(error) => ContainerError::Io(error),
            Fault::Data(cause) => damage(cause.to_owned()),
        })?;
        let element = self.head().element;
        let bytes = decode(worker, channel, &stored, (element, brick), level).map_err(damage)?;
        if level == 0 && crc32fast::hash(&bytes) != stored.label.samples_crc {
            return Err(damage(CONTRADICTED_SAMPLES.to_owned()));
        }
        Ok(bytes)
    }

    /// Reads of a brick what a level needs, and compares that with its checksum.
    fn read_brick(&self, place: Place, channel: &Channel, level: u8) -> Result<Stored, Fault> {
        let bytes = self.brick_bytes(place.step, place.brick, place.component);
        let needed = if level == 0 || !channel.has_quick_levels() { u64::MAX } else { FIRST_BYTES };
        let read = |range: Range<u64>| read(&*self.source, range.start, (range.end - range.start) as u32);
        let mut first = read(bytes.start..bytes.end.min(bytes.start.saturating_add(needed)))?;
        let (label, len) = label_of(&first, place, bytes.end - bytes.start)?;
        first.drain(..len);
        let start = bytes.start + len as u64;
        let exceptions = label.exceptions.map_or(0, |kept| u64::from(kept.bytes));
        if let Some((prefix, expected)) = prefix_of(&first, &label, level).filter(|_| needed < u64::MAX) {
            if prefix > first.len() as u64 {
                first.extend(read(start + first.len() as u64..start + prefix)?);
            }
            first.truncate(prefix as usize);
            let exceptions = read(bytes.end - exceptions..bytes.end)?;
            if check(&first, &exceptions) != expected {
                return Err(CONTRADICTED);
            }
            return Ok(Stored { label, codestreams: first, exceptions });
        }
        first.extend(read(start + first.len() as u64..bytes.end)?);
        if crc32fast::hash(&first) != label.stored_crc {
            return Err(CONTRADICTED);
        }
        let exceptions = first.split_off(first.len() - exceptions as usize);
        Ok(Stored { label, codestreams: first, exceptions })
    }
}

/// Decodes a brick that was found without the index, and compares it with the checksum of its samples.
pub(super) fn decode_found(
    worker: &mut Worker,
    channel: &Channel,
    (label, stored): (&BrickLabel, &[u8]),
    (element, brick): (ElementType, Brick),
) -> Result<Vec<u8>, String> {
    let exceptions = label.exceptions.map_or(0, |kept| kept.bytes as usize);
    let (codestreams, exceptions) =
        stored.split_at_checked(stored.len().saturating_sub(exceptions)).ok_or("it is too short")?;
    let (codestreams, exceptions) = (codestreams.to_vec(), exceptions.to_vec());
    let stored = Stored { label: label.clone(), codestreams, exceptions };
    let bytes = decode(worker, channel, &stored, (element, brick), 0)?;
    if crc32fast::hash(&bytes) == label.samples_crc {
        Ok(bytes)
    } else {
        Err(CONTRADICTED_SAMPLES.to_owned())
    }
}

const CONTRADICTED_SAMPLES: &str = "its samples contradict their checksum";

/// Why a brick could not be read.
enum Fault {
    Io(std::io::Error),
    Data(&'static str),
}

const CONTRADICTED: Fault = Fault::Data("its bytes contradict their checksum");

impl From<std::io::Error> for Fault {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}

/// The record that a brick of `total` bytes begins with, and its length.
fn label_of(bytes: &[u8], place: Place, total: u64) -> Result<(BrickLabel, usize), Fault> {
    if total == 0 {
        return Err(Fault::Data("it is lost"));
    }
    let found = record::from_bytes::<BrickLabel>(Kind::Brick, bytes);
    let (label, len) = found.ok_or(Fault::Data("its record contradicts its checksum, or cannot be read"))?;
    if label.place != place || label.bytes() != total - len as u64 {
        return Err(Fault::Data("its record is that of another brick, or of another length"));
    }
    Ok((label, len))
}

/// Bytes of the beginning that makes `level`, of a codestream whose first bytes are given, and their check.
fn prefix_of(first: &[u8], label: &BrickLabel, level: u8) -> Option<(u64, [u8; 2])> {
    let [len] = label.lengths[..] else { return None };
    let header = Header::parse(&first[..first.len().min(len as usize)]).ok()?;
    let level = level.min(header.plan().levels());
    let expected = label.level_checks.get(usize::from(level).checked_sub(1)?)?;
    Some((header.bytes_to_level(level), *expected)).filter(|(prefix, _)| *prefix <= u64::from(len))
}

/// Decodes a brick to little-endian samples of `level`.
fn decode(
    worker: &mut Worker,
    channel: &Channel,
    stored: &Stored,
    (element, brick): (ElementType, Brick),
    level: u8,
) -> Result<Vec<u8>, String> {
    match (&channel.form, stored.label.exceptions) {
        (Form::Scaled { .. }, None) => {
            let exact = Coded { transform: Transform::NONE, form: &Form::Exact };
            let samples = exact.decode(worker, stored, (element, brick), 0)?;
            Ok(scaled::thin(element, brick.sides, level, &samples))
        }
        (Form::Scaled { .. }, Some(_)) | (_, None) => {
            let coded = Coded { transform: channel.transform(), form: &channel.form };
            coded.decode(worker, stored, (element, brick), level)
        }
        _ => Err("it has exceptions, though its volume is on no scale".into()),
    }
}

/// How a brick is coded.
struct Coded<'a> {
    transform: Transform,
    form: &'a Form,
}

impl Coded<'_> {
    /// Decodes a brick from what is stored of it to little-endian samples of its level.
    fn decode(
        &self,
        worker: &mut Worker,
        stored: &Stored,
        (element, brick): (ElementType, Brick),
        level: u8,
    ) -> Result<Vec<u8>, String> {
        let extent = Extent::new(brick.sides).map_err(|error| error.to_string())?;
        let expected = Expected::new(element, self.form, self.transform, extent);
        let is_lattice = self.form.slack().is_some();
        let asked = if is_lattice || self.transform.wavelet.is_some() { level } else { 0 };
        let mut decoded = worker.decode(&stored.codestreams, &stored.label.lengths, &expected, asked)?;
        self.form.unpack(&mut decoded.planes).ok_or("it has samples without a value")?;
        if level > 0 && !is_lattice {
            self.bring_to_level(&mut decoded, element, level);
        }
        let mut bytes = self.form.join(element, &decoded.planes);
        let levels = decoded.header.plan().levels();
        if is_lattice && level > levels {
            let sides = decoded.header.extent_at(levels).axes();
            bytes = scaled::thin(element, sides, level - levels, &bytes);
        }
        if let Some(kept) = stored.label.exceptions {
            let exceptions =
                read_exceptions(&stored.exceptions, kept).ok_or("its exceptions cannot be read")?;
            if !scaled::apply(&exceptions, element, (brick.sides, level), &mut bytes) {
                return Err("it has exceptions outside".into());
            }
        }
        Ok(bytes)
    }

    /// Makes integers of `level` of what was decoded: of the low-pass part of a transform, or of all of them.
    fn bring_to_level(&self, decoded: &mut Decoded, element: ElementType, level: u8) {
        let plan = decoded.header.plan();
        let sample_type = match self.form {
            Form::Scaled { integers, .. } => *integers,
            _ => planes::sample_types(element)[0],
        };
        for plane in &mut decoded.planes {
            match self.transform.wavelet {
                Some(_) => level::rescale(&plan, level, sample_type, plane),
                None => level::coarsen(plan.extent(), level, sample_type, plane),
            }
        }
    }
}
