//! A volume to a container.

use std::io::Write;
use std::num::NonZeroUsize;

use rayon::prelude::*;
use serde::Serialize;
use wavelift_kernel::Extent;

use super::brick::{Encoded, Worker};
use super::choice::{Candidates, Transform};
use super::container::{Description, Writer};
use super::{Choice, CompressError, Grid, Progress, pool};
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
}

/// Bricks that `auto` tries every candidate on.
const TRIED_BRICKS: u64 = 8;

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
    let transform = pool.install(|| choose(volume, &grid, &candidates));
    let readable_levels = readable_levels(volume, &grid, transform);
    let description =
        Description { grid, element: volume.element, transform, readable_levels, metadata: &volume.metadata };
    let mut writer = Writer::new(out, description)?;
    let batch = BATCH * pool.current_num_threads();
    for first in (0..grid.bricks()).step_by(batch) {
        let indices = first..grid.bricks().min(first + batch as u64);
        let encoded: Vec<Encoded> = pool.install(|| {
            let encode = |worker: &mut Worker, index| {
                let encoded = encode(worker, volume, &grid, index, transform);
                progress(samples_of(&grid, index));
                encoded
            };
            indices.into_par_iter().map_init(Worker::new, encode).collect()
        });
        encoded.into_iter().try_for_each(|brick| writer.brick(brick))?;
    }
    let container_bytes = writer.finish()?;
    Ok(Report {
        sample_bytes: actual,
        container_bytes,
        bricks: grid.bricks(),
        wavelet: transform.wavelet.map_or("none", |wavelet| wavelet.name()),
        levels: transform.levels,
        readable_levels,
    })
}

fn encode(worker: &mut Worker, volume: &Volume, grid: &Grid, index: u64, transform: Transform) -> Encoded {
    worker.encode(&volume.samples, volume.extent, volume.element, grid.brick(index), transform)
}

fn samples_of(grid: &Grid, index: u64) -> u64 {
    grid.brick(index).sides.into_iter().map(u64::from).product()
}

/// The candidate that makes a few bricks, spread over the volume, smallest; the first of several.
fn choose(volume: &Volume, grid: &Grid, candidates: &Candidates) -> Transform {
    let transform = |wavelet: Option<_>| Transform {
        wavelet: wavelet.filter(|_| candidates.levels > 0),
        levels: if wavelet.is_some() { candidates.levels } else { 0 },
    };
    if let [only] = candidates.wavelets[..] {
        return transform(only);
    }
    let tried = TRIED_BRICKS.min(grid.bricks());
    let bricks: Vec<u64> = (0..tried).map(|i| (2 * i + 1) * grid.bricks() / (2 * tried)).collect();
    let cost = |worker: &mut Worker, &wavelet: &_| {
        let len = |&index: &u64| encode(worker, volume, grid, index, transform(wavelet)).codestreams.len();
        bricks.iter().map(len).sum::<usize>()
    };
    let costs: Vec<usize> = candidates.wavelets.par_iter().map_init(Worker::new, cost).collect();
    let best = costs.iter().zip(&candidates.wavelets).min_by_key(|(cost, _)| **cost);
    transform(best.and_then(|(_, &wavelet)| wavelet))
}

/// The coarsest level that will mean something: none for types whose low-pass part is not in the samples' scale, nor
/// beyond what the bricks' borders and the transform allow.
fn readable_levels(volume: &Volume, grid: &Grid, transform: Transform) -> u8 {
    let in_scale = match volume.element {
        ElementType::F32 | ElementType::F64 | ElementType::U64 | ElementType::I64 => false,
        ElementType::U32 => volume.samples.as_chunks::<4>().0.iter().all(|bytes| bytes[3] < 0x80),
        _ => true,
    };
    let deepest = Extent::new(grid.sides).map_or(0, Extent::max_levels);
    if in_scale { transform.levels.min(grid.aligned_levels()).min(deepest) } else { 0 }
}
