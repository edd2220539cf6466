//! `wavelift verify`.

use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde_json::json;
use wavelift_host::codec::{Comparison, Container, ContainerError, DecompressOptions, Difference, Part};
use wavelift_host::volume::{
    self, AxisOrder, ElementType, Fault, FileFormat, Header, RankedExtent, RawLayout, ReadError, Source,
};

use super::choice::{parse_memory, parse_threads};
use super::convert::in_words;
use super::exit::Failure;
use super::input::{RawArgs, input_path, open_source};
use super::output::{print, print_json, say};
use super::progress::Bar;

/// Check a compressed file, and compare it with the original
///
/// Every brick is decoded and compared with its checksums; with ORIGINAL, every sample with that file's as well: bit for
/// bit, or within the error bound that the file was compressed with, in exact arithmetic. The exit code is 0 only if all
/// agree, 3 if anything differs.
#[derive(Debug, clap::Args)]
#[command(mut_arg("byte_order", |arg| arg.help(BYTE_ORDER)))]
#[command(after_help = "\
Examples:
  wavelift verify head.wlift
  wavelift verify head.wlift head.nrrd
  wavelift verify engine.wlift engine.raw")]
pub(crate) struct Args {
    /// Compressed file
    #[arg(value_parser = input_path())]
    pub(crate) input: PathBuf,
    /// Volume that was compressed: of any format that wavelift knows, or raw samples, which are taken to lie as the compressed file
    /// says unless --extent, --type or --byte-order say otherwise
    #[arg(value_parser = input_path())]
    pub(crate) original: Option<PathBuf>,
    /// Threads to work on [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Memory to work in, about, such as 512MiB or 4G [default: half of what is free]
    #[arg(long, value_name = "SIZE", value_parser = parse_memory)]
    pub(crate) memory: Option<u64>,
    /// Report what was found as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) raw: RawArgs,
}

/// Help for the one part of a layout that has a default elsewhere.
const BYTE_ORDER: &str =
    "Order of the bytes of a sample in the file [default: as it was in the file compressed]";

/// Checks a compressed file, and compares it with the original.
///
/// # Errors
/// A [`Failure`] if anything is damaged or differs; every damaged brick has been named then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if args.original.is_none() && args.raw.is_given() {
        let message = "--extent, --type and --byte-order describe ORIGINAL, which is not given";
        return Err(Failure::new(Fault::Usage, message));
    }
    let findings = match Container::open(&args.input) {
        Ok(container) => examine(args, &container)?,
        Err(error) if error.kind() == Fault::Data => {
            Findings { damaged: vec![error.cause().to_string()], ..Findings::default() }
        }
        Err(error) => return Err(Failure::of_container(&args.input, &error)),
    };
    findings.tell(args)
}

/// What was found out about a file.
#[derive(Debug, Default)]
struct Findings {
    /// Number of bricks, unless not even that is known.
    bricks: Option<usize>,
    /// What is wrong with the file: all bricks that are damaged, or what keeps it from being opened.
    damaged: Vec<String>,
    /// Where it differs from the original by more than it may.
    difference: Option<String>,
    /// The bound that it may differ by, and the largest difference found.
    errors: Option<(f64, f64)>,
}

impl Findings {
    fn tell(self, args: &Args) -> Result<(), Failure> {
        let original = args.original.as_ref().map(|path| path.display().to_string());
        if args.json {
            print_json(&json!({
                "input": args.input.display().to_string(),
                "original": original,
                "bricks": self.bricks,
                "whole": self.damaged.is_empty(),
                "damaged": self.damaged,
                "difference": self.difference,
                "max_error": self.errors.map(|(bound, _)| bound),
                "largest_error": self.errors.map(|(_, largest)| largest),
            }))?;
        }
        if let (Some(path), Some(difference)) = (&args.original, self.difference) {
            return Err(Failure::at(path, Fault::Data, difference));
        }
        match (self.bricks, &self.damaged[..]) {
            (_, []) if args.json => Ok(()),
            (Some(bricks), []) => {
                let equal = match (original, self.errors) {
                    (None, _) => String::new(),
                    (Some(path), None) => format!(", every sample equal to {path}"),
                    (Some(path), Some((bound, largest))) => {
                        format!(", every sample within {bound:e} of {path}, the largest error is {largest:e}")
                    }
                };
                print(&format!("{}: {bricks} bricks, every checksum right{equal}\n", args.input.display()))
            }
            (Some(bricks), damaged) => {
                for brick in damaged {
                    say(format_args!("wavelift: {}: {brick}", args.input.display()));
                }
                let message = format_args!("{} of {bricks} bricks are damaged", damaged.len());
                Err(Failure::at(&args.input, Fault::Data, message))
            }
            (None, damaged) => Err(Failure::at(&args.input, Fault::Data, damaged.join(", "))),
        }
    }
}

