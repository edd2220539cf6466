//! A volume to a container.

use std::io::Write;
use std::num::NonZeroUsize;

use rayon::prelude::*;
use serde::Serialize;

use super::brick::{Coding, Encoded, Worker};
use super::choice::{Candidates, Transform};
use super::container::{Index, Writer, has_levels};
use super::{Choice, CompressError, Grid, Progress, Values, pool};
use crate::volume::{ElementType, Volume, sample_bytes};

/// How a volume is compressed.
#[derive(Clone, Copy, Debug, Default)]
pub struct CompressOptions {
    /// The wavelet.
    pub wavelet: Choice,
    /// Levels of the transform; `None` for as many as a brick allows.
    pub levels: Option<u8>,
    /// Sides of a brick; `None` for [`Grid::default_sides`].
    pub brick: Option<[u32; 3]>,
    /// Threads; `None` for one per core. The bytes do not depend on it.
    pub threads: Option<NonZeroUsize>,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Report {
    /// Bytes of the samples.
    pub sample_bytes: u64,
    /// Bytes of the container.
    pub container_bytes: u64,
    /// Number of bricks.
    pub bricks: u64,
    /// The wavelet chosen, `none` for no transform.
    pub wavelet: &'static str,
    /// Levels of its transform.
    pub levels: u8,
    /// The coarsest level that can be read.
    pub readable_levels: u8,
    /// Values that samples are packed to the numbers of, if they are.
    pub packed_values: Option<usize>,
}

/// Bricks that `auto` tries every candidate on.
const TRIED_BRICKS: u64 = 8;

/// Bytes that a packed value takes in the index, about.
const BYTES_PER_VALUE: u64 = 2;

/// Bricks coded before they are written, per thread.
const BATCH: usize = 8;

/// Compresses `volume` into `out`, one pass from front to back.
///
/// Takes the memory of a few bricks per thread beside the volume. The bytes depend on the volume and on wavelet,
/// levels and bricks, not on the number of threads.
///
/// # Errors
/// [`CompressError`]; what is in `out` is of no use then.
pub fn compress(
    volume: &Volume,
    options: &CompressOptions,
    out: &mut impl Write,
    progress: Progress<'_>,
) -> Result<Report, CompressError> {
    let sides = options.brick.unwrap_or_else(|| Grid::default_sides(volume.extent));
    let grid = Grid::new(volume.extent, sides).ok_or(CompressError::BrickSides(sides))?;
    let expected = sample_bytes(volume.extent, volume.element).unwrap_or(u64::MAX);
    let actual = volume.samples.len() as u64;
    if actual != expected {
        return Err(CompressError::SampleBytes { expected, actual });
    }
    let pool = pool(options.threads.map(NonZeroUsize::get))?;
    let candidates = options.wavelet.candidates(options.levels, grid.sides)?;
    let coding = pool.install(|| choose(volume, &grid, &candidates));
    let index = Index {
        grid,
        element: volume.element,
        wavelet: coding.transform.wavelet,
        levels: coding.transform.levels,
        readable_levels: readable_levels(volume, &grid, coding.transform),
        values: coding.values.as_deref().and_then(Values::new),
        metadata: volume.metadata.clone(),
        bricks: Vec::new(),
    };
    let mut report = Report {
        sample_bytes: actual,
        container_bytes: 0,
        bricks: grid.bricks(),
        wavelet: index.wavelet.map_or("none", |wavelet| wavelet.name()),
        levels: index.levels,
        readable_levels: index.readable_levels,
        packed_values: index.values.as_ref().map(Values::count),
    };
    let mut writer = Writer::new(out, index)?;
    let batch = BATCH * pool.current_num_threads();
    for first in (0..grid.bricks()).step_by(batch) {
        let indices = first..grid.bricks().min(first + batch as u64);
        let encoded: Vec<Encoded> = pool.install(|| {
            let encode = |worker: &mut Worker, index| {
                let encoded = worker.encode(volume, grid.brick(index), &coding);
                progress(grid.brick(index).samples());
                encoded
            };
            indices.into_par_iter().map_init(Worker::new, encode).collect()
        });
        encoded.into_iter().try_for_each(|brick| writer.brick(brick))?;
    }
    report.container_bytes = writer.finish()?;
    Ok(report)
}

/// The candidate that makes a few bricks, spread over the volume, smallest; the first of several.
fn choose(volume: &Volume, grid: &Grid, candidates: &Candidates) -> Coding {
    let mut codings: Vec<Coding> =
        candidates.transforms().map(|transform| Coding { transform, values: None }).collect();
    if codings.iter().any(|coding| coding.transform.wavelet.is_none()) {
        let packed = |values| Coding { transform: Transform::NONE, values: Some(values) };
        codings.extend(Values::of(volume).map(packed));
    }
    let tried = TRIED_BRICKS.min(grid.bricks());
    let bricks: Vec<u64> = (0..tried).map(|i| (2 * i + 1) * grid.bricks() / (2 * tried)).collect();
    let cost = |worker: &mut Worker, coding: &Coding| {
        let len = |&index: &u64| worker.encode(volume, grid.brick(index), coding).codestreams.len() as u64;
        let values = coding.values.as_ref().map_or(0, |values| BYTES_PER_VALUE * values.len() as u64);
        values + bricks.iter().map(len).sum::<u64>() * grid.bricks() / tried
    };
    if codings.len() > 1 {
        let costs: Vec<u64> = codings.par_iter().map_init(Worker::new, cost).collect();
        let best = costs.iter().enumerate().min_by_key(|&(_, cost)| cost).map_or(0, |(best, _)| best);
        codings.swap(0, best);
    }
    codings.swap_remove(0)
}

/// The coarsest level that will mean something: none for types whose low-pass part is not in the samples' scale, nor
/// beyond what the bricks' borders and the transform allow. Without a transform, a reader makes levels of what it
/// decodes.
fn readable_levels(volume: &Volume, grid: &Grid, transform: Transform) -> u8 {
    let in_scale = match volume.element {
        ElementType::U32 => volume.samples.as_chunks::<4>().0.iter().all(|bytes| bytes[3] < 0x80),
        element => has_levels(element),
    };
    let levels = if transform.wavelet.is_some() { transform.levels } else { grid.max_levels() };
    if in_scale { levels.min(grid.aligned_levels()) } else { 0 }
}
