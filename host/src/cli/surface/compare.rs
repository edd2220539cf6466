//! `wavelift surface compare`.

use std::path::PathBuf;

use serde_json::json;
use wavelift_host::measure::{Deviation, Distortion, SurfaceDistance};
use wavelift_host::mesh::Report;
use wavelift_host::volume::Fault;

use super::file::{length, read_level};
use crate::cli::exit::Failure;
use crate::cli::output::{print, print_json};

/// Distance between two surfaces, as METRO measures it
///
/// From samples spread over each surface to the nearest point of the other, both ways: mean, root mean square and largest
/// distance, in units of the surfaces and as a share of the diagonal of the box around the first.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example:
  wavelift surface compare engine.ply engine.wsurf --cell 1")]
pub(crate) struct Args {
    /// Surface (.wsurf) or mesh
    first: PathBuf,
    /// Surface (.wsurf) or mesh
    second: PathBuf,
    /// Level of surfaces, 0 being the base mesh [default: the finest]
    #[arg(long, value_name = "L")]
    level: Option<u32>,
    /// Samples on each surface, about
    #[arg(long, value_name = "N", default_value_t = 400_000)]
    samples: usize,
    /// Edge of a cell, to tell distances in percent of
    #[arg(long, value_name = "E", value_parser = length)]
    cell: Option<f64>,
    /// Write one JSON document instead of text
    #[arg(long)]
    json: bool,
}

/// Compares.
///
/// # Errors
/// A [`Failure`].
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let level_of = |path: &std::path::Path| args.level.filter(|_| super::file::is_surface(path));
    let (first, _) = read_level(&args.first, level_of(&args.first), &[])?;
    let (second, _) = read_level(&args.second, level_of(&args.second), &[])?;
    let distance = SurfaceDistance::between(&first.triangulated(), &second.triangulated(), args.samples);
    let distance = distance.ok_or_else(|| {
        let (first, second) = (args.first.display(), args.second.display());
        let what = format_args!(
            "{first} or {second} has no area, or none that can be measured: there is no distance"
        );
        Failure::new(Fault::Data, what)
    })?;
    if args.json {
        let way = |deviation: &Deviation| json!({ "mean": deviation.mean, "rms": deviation.rms, "max": deviation.max });
        return print_json(&json!({
            "forward": way(&distance.forward),
            "backward": way(&distance.backward),
            "rms": distance.rms(1.0),
            "max": distance.max(1.0),
            "diagonal": distance.diagonal,
            "relative_rms": distance.rms(distance.diagonal),
            "relative_max": distance.max(distance.diagonal),
        }));
    }
    let name = |path: &std::path::Path| match level_of(path) {
        Some(level) => format!("{}, level {level}", path.display()),
        None if super::file::is_surface(path) => format!("{}, finest level", path.display()),
        None => path.display().to_string(),
    };
    let mut lines = vec![
        format!("{}: {}", name(&args.first), Report::of(&first)),
        format!("{}: {}", name(&args.second), Report::of(&second)),
        "                     mean         rms         max".to_owned(),
    ];
    let mut line = |what: &str, [mean, rms, max]: [f64; 3]| {
        lines.push(format!("{what:14} {mean:11.4e} {rms:11.4e} {max:11.4e}"));
    };
    let of = |deviation: &Deviation| [deviation.mean, deviation.rms, deviation.max];
    line("first->second", of(&distance.forward));
    line("second->first", of(&distance.backward));
    let in_units = |unit: f64| [distance.mean(unit), distance.rms(unit), distance.max(unit)];
    line("of diagonal", in_units(distance.diagonal));
    if let Some(cell) = args.cell {
        line("% of a cell", in_units(cell).map(|value| 100.0 * value));
    }
    if let Some(distortion) = Distortion::of(&second) {
        lines.push(format!(
            "{} quads, {} with a corner turned over; off right angles by {:.1} degrees, sides {:.2}:1, in the mean",
            distortion.quads, distortion.inverted, distortion.angle.mean, distortion.aspect.mean,
        ));
    }
    print(&(lines.join("\n") + "\n"))
}
