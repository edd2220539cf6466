//! `wavelift surface tables`.

use std::path::{Path, PathBuf};

use serde_json::json;
use wavelift_host::measure::SurfaceDistance;
use wavelift_host::mesh::{Point, PolygonMesh};
use wavelift_host::picture::{Camera, Image, Picture};
use wavelift_host::subdivision::{Hierarchy, SubdivisionSurface};
use wavelift_host::surface_wavelet::{Basis, Norms, forward, inverse, keep_largest};
use wavelift_host::volume::Fault;

use super::file::{length, read_surface};
use crate::cli::exit::Failure;
use crate::cli::output::{print, print_json};

/// Shares of the coefficients, in percent, and what Vis2000 Table 1 says of them for an isosurface of turbulent mixing.
const TABLE_1: [(f64, f64); 4] = [(20.0, 7.6), (10.0, 20.5), (5.0, 41.7), (1.6, 71.3)];

/// Error against share of wavelet coefficients (Vis2000 Table 1)
///
/// All but the largest coefficients are set to zero, and the surface is made again: its vertices are off by so much, and its
/// surface.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example:
  wavelift surface tables engine.wsurf --cell 1 --pictures pictures")]
pub(crate) struct Args {
    /// Surface: .wsurf
    input: PathBuf,
    /// Edge of a cell of the volume that the surface came from: errors are in percent of it
    #[arg(long, value_name = "E", default_value_t = 1.0, value_parser = length)]
    cell: f64,
    /// Samples on each surface, about
    #[arg(long, value_name = "N", default_value_t = 400_000)]
    samples: usize,
    /// Draws the base mesh, each of the surfaces, and all of it into this folder
    #[arg(long, value_name = "FOLDER")]
    pictures: Option<PathBuf>,
    /// Write one JSON document instead of text
    #[arg(long)]
    json: bool,
}

struct Row {
    share: f64,
    text: f64,
    coefficients: usize,
    /// RMS of vertices and of the surface, in percent of a cell's edge.
    vertices: f64,
    surface: f64,
}

/// Measures, and prints.
///
/// # Errors
/// A [`Failure`].
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let pictures = args.pictures.iter().flat_map(|folder| pictures().map(|name| folder.join(name)));
    let pictures: Vec<PathBuf> = pictures.collect();
    let surface = read_surface(&args.input, &pictures.iter().map(PathBuf::as_path).collect::<Vec<_>>())?;
    let hierarchy = Hierarchy::from(&surface);
    let mut coefficients = surface.positions.clone();
    forward(Basis::Bicubic, &hierarchy, &mut coefficients);
    let norms = Norms::new(Basis::Bicubic, hierarchy.steps().len());
    let exact = surface.level(surface.levels).triangulated();
    let mut drawn = Vec::new();
    if args.pictures.is_some() {
        drawn.push((BASE.to_owned(), draw(&surface.level(0))));
        drawn.push((ALL.to_owned(), draw(&surface.level(surface.levels))));
    }
    let mut rows = Vec::new();
    for (share, text) in TABLE_1 {
        let mut kept = coefficients.clone();
        let wanted = (share / 100.0 * kept.len() as f64) as usize;
        let left = keep_largest(&norms, &hierarchy, &mut kept, wanted);
        inverse(Basis::Bicubic, &hierarchy, &mut kept);
        let squares: f64 = kept.iter().zip(&surface.positions).map(|(a, b)| a.distance_squared(*b)).sum();
        let rough = SubdivisionSurface { positions: kept, ..surface.clone() }.level(surface.levels);
        if args.pictures.is_some() {
            drawn.push((picture(share), draw(&rough)));
        }
        let distance = SurfaceDistance::between(&exact, &rough.triangulated(), args.samples);
        let percent = 100.0 / args.cell;
        rows.push(Row {
            share,
            text,
            coefficients: left,
            vertices: percent * (squares / surface.positions.len() as f64).sqrt(),
            surface: percent * distance.map_or(0.0, |distance| distance.rms(1.0)),
        });
    }
    if let Some(folder) = &args.pictures {
        write_pictures(folder, &drawn)?;
    }
    if args.json { print_json(&document(&surface, &rows)) } else { print(&text(&surface, &rows)) }
}

/// Names of the pictures of all coefficients and of none.
const BASE: &str = "base.png";
const ALL: &str = "all.png";

/// Name of the picture of a share of the coefficients.
fn picture(share: f64) -> String {
    format!("{share}.png")
}

/// Names of all pictures.
fn pictures() -> impl Iterator<Item = String> {
    [BASE, ALL].map(str::to_owned).into_iter().chain(TABLE_1.map(|(share, _)| picture(share)))
}

/// Pixels along each side of a picture.
const SIDE: u32 = 480;

fn draw(mesh: &PolygonMesh) -> Image {
    let camera = Camera { towards: Point::new(0.5, -1.0, 0.45), up: Point::Z, ..Camera::default() };
    Picture { size: [SIDE; 2], camera, ..Picture::default() }.draw(mesh, None)
}

/// Writes one picture after another, so that little is left to do once the first has appeared.
fn write_pictures(folder: &Path, drawn: &[(String, Image)]) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|cause| Failure::cannot_write(folder, &cause))?;
    let write = |(name, image): &(String, Image)| image.write_png(&folder.join(name));
    drawn.iter().try_for_each(write).map_err(|error| Failure::new(Fault::Io, error))
}

fn document(surface: &SubdivisionSurface, rows: &[Row]) -> serde_json::Value {
    let rows: Vec<_> = rows
        .iter()
        .map(|row| {
            json!({
                "percent_of_coefficients": row.share,
                "coefficients": row.coefficients,
                "vertex_rmse_percent": row.vertices,
                "surface_rmse_percent": row.surface,
                "vis2000_percent": row.text,
            })
        })
        .collect();
    json!({ "vertices": surface.positions.len(), "base_vertices": surface.base_vertices(), "rows": rows })
}

fn text(surface: &SubdivisionSurface, rows: &[Row]) -> String {
    let mut lines = vec![
        format!("{} vertices, {} in the base mesh", surface.positions.len(), surface.base_vertices()),
        "coefficients           RMSE of vertices   of the surface   Vis2000 Table 1".to_owned(),
        "    %    number                       %                %                 %".to_owned(),
    ];
    lines.extend(rows.iter().map(|row| {
        format!(
            "{:5.1} {:9} {:23.2} {:16.2} {:17.1}",
            row.share, row.coefficients, row.vertices, row.surface, row.text
        )
    }));
    lines.push(
        "errors in percent of a cell's edge; the text's are of another surface of the same kind".to_owned(),
    );
    lines.join("\n") + "\n"
}
