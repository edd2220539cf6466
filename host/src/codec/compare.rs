//! A container beside its original, brick by brick.

use std::sync::{Mutex, PoisonError};

use super::brick::Worker;
use super::content::Place;
use super::supply::{Block, Layout, Supply};
use super::units::{Unit, counts, units};
use super::{Brick, CompressError, Container, ContainerError, DecompressOptions, Pool, Progress, memory};
use crate::bound::Deviation;
use crate::progress::tell;
use crate::volume::Source;

/// What a comparison found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// The first value that is further off than it may be.
    pub difference: Option<Difference>,
    /// The largest distance of two values, where there is a bound.
    pub largest: Option<f64>,
}

/// A value that is not what it should be; the first is that which comes first in a file.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Difference {
    /// Number of the time step.
    pub step: u64,
    /// The sample, z, y, x.
    pub sample: [u64; 3],
    /// Number of the component.
    pub component: u32,
    /// The bound that it exceeds; `None` where every bit is kept.
    pub bound: Option<f64>,
}

impl Container {
    /// Decodes every brick, as [`Container::verify`] does, and compares it with the values of `original`, which has the
    /// same extent, type, components and time steps: bit for bit, or within the bound that it was kept to.
    ///
    /// # Errors
    /// [`CompressError`]: the original cannot be read, or is of another kind; damage is told to `damaged` instead.
    pub fn compare(
        &self,
        original: &mut dyn Source,
        options: &DecompressOptions,
        progress: Progress<'_>,
        damaged: &(dyn Fn(ContainerError) + Sync),
    ) -> Result<Comparison, CompressError> {
        super::compress::refuse_others(self.head(), original.header())?;
        let pool = Pool::new(options.threads)?;
        let most = options.memory.unwrap_or_else(|| memory::available() / 2) / 2;
        let most = most - original.hold_at_most(most / 2).min(most);
        let note = |result: Result<(), ContainerError>| match result {
            Err(ContainerError::Stopped(stopped)) => Err(stopped),
            other => {
                other.unwrap_or_else(damaged);
                Ok(())
            }
        };
        note(self.metadata().map(|_| ()))?;
        note(self.summaries().map(|_| ()))?;
        let found = Mutex::new(Comparison::default());
        for step in 0..self.steps().min(original.header().steps) {
            note(self.check_copies(step))?;
            let grid = match self.grid(step) {
                Ok(grid) => grid,
                Err(error) => {
                    damaged(error);
                    continue;
                }
            };
            let layout = Layout::of(original.header());
            let mut supply = Supply::new(original, step, most)?;
            for unit in units(grid, counts(&grid, layout.sample(), most)) {
                let mut values = Vec::new();
                supply.read(&layout.stretches(unit.origin, unit.sides), &mut values)?;
                let Unit { origin, sides } = unit;
                let block = Block { values: &values, layout, origin, sides };
                let places: Vec<Place> = unit
                    .bricks(&grid)
                    .flat_map(|brick| {
                        (0..layout.components).map(move |component| Place { step, brick, component })
                    })
                    .collect();
                let compare = |place: Place| {
                    note(pool.with_worker(|worker| self.compare_brick(worker, place, block, &found)))?;
                    tell(progress, grid.brick(place.brick).samples())
                };
                pool.try_map(places, compare)?;
            }
        }
        Ok(found.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    fn compare_brick(
        &self,
        worker: &mut Worker,
        place: Place,
        original: Block<'_>,
        found: &Mutex<Comparison>,
    ) -> Result<(), ContainerError> {
        let decoded = self.decode_and_check(worker, place)?;
        let step = self.step(place.step)?;
        let Brick { origin, sides } = step.grid(self.head()).brick(place.brick);
        let (element, bound) = (self.head().element, step.channels[place.component as usize].bound);
        let expected = original.cut(origin, sides, place.component);
        let (beyond, largest) = match bound {
            None => {
                (expected.iter().zip(&decoded).position(|(a, b)| a != b).map(|at| at / element.bytes()), None)
            }
            Some(bound) => {
                let Deviation { largest, beyond } = Deviation::of(element, &expected, &decoded, bound.error);
                (beyond, Some(largest))
            }
        };
        let [width, height, _] = sides.map(|side| side as usize);
        let difference = beyond.map(|at| {
            let [x, y, z] = [at % width, at / width % height, at / width / height].map(|place| place as u64);
            let sample = [origin[2] + z, origin[1] + y, origin[0] + x];
            let bound = bound.map(|bound| bound.error);
            Difference { step: place.step, sample, component: place.component, bound }
        });
        let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
        found.largest = [found.largest, largest].into_iter().flatten().reduce(f64::max);
        if difference.is_some_and(|one| found.difference.is_none_or(|first| one < first)) {
            found.difference = difference;
        }
        Ok(())
    }
}
