//! A data set to a container.

use std::io::Write;
use std::num::NonZeroUsize;

use super::ahead::{BUFFERS, read_ahead};
use super::brick::Coding;
use super::content::{Channel, Head, Step, Summary};
use super::encode::Job;
use super::supply::{Block, Gathered, Layout, Supply};
use super::survey::Survey;
use super::trial::{Trial, Tried};
use super::writer::Writer;
use super::{Brick, Choice, CompressError, Container, Effort, Form, Grid, Pool, Progress, memory};
use crate::bound::{Bound, Tolerance};
use crate::progress::tell;
use crate::volume::{ElementType, Header, InMemory, Source, Volume, sample_bytes};

/// How a data set is compressed.
#[derive(Clone, Debug, Default)]
pub struct CompressOptions {
    /// The wavelet.
    pub wavelet: Choice,
    /// Levels of the transform; `None` for as many as a brick allows.
    pub levels: Option<u8>,
    /// How hard to try.
    pub effort: Effort,
    /// How far a sample may move; `None` to keep every bit. A relative bound is one of the range of each component of
    /// each time step.
    pub tolerance: Option<Tolerance>,
    /// Sides of a brick; `None` for [`Grid::default_sides`] of [`Grid::SMALL_BRICK`], or of [`Grid::LARGE_BRICK`] for
    /// [`Effort::Dense`] and where samples may move, unless the effort is fast or light.
    pub brick: Option<[u32; 3]>,
    /// Threads; `None` for one per core. The bytes do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Bytes of memory to work in, about, beside that of the source; `None` for half of what is free. The bytes do not
    /// depend on it.
    pub memory: Option<u64>,
    /// Names of the components; none, or one for each.
    pub names: Vec<String>,
    /// What the time steps are called; those beyond have no name.
    pub labels: Vec<Label>,
}

/// What a time step is called.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Label {
    /// Its name.
    pub name: Option<String>,
    /// Its time.
    pub time: Option<f64>,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Bytes of the samples that were compressed.
    pub sample_bytes: u64,
    /// Bytes of the container.
    pub container_bytes: u64,
    /// What is the same for every time step.
    pub head: Head,
    /// The time steps that were compressed.
    pub steps: Vec<Step>,
    /// What the samples are like, of each component of each of these time steps.
    pub summaries: Vec<Vec<Summary>>,
}

/// Compresses `volume` into `out`, one pass from front to back: [`compress_stream`] of what is in memory.
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
    let actual = volume.samples.len() as u64;
    let mut source = InMemory::new(volume).ok_or(CompressError::SampleBytes { expected, actual })?;
    compress_stream(&mut source, options, out, progress)
}

/// Compresses all that `source` has into `out`, one pass from front to back.
///
/// Each component of each time step is a volume of its own, with a form, a transform and a bound of its own. Every step
/// is read twice, once to look through it and once to code it; one that comes compressed or through a pipe is copied in
/// between, to memory or to a temporary file. With a tolerance, every brick is decoded again and compared with its
/// samples, in exact arithmetic, before it is written.
///
/// The bytes depend on the values and on all options but threads and memory. `progress` counts values.
///
/// # Errors
/// [`CompressError`]; what is in `out` is of no use then.
///
/// Memory: [`CompressOptions::memory`], but at least a few bricks for each thread and two more.
pub fn compress_stream(
    source: &mut dyn Source,
    options: &CompressOptions,
    out: &mut impl Write,
    progress: Progress<'_>,
) -> Result<Report, CompressError> {
    let header = source.header().clone();
    let head = head(&header, options)?;
    let writer = Writer::new(out, &head, &header.metadata)?;
    Compressor::new(head, options)?.run(source, writer, progress)
}

/// Writes all records of `container` to `out`, and then those of the time steps of `source`.
///
/// # Errors
/// [`CompressError`]; what is in `out` is of no use then.
///
/// Cost: that of copying the container, beside that of compressing.
pub fn append(
    container: &Container,
    source: &mut dyn Source,
    options: &CompressOptions,
    out: &mut impl Write,
    progress: Progress<'_>,
) -> Result<Report, CompressError> {
    let head = container.head().clone();
    refuse_others(&head, source.header())?;
    let writer = resumed(container, out)?;
    Compressor::new(head, options)?.run(source, writer, progress)
}