fn examine(args: &Args, container: &Container) -> Result<Findings, Failure> {
    let errors = Mutex::new(Vec::new());
    let note = |error| errors.lock().unwrap_or_else(PoisonError::into_inner).push(error);
    let at_input = |error: &ContainerError| Failure::of_container(&args.input, error);
    let bar = Bar::new("verifying", container.values(&Part::default()), container.head().element.bytes());
    let count = |values| bar.count(values);
    let comparison = match &args.original {
        None => container.verify(args.threads, &count, &note).map(|()| Ok(Comparison::default())),
        Some(path) => Ok(compare(args, path, container, (&count, &note))?),
    };
    let comparison = comparison.map_err(|error| at_input(&error))?;
    drop(bar);
    let mut damaged = BTreeSet::new();
    for error in errors.into_inner().unwrap_or_else(PoisonError::into_inner) {
        let place = match error {
            ContainerError::Brick { place, .. } => Some(place),
            _ if error.kind() == Fault::Data => None,
            _ => return Err(at_input(&error)),
        };
        damaged.insert((place, error.to_string()));
    }
    let damaged: Vec<String> = damaged.into_iter().map(|(_, message)| message).collect();
    let bricks = Some(container.bricks() as usize);
    Ok(match comparison {
        Ok(Comparison { difference, largest }) if damaged.is_empty() => {
            let bound = container.step(0).ok().and_then(|step| step.channels[0].bound);
            let difference =
                difference.map(|found| difference_in_words(&found, largest, container.head().components));
            Findings { bricks, damaged, difference, errors: bound.map(|bound| bound.error).zip(largest) }
        }
        Ok(_) => Findings { bricks, damaged, ..Findings::default() },
        Err(difference) => Findings { bricks, damaged, difference: Some(difference), errors: None },
    })
}

/// Who is told of values that are done, and of what is damaged.
type Watch<'a> = (&'a (dyn Fn(u64) -> ControlFlow<()> + Sync), &'a (dyn Fn(ContainerError) + Sync));

/// Compares with the original; what makes that impossible is a difference too.
fn compare(
    args: &Args,
    path: &Path,
    container: &Container,
    (count, note): Watch<'_>,
) -> Result<Result<Comparison, String>, Failure> {
    let mut original = open_original(args, path, container)?;
    let ours = container.head().header(container.steps(), original.header().metadata.clone());
    if (ours.extent, ours.components, ours.steps, ours.element) != kind(original.header()) {
        let (theirs, ours) = (in_words(original.header()), in_words(&ours));
        return Ok(Err(format!("holds {theirs}, but the compressed file {ours}")));
    }
    let options = DecompressOptions { threads: args.threads, memory: args.memory };
    match container.compare(original.as_mut(), &options, count, note) {
        Ok(comparison) => Ok(Ok(comparison)),
        Err(error) => Err(Failure::new(error.kind(), error)),
    }
}

const fn kind(header: &Header) -> ([u64; 3], u32, u64, ElementType) {
    (header.extent, header.components, header.steps, header.element)
}

/// Opens the original; as a raw file it lies as the compressed file says, but for what is given.
fn open_original(args: &Args, path: &Path, container: &Container) -> Result<Box<dyn Source>, Failure> {
    let (head, order) = (container.head(), container.metadata().map(|metadata| metadata.source.byte_order));
    let extent =
        RankedExtent::new(&head.extent).map_err(|fault| Failure::at(&args.input, Fault::Data, fault))?;
    // Only raw files come back with their axes in an order of their own.
    let raw = container.metadata().ok().filter(|metadata| metadata.source.format == FileFormat::Raw);
    let known = RawLayout {
        byte_order: order.unwrap_or_default(),
        components: head.components,
        steps: container.steps(),
        order: raw.map(|metadata| AxisOrder::of(&metadata.axes)).unwrap_or_default(),
        ..RawLayout::new(extent, head.element)
    };
    if let Some(layout) = args.raw.completed_by(known) {
        return open_source(path, Some(&layout));
    }
    volume::open_known(path, &known).map_err(|error| match error {
        ReadError::LayoutMismatch { layout, expected, found, .. } => {
            let message =
                format!("has {found} bytes, but the compressed file holds {layout}, {expected} bytes");
            Failure::at(path, Fault::Data, message)
        }
        other => other.into(),
    })
}

/// Where the original differs first.
fn difference_in_words(found: &Difference, largest: Option<f64>, components: u32) -> String {
    let Difference { step, sample: [z, y, x], component, bound } = found;
    let by = bound.map_or_else(String::new, |bound| format!(" by more than {bound:e}"));
    let of = match (step, components) {
        (0, 1) => String::new(),
        (step, 1) => format!(" of time step {step}"),
        (step, _) => format!(" of time step {step}, component {component}"),
    };
    let most = largest.filter(|_| bound.is_some());
    let most = most.map_or_else(String::new, |largest| format!("; the largest error is {largest:e}"));
    format!("differs{by} from the compressed file, first at sample ({x}, {y}, {z}){of}{most}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_named() {
        let mut found = Difference { step: 0, sample: [0, 1, 2], component: 0, bound: None };
        let text = difference_in_words(&found, None, 1);
        assert_eq!(text, "differs from the compressed file, first at sample (2, 1, 0)");
        (found.step, found.component, found.bound) = (3, 1, Some(255.5));
        let text = difference_in_words(&found, Some(256.0), 2);
        assert!(text.starts_with("differs by more than 2.555e2 from"), "{text}");
        assert!(
            text.ends_with("(2, 1, 0) of time step 3, component 1; the largest error is 2.56e2"),
            "{text}"
        );
    }
}
