//! `wavelift surface`: from volumes and meshes to compressed multiresolution surfaces, step by step or in one go.

mod base;
mod build;
mod compare;
mod decode;
mod distance;
mod encode;
mod extract;
mod file;
mod picture;
mod tables;
mod wrap;

use clap::Subcommand;

use super::exit::Failure;

/// Isosurfaces and meshes as compressed multiresolution surfaces
///
/// build does everything; the other commands are its steps, and what to do with the result. Surfaces with levels are kept
/// in .wsurf files, any beginning of which that holds the base mesh can be decoded. Meshes are PLY, OBJ, STL, OFF or glTF.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift surface build engine.nrrd engine.wsurf --iso 80
  wavelift surface decode engine.wsurf engine.ply --level 1
  wavelift surface view-png engine.wsurf engine.png")]
pub(crate) struct Args {
    #[command(subcommand)]
    step: Step,
}

#[derive(Debug, Subcommand)]
enum Step {
    Build(build::Args),
    Extract(extract::Args),
    Distance(distance::Args),
    Base(base::Args),
    Wrap(wrap::Args),
    Encode(encode::Args),
    Decode(decode::Args),
    ViewPng(picture::Args),
    Compare(compare::Args),
    Tables(tables::Args),
}

/// Takes the step.
///
/// # Errors
/// A [`Failure`] of that step.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    match &args.step {
        Step::Build(args) => build::run(args),
        Step::Extract(args) => extract::run(args),
        Step::Distance(args) => distance::run(args),
        Step::Base(args) => base::run(args),
        Step::Wrap(args) => wrap::run(args),
        Step::Encode(args) => encode::run(args),
        Step::Decode(args) => decode::run(args),
        Step::ViewPng(args) => picture::run(args),
        Step::Compare(args) => compare::run(args),
        Step::Tables(args) => tables::run(args),
    }
}
