//! `wavelift transform`.

use std::path::PathBuf;

use wavelift_host::transform::{self, TransformError};
use wavelift_host::volume::{self, ElementType, Fault, WriteOptions};
use wavelift_kernel::Wavelet;

use super::exit::Failure;
use super::input::{RawArgs, read_volume_for, refuse_same_file, wavelet_names};
use super::output::tell;

/// Transform a volume to wavelet coefficients or back, without coding (for study and tests)
///
/// The coefficients of the whole volume, as 32-bit signed integers in Mallat order: along each axis the low half
/// first, x fastest. OUTPUT is raw and little-endian, or NRRD or NumPy by its extension.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift transform head.nrrd coefficients.nrrd --wavelet linear --levels 3
  wavelift transform coefficients.nrrd samples.nrrd --wavelet linear --levels 3 --inverse
  wavelift transform c.raw s.raw --wavelet linear --levels 3 --inverse --extent 64x64x93

The inverse gives the samples as 32-bit integers, whatever they were before; unsigned ones of 32 bits as the same bits.
With 0 levels the samples are converted to 32 bits and nothing else.")]
pub(crate) struct Args {
    /// Volume of integers of up to 32 bits; with --inverse, coefficients (a raw file then needs --extent only)
    input: PathBuf,
    /// File to write, as 32-bit integers; it appears whole or not at all
    output: PathBuf,
    /// Wavelet of the transform
    #[arg(long, value_name = "W", value_parser = wavelet_names())]
    wavelet: Wavelet,
    /// Levels of the transform: how often the low-pass part is transformed again
    #[arg(long, value_name = "N")]
    levels: u8,
    /// From coefficients back to samples
    #[arg(long)]
    inverse: bool,
    #[command(flatten)]
    raw: RawArgs,
}

/// Reads, transforms, writes.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_same_file(&args.input, &args.output)?;
    let layout = args.raw.layout(args.inverse.then_some(ElementType::I32))?;
    let input = read_volume_for(&args.input, layout.as_ref(), &args.output)?;
    let direction = if args.inverse { transform::inverse } else { transform::forward };
    let output = direction(&input, args.wavelet, args.levels)
        .map_err(|error: TransformError| Failure::at(&args.input, Fault::Usage, error))?;
    volume::write(&output, &args.output, &WriteOptions::default())?;
    let [x, y, z] = output.extent;
    let made = if args.inverse { "samples" } else { "coefficients" };
    let (output, levels, wavelet) = (args.output.display(), args.levels, args.wavelet.name());
    tell(format_args!("{output}: {x}x{y}x{z} {made}, {levels} levels of {wavelet}"));
    Ok(())
}