/// A copy of a container that takes more steps.
pub(super) fn resumed<W: Write>(container: &Container, mut out: W) -> Result<Writer<W>, CompressError> {
    let (written, index, summaries) = container.for_appending()?;
    container.copy(0..written, &mut out)?;
    let records = (container.head(), container.metadata()?);
    Ok(Writer::resumed(out, written, index, summaries, records)?)
}

/// What is the same for every time step.
pub(super) fn head(header: &Header, options: &CompressOptions) -> Result<Head, CompressError> {
    let (names, components) = (options.names.clone(), header.components);
    if header.step_bytes().is_none_or(|bytes| bytes == 0) {
        return Err(CompressError::Extent { extent: header.extent, components });
    }
    if !names.is_empty() && names.len() as u64 != u64::from(components) {
        return Err(CompressError::Names { names: names.len(), components });
    }
    let (program, element) = (env!("CARGO_PKG_VERSION").to_owned(), header.element);
    Ok(Head { program, extent: header.extent, components, element, names })
}

/// Refuses steps of another kind than those that are there.
pub(super) fn refuse_others(head: &Head, header: &Header) -> Result<(), CompressError> {
    let say = |extent: [u64; 3], components, element: ElementType| {
        let [x, y, z] = extent;
        let components = if components == 1 { String::new() } else { format!(" of {components} components") };
        format!("{x}x{y}x{z} {element}{components}")
    };
    let there = say(head.extent, head.components, head.element);
    let given = say(header.extent, header.components, header.element);
    if there == given {
        return Ok(());
    }
    Err(CompressError::OtherSteps { file: "the file".to_owned(), there, given })
}

/// What is the same for all steps that are compressed.
pub(super) struct Compressor<'a> {
    pub(super) head: Head,
    options: &'a CompressOptions,
    pool: Pool,
    memory: u64,
}

impl<'a> Compressor<'a> {
    pub(super) fn new(head: Head, options: &'a CompressOptions) -> Result<Self, CompressError> {
        let pool = Pool::new(options.threads)?;
        let memory = options.memory.unwrap_or_else(|| memory::available() / 2);
        Ok(Self { head, options, pool, memory })
    }

    fn run<W: Write>(
        self,
        source: &mut dyn Source,
        mut writer: Writer<W>,
        progress: Progress<'_>,
    ) -> Result<Report, CompressError> {
        let header = source.header().clone();
        let first = writer.next_step();
        let memory = self.memory - source.hold_at_most(self.memory / 2).min(self.memory);
        let compressor = Compressor { memory, ..self };
        let mut steps = Vec::new();
        for number in 0..header.steps {
            let label = compressor.label(steps.len());
            let mut supply = Supply::new(source, number, memory / 2)?;
            steps.push(compressor.step(&mut supply, first + number, label, &mut writer, progress)?);
        }
        let summaries = writer.summaries()[first as usize..].to_vec();
        let (container_bytes, _) = writer.finish()?;
        let sample_bytes = header.bytes().unwrap_or(u64::MAX);
        Ok(Report { sample_bytes, container_bytes, head: compressor.head, steps, summaries })
    }

    /// What a step is called, the first that is compressed being 0.
    pub(super) fn label(&self, step: usize) -> Label {
        self.options.labels.get(step).cloned().unwrap_or_default()
    }

    /// Room for the values of a step that do not come from a source.
    pub(super) fn room(&self) -> Result<Gathered, CompressError> {
        let layout = self.layout();
        let bytes = layout.extent.into_iter().fold(layout.sample(), u64::saturating_mul);
        Gathered::new(bytes, self.memory / 2)
    }

    pub(super) fn layout(&self) -> Layout {
        let Head { extent, components, element, .. } = self.head;
        Layout { extent, components, size: element.bytes() }
    }

