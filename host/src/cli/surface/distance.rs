//! `wavelift surface distance`.

use std::path::PathBuf;
use std::time::Instant;

use wavelift_host::distance::{self, DistanceError, Options};
use wavelift_host::pipeline::MARGIN;
use wavelift_host::volume::{self, Fault, WriteOptions};

use super::file::{bad, is_mesh, read_field, read_mesh};
use crate::cli::exit::Failure;
use crate::cli::input::RawArgs;
use crate::cli::output::print;

/// Signed distance to an isosurface or a mesh, as a volume
///
/// Distances are in the units of the volume or mesh, negative inside, on the grid of the volume or, for a mesh, on a grid
/// around it.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift surface distance engine.nrrd distance.nrrd --iso 80
  wavelift surface distance horse.ply distance.nrrd --cells 256")]
pub(crate) struct Args {
    /// Volume, or mesh by its name: .ply, .obj, .stl, .off, .gltf or .glb
    input: PathBuf,
    /// Volume of distances to write: .nrrd, .npy, or raw
    output: PathBuf,
    /// The value of the isosurface of a volume
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    iso: Option<f32>,
    /// Cells along the longest axis of a mesh
    #[arg(long, value_name = "N", default_value_t = 192)]
    cells: usize,
    /// Greatest distance that matters, in the same units: nodes farther away have this one
    #[arg(long, value_name = "D")]
    limit: Option<f64>,
    #[command(flatten)]
    raw: RawArgs,
}

/// Computes distances, and tells how.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let mut options = Options::default();
    if let Some(limit) = args.limit {
        if limit.is_nan() || limit <= 0.0 {
            return Err(Failure::new(Fault::Usage, "--limit is a distance above 0"));
        }
        options.limit = limit;
    }
    let of_file = |error: &dyn std::fmt::Display| bad(&args.input, error);
    let start;
    let distance = if is_mesh(&args.input) {
        if args.iso.is_some() {
            return Err(Failure::new(
                Fault::Usage,
                "--iso is for volumes, and INPUT is a mesh: leave it out",
            ));
        }
        let mut mesh = read_mesh(&args.input, &[&args.output])?;
        start = Instant::now();
        mesh.repair();
        let grid = distance::grid_around(&mesh, args.cells, MARGIN).map_err(|error| of_file(&error))?;
        distance::of_mesh(&mesh, &grid, &options).map_err(|error| of_file(&error))?
    } else {
        let Some(iso) = args.iso else {
            return Err(Failure::new(
                Fault::Usage,
                "the distance to which surface of the volume? give --iso",
            ));
        };
        let field = read_field(&args.input, &args.raw, &[&args.output])?;
        start = Instant::now();
        distance::of_isosurface(&field, iso, &options).map_err(|error| match error {
            DistanceError::NoSurface => Failure::at(&args.input, Fault::Usage, error),
            _ => of_file(&error),
        })?
    };
    let seconds = start.elapsed().as_secs_f64();
    volume::write(&distance.field.to_volume(), &args.output, &WriteOptions::default())?;
    let ([x, y, z], report) = (distance.field.grid().extent, distance.report);
    print(&format!(
        "{x}x{y}x{z} nodes, {} triangles; {:.2} updates a node, {:.1} Mnodes/s, {seconds:.2} s\n",
        report.triangles,
        report.updates as f64 / report.nodes as f64,
        report.nodes as f64 / seconds / 1e6,
    ))
}
