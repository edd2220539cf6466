//! A container, or a part of it, to a volume; and checking without keeping.

use std::fmt;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::str::FromStr;
use std::sync::Mutex;

use rayon::prelude::*;
use wavelift_kernel::Extent;

use super::brick::{Decoded, Expected, Worker, coarsened, read_exceptions, scatter};
use super::choice::Transform;
use super::container::{BrickEntry, Container, Index};
use super::grid::per_axis;
use super::{Brick, ContainerError, Form, Progress, level, planes, pool, scaled};
use crate::volume::{ElementType, Volume, sample_bytes};

/// A box of samples: `from` up to but without `to`, along x, y, z of the volume at full resolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// The first sample.
    pub from: [u64; 3],
    /// One beyond the last; `u64::MAX` for the end of the axis.
    pub to: [u64; 3],
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = per_axis(|axis| format!("{}:{}", self.from[axis], self.to[axis]));
        write!(f, "{x},{y},{z}")
    }
}

/// A text that is not of the form `X0:X1,Y0:Y1,Z0:Z1`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is not a region: write X0:X1,Y0:Y1,Z0:Z1, each end beyond its beginning")]
pub struct RegionError(String);

impl FromStr for Region {
    type Err = RegionError;

    fn from_str(text: &str) -> Result<Self, RegionError> {
        let range = |text: &str| -> Option<[u64; 2]> {
            let (from, to) = text.split_once(':')?;
            Some([from.trim().parse().ok()?, to.trim().parse().ok()?]).filter(|[from, to]| from < to)
        };
        let ranges: Option<Vec<[u64; 2]>> = text.split(',').map(range).collect();
        let mut ranges =
            ranges.filter(|ranges| ranges.len() <= 3).ok_or_else(|| RegionError(text.to_owned()))?;
        ranges.resize(3, [0, u64::MAX]);
        Ok(Self { from: per_axis(|axis| ranges[axis][0]), to: per_axis(|axis| ranges[axis][1]) })
    }
}

/// Which samples of a volume are wanted. The default is all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Part {
    /// 0 for full resolution; level L keeps every 2^L-th position along each axis, from the volume's first on.
    pub level: u8,
    /// The box, at full resolution; `None` for the whole volume.
    pub region: Option<Region>,
}

/// A [`Part`] that is known to exist: samples `from .. to` of the level.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    level: u8,
    from: [u64; 3],
    to: [u64; 3],
}

impl Wanted {
    fn extent(&self) -> [u64; 3] {
        per_axis(|axis| self.to[axis] - self.from[axis])
    }
}

impl Container {
    /// Reads a part of the volume, on `threads` threads (`None`: one per core); bricks outside it are not touched.
    ///
    /// The samples of level L stand for the positions that are multiples of 2^L; of a region, those inside it.
    ///
    /// # Errors
    /// [`ContainerError`]: a part that the volume does not have, a damaged brick, a file that cannot be read.
    pub fn read(
        &self,
        part: &Part,
        threads: Option<NonZeroUsize>,
        progress: Progress<'_>,
    ) -> Result<Volume, ContainerError> {
        let index = self.index();
        let wanted = self.check(part)?;
        let extent = wanted.extent();
        let bytes = sample_bytes(extent, index.element).unwrap_or(u64::MAX);
        let mut samples = zeros(bytes).ok_or(ContainerError::OutOfMemory { bytes })?;
        let start = wanted.from.map(|first| first << wanted.level);
        let target = Mutex::new(&mut samples[..]);
        let bricks: Vec<u64> = self.bricks_of(&wanted).collect();
        pool(threads.map(NonZeroUsize::get))?.install(|| {
            bricks.into_par_iter().try_for_each_init(Worker::new, |worker, brick| {
                self.read_into(worker, brick, &wanted, &target)?;
                progress(self.samples_of(brick));
                Ok::<_, ContainerError>(())
            })
        })?;
        let metadata = index.metadata.of_part(start, 1 << wanted.level);
        Ok(Volume { extent, element: index.element, samples, metadata })
    }

    /// Decodes every brick and compares both checksums. Calls `damaged` with each that is not whole, in any order.
    ///
    /// # Errors
    /// [`ContainerError::Io`] if threads cannot be started.
    pub fn verify(
        &self,
        threads: Option<NonZeroUsize>,
        progress: Progress<'_>,
        damaged: &(dyn Fn(ContainerError) + Sync),
    ) -> Result<(), ContainerError> {
        pool(threads.map(NonZeroUsize::get))?.install(|| {
            (0..self.index().grid.bricks()).into_par_iter().for_each_init(Worker::new, |worker, brick| {
                if let Err(error) = self.decode(worker, brick, 0) {
                    damaged(error);
                }
                progress(self.samples_of(brick));
            });
        });
        Ok(())
    }

    /// Samples of the bricks that a part lies in, which is what [`Container::read`] counts progress up to; 0 for
    /// a part that does not exist.
    pub fn samples_read(&self, part: &Part) -> u64 {
        let wanted = self.check(part);
        wanted.map_or(0, |wanted| self.bricks_of(&wanted).map(|brick| self.samples_of(brick)).sum())
    }

