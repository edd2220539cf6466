//! A container, or a part of it, to a sink, in as little memory as is allowed.

use std::num::NonZeroUsize;
use std::sync::mpsc::channel;

use super::ahead::BUFFERS;
use super::fill::Holes;
use super::region::Wanted;
use super::{Container, ContainerError, Fill, Lost, Part, Pool, Progress, memory};
use crate::volume::Sink;

/// How a part is decompressed.
#[derive(Clone, Copy, Debug, Default)]
pub struct DecompressOptions {
    /// Threads; `None` for one per core.
    pub threads: Option<NonZeroUsize>,
    /// Bytes of memory to work in, about, beside that of the sink; `None` for half of what is free.
    pub memory: Option<u64>,
}

impl Container {
    /// Writes a part to a sink that was made for [`Container::header_of`] it, and finishes that; the last planes are
    /// written while the next are decoded.
    ///
    /// Where memory does not hold all that a row of bricks makes, its bricks are decoded several times. `progress` counts
    /// values, up to [`Container::values`].
    ///
    /// # Errors
    /// [`ContainerError`]; the sink is not finished then.
    pub fn decompress(
        &self,
        part: &Part,
        sink: Box<dyn Sink>,
        options: &DecompressOptions,
        progress: Progress<'_>,
    ) -> Result<(), ContainerError> {
        self.write_part(part, sink, options, (progress, None))
    }

    /// As [`Container::decompress`], but with `fill` in place of every sample whose brick is lost or damaged; returns
    /// those bricks, in the order of the file.
    ///
    /// # Errors
    /// As [`Container::decompress`], but for damaged bricks.
    pub fn decompress_with(
        &self,
        part: &Part,
        sink: Box<dyn Sink>,
        options: &DecompressOptions,
        fill: Fill,
        progress: Progress<'_>,
    ) -> Result<Vec<Lost>, ContainerError> {
        let holes = Holes::new(fill);
        self.write_part(part, sink, options, (progress, Some(&holes)))?;
        Ok(holes.into_lost())
    }

    fn write_part(
        &self,
        part: &Part,
        mut sink: Box<dyn Sink>,
        options: &DecompressOptions,
        watch: (Progress<'_>, Option<&Holes>),
    ) -> Result<(), ContainerError> {
        let wanted = self.check(part)?;
        let pool = Pool::new(options.threads)?;
        let memory = options.memory.unwrap_or_else(|| memory::available() / 2);
        for step in wanted.steps.clone() {
            let parts = self.slabs(step, &wanted, memory, pool.count() as u64)?;
            std::thread::scope(|threads| {
                let (full, slabs) = channel::<Vec<u8>>();
                let (home, empty) = channel();
                (0..BUFFERS).for_each(|_| home.send(Vec::new()).unwrap_or(()));
                let sink = &mut sink;
                let writing = threads.spawn(move || {
                    for slab in slabs {
                        sink.write(&slab)?;
                        // Nobody waits for it once all is decoded.
                        let _ = home.send(slab);
                    }
                    Ok::<(), ContainerError>(())
                });
                let decoded = parts.into_iter().try_for_each(|part| {
                    // It is missing only if writing has failed, which is told below.
                    let Ok(mut slab) = empty.recv() else { return Ok(()) };
                    slab.clear();
                    slab.resize(self.bytes_of(&part) as usize, 0);
                    self.fill(&pool, step, &part, (&mut slab, watch))?;
                    let _ = full.send(slab);
                    Ok(())
                });
                drop(full);
                let written = writing.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
                written.and(decoded)
            })?;
        }
        Ok(sink.finish()?)
    }

    /// Bytes of the values of one time step of what is wanted.
    fn bytes_of(&self, wanted: &Wanted) -> u64 {
        let value = self.head().element.bytes() as u64 * wanted.components.len() as u64;
        wanted.extent().into_iter().fold(value, u64::saturating_mul)
    }

    /// Cuts what is wanted of a step into parts that follow each other in its values, each in about as much memory: rows
    /// of bricks, or else planes, or else rows of a plane.
    fn slabs(
        &self,
        step: u64,
        wanted: &Wanted,
        memory: u64,
        threads: u64,
    ) -> Result<Vec<Wanted>, ContainerError> {
        let grid = self.grid(step)?;
        let brick: u64 = grid.sides.into_iter().map(u64::from).product();
        let most =
            memory.saturating_sub(brick.saturating_mul(DECODING_BYTES).saturating_mul(threads)) / BUFFERS;
        let [_, height, depth] = wanted.extent();
        let plane = self.bytes_of(&wanted.planes(wanted.from[2], wanted.from[2] + 1));
        let at_level = |axis: usize| (u64::from(grid.sides[axis]) >> wanted.level).max(1);
        let fit = most / plane;
        if fit > 0 || depth * height == 1 {
            return Ok(cuts(wanted.from[2], wanted.to[2], at_level(2), fit.max(1))
                .map(|[from, to]| wanted.planes(from, to))
                .collect());
        }
        let rows = (most / (plane / height).max(1)).max(1);
        let planes = (wanted.from[2]..wanted.to[2]).map(|z| wanted.planes(z, z + 1));
        let row_cuts = |plane: Wanted| {
            let cuts = cuts(plane.from[1], plane.to[1], at_level(1), rows);
            cuts.map(move |[from, to]| plane.rows(from, to))
        };
        Ok(planes.flat_map(row_cuts).collect())
    }
}

/// Bytes of memory that decoding takes for a sample of a brick, about: stored, as integers, in scratch, and as values.
const DECODING_BYTES: u64 = 24;

/// Cuts `from .. to` at multiples of `side`, and further where that is more than `most`.
fn cuts(from: u64, to: u64, side: u64, most: u64) -> impl Iterator<Item = [u64; 2]> {
    let next = move |at: u64| (at / side + 1).saturating_mul(side).min(to).min(at.saturating_add(most));
    let starts = std::iter::successors(Some(from), move |&at| Some(next(at)).filter(|&end| end < to));
    starts.map(move |at| [at, next(at)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cuts_follow_bricks_and_memory() {
        let cut = |from, to, side, most| cuts(from, to, side, most).map(|[_, end]| end).collect::<Vec<_>>();
        assert_eq!(cut(0, 10, 4, 100), [4, 8, 10]);
        assert_eq!(cut(3, 9, 4, 100), [4, 8, 9]);
        assert_eq!(cut(0, 10, 4, 3), [3, 4, 7, 8, 10]);
        assert_eq!(cut(5, 6, 1, 1), [6]);
    }
}
