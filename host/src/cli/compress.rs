//! `wavelift compress`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use serde_json::{Value, json};
use wavelift_host::codec::{self, Choice, CompressError, CompressOptions, Effort, Report};
use wavelift_host::volume::Volume;
use wavelift_kernel::Wavelet;

use super::bound::{self, BoundArgs};
use super::choice::{Levels, effort_names, parse_brick, parse_threads, wavelet_choices};
use super::exit::Failure;
use super::input::{RawArgs, read_volume, refuse_same_file};
use super::output::{JSON_AND_OUTPUT, print_json, refuse_standard_output, tell, write_atomically};
use super::progress;

/// Compress a volume without loss, or within an error bound
///
/// INPUT is NRRD, NumPy or raw samples of any integer or floating-point type; OUTPUT holds the same samples, bit for
/// bit unless an error bound is given, and all that the header said. It appears whole or not at all.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift compress head.nrrd head.wlift
  wavelift compress engine.raw engine.wlift --extent 256x256x128 --type u8
  wavelift compress density.npy density.wlift --relative-error 1e-4 --brick 128")]
pub(crate) struct Args {
    /// Volume to compress: .nrrd, .nhdr, .npy, or raw samples with --extent and --type
    pub(crate) input: PathBuf,
    /// Compressed file to write
    pub(crate) output: PathBuf,
    /// Wavelet of the transform; none does without (smallest for sparse, noisy or very smooth volumes), auto takes
    /// whichever of all makes this volume smallest
    #[arg(long, value_name = "W", default_value = "auto", value_parser = wavelet_choices())]
    pub(crate) wavelet: Choice,
    /// Levels of the transform, each a resolution of half the samples along each axis: auto for as many as a brick
    /// allows, or a number
    #[arg(long, value_name = "N", default_value = "auto")]
    pub(crate) levels: Levels,
    /// How hard to try: fast, default, or dense, which is smallest. Any wavelift reads any of them
    #[arg(long, value_name = "E", default_value = "default", value_parser = effort_names())]
    pub(crate) effort: Effort,
    #[command(flatten)]
    pub(crate) bound: BoundArgs,
    /// Samples of the bricks that are coded, and can be read, one by one: N along each axis, or XxYxZ
    /// [default: about 2^18 samples, 64x64x64 where no axis is shorter; 2^21 with --effort dense, and within an error
    /// bound unless --effort is fast]
    #[arg(long, value_name = "N|XxYxZ", value_parser = parse_brick)]
    pub(crate) brick: Option<[u32; 3]>,
    /// Threads to work on; the file is the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Report sizes and choices as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) raw: RawArgs,
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
    let volume = read_volume(&args.input, args.raw.layout(None)?.as_ref())?;
    let options = CompressOptions {
        wavelet: args.wavelet,
        levels: args.levels.count(),
        effort: args.effort,
        tolerance: args.bound.tolerance(),
        brick: args.brick,
        threads: args.threads,
    };
    let samples = volume.extent.into_iter().product();
    let bar = progress::bar("compressing", samples);
    let report = write_atomically(&args.output, |out| {
        codec::compress(&volume, &options, out, &|samples| bar.inc(samples)).map_err(|error| match error {
            CompressError::Io(cause) => Failure::cannot_write(&args.output, &cause),
            fault => Failure::new(fault.kind(), fault),
        })
    })?;
    drop(bar);
    if args.json {
        return print_json(&document(args, &volume, &report));
    }
    let [x, y, z] = volume.extent;
    tell(format_args!(
        "{}: {x}x{y}x{z} {}, {} bytes -> {}: {} bytes, {:.3} bits a sample, {:.2}:1, wavelet {}, {} levels",
        args.input.display(),
        volume.element,
        report.sample_bytes,
        args.output.display(),
        report.container_bytes,
        8.0 * report.container_bytes as f64 / samples as f64,
        report.sample_bytes as f64 / report.container_bytes as f64,
        report.steps[0].channels[0].wavelet.map_or("none", Wavelet::name),
        report.steps[0].channels[0].levels,
    ));
    bound::lines(&report.steps[0].channels[0], &report.summaries[0][0])
        .iter()
        .for_each(|line| tell(format_args!("{line}")));
    Ok(())
}

fn document(args: &Args, volume: &Volume, report: &Report) -> Value {
    let (channel, summary) = (&report.steps[0].channels[0], &report.summaries[0][0]);
    let samples: u64 = volume.extent.into_iter().product();
    let mut document = json!({
        "input": args.input.display().to_string(),
        "output": args.output.display().to_string(),
        "extent": volume.extent,
        "type": volume.element.name(),
        "sample_bytes": report.sample_bytes,
        "bytes": report.container_bytes,
        "bits_per_sample": 8.0 * report.container_bytes as f64 / samples as f64,
        "bricks": summary.bricks.len(),
        "effort": channel.effort.name(),
        "wavelet": channel.wavelet.map_or("none", Wavelet::name),
        "levels": channel.levels,
        "readable_levels": channel.readable_levels,
    });
    if let Value::Object(fields) = &mut document {
        fields.extend(bound::fields(channel, summary));
    }
    document
}