    /// Compresses one time step.
    pub(super) fn step<W: Write>(
        &self,
        supply: &mut Supply<'_>,
        number: u64,
        label: Label,
        writer: &mut Writer<W>,
        progress: Progress<'_>,
    ) -> Result<Step, CompressError> {
        let (element, layout) = (self.head.element, self.layout());
        let (surveys, crc) = self.survey(supply, progress)?;
        let bound = |survey: &Survey| self.options.tolerance.map(|bound| bound.within(survey.range()));
        let bounds: Vec<Option<Bound>> = surveys.iter().map(bound).collect();
        let errors = bounds.iter().map(|bound| bound.map_or(0.0, |bound| bound.error));
        let sides =
            self.options.brick.unwrap_or_else(|| self.default_sides(errors.clone().fold(0.0, f64::max)));
        let grid = Grid::new(self.head.extent, sides).ok_or(CompressError::BrickSides(sides))?;
        let (mut codings, mut tried) = (Vec::new(), Vec::new());
        for ((component, survey), error) in (0..).zip(&surveys).zip(errors) {
            tell(progress, 0)?;
            let (coding, of_trial) = self.best(supply, survey, &grid, (component, error))?;
            codings.push(coding);
            tried.push(of_trial);
        }
        let channels = codings.iter().zip(&surveys).zip(bounds);
        let channels =
            channels.map(|((coding, survey), bound)| channel(coding, survey, &grid, bound, element));
        let Label { name, time } = label;
        let step = Step { number, name, time, sides: grid.sides, channels: channels.collect() };
        writer.step(&step)?;
        let known: u64 = tried.iter().flatten().map(Tried::held).sum();
        let most = self.most(&grid, supply.held().saturating_add(known));
        let job = Job { step: &step, codings: &codings, tried: &tried, grid, element, layout, most };
        let coded = job.run(supply, &self.pool, writer, progress)?;
        if coded.is_some_and(|coded| coded != crc) {
            return Err(CompressError::Changed);
        }
        writer.end_step()?;
        Ok(step)
    }

    /// Looks through all values of a step. Returns a survey for each component, and the checksum of all values.
    fn survey(
        &self,
        supply: &mut Supply<'_>,
        progress: Progress<'_>,
    ) -> Result<(Vec<Survey>, u32), CompressError> {
        let layout = self.layout();
        let samples: u64 = layout.extent.into_iter().product();
        let mut surveys: Vec<Survey> =
            (0..layout.components).map(|_| Survey::new(self.head.element, samples)).collect();
        let mut hasher = crc32fast::Hasher::new();
        let enough = u64::from(LOOK_SAMPLES) * LOOKS_AT_ONCE * self.pool.count() as u64;
        let piece = (PIECE_BYTES / layout.sample()).clamp(1, enough);
        let wanted = (0..samples).step_by(piece as usize).map(move |first| {
            let last = (first + piece).min(samples);
            (last - first, std::iter::once(first * layout.sample()..last * layout.sample()).collect())
        });
        std::thread::scope(|threads| {
            for found in read_ahead(threads, supply, wanted) {
                let (samples, values) = found?;
                tell(progress, 0)?;
                hasher.update(&values);
                let whole = Block { values: &values, layout, origin: [0; 3], sides: [samples, 1, 1] };
                look_through(&self.pool, whole, &mut surveys);
            }
            Ok::<(), CompressError>(())
        })?;
        Ok((surveys, hasher.finalize()))
    }

    /// The sides of bricks unless asked otherwise: large ones for [`Effort::Dense`], and where there may be lattices.
    fn default_sides(&self, error: f64) -> [u32; 3] {
        let (effort, element) = (self.options.effort, self.head.element);
        let moves = error >= 1.0 || error > 0.0 && element.is_float();
        let is_large = effort == Effort::Dense || effort.has_lattices() && moves;
        let samples = if is_large { Grid::LARGE_BRICK } else { Grid::SMALL_BRICK };
        Grid::default_sides(self.head.extent, samples)
    }

