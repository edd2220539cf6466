//! A whole container from one that is damaged or cut short.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::ops::Range;

use rayon::prelude::*;

use super::brick::Worker;
use super::container::{FOOTER_BYTES, read_index};
use super::content::{BrickLabel, Head, Place, Step};
use super::decode::decode_found;
use super::writer::Writer;
use super::{Brick, Content, Found, ReadAt, Region, Scanner, Statistics, pool};
use crate::progress::{Progress, Stopped, tell};
use crate::volume::{Fault, FileFormat, Metadata};

/// Bricks decoded before they are written, per thread.
const BATCH: usize = 8;

/// Bricks that a file of few bytes may have had at most: it may be cut short.
const FEW_BRICKS: u64 = 1 << 20;

/// Why a file could not be repaired.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RepairError {
    /// No head was found.
    #[error("nothing in it says what its samples are: neither the head of a wavelift file nor a copy of it")]
    NoHead,
    /// No time step was found.
    #[error("nothing in it says how its samples are coded: no description of a time step, nor a copy of one")]
    NoStep,
    /// More bricks than there can have been.
    #[error("it speaks of more bricks than a file of its size can have")]
    TooManyBricks,
    /// It was stopped.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The damaged file cannot be read.
    #[error("cannot read: {0}")]
    Read(io::Error),
    /// The new one cannot be written.
    #[error("cannot write: {0}")]
    Write(io::Error),
}

impl RepairError {
    /// Whose fault it is.
    pub const fn kind(&self) -> Fault {
        match self {
            Self::NoHead | Self::NoStep | Self::TooManyBricks => Fault::Data,
            Self::Stopped(_) | Self::Read(_) | Self::Write(_) => Fault::Io,
        }
    }
}

/// What came of a repair.
#[derive(Clone, Debug, PartialEq)]
pub struct Repaired {
    /// What the file holds.
    pub head: Head,
    /// Number of time steps.
    pub steps: u64,
    /// Bricks that are whole, of all time steps and components.
    pub kept: u64,
    /// Those that are not.
    pub lost: Vec<Lost>,
    /// Whether what the source said beside extent and type is lost.
    pub lost_metadata: bool,
    /// Time steps whose description is lost, and with it all their bricks.
    pub lost_steps: Vec<u64>,
    /// Bytes of the damaged file that are no whole record.
    pub gaps: Vec<Range<u64>>,
}

/// A brick that is not in the file any more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lost {
    /// Which one it is.
    pub place: Place,
    /// The samples it held.
    pub region: Region,
}

/// Writes a whole container to `out` with every brick of `source` that is whole, in the bytes that it had. The others
/// are marked as lost: reading them is an error that says so. Neither index nor footer of `source` are needed.
///
/// Each brick is decoded and compared with both its checksums. `progress` counts values of all bricks.
///
/// # Errors
/// [`RepairError`]; what is in `out` is of no use then.
///
/// Cost: that of reading and decoding the file. The memory of a few bricks per thread.
pub fn repair(
    source: &dyn ReadAt,
    out: impl Write,
    threads: Option<NonZeroUsize>,
    progress: Progress<'_>,
) -> Result<Repaired, RepairError> {
    let pool = pool(threads.map(NonZeroUsize::get)).map_err(RepairError::Read)?;
    let remains = Remains::find(source).map_err(RepairError::Read)?;
    let head = remains.head.clone().ok_or(RepairError::NoHead)?;
    let (steps, lost_steps) = remains.steps(&head, source)?;
    let lost_metadata = remains.metadata.is_none();
    let metadata = remains.metadata.clone().unwrap_or_else(|| Metadata::plain(3, FileFormat::Raw));
    let mut writer = Writer::new(out, &head, &metadata).map_err(RepairError::Write)?;
    let mut repaired = Repaired {
        head,
        steps: steps.len() as u64,
        kept: 0,
        lost: Vec::new(),
        lost_metadata,
        lost_steps,
        gaps: remains.gaps.clone(),
    };
    let batch = BATCH * pool.current_num_threads();
    for step in &steps {
        writer.step(step).map_err(RepairError::Write)?;
        let places: Vec<Place> = places(&repaired.head, step).collect();
        for places in places.chunks(batch) {
            let read = |worker: &mut Worker, place: &Place| {
                remains.brick(source, worker, (&repaired.head, step), *place)
            };
            let bricks: io::Result<Vec<_>> =
                pool.install(|| places.par_iter().map_init(Worker::new, read).collect());
            for (place, whole) in places.iter().zip(bricks.map_err(RepairError::Read)?) {
                let brick = step.grid(&repaired.head).brick(place.brick);
                match whole {
                    Some(Whole { label, stored, statistics }) => {
                        writer.brick(step, &label, &stored, statistics).map_err(RepairError::Write)?;
                        repaired.kept += 1;
                    }
                    None => {
                        writer.lost_brick(place.component);
                        repaired.lost.push(Lost { place: *place, region: region(&brick) });
                    }
                }
                tell(progress, brick.samples())?;
            }
        }
        writer.end_step().map_err(RepairError::Write)?;
    }
    writer.finish().map_err(RepairError::Write)?;
    Ok(repaired)
}

