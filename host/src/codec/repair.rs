//! A whole container from one that is damaged or cut short.

use std::io::{self, Write};
use std::num::NonZeroUsize;

use super::brick::Worker;
use super::content::{BrickLabel, Head, Place, Step};
use super::decode::decode_found;
use super::salvage::{Damage, Lost, Salvaged};
use super::writer::Writer;
use super::{Container, Content, Found, Pool, ReadAt, Scanner, Statistics};
use crate::progress::{Progress, Stopped, tell};
use crate::volume::Fault;

/// Bricks decoded before they are written, per thread.
const BATCH: usize = 8;

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
    /// What was wrong with the file, and every brick that is lost.
    pub damage: Damage,
}

/// Writes a whole container to `out` with every brick of `source` that is whole, in the bytes that it had. The others
/// are marked as lost: reading them is an error that says so. Neither index nor footer of `source` are needed, and
/// single wrong bytes are put right, as [`Container::salvage`] does.
///
/// Each brick is decoded and compared with both its checksums. `progress` counts values of all bricks.
///
/// # Errors
/// [`RepairError`]; what is in `out` is of no use then.
///
/// Cost: that of reading and decoding the file. The memory of a few bricks per thread.
pub fn repair(
    source: Box<dyn ReadAt>,
    out: impl Write,
    threads: Option<NonZeroUsize>,
    progress: Progress<'_>,
) -> Result<Repaired, RepairError> {
    let pool = Pool::new(threads).map_err(RepairError::Read)?;
    let Salvaged { container, mut damage } = Container::salvage(source)?;
    let head = container.head().clone();
    let metadata = container.metadata().map_err(|_| RepairError::NoHead)?;
    let mut writer = Writer::new(out, &head, metadata).map_err(RepairError::Write)?;
    let mut kept = 0;
    damage.lost.clear();
    let batch = BATCH * pool.count();
    for number in 0..container.steps() {
        let step = container.step(number).map_err(|_| RepairError::NoStep)?;
        writer.step(step).map_err(RepairError::Write)?;
        let places: Vec<Place> = places(&head, step).collect();
        for places in places.chunks(batch) {
            let read = |place| pool.with_worker(|worker| whole(&container, worker, step, place));
            let bricks = pool.try_map(places.to_vec(), read);
            for (place, whole) in places.iter().zip(bricks.map_err(RepairError::Read)?) {
                match whole {
                    Some(Whole { label, stored, statistics }) => {
                        writer.brick(step, &label, &stored, statistics).map_err(RepairError::Write)?;
                        kept += 1;
                    }
                    None => {
                        writer.lost_brick(place.component);
                        damage.lost.push(Lost::new(*place, &step.grid(&head)));
                    }
                }
                tell(progress, step.grid(&head).brick(place.brick).samples())?;
            }
        }
        writer.end_step().map_err(RepairError::Write)?;
    }
    writer.finish().map_err(RepairError::Write)?;
    Ok(Repaired { head, steps: container.steps(), kept, damage })
}

/// A brick that decodes to the samples it should.
struct Whole {
    label: BrickLabel,
    stored: Vec<u8>,
    statistics: Option<Statistics>,
}

/// A brick, if it was found and is whole.
fn whole(container: &Container, worker: &mut Worker, step: &Step, place: Place) -> io::Result<Option<Whole>> {
    let bytes = container.brick_bytes(place.step, place.brick, place.component);
    if bytes.is_empty() {
        return Ok(None);
    }
    let found = Scanner::record_at(&*container.source, bytes.start)?;
    let Some(Found { content: Some(Content::Brick { label, stored }), .. }) = found else { return Ok(None) };
    let (head, channel) = (container.head(), &step.channels[place.component as usize]);
    let brick = step.grid(head).brick(place.brick);
    let samples = decode_found(worker, channel, (&label, &stored), (head.element, brick));
    Ok(samples.ok().map(|samples| {
        let statistics = Statistics::of(head.element, &samples);
        Whole { label, stored, statistics }
    }))
}

/// Every brick of a step, in the order of the file.
pub(super) fn places(head: &Head, step: &Step) -> impl Iterator<Item = Place> + use<> {
    let (number, components) = (step.number, head.components);
    (0..step.grid(head).bricks())
        .flat_map(move |brick| (0..components).map(move |component| Place { step: number, brick, component }))
}