    /// What makes a component smallest, judging by some pieces of it; and what that makes of the whole, if it was tried on
    /// that.
    fn best(
        &self,
        supply: &mut Supply<'_>,
        survey: &Survey,
        grid: &Grid,
        (component, error): (u32, f64),
    ) -> Result<(Coding, Option<Tried>), CompressError> {
        let (layout, element, effort) = (self.layout(), self.head.element, self.options.effort);
        let mut cut = |boxes: &[Brick]| {
            let cut_one = |&Brick { origin, sides }: &Brick| {
                let mut values = Vec::new();
                let wide = sides.map(u64::from);
                supply.read(&layout.stretches(origin, wide), &mut values)?;
                let block = Block { values: &values, layout, origin, sides: wide };
                Ok(block.cut(origin, sides, component))
            };
            boxes.iter().map(cut_one).collect::<Result<Vec<Vec<u8>>, CompressError>>()
        };
        let candidates = self.options.wavelet.candidates(self.options.levels, grid.sides)?;
        let trial = Trial { pool: &self.pool, survey, element, grid, effort, error };
        trial.best(&candidates, &mut cut)
    }

    /// Bytes that may be read at once, beside `held` bytes and those that bricks are coded in.
    fn most(&self, grid: &Grid, held: u64) -> u64 {
        let brick: u64 = grid.sides.into_iter().map(u64::from).product();
        let coding = brick.saturating_mul(CODING_BYTES).saturating_mul(self.pool.count() as u64);
        self.memory.saturating_sub(held).saturating_sub(coding) / BUFFERS
    }
}

/// Bytes that are read at once to be looked through, at most.
const PIECE_BYTES: u64 = 1 << 22;

/// How often each thread looks through samples that were read at once: few threads read so little that it stays near.
const LOOKS_AT_ONCE: u64 = 4;

/// Samples that one thread looks through at once.
const LOOK_SAMPLES: u32 = 1 << 17;

/// Bytes of memory that coding takes for a sample of a brick, about: as integers, in scratch, coded, and decoded again.
const CODING_BYTES: u64 = 40;

/// Adds the samples of a line to the surveys of their components.
fn look_through(pool: &Pool, line: Block<'_>, surveys: &mut [Survey]) {
    let starts = (0..line.sides[0]).step_by(LOOK_SAMPLES as usize);
    let parts = starts.flat_map(|start| (0..surveys.len()).map(move |component| (start, component)));
    let look = |(start, component): (u64, usize)| {
        let count = (line.sides[0] - start).min(LOOK_SAMPLES.into()) as u32;
        let mut next = surveys[component].next();
        next.add(&line.cut([start, 0, 0], [count, 1, 1], component as u32));
        (component, next)
    };
    let found = pool.map(parts.collect(), look);
    found.iter().for_each(|(component, next)| surveys[*component].append(next));
}

/// What there is to say before the bricks are coded.
fn channel(
    coding: &Coding,
    survey: &Survey,
    grid: &Grid,
    bound: Option<Bound>,
    element: ElementType,
) -> Channel {
    Channel {
        effort: coding.effort,
        wavelet: coding.transform.wavelet,
        levels: coding.transform.levels,
        readable_levels: readable_levels(coding, survey, grid, element),
        form: coding.form.clone(),
        bound,
    }
}

/// The coarsest level that will mean something: none for integers whose low-pass part is not in the samples' scale, nor
/// beyond what the bricks' borders and the transform allow. Without a transform, a reader makes levels of what it
/// decodes.
fn readable_levels(coding: &Coding, survey: &Survey, grid: &Grid, element: ElementType) -> u8 {
    let in_scale = match (element, &coding.form) {
        (ElementType::U32, Form::Exact | Form::Packed(_)) => survey.largest() < 1 << 31,
        (element, form) => form.has_levels(element),
    };
    let transform = coding.transform;
    let levels = if transform.wavelet.is_some() { transform.levels } else { grid.max_levels() };
    if in_scale { levels.min(grid.aligned_levels()) } else { 0 }
}
