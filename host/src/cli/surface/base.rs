//! `wavelift surface base`.

use std::path::PathBuf;
use std::time::Instant;

use wavelift_host::mesh::{FeatureAngles, Features, Report};
use wavelift_host::pipeline::target;
use wavelift_host::simplify::{Constraints, OctreeOptions, base_mesh, octree_mesh};
use wavelift_host::volume::Fault;

use super::file::{bad, is_mesh, read_field, read_mesh, refuse_other_than_mesh, write_mesh};
use crate::cli::exit::Failure;
use crate::cli::input::RawArgs;
use crate::cli::output::print;

/// Make a base mesh: few polygons with the topology of a mesh, or with a simpler one
///
/// Of a mesh, edges collapse, then edges between faces that are flat enough go: faces of 3 to 5 sides are left. Of a volume
/// of distances, an octree is made, and its leaves are wrapped: narrow gaps and holes close.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift surface base engine.ply base.ply --share 0.02 --border engine.nrrd
  wavelift surface base distance.nrrd base.ply --deviation 0.2")]
pub(crate) struct Args {
    /// Mesh of triangles, or volume of signed distances
    input: PathBuf,
    /// Mesh to write; .ply, .obj and .off keep polygons
    output: PathBuf,
    /// Vertices to keep, as a share of all
    #[arg(long, value_name = "S", default_value_t = 0.02)]
    share: f64,
    /// Edges where faces turn by more than so many degrees are sharp and stay
    #[arg(long, value_name = "DEGREES")]
    sharp: Option<f64>,
    /// Volume in whose border the boundary lies: it stays there
    #[arg(long, value_name = "VOLUME")]
    border: Option<PathBuf>,
    /// Octree: mean deviation from trilinear above which a cell is split, in widths of the cell
    #[arg(long, value_name = "D", default_value_t = 0.2)]
    deviation: f64,
    #[command(flatten)]
    raw: RawArgs,
}

/// Makes the base mesh, and tells its topology.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_other_than_mesh(&args.output)?;
    if is_mesh(&args.input) { of_mesh(args) } else { of_distance(args) }
}

fn of_distance(args: &Args) -> Result<(), Failure> {
    let distance = read_field(&args.input, &args.raw, &[&args.output])?;
    let start = Instant::now();
    let options = OctreeOptions { deviation: args.deviation, ..OctreeOptions::default() };
    let base = octree_mesh(&distance, &options);
    if base.faces().is_empty() {
        return Err(bad(&args.input, "no surface: the distances have one sign"));
    }
    let seconds = start.elapsed().as_secs_f64();
    write_mesh(&base, &args.output)?;
    print(&format!("{} in {seconds:.2} s\n", Report::of(&base)))
}

fn of_mesh(args: &Args) -> Result<(), Failure> {
    let mut mesh = read_mesh(&args.input, &[&args.output])?;
    let mut constraints = Constraints::default();
    if let Some(volume) = &args.border {
        constraints.border = Some(*read_field(volume, &args.raw, &[&args.output])?.grid());
    }
    let start = Instant::now();
    mesh.repair();
    if let Some(edge) = args.sharp {
        constraints.features = Features::by_angle(&mesh, FeatureAngles { edge, ..FeatureAngles::default() });
    }
    let target = target(&mesh, args.share).map_err(|error| Failure::new(Fault::Usage, error))?;
    let base = base_mesh(&mesh, &constraints, target).map_err(|error| bad(&args.input, error))?.mesh;
    let seconds = start.elapsed().as_secs_f64();
    write_mesh(&base, &args.output)?;
    print(&format!("{} -> {} in {seconds:.2} s\n", Report::of(&mesh), Report::of(&base)))
}
