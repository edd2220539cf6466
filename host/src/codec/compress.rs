//! A volume to a container.

use std::io::Write;
use std::num::NonZeroUsize;

use rayon::prelude::*;

use super::brick::{Coding, Encoded, Samples, Unfaithful, Worker};
use super::content::{Channel, Head, Place, Step, Summary};
use super::trial::Trial;
use super::writer::Writer;
use super::{Choice, CompressError, Effort, Form, Grid, Progress, pool};
use crate::bound::{self, Bound, Tolerance};
use crate::volume::{ElementType, Header, Volume, sample_bytes};

/// How a volume is compressed.
#[derive(Clone, Copy, Debug, Default)]
pub struct CompressOptions {
    /// The wavelet.
    pub wavelet: Choice,
    /// Levels of the transform; `None` for as many as a brick allows.
    pub levels: Option<u8>,
    /// How hard to try.
    pub effort: Effort,
    /// How far a sample may move; `None` to keep every bit.
    pub tolerance: Option<Tolerance>,
    /// Sides of a brick; `None` for [`Grid::default_sides`] of [`Grid::SMALL_BRICK`], or of [`Grid::LARGE_BRICK`] for
    /// [`Effort::Dense`] and where samples may move, unless the effort is fast.
    pub brick: Option<[u32; 3]>,
    /// Threads; `None` for one per core. The bytes do not depend on it.
    pub threads: Option<NonZeroUsize>,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Bytes of the samples.
    pub sample_bytes: u64,
    /// Bytes of the container.
    pub container_bytes: u64,
    /// What is the same for every time step.
    pub head: Head,
    /// The time steps.
    pub steps: Vec<Step>,
    /// What the samples are like, of each component of each time step.
    pub summaries: Vec<Vec<Summary>>,
}

/// Bricks coded before they are written, per thread.
const BATCH: usize = 8;

/// Compresses `volume` into `out`, one pass from front to back.
///
/// With a tolerance, every brick is decoded again and compared with its samples, in exact arithmetic, before it is
/// written. Takes the memory of a few bricks per thread beside the volume. The bytes depend on the volume and on all
/// options but the number of threads.
///
/// # Errors
/// [`CompressError`]; what is in `out` is of no use then.
pub fn compress(
    volume: &Volume,
    options: &CompressOptions,
    out: &mut impl Write,
    progress: Progress<'_>,
) -> Result<Report, CompressError> {
    let expected = sample_bytes(volume.extent, volume.element).unwrap_or(u64::MAX);
    let sample_bytes = volume.samples.len() as u64;
    if sample_bytes != expected {
        return Err(CompressError::SampleBytes { expected, actual: sample_bytes });
    }
    let range = || bound::range(volume.element, &volume.samples);
    let bound = options.tolerance.map(|tolerance| tolerance.within(range()));
    let (effort, error) = (options.effort, bound.map_or(0.0, |bound| bound.error));
    let sides = options.brick.unwrap_or_else(|| default_sides(volume, effort, error));
    let grid = Grid::new(volume.extent, sides).ok_or(CompressError::BrickSides(sides))?;
    let pool = pool(options.threads.map(NonZeroUsize::get))?;
    let candidates = options.wavelet.candidates(options.levels, grid.sides)?;
    let trial = Trial { volume, grid: &grid, effort, error };
    let coding = pool.install(|| trial.best(&candidates)).map_err(|Unfaithful| CompressError::Unfaithful)?;
    let head = head(&volume.header());
    let step = Step {
        number: 0,
        name: None,
        time: None,
        sides: grid.sides,
        channels: vec![channel(volume, &grid, &coding, bound)],
    };
    let readable = step.channels[0].readable_levels;
    let mut writer = Writer::new(out, &head, &volume.metadata)?;
    writer.step(&step)?;
    let batch = BATCH * pool.current_num_threads();
    for first in (0..grid.bricks()).step_by(batch) {
        let indices = first..grid.bricks().min(first + batch as u64);
        let encoded: Result<Vec<Encoded>, Unfaithful> = pool.install(|| {
            let encode = |worker: &mut Worker, index| {
                let brick = grid.brick(index);
                let bytes = volume.cut(brick.origin, brick.sides);
                let samples = Samples { element: volume.element, sides: brick.sides, bytes: &bytes };
                let encoded = worker.encode(samples, &coding);
                progress(brick.samples());
                encoded
            };
            indices.clone().into_par_iter().map_init(Worker::new, encode).collect()
        });
        let encoded = encoded.map_err(|Unfaithful| CompressError::Unfaithful)?;
        for (brick, encoded) in indices.zip(encoded) {
            let label = encoded.label(Place { step: 0, brick, component: 0 }, readable);
            writer.brick(&step, &label, &encoded.bytes, encoded.statistics)?;
        }
    }
    writer.end_step()?;
    let summaries = writer.summaries().to_vec();
    let container_bytes = writer.finish()?;
    Ok(Report { sample_bytes, container_bytes, head, steps: vec![step], summaries })
}

/// What is the same for every time step.
fn head(header: &Header) -> Head {
    Head {
        program: env!("CARGO_PKG_VERSION").to_owned(),
        extent: header.extent,
        components: header.components,
        element: header.element,
        names: Vec::new(),
    }
}

/// The sides of bricks unless asked otherwise: large ones for [`Effort::Dense`], and where there may be lattices.
fn default_sides(volume: &Volume, effort: Effort, error: f64) -> [u32; 3] {
    let moves = error >= 1.0 || error > 0.0 && volume.element.is_float();
    let is_large = effort == Effort::Dense || effort.has_lattices() && moves;
    Grid::default_sides(volume.extent, if is_large { Grid::LARGE_BRICK } else { Grid::SMALL_BRICK })
}

/// What there is to say before the bricks are coded.
fn channel(volume: &Volume, grid: &Grid, coding: &Coding, bound: Option<Bound>) -> Channel {
    Channel {
        effort: coding.effort,
        wavelet: coding.transform.wavelet,
        levels: coding.transform.levels,
        readable_levels: readable_levels(volume, grid, coding),
        form: coding.form.clone(),
        bound,
    }
}

/// The coarsest level that will mean something: none for integers whose low-pass part is not in the samples' scale, nor
/// beyond what the bricks' borders and the transform allow. Without a transform, a reader makes levels of what it
/// decodes.
fn readable_levels(volume: &Volume, grid: &Grid, coding: &Coding) -> u8 {
    let in_scale = match (volume.element, &coding.form) {
        (ElementType::U32, Form::Exact | Form::Packed(_)) => {
            volume.samples.as_chunks::<4>().0.iter().all(|bytes| bytes[3] < 0x80)
        }
        (element, form) => form.has_levels(element),
    };
    let transform = coding.transform;
    let levels = if transform.wavelet.is_some() { transform.levels } else { grid.max_levels() };
    if in_scale { levels.min(grid.aligned_levels()) } else { 0 }
}
