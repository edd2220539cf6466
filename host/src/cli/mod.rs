//! The command line: words to options of the library, and what went wrong to an exit code.

mod append;
mod bound;
mod choice;
mod compress;
mod convert;
mod decompress;
mod exit;
mod info;
mod input;
mod interrupt;
mod output;
mod panics;
mod preview;
mod progress;
mod repair;
mod surface;
mod tables;
mod transform;
mod verify;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Compression of scientific volumes with integer wavelets: without loss, or within an error bound.
///
/// A volume is a line, a slice or a brick of integers or floating-point numbers, with any number of components and
/// time steps. Extents are written x, y, z, and x varies fastest in the file.
#[derive(Debug, Parser)]
#[command(name = "wavelift", version, max_term_width = 100, after_help = AFTER_HELP)]
struct Program {
    #[command(subcommand)]
    command: Command,
}

const AFTER_HELP: &str = "\
Files that are read and written, by their names:
  .nii .nii.gz .hdr/.img   NIfTI-1 and NIfTI-2, ANALYZE
  .mgz .mgh                FreeSurfer, which is read only
  .dcm, or a folder        DICOM: a series, or a file of one frame or many
  .nrrd .nhdr              NRRD
  .mha .mhd                MetaImage
  .mrc .map .map.gz        MRC and CCP4
  .npy .npz                NumPy arrays; .npz is read only
  .tif .tiff               TIFF of one page or many, BigTIFF, ImageJ, OME-TIFF
  .png .pgm .ppm .pfm      slices
  .vti .pvti .vtk          VTK images
  .zarr .ome.zarr          Zarr 2 and 3, OME-Zarr
  .h5 .nc, FILE#VARIABLE   HDF5 and NetCDF, which are read only
  any other                raw samples, which need --extent and --type
  scan_%04d.tif, *.png     a file for each slice: numbers for %d or ###, anything for *, or a folder of them

Exit codes: 0 all well, 2 the command line is wrong, 3 a file holds bad data, 4 a file cannot be
read or written, 130 interrupted.

`wavelift COMMAND --help` says more about each, with an example.";

#[derive(Debug, Subcommand)]
enum Command {
    Compress(compress::Args),
    Decompress(decompress::Args),
    Append(append::Args),
    Convert(convert::Args),
    Preview(preview::Args),
    Info(info::Args),
    Verify(verify::Args),
    Repair(repair::Args),
    Tables(tables::Args),
    Transform(transform::Args),
    Surface(surface::Args),
}

/// Does what the command line says.
pub(crate) fn run() -> ExitCode {
    interrupt::watch();
    panics::print_no_caught();
    let outcome = match Program::parse().command {
        Command::Compress(args) => compress::run(&args),
        Command::Decompress(args) => decompress::run(&args),
        Command::Append(args) => append::run(&args),
        Command::Convert(args) => convert::run(&args),
        Command::Preview(args) => preview::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Repair(args) => repair::run(&args),
        Command::Tables(args) => tables::run(&args),
        Command::Transform(args) => transform::run(&args),
        Command::Surface(args) => surface::run(&args),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        Program::command().debug_assert();
    }

    #[test]
    fn every_command_has_an_example() {
        for command in Program::command().get_subcommands() {
            let help = command.clone().render_long_help().to_string();
            assert!(help.contains(&format!("wavelift {}", command.get_name())), "{help}");
        }
    }
}
