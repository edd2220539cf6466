//! `wavelift surface build`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use wavelift_host::field::ScalarField;
use wavelift_host::mesh::{Repairs, Report};
use wavelift_host::pipeline::{self, BuildError, BuildOptions, Built, End, Missed, Rounds, Source, Stage};
use wavelift_host::volume::{self, Fault, WriteOptions};
use wavelift_host::wrap::Misfit;

use super::encode::{self, How};
use super::file::{self, is_mesh, read_field, read_mesh, refuse_mesh, write_bytes, write_mesh};
use super::wrap;
use crate::cli::exit::Failure;
use crate::cli::input::RawArgs;
use crate::cli::output::{print, tell};

/// Share of a cell's edge that coding may move a surface by, unless something else is asked for.
const FINE: f64 = 0.02;

/// Parts that the surface misses which are listed.
const MOST_MISSED: usize = 20;

/// Build a compressed surface from an isosurface of a volume, or from a mesh
///
/// Contour, signed distance, base mesh, shrink-wrap, wavelets, coding: all in one go.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift surface build engine.nrrd engine.wsurf --iso 80
  wavelift surface build horse.ply horse.wsurf --share 0.008 --levels 4 --bytes 25000")]
pub(crate) struct Args {
    /// Volume, or mesh by its name: .ply, .obj, .stl, .off, .gltf or .glb
    input: PathBuf,
    /// Surface to write: .wsurf
    output: PathBuf,
    /// The value of the isosurface of a volume; larger ones are inside
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    iso: Option<f32>,
    /// Vertices of the base mesh, as a share of those of the contour or the mesh [default: 0.02, and more where the
    /// surface does not fit]
    #[arg(long, value_name = "S")]
    share: Option<f64>,
    /// How often the base mesh is made finer where the surface does not fit, at most [default: 3, or 0 with --share]
    #[arg(long, value_name = "N")]
    rounds: Option<u32>,
    /// How often faces are split; without --share less often where the finest mesh would come out much finer than the contour
    #[arg(long, value_name = "N", default_value_t = 3)]
    levels: u32,
    /// Splits no further once the surface fits this well, in cells' edges
    #[arg(long, value_name = "T", default_value_t = 0.0)]
    tolerance: f64,
    /// Cells along the longest axis of a mesh [default: 192]
    #[arg(long, value_name = "N")]
    cells: Option<usize>,
    /// Edges of a mesh are sharp where its faces turn by more than so many degrees
    #[arg(long, value_name = "DEGREES")]
    sharp: Option<f64>,
    /// Writes contour.ply, distance.nrrd, base.ply and finest.ply into this folder, too
    #[arg(long, value_name = "FOLDER")]
    keep: Option<PathBuf>,
    #[command(flatten)]
    how: How,
    #[command(flatten)]
    raw: RawArgs,
}

/// Builds, and tells what each stage came to.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_mesh(&args.output)?;
    let written = written(args);
    let outputs: Vec<&Path> = written.iter().map(PathBuf::as_path).collect();
    let field = field(args, &outputs)?;
    let source = match (&field, args.iso) {
        (Some(field), Some(iso)) => Source::Isosurface(field, iso),
        _ => Source::Mesh(read_mesh(&args.input, &outputs)?),
    };
    let usual = BuildOptions::default();
    let options = BuildOptions {
        share: args.share.unwrap_or(usual.share),
        error: args.share.map_or(usual.error, |_| f64::INFINITY),
        growth: args.share.map_or(usual.growth, |_| f64::INFINITY),
        rounds: args.rounds.unwrap_or(if args.share.is_some() { 0 } else { usual.rounds }),
        levels: args.levels,
        tolerance: args.tolerance,
        cells: args.cells.unwrap_or(usual.cells),
        sharp: args.sharp,
    };
    let mut times = Vec::new();
    let mut observe = |stage: Stage, time: Duration| {
        tell(format_args!("{:9} {:8.2} s", stage.name(), time.as_secs_f64()));
        times.push(format!("{} {:.2} s", stage.name(), time.as_secs_f64()));
    };
    let built = pipeline::build(source, &options, &mut observe)
        .map_err(|error| Failure::at(&args.input, fault(&error), error))?;
    let surface = &built.wrapped.surface;
    let cell = built.distance.grid().cell_edge();
    let encoded = file::encode(&args.input, surface, &args.how.settings(FINE * cell))?;
    // One after another, so that little is left to do once the first has appeared.
    if let Some(folder) = &args.keep {
        keep(folder, &built)?;
    }
    write_bytes(&args.output, &encoded.bytes)?;
    let fit = fit(&built);
    warn(&built, is_mesh(&args.input));
    print(&format!(
        "contour: {}\n{}base:    {}\n{}{fit}{}times: {}\n{}",
        Report::of(&built.contour),
        repairs(&built),
        Report::of(&built.base),
        wrap::text(&built.wrapped.report),
        rounds(&built),
        times.join(", "),
        encode::text(&args.output, surface, &encoded),
    ))
}

