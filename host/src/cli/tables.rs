//! `wavelift tables`.

use std::path::{Path, PathBuf};

use wavelift_host::tables::{self, Table};
use wavelift_host::volume::{self, Volume};

use super::exit::Failure;
use super::input::{RawArgs, read_volume, read_volume_for, refuse_same_file};
use super::output;
use super::progress::Bar;

/// Compare the six wavelets on a volume, or on a built-in slice and brick
///
/// For each wavelet, and for none: how long the transform takes, how long the code of its coefficients' histogram is
/// (the columns of Tables 3.5 and 3.6 in Bertram's dissertation), and how long the real codestream. Every codestream
/// is decoded again and compared before it is counted. Volumes are cut into bricks of
/// about 2^18 samples, as `wavelift compress` does.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift tables
  wavelift tables --svg tables.svg
  wavelift tables engine.raw --extent 256x256x128 --type u8 --json")]
pub(crate) struct Args {
    /// Volume of integers of up to 32 bits; without one, the built-in slice and brick
    input: Option<PathBuf>,
    /// Levels of the transform [default: as many as the extent allows]
    #[arg(long, value_name = "N")]
    levels: Option<u8>,
    /// Write one JSON document instead of text
    #[arg(long)]
    json: bool,
    /// Draw the tables as a picture into this file, too
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    #[command(flatten)]
    raw: RawArgs,
}

/// Measures, draws, prints.
///
/// # Errors
/// A [`Failure`]; nothing is drawn or printed unless everything could be measured.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if let (Some(input), Some(svg)) = (&args.input, &args.svg) {
        refuse_same_file(input, svg)?;
    }
    if let Some(svg) = &args.svg {
        let message = "the tables and --svg both go to standard output: give --svg another file";
        output::refuse_standard_output(svg, message)?;
    }
    let layout = args.raw.layout(None)?;
    let tables = match &args.input {
        None if layout.is_some() => {
            let message = "--extent and --type describe INPUT, which is not given";
            return Err(Failure::new(volume::Fault::Usage, message));
        }
        None => built_in(args.levels)?,
        Some(input) => {
            let title = input.file_name().unwrap_or(input.as_os_str()).to_string_lossy();
            let volume = match &args.svg {
                Some(svg) => read_volume_for(input, layout.as_ref(), svg)?,
                None => read_volume(input, layout.as_ref())?,
            };
            vec![measure(input, &title, &volume, args.levels)?]
        }
    };
    if let Some(path) = &args.svg {
        output::write_file(path, &tables::svg(&tables))?;
    }
    if args.json { output::print_json(&tables::json(&tables)) } else { output::print(&tables::text(&tables)) }
}

fn built_in(levels: Option<u8>) -> Result<Vec<Table>, Failure> {
    let measured = tables::built_in().into_iter().map(|built_in| {
        let table = measure(Path::new(built_in.title), built_in.title, &built_in.volume, levels)?;
        Ok(Table { reference: Some(built_in.reference), ..table })
    });
    measured.collect()
}

fn measure(path: &Path, title: &str, volume: &Volume, levels: Option<u8>) -> Result<Table, Failure> {
    let samples = (volume.samples.len() / volume.element.bytes()) as u64;
    // Six wavelets and none.
    let bar = Bar::new("measuring", 7 * samples, volume.element.bytes());
    let count = |samples| {
        let _to_be_continued = bar.count(samples);
    };
    let table = tables::measure(title, volume, levels, &count);
    table.map_err(|error| Failure::at(path, error.kind(), error))
}
