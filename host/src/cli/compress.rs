//! `wavelift compress`.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};
use wavelift_host::codec::{self, Choice, CompressOptions, Effort, Report, Step, Summary};
use wavelift_host::volume::{ElementType, Fault, FileFormat, Header};
use wavelift_kernel::Wavelet;

use super::bound::{self, BoundArgs};
use super::choice::{Levels, effort_names, parse_brick, parse_memory, parse_threads, wavelet_choices};
use super::exit::Failure;
use super::input::{RawArgs, input_path, open_source_for, refuse_same_file};
use super::output::{JSON_AND_OUTPUT, output_path, print_json, refuse_standard_output, tell};
use super::progress::Bar;

/// Compress a volume without loss, or within an error bound
///
/// INPUT is a file of any format that wavelift knows, of any integer or floating-point type, with any number of
/// components and time steps; OUTPUT holds the same values, bit for bit unless an error bound is given, and all that the
/// header said. Both may be larger than memory. OUTPUT appears whole or not at all.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift compress head.nrrd head.wlift
  wavelift compress engine.raw engine.wlift --extent 256x256x128 --type u8
  wavelift compress density.npy density.wlift --relative-error 1e-4 --brick 128
  wavelift compress wind.nrrd wind.wlift --component-names u,v,w --memory 512MiB")]
pub(crate) struct Args {
    /// Volume to compress: of any format that wavelift knows, or raw samples with --extent and --type
    #[arg(value_parser = input_path())]
    pub(crate) input: PathBuf,
    /// Compressed file to write
    #[arg(value_parser = output_path())]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) how: How,
    /// Names of the components of a sample, kept with them
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    pub(crate) component_names: Vec<String>,
    /// Report sizes and choices as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) raw: RawArgs,
}

/// How volumes are compressed.
#[derive(Debug, clap::Args)]
pub(crate) struct How {
    /// Wavelet of the transform; none does without, which is smallest; auto is none, or with --levels the wavelet that
    /// makes this volume smallest
    #[arg(long, value_name = "W", default_value = "auto", value_parser = wavelet_choices())]
    pub(crate) wavelet: Choice,
    /// Levels of the transform, each a resolution of half the samples along each axis: a number, or auto for as many as
    /// a brick allows, none without a wavelet
    #[arg(long, value_name = "N", default_value = "auto")]
    pub(crate) levels: Levels,
    /// How hard to try: fast, default, or dense, which is smallest; or light, for bricks that small processors decode.
    /// Any wavelift reads any of them
    #[arg(long, value_name = "E", default_value = "default", value_parser = effort_names())]
    pub(crate) effort: Effort,
    #[command(flatten)]
    pub(crate) bound: BoundArgs,
    /// Samples of the bricks that are coded, and can be read, one by one: N along each axis, or XxYxZ
    /// [default: about 2^18 samples, 64x64x64 where no axis is shorter; 2^21 with --effort dense, and within an error
    /// bound unless --effort is fast or light]
    #[arg(long, value_name = "N|XxYxZ", value_parser = parse_brick)]
    pub(crate) brick: Option<[u32; 3]>,
    /// Threads to work on; the file is the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Memory to work in, about, such as 512MiB or 4G; the file is the same for any [default: half of what is free]
    #[arg(long, value_name = "SIZE", value_parser = parse_memory)]
    pub(crate) memory: Option<u64>,
}

impl How {
    pub(crate) fn options(&self) -> CompressOptions {
        CompressOptions {
            wavelet: self.wavelet,
            levels: self.levels.count(),
            effort: self.effort,
            tolerance: self.bound.tolerance(),
            brick: self.brick,
            threads: self.threads,
            memory: self.memory,
            ..CompressOptions::default()
        }
    }
}

/// Compresses a volume.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_same_file(&args.input, &args.output)?;
    if args.json {
        refuse_standard_output(&args.output, JSON_AND_OUTPUT)?;
    }
    let mut source = open_source_for(&args.input, args.raw.layout(None)?.as_ref(), &args.output)?;
    refuse_other_format(&args.output)?;
    let bar = Bar::new("compressing", values(source.header()), source.header().element.bytes());
    let count = |values| bar.count(values);
    let options = CompressOptions { names: args.component_names.clone(), ..args.how.options() };
    let report = codec::compress_file(&args.output, source.as_mut(), &options, &count)?;
    drop(bar);
    tell_of(&args.input, &args.output, &report, args.json)
}

