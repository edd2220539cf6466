//! `wavelift verify`.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::json;
use wavelift_host::codec::{Container, ContainerError, Part};
use wavelift_host::volume::{self, Fault, Volume};

use super::exit::Failure;
use super::input::RawArgs;
use super::output::{print, print_json};
use super::progress;

/// Check a compressed file, and compare it with the original
///
/// Every brick is decoded and compared with its checksums; with ORIGINAL, every sample with that file's as well. The
/// exit code is 0 only if all agree, 3 if anything differs.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift verify head.wlift
  wavelift verify head.wlift head.nrrd
  wavelift verify engine.wlift engine.raw --extent 256x256x128 --type u8")]
pub(crate) struct Args {
    /// Compressed file
    pub(crate) input: PathBuf,
    /// Volume that was compressed: .nrrd, .nhdr, .npy, or raw samples with --extent and --type
    pub(crate) original: Option<PathBuf>,
    /// Threads to work on [default: one per core]
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Report what was found as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) raw: RawArgs,
}

/// Checks a compressed file, and compares it with the original.
///
/// # Errors
/// A [`Failure`] if anything is damaged or differs; every damaged brick has been named on standard error then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let layout = args.raw.layout(None)?;
    if let (None, Some(_)) = (&args.original, &layout) {
        return Err(Failure::new(Fault::Usage, "--extent and --type describe ORIGINAL, which is not given"));
    }
    let at_input = |error: ContainerError| Failure::at(&args.input, error.kind(), error);
    let container = Container::open(&args.input).map_err(at_input)?;
    let bricks = container.index().bricks.len();
    match &args.original {
        Some(path) => {
            let original = volume::read(path, layout.as_ref())?;
            let bar = progress::bar("comparing", container.samples_read(&Part::default()));
            let decoded = container
                .read(&Part::default(), args.threads, &|samples| bar.inc(samples))
                .map_err(at_input)?;
            drop(bar);
            compare(&decoded, &original).map_err(|difference| Failure::at(path, Fault::Data, difference))?;
        }
        None => check(args, &container)?,
    }
    let compared = args.original.as_ref().map(|path| path.display().to_string());
    if args.json {
        return print_json(&json!({
            "input": args.input.display().to_string(),
            "original": compared,
            "bricks": bricks,
            "whole": true,
        }));
    }
    let equal = compared.map_or_else(String::new, |path| format!(", every sample equal to {path}"));
    print(&format!("{}: {bricks} bricks, every checksum right{equal}\n", args.input.display()))
}

/// Decodes every brick and names those that are damaged.
fn check(args: &Args, container: &Container) -> Result<(), Failure> {
    let damaged = AtomicUsize::new(0);
    let bar = progress::bar("verifying", container.samples_read(&Part::default()));
    let name = |error: ContainerError| {
        damaged.fetch_add(1, Ordering::Relaxed);
        bar.suspend(|| eprintln!("wavelift: {}: {error}", args.input.display()));
    };
    container
        .verify(args.threads, &|samples| bar.inc(samples), &name)
        .map_err(|error| Failure::at(&args.input, error.kind(), error))?;
    drop(bar);
    match damaged.into_inner() {
        0 => Ok(()),
        count => {
            let bricks = container.index().bricks.len();
            Err(Failure::at(&args.input, Fault::Data, format_args!("{count} of {bricks} bricks are damaged")))
        }
    }
}

/// Whether two volumes have the same extent, type and samples; if not, where they differ first.
fn compare(decoded: &Volume, original: &Volume) -> Result<(), String> {
    if (decoded.extent, decoded.element) != (original.extent, original.element) {
        let say = |volume: &Volume| {
            let [x, y, z] = volume.extent;
            format!("{x}x{y}x{z} {}", volume.element)
        };
        return Err(format!("holds {}, but the compressed file {}", say(original), say(decoded)));
    }
    match decoded.samples.iter().zip(&original.samples).position(|(a, b)| a != b) {
        None => Ok(()),
        Some(byte) => {
            let [width, height, _] = decoded.extent;
            let sample = (byte / decoded.element.bytes()) as u64;
            let (x, y, z) = (sample % width, sample / width % height, sample / width / height);
            Err(format!("differs from the compressed file, first at sample ({x}, {y}, {z})"))
        }
    }
}

#[cfg(test)]
mod tests {
    use wavelift_host::volume::ElementType;
    use wavelift_host::volume::synthetic::{Kind, generate};

    use super::*;

    #[test]
    fn differences_are_named() {
        let volume = generate(Kind::Waves, [4, 3, 2], ElementType::U16, 1);
        assert_eq!(compare(&volume, &volume), Ok(()));
        let mut changed = volume.clone();
        changed.samples[2 * (4 + 1) + 1] ^= 1;
        assert!(compare(&volume, &changed).unwrap_err().ends_with("(1, 1, 0)"));
        let other = generate(Kind::Waves, [4, 3, 3], ElementType::U16, 1);
        assert_eq!(
            compare(&volume, &other).unwrap_err(),
            "holds 4x3x3 u16, but the compressed file 4x3x2 u16"
        );
    }
}
