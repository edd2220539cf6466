//! `wavelift surface wrap`.

use std::path::PathBuf;

use wavelift_host::measure::Bvh;
use wavelift_host::mesh::{FeatureAngles, Features};
use wavelift_host::volume::Fault;
use wavelift_host::wrap::{Lines, Target, WrapError, WrapOptions, WrapReport, wrap};

use super::file::{encode_exactly, read_field, read_mesh, read_polygons, refuse_mesh, write_bytes};
use crate::cli::exit::Failure;
use crate::cli::input::RawArgs;
use crate::cli::output::print;

/// Wrap a base mesh around a surface given by its distance
///
/// The base mesh is split, relaxed and attracted to the zeros of the distance level by level.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example:
  wavelift surface wrap base.ply distance.nrrd engine.wsurf --levels 3 --onto engine.ply")]
pub(crate) struct Args {
    /// Base mesh: .ply, .obj or .off
    base: PathBuf,
    /// Volume of signed distances
    distance: PathBuf,
    /// Surface to write: .wsurf
    output: PathBuf,
    /// How often faces are split
    #[arg(long, value_name = "N", default_value_t = 3)]
    levels: u32,
    /// Splits no further once the surface fits this well, in cells' edges
    #[arg(long, value_name = "T", default_value_t = 0.0)]
    tolerance: f64,
    /// Mesh that the finest vertices are moved onto in the end
    #[arg(long, value_name = "MESH")]
    onto: Option<PathBuf>,
    /// Edges where faces of the base mesh, and of --onto, turn by more than so many degrees are sharp
    #[arg(long, value_name = "DEGREES")]
    sharp: Option<f64>,
    #[command(flatten)]
    raw: RawArgs,
}

/// Wraps, and tells how well each level fits.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_mesh(&args.output)?;
    let outputs = [&*args.output];
    let mut base = read_polygons(&args.base, &outputs)?;
    let angles = args.sharp.map(|edge| FeatureAngles { edge, ..FeatureAngles::default() });
    if let Some(angles) = angles {
        base.features = Features::by_angle(&base, angles);
    }
    let distance = read_field(&args.distance, &args.raw, &outputs)?;
    let onto = args.onto.as_deref().map(|path| read_mesh(path, &outputs)).transpose()?.map(|mut mesh| {
        mesh.repair();
        let features = angles.map(|angles| Features::by_angle(&mesh, angles)).unwrap_or_default();
        (Bvh::new(&mesh), Lines::of_mesh(&mesh, &features))
    });
    let mut options =
        WrapOptions { levels: args.levels, tolerance: args.tolerance, ..WrapOptions::default() };
    if let Some((tree, lines)) = &onto {
        options.target = Target::Triangles(tree);
        options.lines = Some(lines);
    }
    let wrapped =
        wrap(&base, &distance, &options).map_err(|error| Failure::at(&args.base, fault(&error), error))?;
    let encoded = encode_exactly(&args.output, &wrapped.surface)?;
    write_bytes(&args.output, &encoded.bytes)?;
    print(&text(&wrapped.report))
}

/// Whether what was asked for is at fault, or a file.
pub(super) const fn fault(error: &WrapError) -> Fault {
    match error {
        WrapError::TooManyVertices { .. } | WrapError::Option { .. } => Fault::Usage,
        _ => Fault::Data,
    }
}

/// What wrapping came to, level by level, in percent of a cell's edge.
pub(super) fn text(report: &WrapReport) -> String {
    let mut lines = vec!["level  vertices     rms %     max %  unsnapped  inverted  seconds".to_owned()];
    for level in &report.levels {
        lines.push(format!(
            "{:5} {:9} {:9.2} {:9.1} {:10} {:9} {:8.2}",
            level.level,
            level.vertices,
            100.0 * level.at_faces.rms,
            100.0 * level.at_faces.most,
            level.unsnapped,
            level.inverted.corners,
            level.seconds,
        ));
    }
    lines.push(format!(
        "{} components, {} of which do not fit everywhere; {} inverted faces in the end",
        report.components,
        report.failures.len(),
        report.inverted.corners,
    ));
    for failure in report.failures.iter().take(MOST_FAILURES) {
        lines.push(format!(
            "  at ({:.1}, {:.1}, {:.1}): {:?}, {} of {} vertices off by up to {:.2} cells, {} inverted faces",
            failure.place.x,
            failure.place.y,
            failure.place.z,
            failure.cause,
            failure.unfit,
            failure.vertices,
            failure.most,
            failure.inverted,
        ));
    }
    if report.failures.len() > MOST_FAILURES {
        lines.push(format!("  and {} more", report.failures.len() - MOST_FAILURES));
    }
    lines.join("\n") + "\n"
}

/// Components that do not fit which are listed.
const MOST_FAILURES: usize = 20;