/// A brick that decodes to the samples it should.
struct Whole {
    label: BrickLabel,
    stored: Vec<u8>,
    statistics: Option<Statistics>,
}

/// What a scan found of one container.
#[derive(Default)]
struct Remains {
    head: Option<Head>,
    metadata: Option<Metadata>,
    steps: BTreeMap<u64, Step>,
    bricks: BTreeMap<Place, Range<u64>>,
    gaps: Vec<Range<u64>>,
}

impl Remains {
    fn find(source: &dyn ReadAt) -> io::Result<Self> {
        let mut remains = Self::default();
        // Another container may follow, or lie in a gap.
        let mut is_own = true;
        for found in Scanner::new(source) {
            let Found { bytes, content } = found?;
            match content {
                None => remains.gaps.push(bytes),
                Some(Content::Head(head)) => {
                    is_own = *remains.head.get_or_insert_with(|| head.clone()) == head
                }
                Some(_) if !is_own => {}
                Some(Content::Metadata(metadata)) => {
                    remains.metadata.get_or_insert(metadata);
                }
                Some(Content::Step(step)) => {
                    remains.steps.entry(step.number).or_insert(step);
                }
                Some(Content::Brick { label, .. }) => {
                    remains.bricks.entry(label.place).or_insert(bytes);
                }
                Some(Content::Other(_)) => {}
            }
        }
        // A whole footer is no record, and no gap either.
        if let Some(gap) =
            remains.gaps.last_mut().filter(|gap| gap.end == source.bytes() && read_index(source).is_ok())
        {
            gap.end -= FOOTER_BYTES as u64;
        }
        remains.gaps.retain(|gap| !gap.is_empty());
        Ok(remains)
    }

    /// Every time step, and the numbers of those whose description is lost: another's stands for it.
    fn steps(&self, head: &Head, source: &dyn ReadAt) -> Result<(Vec<Step>, Vec<u64>), RepairError> {
        let sound: BTreeMap<u64, &Step> = self
            .steps
            .iter()
            .filter(|(_, step)| step.check(head).is_ok())
            .map(|(number, step)| (*number, step))
            .collect();
        let (last, example) = sound.last_key_value().ok_or(RepairError::NoStep)?;
        let most = source.bytes().max(FEW_BRICKS);
        let in_index = read_index(source).map_or(0, |(index, _)| index.steps.len() as u64);
        let count = last.saturating_add(1).max(in_index);
        if count > most {
            return Err(RepairError::TooManyBricks);
        }
        let mut bricks = 0_u64;
        let (mut steps, mut lost) = (Vec::new(), Vec::new());
        for number in 0..count {
            let step = sound.get(&number).map_or_else(
                || {
                    lost.push(number);
                    Step { number, name: None, time: None, ..(*example).clone() }
                },
                |step| (*step).clone(),
            );
            let here = step.grid(head).bricks().saturating_mul(head.components.into());
            bricks = bricks.saturating_add(here);
            if bricks > most {
                return Err(RepairError::TooManyBricks);
            }
            steps.push(step);
        }
        Ok((steps, lost))
    }

    /// A brick, if it was found and is whole.
    fn brick(
        &self,
        source: &dyn ReadAt,
        worker: &mut Worker,
        (head, step): (&Head, &Step),
        place: Place,
    ) -> io::Result<Option<Whole>> {
        let Some(range) = self.bricks.get(&place).filter(|_| self.steps.contains_key(&step.number)) else {
            return Ok(None);
        };
        let Some(Content::Brick { label, stored }) = Scanner::record_at(source, range.start)? else {
            return Ok(None);
        };
        let channel = &step.channels[place.component as usize];
        let brick = step.grid(head).brick(place.brick);
        let samples = decode_found(worker, channel, (&label, &stored), (head.element, brick));
        Ok(samples.ok().map(|samples| {
            let statistics = Statistics::of(head.element, &samples);
            Whole { label, stored, statistics }
        }))
    }
}

/// Every brick of a step, in the order of the file.
fn places(head: &Head, step: &Step) -> impl Iterator<Item = Place> + use<> {
    let (number, components) = (step.number, head.components);
    (0..step.grid(head).bricks())
        .flat_map(move |brick| (0..components).map(move |component| Place { step: number, brick, component }))
}

fn region(brick: &Brick) -> Region {
    let to = std::array::from_fn(|axis| brick.origin[axis] + u64::from(brick.sides[axis]));
    Region { from: brick.origin, to }
}