/// Refuses a name that promises a format which nobody could read the file as.
fn refuse_other_format(output: &Path) -> Result<(), Failure> {
    let name = match FileFormat::of_path(output) {
        FileFormat::Raw => return Ok(()),
        other => other.name(),
    };
    let message = format_args!(
        "is named as a file of {name}, but would be a compressed one: name it .wlift, or write {name} with \
         `wavelift convert`"
    );
    Err(Failure::at(output, Fault::Usage, message))
}

/// How many values a data set has.
pub(crate) fn values(header: &Header) -> u64 {
    header.bytes().map_or(0, |bytes| bytes / header.element.bytes() as u64)
}

/// Tells what came of it.
pub(crate) fn tell_of(input: &Path, output: &Path, report: &Report, json: bool) -> Result<(), Failure> {
    if json {
        return print_json(&document(input, output, report));
    }
    let head = &report.head;
    let [x, y, z] = head.extent;
    let components =
        if head.components > 1 { format!(" of {} components", head.components) } else { String::new() };
    let steps =
        if report.steps.len() == 1 { String::new() } else { format!(", {} time steps", report.steps.len()) };
    let channels =
        report.steps.iter().zip(&report.summaries).flat_map(|(step, all)| step.channels.iter().zip(all));
    let (mut told, mut transforms) = (Vec::new(), Vec::new());
    for (channel, summary) in channels {
        let transform =
            format!("wavelet {}, {} levels", channel.wavelet.map_or("none", Wavelet::name), channel.levels);
        push_new(&mut transforms, transform);
        bound::lines(channel, summary).into_iter().for_each(|line| push_new(&mut told, line));
    }
    tell(format_args!(
        "{}: {x}x{y}x{z} {}{components}{steps}, {} bytes -> {}: {} bytes, {:.3} bits a value, {:.2}:1, {}",
        input.display(),
        head.element,
        report.sample_bytes,
        output.display(),
        report.container_bytes,
        bits(report),
        report.sample_bytes as f64 / report.container_bytes as f64,
        transforms.join("; "),
    ));
    told.iter().for_each(|line| tell(format_args!("{line}")));
    Ok(())
}

fn push_new(texts: &mut Vec<String>, text: String) {
    if !texts.contains(&text) {
        texts.push(text);
    }
}

/// Bits that a value takes in the file.
fn bits(report: &Report) -> f64 {
    let values = report.sample_bytes as f64 / report.head.element.bytes() as f64;
    8.0 * report.container_bytes as f64 / values
}

fn document(input: &Path, output: &Path, report: &Report) -> Value {
    let head = &report.head;
    let mut document = json!({
        "input": input.display().to_string(),
        "output": output.display().to_string(),
        "extent": head.extent,
        "components": head.components,
        "type": head.element.name(),
        "sample_bytes": report.sample_bytes,
        "bytes": report.container_bytes,
        "bits_per_sample": bits(report),
        "bricks": report.summaries.iter().flatten().map(|summary| summary.bricks.len()).sum::<usize>(),
        "readable_levels": report.steps.iter().map(Step::readable_levels).min(),
    });
    if let Value::Object(fields) = &mut document {
        fields.extend(steps_document(&report.steps, &report.summaries, head.element));
    }
    document
}

/// How every component of every time step is coded; of one volume of single values at the top as well.
pub(crate) fn steps_document(
    steps: &[Step],
    summaries: &[Vec<Summary>],
    element: ElementType,
) -> Map<String, Value> {
    let mut fields = Map::new();
    if let ([step], [summaries]) = (steps, summaries)
        && let ([channel], [summary]) = (&step.channels[..], &summaries[..])
    {
        fields.insert("brick".to_owned(), json!(step.sides));
        fields.extend(bound::channel_fields(channel, summary, element));
    }
    let of_step = |(step, summaries): (&Step, &Vec<Summary>)| {
        let channels = step.channels.iter().zip(summaries);
        let channels: Vec<Value> = channels
            .map(|(channel, summary)| bound::channel_fields(channel, summary, element).into())
            .collect();
        json!({ "name": step.name, "time": step.time, "brick": step.sides, "components": channels })
    };
    fields.insert("steps".to_owned(), steps.iter().zip(summaries).map(of_step).collect());
    fields
}
