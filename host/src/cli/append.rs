//! `wavelift append`.

use std::path::PathBuf;

use wavelift_host::codec::{self, CompressOptions, Label};

use super::compress::{How, tell_of, values};
use super::exit::Failure;
use super::input::{RawArgs, input_path, open_source_for, refuse_same_file};
use super::progress::Bar;

/// Add time steps to a compressed file
///
/// The steps of INPUT follow those that FILE has already, which are copied as they are, so that it takes as long as
/// copying FILE and compressing INPUT; extent, type and components have to be the same. FILE is replaced when all is
/// done, or stays as it is.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift append run.wlift step-17.nrrd
  wavelift append run.wlift step-18.raw --extent 512x512x301 --type f32 --relative-error 1e-4 --time 0.18")]
pub(crate) struct Args {
    /// Compressed file to add to
    pub(crate) file: PathBuf,
    /// Volume to add: of any format that wavelift knows, or raw samples with --extent and --type
    #[arg(value_parser = input_path())]
    pub(crate) input: PathBuf,
    /// Name of the first step that is added [default: INPUT without folder and extension]
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,
    /// Time of the first step that is added
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(crate) time: Option<f64>,
    #[command(flatten)]
    pub(crate) how: How,
    /// Report sizes and choices as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) raw: RawArgs,
}

/// Adds time steps to a compressed file.
///
/// # Errors
/// A [`Failure`]; FILE is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_same_file(&args.input, &args.file)?;
    let mut source = open_source_for(&args.input, args.raw.layout(None)?.as_ref(), &args.file)?;
    let bar = Bar::new("compressing", values(source.header()), source.header().element.bytes());
    let count = |values| bar.count(values);
    let stem = || args.input.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let label = Label { name: args.name.clone().or_else(stem), time: args.time };
    let options = CompressOptions { labels: vec![label], ..args.how.options() };
    let report = codec::append_file(&args.file, source.as_mut(), &options, &count)?;
    drop(bar);
    tell_of(&args.input, &args.file, &report, args.json)
}
