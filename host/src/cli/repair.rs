//! `wavelift repair`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use serde_json::{Value, json};
use wavelift_host::codec::{self, FileAt, Lost, RepairError, Repaired};
use wavelift_host::volume::Fault;

use super::choice::parse_threads;
use super::exit::Failure;
use super::input::refuse_same_file;
use super::output::{JSON_AND_OUTPUT, print, print_json, refuse_standard_output, say, write_atomically};
use super::progress::Bar;

/// Save what is whole of a damaged or truncated file
///
/// OUTPUT is a whole wavelift file with every brick of INPUT that is undamaged, bit for bit, and says which ones are
/// lost: reading their samples is an error, reading others is not. INPUT stays as it is. The exit code is 0 only if no
/// brick is lost, 3 if any is, with OUTPUT written all the same.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift repair damaged.wlift saved.wlift
  wavelift repair damaged.wlift saved.wlift --json")]
pub(crate) struct Args {
    /// Damaged or truncated file
    pub(crate) input: PathBuf,
    /// Whole file to write
    pub(crate) output: PathBuf,
    /// Threads to work on [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Report what was saved and what is lost as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Writes what is whole of a damaged file.
///
/// # Errors
/// A [`Failure`] if anything is lost; every lost brick has been named then. If nothing can be saved, OUTPUT is what it
/// was.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_same_file(&args.input, &args.output)?;
    if args.json {
        refuse_standard_output(&args.output, JSON_AND_OUTPUT)?;
    }
    let file = FileAt::open(&args.input)
        .map_err(|cause| Failure::of_container(&args.input, &codec::ContainerError::Io(cause)))?;
    let bar = Bar::spinner("repairing");
    let repaired = write_atomically(&args.output, |out| {
        codec::repair(&file, out, args.threads, &|samples| bar.count(samples)).map_err(|error| match error {
            RepairError::Write(cause) => Failure::cannot_write(&args.output, &cause),
            other => Failure::at(&args.input, other.kind(), other),
        })
    })?;
    drop(bar);
    if args.json {
        print_json(&document(args, &repaired))?;
    }
    tell(args, &repaired)
}

fn tell(args: &Args, repaired: &Repaired) -> Result<(), Failure> {
    let input = args.input.display();
    let note = |what: &str| say(format_args!("wavelift: {input}: {what}"));
    for gap in &repaired.gaps {
        note(&format!("bytes {} to {} are no whole record", gap.start, gap.end - 1));
    }
    if repaired.lost_metadata {
        note("lost: what its source said beside extent and type");
    }
    for step in &repaired.lost_steps {
        note(&format!("lost: how time step {step} is coded, and with it all its bricks"));
    }
    for lost in &repaired.lost {
        note(&format!("lost: {}", in_words(lost)));
    }
    let bricks = repaired.kept + repaired.lost.len() as u64;
    if !repaired.lost.is_empty() {
        let message = format_args!("{} of {bricks} bricks are lost", repaired.lost.len());
        return Err(Failure::at(&args.input, Fault::Data, message));
    }
    if args.json {
        return Ok(());
    }
    print(&format!("{}: all {bricks} bricks saved\n", args.output.display()))
}

fn in_words(lost: &Lost) -> String {
    let Lost { place, region } = lost;
    let step = if place.step > 0 { format!(" of time step {}", place.step) } else { String::new() };
    let component =
        if place.component > 0 { format!(", component {}", place.component) } else { String::new() };
    format!("brick {}{step}{component} (samples {region})", place.brick)
}

fn document(args: &Args, repaired: &Repaired) -> Value {
    let lost = |lost: &Lost| {
        json!({
            "step": lost.place.step,
            "brick": lost.place.brick,
            "component": lost.place.component,
            "region": lost.region.to_string(),
        })
    };
    json!({
        "input": args.input.display().to_string(),
        "output": args.output.display().to_string(),
        "extent": repaired.head.extent,
        "components": repaired.head.components,
        "steps": repaired.steps,
        "type": repaired.head.element.name(),
        "bricks": repaired.kept + repaired.lost.len() as u64,
        "lost": repaired.lost.iter().map(lost).collect::<Vec<_>>(),
        "lost_steps": repaired.lost_steps,
        "lost_metadata": repaired.lost_metadata,
        "gaps": repaired.gaps.iter().map(|gap| [gap.start, gap.end]).collect::<Vec<_>>(),
    })
}
