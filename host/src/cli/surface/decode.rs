//! `wavelift surface decode`.

use std::path::PathBuf;

use wavelift_host::mesh::{PolygonMesh, Report};
use wavelift_host::subdivision::{Hierarchy, SubdivisionSurface, limit};
use wavelift_host::surface_codec::{self, DecodeError, Limits};
use wavelift_host::volume::Fault;

use super::file::{bad, read_bytes, refuse_other_than_mesh, write_mesh};
use crate::cli::exit::Failure;
use crate::cli::output::print;

/// Decode a surface, whole or in part, to a mesh of any of its levels
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift surface decode engine.wsurf engine.ply
  wavelift surface decode engine.wsurf coarse.obj --level 1 --bytes 20000")]
pub(crate) struct Args {
    /// Surface: .wsurf, or the beginning of one
    input: PathBuf,
    /// Mesh to write: .ply, .obj, .stl, .off, .gltf or .glb
    output: PathBuf,
    /// Level to write, 0 being the base mesh: the vertices that it has, where the finest mesh has them [default: the finest]
    #[arg(long, value_name = "L")]
    level: Option<u32>,
    /// Reads no more than the first N bytes
    #[arg(long, value_name = "N")]
    bytes: Option<usize>,
    /// Decodes only region R, the first being 0, of a surface that was encoded by regions, and writes its faces
    #[arg(long, value_name = "R", conflicts_with = "bytes")]
    region: Option<usize>,
    /// Refuses surfaces of more vertices than this, each of which takes about 100 bytes of memory
    #[arg(long, value_name = "N", default_value_t = Limits::default().vertices)]
    most_vertices: u64,
    /// Moves vertices to where endless bicubic subdivision of what the wavelets leave at the level would; nothing is
    /// decoded that only finer levels need
    #[arg(long)]
    limit: bool,
}

/// Decodes, and tells the topology of the mesh.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_other_than_mesh(&args.output)?;
    let bytes = read_bytes(&args.input, args.bytes, &[&args.output])?;
    let accepted = Limits { vertices: args.most_vertices };
    let levels = surface_codec::levels(&bytes).map_err(|error| bad(&args.input, error))?;
    let level = args.level.unwrap_or(levels);
    // Where vertices end up in the finest mesh takes all levels.
    let decoded = if args.limit { level } else { levels.max(level) };
    let refused = |error| match error {
        DecodeError::Region { .. } | DecodeError::Level { .. } => {
            Failure::at(&args.input, Fault::Usage, error)
        }
        _ => bad(&args.input, error),
    };
    let (surface, faces) = match args.region {
        None => {
            let surface = surface_codec::decode_level(&bytes, decoded, accepted).map_err(refused)?;
            let faces = 0..surface.base.len();
            (surface, faces)
        }
        Some(region) => surface_codec::decode_region(&bytes, region, decoded, accepted).map_err(refused)?,
    };
    let mut mesh = surface.level(level);
    if args.limit {
        mesh.positions = limits(&surface, &mesh, level)?;
    }
    if args.region.is_some() {
        mesh = part(&surface, &mesh, level, faces);
    }
    write_mesh(&mesh, &args.output)?;
    print(&format!("{}\n", Report::of(&mesh)))
}

/// Where the vertices of a level go in the limit.
fn limits(
    surface: &SubdivisionSurface,
    mesh: &PolygonMesh,
    level: u32,
) -> Result<Vec<wavelift_host::mesh::Point>, Failure> {
    if level == 0 {
        return Err(Failure::new(
            Fault::Usage,
            "--limit is for levels from 1 on: the base mesh has other faces than quads",
        ));
    }
    let hierarchy = Hierarchy::new(surface.base_vertices(), &surface.base, &surface.features, level + 1);
    Ok(limit(&hierarchy.steps()[level as usize], mesh).positions)
}

/// The faces of a level that come from some faces of the base mesh, and the vertices that they need.
fn part(
    surface: &SubdivisionSurface,
    mesh: &PolygonMesh,
    level: u32,
    faces: std::ops::Range<usize>,
) -> PolygonMesh {
    let quads = |face: usize| if level == 0 { 1 } else { surface.base.get(face).len() << (2 * (level - 1)) };
    let first: usize = (0..faces.start).map(quads).sum();
    let count: usize = faces.map(quads).sum();
    let mut numbers = vec![u32::MAX; mesh.positions.len()];
    let mut positions = Vec::new();
    let mut kept = wavelift_host::mesh::Faces::default();
    for face in mesh.faces().iter().skip(first).take(count) {
        let mut renumbered = Vec::with_capacity(face.len());
        for &corner in face {
            let number = &mut numbers[corner as usize];
            if *number == u32::MAX {
                *number = positions.len() as u32;
                positions.push(mesh.positions[corner as usize]);
            }
            renumbered.push(*number);
        }
        kept.push(&renumbered);
    }
    PolygonMesh::new(positions, kept)
}
