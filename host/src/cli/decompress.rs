//! `wavelift decompress`.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use wavelift_host::codec::{
    Channel, Container, ContainerError, Damage, DecompressOptions, FileAt, Fill, Lost, Part, Region,
    Salvaged, Step,
};
use wavelift_host::volume::{self, ByteOrder, Created, ElementType, Fault, FileFormat, Header, WriteOptions};
use wavelift_kernel::Wavelet;

use super::choice::{parse_memory, parse_threads};
use super::convert::{self, in_words};
use super::exit::Failure;
use super::info::QUICK;
use super::input::{byte_order_names, input_path, refuse_same_file};
use super::output::{JSON_AND_OUTPUT, output_path, print_json, refuse_standard_output, say_losses, tell};
use super::progress::Bar;
use super::repair::{self, say_damage, say_lost};

/// Get a volume back: all of it, a region, a coarse level, a time step, a component
///
/// OUTPUT is of the format that its extension says, raw for an unknown one, and by default as the volume was before: same byte order, same
/// order of axes, same header where the format has room for it. It appears whole or not at all.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift decompress head.wlift head.nrrd
  wavelift decompress head.wlift preview.nrrd --level 2
  wavelift decompress engine.wlift corner.npy --region 0:64,0:64,0:32
  wavelift decompress wind.wlift up.nrrd --step 3 --component 2
  wavelift decompress damaged.wlift rest.nrrd --salvage --fill 0")]
pub(crate) struct Args {
    /// Compressed file
    #[arg(value_parser = input_path())]
    pub(crate) input: PathBuf,
    /// File to write: its extension says the format, .nhdr has its samples in a file beside it; raw samples for an unknown one
    #[arg(value_parser = output_path())]
    pub(crate) output: PathBuf,
    /// Resolution: 0 is full, each level more has half the samples along each axis
    #[arg(long, value_name = "L", default_value_t = 0)]
    pub(crate) level: u8,
    /// Samples from X0 up to but without X1, and so on, counted at full resolution; axes left out at the end are
    /// taken whole
    #[arg(long, allow_hyphen_values = true, value_name = "X0:X1,Y0:Y1,Z0:Z1")]
    pub(crate) region: Option<Region>,
    /// Time step, the first is 0 [default: all]
    #[arg(long, value_name = "N")]
    pub(crate) step: Option<u64>,
    /// Component of the samples, the first is 0 [default: all]
    #[arg(long, value_name = "N")]
    pub(crate) component: Option<u32>,
    /// Order of the bytes of a sample in OUTPUT [default: as it was in the file compressed]
    #[arg(long, value_name = "ORDER", value_parser = byte_order_names())]
    pub(crate) byte_order: Option<ByteOrder>,
    /// Compress the samples of an NRRD file with gzip
    #[arg(long)]
    pub(crate) gzip: bool,
    /// Threads to work on [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Memory to work in, about, such as 512MiB or 4G [default: half of what is free]
    #[arg(long, value_name = "SIZE", value_parser = parse_memory)]
    pub(crate) memory: Option<u64>,
    /// Read what is whole of a damaged or truncated file, put single wrong bytes right, and fill the rest. Every brick
    /// that is lost is named with its region, and the exit code is 3 if one is
    #[arg(long)]
    pub(crate) salvage: bool,
    /// Value of samples that are lost [default: NaN for floating-point samples, 0 for others]
    #[arg(long, value_name = "V", requires = "salvage", allow_hyphen_values = true)]
    pub(crate) fill: Option<String>,
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
    let at_input = |error| failure(&args.input, error);
    let (container, damage) = open(args)?;
    let part = Part { level: args.level, region: args.region, step: args.step, component: args.component };
    let header = container.header_of(&part).map_err(at_input)?;
    let fill = fill(args, header.element)?;
    let options = WriteOptions { byte_order: args.byte_order, gzip: args.gzip };
    let Created { sink, losses } = volume::create(&args.output, &header, &options)?;
    let bar = Bar::new("decompressing", container.values(&part), header.element.bytes());
    let count = |values| bar.count(values);
    let options = DecompressOptions { threads: args.threads, memory: args.memory };
    let lost = match damage {
        Some(_) => container.decompress_with(&part, sink, &options, fill, &count),
        None => container.decompress(&part, sink, &options, &count).map(|()| Vec::new()),
    };
    let lost = lost.map_err(at_input)?;
    drop(bar);
    tell_of(args, &container, &Written { header, losses, damage, lost })
}