    /// The bricks that hold what is wanted.
    fn bricks_of(&self, wanted: &Wanted) -> impl Iterator<Item = u64> + use<> {
        let position = |sample: u64| sample << wanted.level;
        let last = wanted.to.map(|end| position(end - 1) + 1);
        self.index().grid.bricks_in(wanted.from.map(position), last)
    }

    fn samples_of(&self, brick: u64) -> u64 {
        self.index().grid.brick(brick).samples()
    }

    fn check(&self, part: &Part) -> Result<Wanted, ContainerError> {
        let (index, level) = (self.index(), part.level);
        let extent = index.grid.extent;
        if level > index.readable_levels {
            let why = match index.readable_levels {
                0 => {
                    "the type of its samples or the sides of its bricks allow full resolution only".to_owned()
                }
                coarsest => format!("its coarsest is {coarsest}"),
            };
            return Err(ContainerError::NoSuchLevel { asked: level, why });
        }
        let mut region = part.region.unwrap_or(Region { from: [0; 3], to: [u64::MAX; 3] });
        for (end, extent) in region.to.iter_mut().zip(extent).filter(|(end, _)| **end == u64::MAX) {
            *end = extent;
        }
        let first = |position: u64| position.div_ceil(1 << level);
        let wanted = Wanted { level, from: region.from.map(first), to: region.to.map(first) };
        if (0..3).any(|axis| region.to[axis] > extent[axis] || region.from[axis] >= region.to[axis]) {
            return Err(ContainerError::NoSuchRegion { region, extent });
        }
        if (0..3).any(|axis| wanted.from[axis] >= wanted.to[axis]) {
            return Err(ContainerError::NoSampleInRegion { region, level });
        }
        Ok(wanted)
    }

    /// Reads one brick and copies what is wanted of it to its place.
    fn read_into(
        &self,
        worker: &mut Worker,
        index: u64,
        wanted: &Wanted,
        target: &Mutex<&mut [u8]>,
    ) -> Result<(), ContainerError> {
        let element = self.index().element;
        let brick = self.index().grid.brick(index);
        let bytes = self.decode(worker, index, wanted.level)?;
        let sides = coarsened(brick.sides, wanted.level);
        let origin = brick.origin.map(|first| first >> wanted.level);
        let range = |axis: usize| -> Range<usize> {
            let end = (origin[axis] + sides[axis] as u64).min(wanted.to[axis]);
            let start = origin[axis].max(wanted.from[axis]);
            (start - origin[axis]) as usize..(end.max(start) - origin[axis]) as usize
        };
        let place = per_axis(|axis| (origin[axis].max(wanted.from[axis]) - wanted.from[axis]) as usize);
        let extent = wanted.extent().map(|axis| axis as usize);
        let mut target = target.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        scatter(&bytes, sides, per_axis(range), place, (&mut target, extent, element.bytes()));
        Ok(())
    }

    /// Reads and decodes one brick; the result is little-endian samples of its level.
    fn decode(&self, worker: &mut Worker, index: u64, level: u8) -> Result<Vec<u8>, ContainerError> {
        let Index { grid, element, form, .. } = self.index();
        let entry = &self.index().bricks[index as usize];
        let brick = grid.brick(index);
        let stored = self.read_brick(index)?;
        if crc32fast::hash(&stored) != entry.stored_crc {
            return Err(damage(index, brick, "its bytes contradict their checksum"));
        }
        let decoded = match (form, entry.exceptions) {
            (Form::Scaled { .. }, None) => {
                let exact = Coded { transform: Transform::NONE, form: &Form::Exact };
                let samples = exact.decode(worker, &stored, entry, (*element, brick), 0);
                samples.map(|samples| scaled::thin(*element, brick.sides, level, &samples))
            }
            _ => {
                let coded = Coded { transform: self.transform(), form };
                coded.decode(worker, &stored, entry, (*element, brick), level)
            }
        };
        let bytes = decoded.map_err(|cause| damage(index, brick, cause))?;
        if level == 0 && crc32fast::hash(&bytes) != entry.samples_crc {
            return Err(damage(index, brick, "its samples contradict their checksum"));
        }
        Ok(bytes)
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
        stored: &[u8],
        entry: &BrickEntry,
        (element, brick): (ElementType, Brick),
        level: u8,
    ) -> Result<Vec<u8>, String> {
        let extent = Extent::new(brick.sides).map_err(|error| error.to_string())?;
        let expected = Expected::new(element, self.form, self.transform, extent);
        let is_lattice = self.form.slack().is_some();
        let asked = if is_lattice || self.transform.wavelet.is_some() { level } else { 0 };
        let mut decoded = worker.decode(stored, &entry.lengths, &expected, asked)?;
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
        if let Some(kept) = entry.exceptions {
            let exceptions = &stored[stored.len() - kept.bytes as usize..];
            let exceptions = read_exceptions(exceptions, kept).ok_or("its exceptions cannot be read")?;
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

/// Memory for `bytes` samples, not touched before they are written: a damaged file that promises more than it holds
/// fails at its first brick. `None` if the system would not give that much.
fn zeros(bytes: u64) -> Option<Vec<u8>> {
    let len = usize::try_from(bytes).ok()?;
    Vec::<u8>::new().try_reserve_exact(len).ok()?;
    Some(vec![0; len])
}

fn damage(index: u64, brick: Brick, cause: impl Into<String>) -> ContainerError {
    ContainerError::Brick { index, brick, cause: cause.into() }
}
