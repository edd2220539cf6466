//! `wavelift surface extract`.

use std::path::PathBuf;
use std::time::Instant;

use wavelift_host::isosurface::contour;
use wavelift_host::mesh::Report;
use wavelift_host::volume::Fault;

use super::file::{bad, read_field, refuse_other_than_mesh, write_mesh};
use crate::cli::exit::Failure;
use crate::cli::input::RawArgs;
use crate::cli::output::print;

/// Extract an isosurface as triangles
///
/// The triangles are watertight, have the topology of the trilinear field, and end in boundaries on the border of the volume.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example:
  wavelift surface extract engine.raw engine.ply --iso 80 --extent 256x256x128 --type u8")]
pub(crate) struct Args {
    /// Volume: .nrrd, .nhdr, .npy, or raw samples with --extent and --type
    input: PathBuf,
    /// Mesh to write: .ply, .obj, .stl, .off, .gltf or .glb
    output: PathBuf,
    /// The value of the surface; larger ones are inside
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    iso: f32,
    #[command(flatten)]
    raw: RawArgs,
}

/// Extracts the surface, and tells its topology.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_other_than_mesh(&args.output)?;
    let field = read_field(&args.input, &args.raw, &[&args.output])?;
    let start = Instant::now();
    let mesh = contour(&field, args.iso).map_err(|error| bad(&args.input, error))?;
    let seconds = start.elapsed().as_secs_f64();
    if mesh.triangles.is_empty() {
        let (low, high) = range(field.values());
        let what = format!("there is no surface at {}: the values lie between {low} and {high}", args.iso);
        return Err(Failure::at(&args.input, Fault::Usage, what));
    }
    write_mesh(&mesh, &args.output)?;
    print(&format!("{} in {seconds:.2} s\n", Report::of(&mesh)))
}

fn range(values: &[f32]) -> (f32, f32) {
    values
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)))
}