/// What was written, and what of it is missing.
struct Written {
    header: Header,
    losses: Vec<String>,
    damage: Option<Damage>,
    lost: Vec<Lost>,
}

/// Opens the compressed file, or what is left of it.
fn open(args: &Args) -> Result<(Container, Option<Damage>), Failure> {
    if !args.salvage {
        let container = Container::open(&args.input).map_err(|error| failure(&args.input, error))?;
        return Ok((container, None));
    }
    let file = FileAt::open(&args.input)
        .map_err(|cause| Failure::of_container(&args.input, &ContainerError::Io(cause)))?;
    let salvaged = Container::salvage(Box::new(file));
    let Salvaged { container, damage } =
        salvaged.map_err(|error| Failure::at(&args.input, error.kind(), error))?;
    Ok((container, Some(damage)))
}

fn fill(args: &Args, element: ElementType) -> Result<Fill, Failure> {
    let Some(text) = &args.fill else { return Ok(Fill::usual(element)) };
    Fill::of_text(element, text)
        .map_err(|error| Failure::new(Fault::Usage, format_args!("--fill: {error}, the samples' type")))
}

/// A failure to read or to write.
fn failure(input: &Path, error: ContainerError) -> Failure {
    match error {
        ContainerError::Write(error) => error.into(),
        other if other.is_damage() => {
            let advice = "`--salvage` writes what is whole";
            Failure::at(input, Fault::Data, format_args!("{}: {advice}", other.cause()))
        }
        other => Failure::of_container(input, &other),
    }
}

/// Tells what was written, and what the format has no place for.
fn tell_of(args: &Args, container: &Container, written: &Written) -> Result<(), Failure> {
    let Written { header, losses, damage, lost } = written;
    let format = FileFormat::of_path(&args.output);
    if args.json {
        print_json(&document(args, written))?;
    } else {
        say_losses(&args.output, losses);
        let (output, bytes) = (args.output.display(), header.bytes().unwrap_or(u64::MAX));
        tell(format_args!("{output}: {}, {bytes} bytes of samples, {}", in_words(header), format.name()));
        let step = container.step(args.step.unwrap_or(0)).map_err(|error| failure(&args.input, error))?;
        tell_of_level(args.level, step);
    }
    let Some(damage) = damage else { return Ok(()) };
    say_damage(&args.input, damage);
    say_lost(&args.input, damage, lost);
    if lost.is_empty() {
        return Ok(());
    }
    let message = format_args!("{} of the bricks asked for are lost, and filled", lost.len());
    Err(Failure::at(&args.input, Fault::Data, message))
}

/// Tells what is to be known of coarse levels.
fn tell_of_level(level: u8, step: &Step) {
    let wavelet = step.channels.iter().find_map(|channel| channel.wavelet);
    match wavelet {
        _ if level == 0 => {}
        Some(wavelet) if loses_digits(wavelet) => {
            tell(format_args!(
                "coarse levels under {wavelet} come in steps; under haar and linear they do not"
            ));
        }
        None if !step.channels.iter().any(Channel::has_quick_levels) => {
            tell(format_args!("whole bricks were decoded, as they have no transform: {QUICK}"));
        }
        _ => {}
    }
}

fn document(args: &Args, written: &Written) -> Value {
    let Written { header, losses, damage, lost } = written;
    let mut document = convert::document([&args.input, &args.output], header, losses);
    if let Some(damage) = damage {
        document["lost"] = repair::list(lost).into();
        document["lost_steps"] = json!(damage.lost_steps);
        document["lost_metadata"] = damage.lost_metadata.into();
        document["mended"] = json!(damage.mended);
        document["gaps"] = json!(repair::gaps(damage));
    }
    document
}

/// Whether the low-pass part is smaller than the samples, so that scaling it back leaves gaps.
fn loses_digits(wavelet: Wavelet) -> bool {
    wavelet.low_pass_gain() != (1, 1)
}
