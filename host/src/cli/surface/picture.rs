//! `wavelift surface view-png`.

use std::path::PathBuf;
use std::str::FromStr;

use wavelift_host::mesh::Point;
use wavelift_host::picture::{Camera, Picture};
use wavelift_host::volume::Fault;

use super::file::read_level;
use crate::cli::exit::Failure;

/// Draw a surface or a mesh into a PNG file
///
/// Faces are flat; outsides are grey, or have the colors of the patches they belong to, insides are orange.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example:
  wavelift surface view-png engine.wsurf engine.png --level 2 --patches --lines")]
pub(crate) struct Args {
    /// Surface (.wsurf) or mesh
    input: PathBuf,
    /// Picture to write: .png
    output: PathBuf,
    /// Level to draw, 0 being the base mesh [default: the finest]
    #[arg(long, value_name = "L")]
    level: Option<u32>,
    /// Pixels along x and y
    #[arg(long, value_name = "XxY", default_value = "1024x1024")]
    size: Size,
    /// From the middle of the surface to the eye
    #[arg(long, value_name = "X,Y,Z", default_value = "0.5,-1,0.45", allow_hyphen_values = true)]
    towards: Vector,
    /// What is up in the picture
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,1", allow_hyphen_values = true)]
    up: Vector,
    /// A color for all that comes from one face of the base mesh
    #[arg(long)]
    patches: bool,
    /// Draws the sides of faces
    #[arg(long)]
    lines: bool,
}

#[derive(Clone, Copy, Debug)]
struct Size([u32; 2]);

impl FromStr for Size {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let sides = text.split_once('x').and_then(|(x, y)| Some([x.parse().ok()?, y.parse().ok()?]));
        let sides: Option<[u32; 2]> =
            sides.filter(|sides: &[u32; 2]| sides.iter().all(|side| (1..=16384).contains(side)));
        sides.map(Self).ok_or("two numbers of pixels from 1 to 16384, as in 1024x768")
    }
}

#[derive(Clone, Copy, Debug)]
struct Vector(Point);

impl FromStr for Vector {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parts: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
        let vector = <[f64; 3]>::try_from(parts).map(Point::from_array).ok();
        let vector = vector.filter(|vector| vector.is_finite() && *vector != Point::ZERO);
        vector.map(Self).ok_or("three numbers, not all 0, as in 0.5,-1,0.45")
    }
}

/// Draws.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let (mesh, patches) = read_level(&args.input, args.level, &[&args.output])?;
    let camera = Camera { towards: args.towards.0, up: args.up.0, ..Camera::default() };
    let line_width = if args.lines { 1.0 } else { 0.0 };
    let picture = Picture { size: args.size.0, camera, line_width, ..Picture::default() };
    let image = picture.draw(&mesh, args.patches.then_some(&patches[..]));
    image.write_png(&args.output).map_err(|error| Failure::new(Fault::Io, error))
}
