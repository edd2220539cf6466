//! Measuring: the transform's time, the histogram of its coefficients, and real codestreams.

use std::time::{Duration, Instant};

use rayon::prelude::*;
use wavelift_kernel::metric::{self, Measure};
use wavelift_kernel::{Codec, Effort, Extent, Plan, SampleType, Training, Wavelet, max_encoded_len};

use super::{Row, Table};
use crate::codec::{Brick, Grid, Transform};
use crate::integers::{NotIntegers, sample_type, widen};
use crate::volume::{Fault, RankedExtent, Volume};

/// Told the number of samples done since it was last told, from any thread.
pub type Progress<'a> = &'a (dyn Fn(u64) + Sync);

/// How often a transform is run; the shortest time counts.
pub const RUNS: usize = 5;

/// Why there is no table of a volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TablesError {
    /// Floats, or integers of 64 bits.
    #[error(transparent)]
    NotIntegers(#[from] NotIntegers),
    /// A brick allows fewer levels.
    #[error("{levels} levels are too many: the bricks allow at most {max}")]
    TooManyLevels {
        /// Levels asked for.
        levels: u8,
        /// The most levels of the largest brick.
        max: u8,
    },
    /// A codestream does not decode to what went in: a fault of the codec.
    #[error("a codestream ({wavelet}, brick {brick}) decodes to other samples: please report this")]
    NotLossless {
        /// Name of the wavelet.
        wavelet: &'static str,
        /// Number of the brick.
        brick: u64,
    },
}

impl TablesError {
    /// Whose fault it is.
    pub const fn kind(&self) -> Fault {
        match self {
            Self::NotIntegers(_) | Self::TooManyLevels { .. } => Fault::Usage,
            Self::NotLossless { .. } => Fault::Data,
        }
    }
}

/// Measures the six wavelets, and no transform, on a volume of integers of up to 32 bits.
///
/// The volume is cut as by [`Grid::default_sides`] into bricks of about 2^18 samples. `levels` is for all bricks
/// that allow so many; `None` for as many as each allows. `progress` is told every sample seven times.
///
/// # Errors
///
/// [`TablesError`]; in particular if any codestream fails to come back bit for bit.
///
/// Cost: per row, [`RUNS`] transforms on one core, a sort of all coefficients (4 bytes a sample), then encoding
/// and decoding on all cores.
pub fn measure(
    title: &str,
    volume: &Volume,
    levels: Option<u8>,
    progress: Progress<'_>,
) -> Result<Table, TablesError> {
    let sample_type = sample_type(volume.element)?;
    let sides = Grid::default_sides(volume.extent, Grid::SMALL_BRICK);
    let grid = Grid::new(volume.extent, sides).expect("bricks of the default sides are possible");
    let max = extent(grid.sides).max_levels();
    if let Some(levels) = levels.filter(|&levels| levels > max) {
        return Err(TablesError::TooManyLevels { levels, max });
    }
    let cut = Cut { volume, sample_type, grid, levels: levels.unwrap_or(max), progress };
    let wavelets = Wavelet::ALL.map(Some).into_iter().chain([None]);
    Ok(Table {
        title: title.to_owned(),
        extent: RankedExtent::new(&volume.extent[..volume.rank()]).expect("a volume has samples"),
        element: volume.element,
        brick: grid.sides,
        bricks: grid.bricks(),
        rows: wavelets.map(|wavelet| cut.row(wavelet)).collect::<Result<_, _>>()?,
        reference: None,
    })
}

/// A volume in bricks.
struct Cut<'a> {
    volume: &'a Volume,
    sample_type: SampleType,
    grid: Grid,
    levels: u8,
    progress: Progress<'a>,
}

