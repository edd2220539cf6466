//! `wavelift preview`.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use serde_json::json;
use wavelift_host::codec::{Container, ContainerError};
use wavelift_host::preview::{self, Axis, Depth, Picture, Select, Shown, View, Window};
use wavelift_host::volume::{Fault, FileFormat};

use super::choice::parse_threads;
use super::exit::Failure;
use super::input::{RawArgs, input_path, open_source_for, refuse_same_file};
use super::output::{JSON_AND_OUTPUT, output_path, print_json, refuse_standard_output, tell};
use super::progress::Bar;

/// Draw a slice of a volume, or the largest values along an axis, as a PNG picture
///
/// Of a compressed file only the bricks are decoded that the picture shows, at a coarse level unless a fine one is asked
/// for; of any other file every sample is looked at. Along z, x goes right and y down; along y, x right and z down;
/// along x, y right and z down. Samples with three or four components are red, green and blue.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift preview head.wlift head.png
  wavelift preview head.wlift front.png --slice y=128 --level 0
  wavelift preview angio.nrrd vessels.png --mip z --window 0:800")]
pub(crate) struct Args {
    /// Compressed file, or a volume in any other format
    #[arg(value_parser = input_path())]
    pub(crate) input: PathBuf,
    /// Picture to write
    #[arg(value_parser = output_path())]
    pub(crate) output: PathBuf,
    /// Slice along an axis, at a place that is counted at full resolution [default: the middle one along z]
    #[arg(long, value_name = "AXIS[=N]", value_parser = parse_slice, conflicts_with = "mip")]
    pub(crate) slice: Option<(Axis, Option<u64>)>,
    /// Largest value along an axis instead of a slice
    #[arg(long, value_name = "AXIS")]
    pub(crate) mip: Option<Axis>,
    /// Resolution of a compressed file: 0 is full, each level more has half the samples along each axis
    /// [default: the coarsest that gives --size]
    #[arg(long, value_name = "L", conflicts_with = "size")]
    pub(crate) level: Option<u8>,
    /// Pixels that the longer side should have at least, where there are so many samples
    #[arg(long, value_name = "N", default_value_t = 512)]
    pub(crate) size: u64,
    /// Values that are black and white [default: see --percentiles]
    #[arg(long, value_name = "LOW:HIGH", value_parser = Window::values, allow_hyphen_values = true)]
    pub(crate) window: Option<Window>,
    /// Percentages of the pixels' values that are black, and not white
    /// [default: 0.5:99.5, but every value as it is for colors of u8]
    #[arg(long, value_name = "LOW:HIGH", value_parser = Window::percentiles, conflicts_with = "window")]
    pub(crate) percentiles: Option<Window>,
    /// Bits of a channel: 8 or 16
    #[arg(long, value_name = "BITS", default_value = "8", value_parser = parse_depth)]
    pub(crate) depth: Depth,
    /// Time step, from 0
    #[arg(long, value_name = "T", default_value_t = 0)]
    pub(crate) step: u64,
    /// Component of samples that have several, from 0
    #[arg(long, value_name = "C")]
    pub(crate) component: Option<u32>,
    /// Threads to work on [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Report what was drawn as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) raw: RawArgs,
}

/// Draws a picture of a volume.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_same_file(&args.input, &args.output)?;
    if args.json {
        refuse_standard_output(&args.output, JSON_AND_OUTPUT)?;
    }
    refuse_other_picture(&args.output)?;
    let view = match (args.slice, args.mip) {
        (Some((axis, at)), _) => View::Slice(axis, at),
        (None, Some(axis)) => View::Maximum(axis),
        (None, None) => View::Slice(Axis::Z, None),
    };
    let select = Select { step: args.step, component: args.component };
    let is_compressed = args.input.is_file() && Container::is_container(&args.input);
    let (picture, level) =
        if is_compressed { of_container(args, view, select)? } else { (of_source(args, view, select)?, 0) };
    let window = args.window.or(args.percentiles).unwrap_or_else(|| picture.usual_window());
    picture.write_png(&args.output, window, args.depth).map_err(|error| Failure::new(Fault::Io, error))?;
    let ends = window.ends(&picture.values);
    if args.json {
        return print_json(&json!({
            "input": args.input.display().to_string(),
            "output": args.output.display().to_string(),
            "size": picture.size,
            "channels": picture.channels,
            "level": level,
            "window": ends,
        }));
    }
    let ([width, height], [low, high]) = (picture.size, ends);
    let output = args.output.display();
    tell(format_args!("{output}: {width}x{height}, level {level}, black {low}, white {high}"));
    Ok(())
}

fn of_container(args: &Args, view: View, select: Select) -> Result<(Picture, u8), Failure> {
    if args.raw.is_given() {
        let message = "is a wavelift file, which needs no --extent, --type or --byte-order";
        return Err(Failure::at(&args.input, Fault::Usage, message));
    }
    let at_input = |error: ContainerError| Failure::of_container(&args.input, &error);
    let container = Container::open(&args.input).map_err(at_input)?;
    let level = match args.level {
        Some(level) => level,
        None => preview::suitable_level(&container, view, args.step, args.size).map_err(at_input)?,
    };
    let bar = Bar::spinner("drawing");
    let count = |values| bar.count(values);
    let picture = preview::of_container(&container, view, select, level, (args.threads, &count));
    Ok((picture.map_err(|error| failure(args, error))?, level))
}

fn of_source(args: &Args, view: View, select: Select) -> Result<Picture, Failure> {
    if args.level.is_some_and(|level| level > 0) {
        let message = "has no levels: compress it first, or leave out --level";
        return Err(Failure::at(&args.input, Fault::Usage, message));
    }
    let layout = args.raw.layout(None)?;
    let mut source = open_source_for(&args.input, layout.as_ref(), &args.output)?;
    let bar = Bar::spinner("drawing");
    let picture = preview::of_source(source.as_mut(), view, select, &|values| bar.count(values));
    picture.map_err(|error| failure(args, error))
}

fn failure(args: &Args, error: Shown) -> Failure {
    match error {
        Shown::Container(error) => Failure::of_container(&args.input, &error),
        Shown::Read(error) => error.into(),
        other => Failure::at(&args.input, Fault::Usage, other),
    }
}

/// Reads `z` or `z=40`.
fn parse_slice(text: &str) -> Result<(Axis, Option<u64>), String> {
    let (axis, at) = text.split_once('=').map_or((text, None), |(axis, at)| (axis, Some(at)));
    let axis = axis.parse().map_err(|error: preview::UnknownAxis| error.to_string())?;
    let at = at.map(str::parse).transpose().map_err(|_| "give a slice as z=40, the first is 0".to_owned())?;
    Ok((axis, at))
}

/// Refuses a name that promises another format than PNG.
fn refuse_other_picture(output: &Path) -> Result<(), Failure> {
    const OTHERS: [&str; 6] = ["jpg", "jpeg", "bmp", "gif", "webp", "svg"];
    let extension = output.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let is_known = !matches!(FileFormat::of_path(output), FileFormat::Raw | FileFormat::Png);
    if !is_known && !OTHERS.contains(&extension.as_str()) {
        return Ok(());
    }
    Err(Failure::at(output, Fault::Usage, "pictures are written as PNG: name it .png"))
}

fn parse_depth(text: &str) -> Result<Depth, String> {
    match text {
        "8" => Ok(Depth::Eight),
        "16" => Ok(Depth::Sixteen),
        _ => Err("give 8 or 16".to_owned()),
    }
}
