//! `wavelift repair`.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use wavelift_host::codec::{self, Damage, FileAt, Lost, RepairError, Repaired};
use wavelift_host::volume::Fault;

use super::choice::parse_threads;
use super::exit::Failure;
use super::input::{input_path, refuse_same_file};
use super::output::{
    JSON_AND_OUTPUT, output_path, print, print_json, refuse_standard_output, say, write_atomically,
};
use super::progress::Bar;

/// Save what is whole of a damaged or truncated file
///
/// OUTPUT is a whole wavelift file with every brick of INPUT that is undamaged, bit for bit, and says which ones are
/// lost: reading their samples is an error, reading others is not. Where a single byte is wrong, checksums tell which,
/// and it is put right. INPUT stays as it is. The exit code is 0 only if no brick is lost, 3 if any is, with OUTPUT
/// written all the same. `wavelift decompress --salvage` writes the samples at once, without such a file.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift repair damaged.wlift saved.wlift
  wavelift repair damaged.wlift saved.wlift --json")]
pub(crate) struct Args {
    /// Damaged or truncated file
    #[arg(value_parser = input_path())]
    pub(crate) input: PathBuf,
    /// Whole file to write
    #[arg(value_parser = output_path())]
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
        codec::repair(Box::new(file), out, args.threads, &|samples| bar.count(samples)).map_err(|error| {
            match error {
                RepairError::Write(cause) => Failure::cannot_write(&args.output, &cause),
                other => Failure::at(&args.input, other.kind(), other),
            }
        })
    })?;
    drop(bar);
    if args.json {
        print_json(&document(args, &repaired))?;
    }
    tell(args, &repaired)
}

fn tell(args: &Args, repaired: &Repaired) -> Result<(), Failure> {
    let damage = &repaired.damage;
    say_damage(&args.input, damage);
    say_lost(&args.input, damage, &damage.lost);
    let bricks = repaired.kept + damage.lost.len() as u64;
    if !damage.lost.is_empty() {
        let message = format_args!("{} of {bricks} bricks are lost", damage.lost.len());
        return Err(Failure::at(&args.input, Fault::Data, message));
    }
    if args.json {
        return Ok(());
    }
    print(&format!("{}: all {bricks} bricks saved\n", args.output.display()))
}

/// Tells what was wrong with a file, and what was put right.
pub(crate) fn say_damage(input: &Path, damage: &Damage) {
    let note = |what: &str| say(format_args!("wavelift: {}: {what}", input.display()));
    for place in &damage.mended {
        note(&format!("byte {place} was wrong, and is put right"));
    }
    for gap in &damage.gaps {
        note(&format!("bytes {} to {} are no whole record", gap.start, gap.end - 1));
    }
}

/// Tells what is lost.
pub(crate) fn say_lost(input: &Path, damage: &Damage, lost: &[Lost]) {
    let note = |what: &str| say(format_args!("wavelift: {}: lost: {what}", input.display()));
    if damage.lost_metadata {
        note("what its source said beside extent and type");
    }
    for step in &damage.lost_steps {
        note(&format!("how time step {step} is coded, and with it all its bricks"));
    }
    for lost in lost {
        note(&in_words(lost));
    }
}

fn in_words(lost: &Lost) -> String {
    let Lost { place, region } = lost;
    let step = if place.step > 0 { format!(" of time step {}", place.step) } else { String::new() };
    let component =
        if place.component > 0 { format!(", component {}", place.component) } else { String::new() };
    format!("brick {}{step}{component} (samples {region})", place.brick)
}

fn document(args: &Args, repaired: &Repaired) -> Value {
    let damage = &repaired.damage;
    json!({
        "input": args.input.display().to_string(),
        "output": args.output.display().to_string(),
        "extent": repaired.head.extent,
        "components": repaired.head.components,
        "steps": repaired.steps,
        "type": repaired.head.element.name(),
        "bricks": repaired.kept + damage.lost.len() as u64,
        "lost": list(&damage.lost),
        "lost_steps": damage.lost_steps,
        "lost_metadata": damage.lost_metadata,
        "mended": damage.mended,
        "gaps": gaps(damage),
    })
}

/// Lost bricks as JSON.
pub(crate) fn list(lost: &[Lost]) -> Vec<Value> {
    let one = |lost: &Lost| {
        json!({
            "step": lost.place.step,
            "brick": lost.place.brick,
            "component": lost.place.component,
            "region": lost.region.to_string(),
        })
    };
    lost.iter().map(one).collect()
}

/// Ends of what is no whole record, for JSON.
pub(crate) fn gaps(damage: &Damage) -> Vec<[u64; 2]> {
    damage.gaps.iter().map(|gap| [gap.start, gap.end]).collect()
}
