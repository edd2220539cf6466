//! A container, or a part of it, to samples in memory; and checking without keeping.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::Mutex;

use super::brick::{Worker, coarsened};
use super::content::Place;
use super::fill::Holes;
use super::grid::per_axis;
use super::region::Wanted;
use super::{Brick, Container, ContainerError, Part, Pool, Progress, Statistics};
use crate::progress::tell;
use crate::volume::{Header, Metadata, Volume};

impl Container {
    /// The header that a part has as a data set of its own: what is left of extent, components and time steps, and
    /// spacing and origin to match.
    ///
    /// # Errors
    /// [`ContainerError`]: a part that the data set does not have, or damage.
    pub fn header_of(&self, part: &Part) -> Result<Header, ContainerError> {
        let wanted = self.check(part)?;
        let start = wanted.from.map(|first| first << wanted.level);
        let metadata = self.metadata()?.of_part(start, 1 << wanted.level);
        Ok(Header { metadata, ..self.shape_of(&wanted) })
    }

    /// The header of a part without its metadata, which may be damaged though samples are not.
    fn shape_of(&self, wanted: &Wanted) -> Header {
        Header {
            extent: wanted.extent(),
            components: wanted.components.len() as u32,
            steps: wanted.steps.end - wanted.steps.start,
            element: self.head().element,
            metadata: Metadata::default(),
        }
    }

    /// Reads one volume of single values, or a part of it, on `threads` threads (`None`: one per core); bricks outside
    /// it are not touched. `progress` counts values, up to [`Container::values`].
    ///
    /// The samples of level L stand for the positions that are multiples of 2^L; of a region, those inside it.
    ///
    /// # Errors
    /// [`ContainerError`]: a part that the volume does not have, or that is no volume of single values, a damaged
    /// brick, a file that cannot be read.
    pub fn read(
        &self,
        part: &Part,
        threads: Option<NonZeroUsize>,
        progress: Progress<'_>,
    ) -> Result<Volume, ContainerError> {
        let Header { extent, components, steps, element, metadata } = self.header_of(part)?;
        if (components, steps) != (1, 1) {
            return Err(ContainerError::NotScalar { steps, components });
        }
        let samples = self.read_values(part, threads, progress)?;
        Ok(Volume { extent, element, samples, metadata })
    }

    /// As [`Container::read`], but of any part: component fastest, then x, y, z, time step.
    ///
    /// # Errors
    /// As [`Container::read`].
    pub fn read_values(
        &self,
        part: &Part,
        threads: Option<NonZeroUsize>,
        progress: Progress<'_>,
    ) -> Result<Vec<u8>, ContainerError> {
        let bytes = self.shape_of(&self.check(part)?).bytes().unwrap_or(u64::MAX);
        let mut samples = zeros(bytes).ok_or(ContainerError::OutOfMemory { bytes })?;
        self.read_into(part, &mut samples, threads, progress)?;
        Ok(samples)
    }

    /// As [`Container::read_values`], into memory of the length that [`Container::header_of`] says.
    ///
    /// # Errors
    /// As [`Container::read`], and [`ContainerError::BufferLength`].
    pub fn read_into(
        &self,
        part: &Part,
        out: &mut [u8],
        threads: Option<NonZeroUsize>,
        progress: Progress<'_>,
    ) -> Result<(), ContainerError> {
        let wanted = self.check(part)?;
        let header = self.shape_of(&wanted);
        let (expected, actual) = (header.bytes().unwrap_or(u64::MAX), out.len() as u64);
        if expected != actual {
            return Err(ContainerError::BufferLength { expected, actual });
        }
        let step_bytes = out.len() / header.steps.max(1) as usize;
        let pool = Pool::new(threads)?;
        let mut steps = wanted.steps.clone().zip(out.chunks_mut(step_bytes.max(1)));
        steps.try_for_each(|(step, out)| self.fill(&pool, step, &wanted, (out, (progress, None))))
    }