/// What was changed of a mesh.
fn repairs(built: &Built) -> String {
    if built.repairs == Repairs::default() { String::new() } else { format!("repairs: {}\n", built.repairs) }
}

/// Tells of what is lost where people see it.
fn warn(built: &Built, is_mesh: bool) {
    let Built { fit, .. } = built;
    if let Some(worst) = fit.missed.first() {
        tell(format_args!(
            "warning: the surface misses parts of {} components, by up to {:.1} cells' edges: try a larger --share or \
             more --rounds",
            fit.missed.len(),
            worst.most,
        ));
    }
    let report = Report::of(&built.contour);
    if is_mesh && report.boundary_loops() > 0 {
        tell(format_args!(
            "warning: the mesh is open ({} boundary loops), and has no inside near its boundary: the surface may stray \
             there",
            report.boundary_loops(),
        ));
    }
}

/// Whether what was asked for is at fault, or INPUT.
fn fault(error: &BuildError) -> Fault {
    match error {
        BuildError::Share { .. } | BuildError::NoSurface { .. } => Fault::Usage,
        BuildError::Wrap(error) => wrap::fault(error),
        _ => Fault::Data,
    }
}

/// The field, if INPUT is a volume.
fn field(args: &Args, outputs: &[&Path]) -> Result<Option<ScalarField>, Failure> {
    match (is_mesh(&args.input), args.iso) {
        (true, Some(_)) => {
            Err(Failure::new(Fault::Usage, "--iso is for volumes, and INPUT is a mesh: leave it out"))
        }
        (true, None) => Ok(None),
        (false, None) => Err(Failure::new(Fault::Usage, "which surface of the volume? give --iso")),
        (false, Some(_)) if args.sharp.is_some() || args.cells.is_some() => {
            let what = "--sharp and --cells are for meshes, and INPUT is a volume: leave them out";
            Err(Failure::new(Fault::Usage, what))
        }
        (false, Some(_)) => read_field(&args.input, &args.raw, outputs).map(Some),
    }
}

/// How far the finest mesh and the contour are from each other, and what of the contour is missed.
fn fit(built: &Built) -> String {
    let surface = &built.wrapped.surface;
    let fit = &built.fit;
    let way =
        |misfit: Misfit| format!("{:.2} % rms, {:.0} % at most", 100.0 * misfit.rms, 100.0 * misfit.most);
    let mut lines = vec![
        format!("finest:  {}", Report::of(&surface.level(surface.levels))),
        format!(
            "fit, in % of a cell's edge: surface from contour {}; contour from surface {}",
            way(fit.forward),
            way(fit.backward)
        ),
    ];
    lines.extend(fit.missed.iter().take(MOST_MISSED).map(missed));
    if fit.missed.len() > MOST_MISSED {
        lines.push(format!("  and {} more", fit.missed.len() - MOST_MISSED));
    }
    lines.join("\n") + "\n"
}

/// What the rounds came to, and why there were no more, if the first base mesh did not do.
fn rounds(built: &Built) -> String {
    let Rounds { made, end } = &built.rounds;
    if *end == End::Fits && made.len() == 1 {
        return String::new();
    }
    let rounds = (1..).zip(made).map(|(number, round)| format!("round {number}: {round}\n"));
    rounds.collect::<String>() + &format!("no further round: {end}\n")
}

fn missed(part: &Missed) -> String {
    let Missed { place, most, missed, vertices, diagonal } = part;
    format!(
        "  the surface misses {missed} of the {vertices} vertices of a part of the contour {diagonal:.1} cells long, \
         by up to {most:.1} cells at ({:.1}, {:.1}, {:.1})",
        place.x, place.y, place.z
    )
}

/// Names of the files that are kept: contour, base mesh, finest mesh, distance.
const KEPT: [&str; 4] = ["contour.ply", "base.ply", "finest.ply", "distance.nrrd"];

/// Every file that is to be written.
fn written(args: &Args) -> Vec<PathBuf> {
    let kept = args.keep.iter().flat_map(|folder| KEPT.map(|name| folder.join(name)));
    kept.chain([args.output.clone()]).collect()
}

fn keep(folder: &Path, built: &Built) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|cause| Failure::cannot_write(folder, &cause))?;
    let [contour, base, finest, distance] = KEPT.map(|name| folder.join(name));
    write_mesh(&built.contour, &contour)?;
    write_mesh(&built.base, &base)?;
    let surface = &built.wrapped.surface;
    write_mesh(&surface.level(surface.levels), &finest)?;
    volume::write(&built.distance.to_volume(), &distance, &WriteOptions::default())?;
    Ok(())
}