impl Cut<'_> {
    fn row(&self, wavelet: Option<Wavelet>) -> Result<Row, TablesError> {
        let (measure, forward) = self.transform(wavelet);
        let bricks = (0..self.grid.bricks()).into_par_iter();
        let stream_bytes = bricks.map(|brick| self.stream_bytes(wavelet, brick)).sum::<Result<u64, _>>()?;
        let levels = wavelet.map_or(0, |_| self.levels);
        Ok(Row { wavelet, levels, forward: wavelet.map(|_| forward), measure, stream_bytes })
    }

    /// The histogram of the coefficients of all bricks, and the time to make them.
    fn transform(&self, wavelet: Option<Wavelet>) -> (Measure, Duration) {
        let mut coefficients = Vec::with_capacity(self.volume.samples.len() / self.volume.element.bytes());
        let mut time = Duration::ZERO;
        for brick in 0..self.grid.bricks() {
            let brick = self.grid.brick(brick);
            let plan = self.plan(wavelet, &brick);
            let samples = self.samples(&brick);
            let mut values = samples.clone();
            let mut scratch = vec![0; plan.scratch_len()];
            let runs = (0..RUNS).map(|_| {
                values.copy_from_slice(&samples);
                let start = Instant::now();
                plan.forward(&mut values, &mut scratch).expect("the memory is that of the plan");
                start.elapsed()
            });
            time += runs.min().unwrap_or_default();
            coefficients.append(&mut values);
        }
        (metric::measure(&mut coefficients), time)
    }

    /// Encodes a brick, decodes and compares it, and returns the bytes that took.
    fn stream_bytes(&self, wavelet: Option<Wavelet>, number: u64) -> Result<u64, TablesError> {
        let brick = self.grid.brick(number);
        let plan = self.plan(wavelet, &brick);
        let samples = self.samples(&brick);
        let mut values = samples.clone();
        let mut scratch = vec![0; plan.scratch_len()];
        let room = max_encoded_len(plan.extent(), self.sample_type).expect("a brick's bytes can be counted");
        let mut stream = vec![0; room];
        let (mut codec, mut training) = (Codec::NEW, Box::new(Training::NEW));
        let effort = Effort::Default(&mut training);
        let bytes = codec
            .encode(effort, &plan, self.sample_type, &mut values, &mut scratch, &mut stream)
            .expect("the memory is that of the plan, the samples are of their type");
        let decoded = codec.decode(&stream[..bytes], &mut values, &mut scratch);
        if decoded.is_err() || values != samples {
            let wavelet = wavelet.map_or("none", Wavelet::name);
            return Err(TablesError::NotLossless { wavelet, brick: number });
        }
        (self.progress)(samples.len() as u64);
        Ok(bytes as u64)
    }

    fn plan(&self, wavelet: Option<Wavelet>, brick: &Brick) -> Plan {
        Transform { wavelet, levels: self.levels }.plan(extent(brick.sides))
    }

    /// The samples of a brick, row by row out of the volume.
    fn samples(&self, brick: &Brick) -> Vec<i32> {
        let mut samples = Vec::with_capacity(brick.samples() as usize);
        for row in self.volume.rows(brick.origin, brick.sides) {
            widen(self.volume.element, row, &mut samples);
        }
        samples
    }
}

fn extent(sides: [u32; 3]) -> Extent {
    Extent::new(sides).expect("a brick has samples, and less than 2^31")
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;
    use crate::volume::ElementType;
    use crate::volume::synthetic::{Kind, generate};

    #[test]
    fn a_volume_is_measured_brick_by_brick() {
        let volume = generate(Kind::Waves, [300, 256, 6], ElementType::U16, 1);
        let told = AtomicU64::new(0);
        let progress = |samples| {
            told.fetch_add(samples, Ordering::Relaxed);
        };
        let table = measure("waves", &volume, None, &progress).unwrap();
        assert_eq!(told.into_inner(), 7 * 300 * 256 * 6);
        assert_eq!((table.brick, table.bricks, table.rows.len()), ([160, 256, 6], 2, 7));
        assert_eq!(table.extent.to_string(), "300x256x6");
        for row in &table.rows {
            assert_eq!(row.measure.samples, 300 * 256 * 6);
            assert_eq!(row.levels, if row.wavelet.is_some() { 8 } else { 0 });
            assert!(row.stream_bytes > 0 && row.stream_bytes < table.raw_bytes());
        }
        let values = volume.samples.as_chunks().0.iter().map(|bytes| i32::from(u16::from_le_bytes(*bytes)));
        assert_eq!(table.rows[6].measure, metric::measure(&mut values.collect::<Vec<_>>()));
    }

    #[test]
    fn levels_and_types_that_are_impossible_are_refused() {
        let table = |element, levels| {
            measure("", &generate(Kind::Steps, [16, 9, 1], element, 1), Some(levels), &|_| {})
        };
        assert_eq!(table(ElementType::I32, 2).unwrap().rows[0].levels, 2);
        assert_eq!(table(ElementType::I32, 5), Err(TablesError::TooManyLevels { levels: 5, max: 4 }));
        let refused = NotIntegers { element: ElementType::F64 };
        assert_eq!(table(ElementType::F64, 1), Err(TablesError::NotIntegers(refused)));
    }
}
