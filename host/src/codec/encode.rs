//! The bricks of a step, coded on all cores and written in their order.

use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::ahead::read_ahead;
use super::brick::{Coding, Encoded, Samples, Unencodable};
use super::content::{Place, Step};
use super::supply::{Block, Layout, Supply};
use super::trial::Tried;
use super::units::{Unit, counts, units};
use super::writer::Writer;
use super::{Brick, CompressError, Grid, Pool, Progress};
use crate::progress::tell;
use crate::volume::ElementType;

/// Jobs that are done or wait for those before them, per thread.
const IN_FLIGHT: u64 = 4;

/// Samples of the bricks of a job, if one brick has no more: to code fewer takes no longer than to hand them over.
const JOB_SAMPLES: u64 = 1 << 14;

/// A step that is to be coded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job<'a> {
    pub(super) step: &'a Step,
    pub(super) codings: &'a [Coding],
    /// What is known of some bricks, by component.
    pub(super) tried: &'a [Option<Tried>],
    pub(super) grid: Grid,
    pub(super) element: ElementType,
    pub(super) layout: Layout,
    /// Bytes that may be read at once.
    pub(super) most: u64,
}

/// Bricks that follow each other.
type Coded = Vec<(Place, Encoded)>;

/// Bricks that were coded in one job, and its number among all of the step.
type Done = (u64, Result<Coded, Unencodable>);

impl Job<'_> {
    /// Codes all bricks. Returns the checksum of all values, where they are read in their order.
    pub(super) fn run<W: Write>(
        &self,
        supply: &mut Supply<'_>,
        pool: &Pool,
        writer: &mut Writer<W>,
        progress: Progress<'_>,
    ) -> Result<Option<u32>, CompressError> {
        let counts = counts(&self.grid, self.layout.sample(), self.most);
        let is_in_order = counts[..2] == self.grid.counts()[..2];
        let layout = self.layout;
        let wanted =
            units(self.grid, counts).map(move |unit| (unit, layout.stretches(unit.origin, unit.sides)));
        let crc = std::thread::scope(|threads| {
            let found = read_ahead(threads, supply, wanted);
            pool.scope(|jobs| {
                let mut hasher = crc32fast::Hasher::new();
                let most = IN_FLIGHT * pool.count() as u64;
                let mut line = Line::new(self, writer, progress);
                for block in found {
                    let (unit, values) = block?;
                    if is_in_order {
                        hasher.update(&values);
                    }
                    let values = Arc::new(values);
                    for places in self.jobs(unit) {
                        line.wait(most)?;
                        let (number, done) = line.enter();
                        let values = Arc::clone(&values);
                        jobs.begin(move || {
                            let code = |place| Ok((place, self.code(unit, &values, place, pool)?));
                            let coded = places.into_iter().map(code).collect();
                            drop(values);
                            // Nobody waits for it once another has failed.
                            let _ = done.send((number, coded));
                        });
                    }
                }
                line.wait(1)?;
                Ok::<u32, CompressError>(hasher.finalize())
            })
        })?;
        Ok(is_in_order.then_some(crc))
    }

    /// The bricks of a unit, in jobs.
    fn jobs(&self, unit: Unit) -> impl Iterator<Item = Vec<Place>> + use<> {
        let brick: u64 = self.grid.sides.into_iter().map(u64::from).product();
        let count = (JOB_SAMPLES / brick).max(1) as usize;
        let mut places = self.places(unit);
        std::iter::from_fn(move || Some(places.by_ref().take(count).collect::<Vec<Place>>()))
            .take_while(|places| !places.is_empty())
    }

    /// The bricks of a unit, with all components.
    fn places(&self, unit: Unit) -> impl Iterator<Item = Place> + use<> {
        let (step, components) = (self.step.number, self.layout.components);
        let bricks = unit.bricks(&self.grid);
        bricks.flat_map(move |brick| (0..components).map(move |component| Place { step, brick, component }))
    }

    fn code(&self, unit: Unit, values: &[u8], place: Place, pool: &Pool) -> Result<Encoded, Unencodable> {
        let Brick { origin, sides } = self.grid.brick(place.brick);
        let block = Block { values, layout: self.layout, origin: unit.origin, sides: unit.sides };
        let bytes = block.cut(origin, sides, place.component);
        let samples = Samples { element: self.element, sides, bytes: &bytes };
        let component = place.component as usize;
        match self.tried[component].as_ref().and_then(|tried| tried.encoded(samples)) {
            Some(encoded) => Ok(encoded),
            None => pool.with_worker(|worker| worker.encode(samples, &self.codings[component])),
        }
    }
}

/// Bricks on their way to the file, which they reach in their order.
struct Line<'a, W> {
    job: &'a Job<'a>,
    writer: &'a mut Writer<W>,
    progress: Progress<'a>,
    done: (Sender<Done>, Receiver<Done>),
    entered: u64,
    written: u64,
    /// Those that came before others that they have to wait for.
    early: BTreeMap<u64, Coded>,
}

impl<'a, W: Write> Line<'a, W> {
    fn new(job: &'a Job<'a>, writer: &'a mut Writer<W>, progress: Progress<'a>) -> Self {
        Self { job, writer, progress, done: channel(), entered: 0, written: 0, early: BTreeMap::new() }
    }

    /// The number of the next job, and where to send its bricks.
    fn enter(&mut self) -> (u64, Sender<Done>) {
        self.entered += 1;
        (self.entered - 1, self.done.0.clone())
    }

    /// Writes bricks until fewer than `most` jobs are on their way.
    fn wait(&mut self, most: u64) -> Result<(), CompressError> {
        while self.entered - self.written >= most.max(1) {
            // There is always a sender here.
            let Ok((number, coded)) = self.done.1.recv() else { return Ok(()) };
            self.early.insert(number, coded?);
            while let Some(coded) = self.early.remove(&self.written) {
                coded.iter().try_for_each(|(place, coded)| self.write(*place, coded))?;
                self.written += 1;
            }
        }
        Ok(())
    }

    fn write(&mut self, place: Place, coded: &Encoded) -> Result<(), CompressError> {
        let step = self.job.step;
        let label = coded.label(place, step.channels[place.component as usize].readable_levels);
        self.writer.brick(step, &label, &coded.bytes, coded.statistics)?;
        Ok(tell(self.progress, self.job.grid.brick(place.brick).samples())?)
    }
}
