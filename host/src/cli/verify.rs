//! `wavelift verify`.

use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde_json::json;
use wavelift_host::bound::Deviation;
use wavelift_host::codec::{Container, ContainerError, Part};
use wavelift_host::volume::{self, Fault, RankedExtent, RawLayout, ReadError, Volume};

use super::choice::parse_threads;
use super::exit::Failure;
use super::input::{RawArgs, read_volume};
use super::output::{print, print_json, say};
use super::progress;

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
    pub(crate) input: PathBuf,
    /// Volume that was compressed: .nrrd, .nhdr, .npy, or raw samples, which are taken to lie as the compressed file
    /// says unless --extent, --type or --byte-order say otherwise
    pub(crate) original: Option<PathBuf>,
    /// Threads to work on [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<NonZeroUsize>,
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
            Findings { damaged: vec![error.to_string()], ..Findings::default() }
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
    let bricks = Some(container.bricks() as usize);
    let Some(path) = &args.original else {
        return Ok(Findings { bricks, damaged: damaged(args, container)?, ..Findings::default() });
    };
    let original = read_original(args, path, container)?;
    let bar = progress::bar("comparing", container.samples_read(&Part::default()));
    match container.read(&Part::default(), args.threads, &|samples| bar.inc(samples)) {
        Ok(decoded) => {
            let bound =
                container.step(0).ok().and_then(|step| step.channels[0].bound).map(|bound| bound.error);
            let (difference, largest) = match compare(&decoded, &original, bound) {
                Ok(largest) => (None, largest),
                Err(difference) => (Some(difference), None),
            };
            Ok(Findings { bricks, damaged: Vec::new(), difference, errors: bound.zip(largest) })
        }
        // Reading checks everything, but stops at the first damaged brick.
        Err(ContainerError::Brick { .. }) => {
            drop(bar);
            Ok(Findings { bricks, damaged: damaged(args, container)?, ..Findings::default() })
        }
        Err(error) => Err(Failure::of_container(&args.input, &error)),
    }
}

/// Decodes every brick and tells those that are damaged, in their order.
fn damaged(args: &Args, container: &Container) -> Result<Vec<String>, Failure> {
    let errors = Mutex::new(Vec::new());
    let bar = progress::bar("verifying", container.samples_read(&Part::default()));
    let note = |error| errors.lock().unwrap_or_else(PoisonError::into_inner).push(error);
    let at_input = |error: &ContainerError| Failure::of_container(&args.input, error);
    container.verify(args.threads, &|samples| bar.inc(samples), &note).map_err(|error| at_input(&error))?;
    let mut damaged = BTreeSet::new();
    for error in errors.into_inner().unwrap_or_else(PoisonError::into_inner) {
        let place = match error {
            ContainerError::Brick { place, .. } => Some(place),
            _ if error.kind() == Fault::Data => None,
            _ => return Err(at_input(&error)),
        };
        damaged.insert((place, error.to_string()));
    }
    Ok(damaged.into_iter().map(|(_, message)| message).collect())
}

/// Reads the original; as a raw file it lies as the compressed file says, but for what is given.
fn read_original(args: &Args, path: &Path, container: &Container) -> Result<Volume, Failure> {
    let at_input = |error: ContainerError| Failure::of_container(&args.input, &error);
    let (head, metadata) = (container.head(), container.metadata().map_err(at_input)?);
    let known = RawLayout {
        extent: RankedExtent::new(&head.extent)
            .map_err(|fault| Failure::at(&args.input, Fault::Data, fault))?,
        element: head.element,
        byte_order: metadata.source.byte_order,
    };
    if let Some(layout) = args.raw.completed_by(known) {
        return read_volume(path, Some(&layout));
    }
    volume::read_known(path, &known).map_err(|error| match error {
        ReadError::LayoutMismatch { layout, expected, found, .. } => {
            let message =
                format!("has {found} bytes, but the compressed file holds {layout}, {expected} bytes");
            Failure::at(path, Fault::Data, message)
        }
        other => other.into(),
    })
}

/// Compares two volumes: same extent, same type, and samples that are equal or, with a bound, within it. Returns the
/// largest error where there is a bound, or else where they differ first.
fn compare(decoded: &Volume, original: &Volume, bound: Option<f64>) -> Result<Option<f64>, String> {
    if (decoded.extent, decoded.element) != (original.extent, original.element) {
        let say = |volume: &Volume| {
            let [x, y, z] = volume.extent;
            format!("{x}x{y}x{z} {}", volume.element)
        };
        return Err(format!("holds {}, but the compressed file {}", say(original), say(decoded)));
    }
    let (element, ours, theirs) = (decoded.element, &decoded.samples, &original.samples);
    let (sample, by, largest) = match bound {
        None => {
            let first = ours.iter().zip(theirs).position(|(a, b)| a != b);
            (first.map(|byte| byte / element.bytes()), String::new(), None)
        }
        Some(bound) => {
            let Deviation { largest, beyond } = Deviation::of(element, theirs, ours, bound);
            (beyond, format!(" by more than {bound:e}"), Some(largest))
        }
    };
    let Some(sample) = sample.map(|sample| sample as u64) else { return Ok(largest) };
    let [width, height, _] = decoded.extent;
    let (x, y, z) = (sample % width, sample / width % height, sample / width / height);
    let most = largest.map_or_else(String::new, |largest| format!("; the largest error is {largest:e}"));
    Err(format!("differs{by} from the compressed file, first at sample ({x}, {y}, {z}){most}"))
}

#[cfg(test)]
mod tests {
    use wavelift_host::volume::ElementType;
    use wavelift_host::volume::synthetic::{Kind, generate};

    use super::*;

    #[test]
    fn differences_are_named() {
        let volume = generate(Kind::Waves, [4, 3, 2], ElementType::U16, 1);
        assert_eq!(compare(&volume, &volume, None), Ok(None));
        let mut changed = volume.clone();
        changed.samples[2 * (4 + 1) + 1] ^= 1;
        assert!(compare(&volume, &changed, None).unwrap_err().ends_with("(1, 1, 0)"));
        assert_eq!(compare(&volume, &changed, Some(256.0)), Ok(Some(256.0)));
        let beyond = compare(&volume, &changed, Some(255.5)).unwrap_err();
        assert!(beyond.contains("(1, 1, 0)") && beyond.ends_with("the largest error is 2.56e2"), "{beyond}");
        let other = generate(Kind::Waves, [4, 3, 3], ElementType::U16, 1);
        assert_eq!(
            compare(&volume, &other, None).unwrap_err(),
            "holds 4x3x3 u16, but the compressed file 4x3x2 u16"
        );
    }
}
