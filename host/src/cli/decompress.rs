//! `wavelift decompress`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use serde_json::json;
use wavelift_host::codec::{Container, Part, Region};
use wavelift_host::volume::{self, ByteOrder, FileFormat, WriteOptions};
use wavelift_kernel::Wavelet;

use super::choice::parse_threads;
use super::exit::Failure;
use super::input::{byte_order_names, refuse_same_file};
use super::output::{JSON_AND_OUTPUT, print_json, refuse_standard_output, say, tell};
use super::progress;

/// Get a volume back: all of it, a region, or a coarse level
///
/// OUTPUT is NRRD, NumPy or raw by its extension, and by default as the volume was before: same byte order, same
/// order of axes, same header where the format has room for it. It appears whole or not at all.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift decompress head.wlift head.nrrd
  wavelift decompress head.wlift preview.nrrd --level 2
  wavelift decompress engine.wlift corner.npy --region 0:64,0:64,0:32")]
pub(crate) struct Args {
    /// Compressed file
    pub(crate) input: PathBuf,
    /// Volume to write: .nrrd, .nhdr (samples in a file beside it), .npy, or raw samples for any other extension
    pub(crate) output: PathBuf,
    /// Resolution: 0 is full, each level more has half the samples along each axis
    #[arg(long, value_name = "L", default_value_t = 0)]
    pub(crate) level: u8,
    /// Samples from X0 up to but without X1, and so on, counted at full resolution; axes left out at the end are
    /// taken whole
    #[arg(long, value_name = "X0:X1,Y0:Y1,Z0:Z1")]
    pub(crate) region: Option<Region>,
    /// Order of the bytes of a sample in OUTPUT [default: as it was in the file compressed]
    #[arg(long, value_name = "ORDER", value_parser = byte_order_names())]
    pub(crate) byte_order: Option<ByteOrder>,
    /// Compress the samples of an NRRD file with gzip
    #[arg(long)]
    pub(crate) gzip: bool,
    /// Threads to work on [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Report what was written as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Writes a volume, or a part of it, from a compressed file.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_same_file(&args.input, &args.output)?;
    if args.json {
        refuse_standard_output(&args.output, JSON_AND_OUTPUT)?;
    }
    let at_input = |error| Failure::of_container(&args.input, &error);
    let container = Container::open(&args.input).map_err(at_input)?;
    let part = Part { level: args.level, region: args.region, ..Part::default() };
    let bar = progress::bar("decompressing", container.samples_read(&part));
    let volume = container.read(&part, args.threads, &|samples| bar.inc(samples)).map_err(at_input)?;
    drop(bar);
    let options = WriteOptions { byte_order: args.byte_order, gzip: args.gzip };
    let losses = volume::write(&volume, &args.output, &options)?;
    let format = FileFormat::of_path(&args.output);
    if args.json {
        return print_json(&json!({
            "input": args.input.display().to_string(),
            "output": args.output.display().to_string(),
            "format": format.name(),
            "extent": volume.extent,
            "type": volume.element.name(),
            "sample_bytes": volume.samples.len(),
            "not_kept": losses,
        }));
    }
    if !losses.is_empty() {
        let (output, format, losses) = (args.output.display(), format.name(), losses.join(", "));
        say(format_args!("wavelift: {output}: {format} has no place for {losses}"));
    }
    let [x, y, z] = volume.extent;
    tell(format_args!(
        "{}: {x}x{y}x{z} {}, {} bytes of samples, {}",
        args.output.display(),
        volume.element,
        volume.samples.len(),
        format.name(),
    ));
    let wavelet = container.step(0).map_err(at_input)?.channels[0].wavelet;
    if let Some(wavelet) = wavelet.filter(|wavelet| args.level > 0 && loses_digits(*wavelet)) {
        tell(format_args!("coarse levels under {wavelet} come in steps; under haar and linear they do not"));
    }
    Ok(())
}

/// Whether the low-pass part is smaller than the samples, so that scaling it back leaves gaps.
fn loses_digits(wavelet: Wavelet) -> bool {
    wavelet.low_pass_gain() != (1, 1)
}