    /// Reads what is wanted of a step. A lost brick is an error, unless something is to stand for it.
    pub(super) fn fill(
        &self,
        pool: &Pool,
        step: u64,
        wanted: &Wanted,
        (out, (progress, holes)): (&mut [u8], (Progress<'_>, Option<&Holes>)),
    ) -> Result<(), ContainerError> {
        let grid = self.grid(step)?;
        let bricks = wanted.bricks_of(&grid);
        let places: Vec<Place> = bricks
            .flat_map(|brick| {
                wanted.components.clone().map(move |component| Place { step, brick, component })
            })
            .collect();
        let (size, components) = (self.head().element.bytes(), wanted.components.len());
        let target = Mutex::new(Target { values: out, extent: wanted.extent(), size, components });
        let fill = |place: Place| {
            let brick = grid.brick(place.brick);
            let sides = coarsened(brick.sides, wanted.level);
            let decoded = pool.with_worker(|worker| self.decode(worker, place, wanted.level));
            let bytes = match (decoded, holes) {
                (Err(ContainerError::Brick { .. }), Some(holes)) => {
                    holes.stand_in(place, &grid, sides.into_iter().product())
                }
                (decoded, _) => decoded?,
            };
            let mut count = 0;
            if let Some((range, to)) = wanted.within(&brick) {
                count = range.iter().map(|axis| axis.len() as u64).product();
                let mut target = target.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                let component = (place.component - wanted.components.start) as usize;
                target.scatter(&bytes, sides, &range, (to, component));
            }
            Ok(tell(progress, count)?)
        };
        pool.try_map(places, fill).map(|_| ())
    }

    /// Decodes every brick and compares both checksums, and reads all other records. Calls `damaged` with what is not
    /// whole, in any order.
    ///
    /// # Errors
    /// [`ContainerError::Io`] if threads cannot be started, [`ContainerError::Stopped`] if it was.
    pub fn verify(
        &self,
        threads: Option<NonZeroUsize>,
        progress: Progress<'_>,
        damaged: &(dyn Fn(ContainerError) + Sync),
    ) -> Result<(), ContainerError> {
        let pool = Pool::new(threads)?;
        let note = |result: Result<(), ContainerError>| match result {
            Err(ContainerError::Stopped(stopped)) => Err(stopped),
            Err(error) => {
                damaged(error);
                Ok(())
            }
            Ok(()) => Ok(()),
        };
        note(self.metadata().map(|_| ()))?;
        note(self.summaries().map(|_| ()))?;
        for step in 0..self.steps() {
            note(self.check_copies(step))?;
            let grid = match self.grid(step) {
                Ok(grid) => grid,
                Err(error) => {
                    damaged(error);
                    continue;
                }
            };
            let check = |brick| {
                (0..self.head().components).try_for_each(|component| {
                    let place = Place { step, brick, component };
                    note(pool.with_worker(|worker| self.decode_and_check(worker, place)).map(|_| ()))?;
                    tell(progress, grid.brick(brick).samples())
                })
            };
            pool.try_map((0..grid.bricks()).collect(), check)?;
        }
        Ok(())
    }

    /// Decodes a brick, and compares it with what is said of it.
    pub(super) fn decode_and_check(
        &self,
        worker: &mut Worker,
        place: Place,
    ) -> Result<Vec<u8>, ContainerError> {
        let bytes = self.decode(worker, place, 0)?;
        // Where statistics are damaged, that is told once.
        let Ok(summaries) = self.summaries() else { return Ok(bytes) };
        let said = summaries[place.step as usize][place.component as usize].bricks[place.brick as usize];
        if said == Statistics::of(self.head().element, &bytes) {
            return Ok(bytes);
        }
        let brick = self.grid(place.step)?.brick(place.brick);
        Err(ContainerError::Brick { place, brick, cause: "its samples contradict their statistics".into() })
    }

    /// The bricks that an isosurface may pass through, judging by their statistics: those where the samples of the brick,
    /// and of its next neighbours along every axis, as cells reach over to them, are not all on one side of `isovalue`.
    ///
    /// # Errors
    /// [`ContainerError`], for a step or a component that is not there, or damage.
    pub fn bricks_crossing(
        &self,
        step: u64,
        component: u32,
        isovalue: f64,
    ) -> Result<Vec<u64>, ContainerError> {
        let (grid, components) = (self.grid(step)?, self.head().components);
        if component >= components {
            return Err(ContainerError::NoSuchComponent { asked: component, components });
        }
        let (element, bricks) =
            (self.head().element, &self.summaries()?[step as usize][component as usize].bricks);
        let crosses = |brick: &u64| {
            let Brick { origin, sides } = grid.brick(*brick);
            let reach = per_axis(|axis| (origin[axis] + u64::from(sides[axis]) + 1).min(grid.extent[axis]));
            let found = grid.bricks_in(origin, reach).filter_map(|near| bricks[near as usize]);
            let ends = found.map(|near| [near.min(element), near.max(element)]);
            let ends = ends.reduce(|[min, max], [low, high]| [min.min(low), max.max(high)]);
            ends.is_some_and(|[min, max]| (min..=max).contains(&isovalue))
        };
        Ok((0..grid.bricks()).filter(crosses).collect())
    }

    /// Values of a part, which is what reading counts progress up to; 0 for a part that does not exist.
    pub fn values(&self, part: &Part) -> u64 {
        let Ok(wanted) = self.check(part) else { return 0 };
        self.shape_of(&wanted).bytes().map_or(0, |bytes| bytes / self.head().element.bytes() as u64)
    }
}

/// Where values go: a box of samples of some components.
struct Target<'a> {
    values: &'a mut [u8],
    extent: [u64; 3],
    /// Bytes of a value.
    size: usize,
    components: usize,
}

impl Target<'_> {
    /// Copies those samples of a decoded box of `sides` that are in `range` to their place, as one component.
    fn scatter(
        &mut self,
        bytes: &[u8],
        sides: [usize; 3],
        range: &[Range<usize>; 3],
        (to, component): ([usize; 3], usize),
    ) {
        let ([x, y, z], size) = (range, self.size);
        let [width, height, _] = self.extent.map(|axis| axis as usize);
        for (dz, z) in z.clone().enumerate() {
            for (dy, y) in y.clone().enumerate() {
                let from = ((z * sides[1] + y) * sides[0] + x.start) * size;
                let row = &bytes[from..from + x.len() * size];
                let first = ((to[2] + dz) * height + to[1] + dy) * width + to[0];
                self.row(row, first, component);
            }
        }
    }

    /// Copies single values to that component of the samples from number `first` on.
    fn row(&mut self, row: &[u8], first: usize, component: usize) {
        let start = (first * self.components + component) * self.size;
        if self.components == 1 {
            self.values[start..start + row.len()].copy_from_slice(row);
            return;
        }
        let places = self.values[start..].chunks_mut(self.components * self.size);
        for (place, value) in places.zip(row.chunks_exact(self.size)) {
            place[..self.size].copy_from_slice(value);
        }
    }
}

/// Memory for `bytes` samples, not touched before they are written: a damaged file that promises more than it holds
/// fails at its first brick. `None` if the system would not give that much.
fn zeros(bytes: u64) -> Option<Vec<u8>> {
    let len = usize::try_from(bytes).ok()?;
    Vec::<u8>::new().try_reserve_exact(len).ok()?;
    Some(vec![0; len])
}
