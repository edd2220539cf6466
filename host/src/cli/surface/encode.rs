//! `wavelift surface encode`.

use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, TypedValueParser};
use wavelift_host::subdivision::SubdivisionSurface;
use wavelift_host::surface_codec::{Encoded, Precision, Settings};
use wavelift_host::surface_wavelet::Basis;

use super::file::{self, read_surface, refuse_mesh, write_bytes};
use crate::cli::exit::Failure;
use crate::cli::output::print;

/// Encode a surface with wavelets: to a precision, to a size, or without loss
///
/// Every beginning of OUTPUT that holds the base mesh can be decoded, and is better with each byte.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift surface encode engine.wsurf small.wsurf --rms 0.05
  wavelift surface encode engine.wsurf small.wsurf --bytes 20000")]
pub(crate) struct Args {
    /// Surface: .wsurf
    input: PathBuf,
    /// Surface to write
    output: PathBuf,
    #[command(flatten)]
    how: How,
}

/// How surfaces are encoded.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct How {
    /// Root mean square deviation along normals of at most R, in units of the surface
    #[arg(long, value_name = "R", conflicts_with_all = ["step", "bytes", "unit"])]
    rms: Option<f64>,
    /// Quantization in steps of S, in units of the surface
    #[arg(long, value_name = "S", conflicts_with_all = ["bytes", "unit"])]
    step: Option<f64>,
    /// As good as N bytes allow
    #[arg(long, value_name = "N", conflicts_with = "unit")]
    bytes: Option<usize>,
    /// Coordinates rounded to multiples of U, then without loss
    #[arg(long, value_name = "U")]
    unit: Option<f64>,
    /// Wavelets [default: bicubic]
    #[arg(long, value_name = "W", value_parser = bases())]
    wavelet: Option<Basis>,
    /// Codes runs of N faces of the base mesh on their own, so that each can be decoded alone
    #[arg(long, value_name = "N")]
    faces_per_region: Option<NonZeroU32>,
}

impl How {
    /// The settings that were asked for; `default` is the RMS deviation where nothing was.
    pub(super) fn settings(&self, default: f64) -> Settings {
        let lossy = self.step.map(Precision::Step).or(self.bytes.map(Precision::Bytes));
        let lossless = self.unit.map(|unit| Precision::Lossless { unit });
        let mut settings =
            Settings::new(lossy.or(lossless).unwrap_or(Precision::Rms(self.rms.unwrap_or(default))));
        settings.basis = self.wavelet.unwrap_or(settings.basis);
        settings.faces_per_region = self.faces_per_region;
        settings
    }
}

/// Encodes, and tells size and deviation.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_mesh(&args.output)?;
    let surface = read_surface(&args.input, &[&args.output])?;
    let encoded = file::encode(&args.input, &surface, &args.how.settings(fine(&surface)))?;
    write_bytes(&args.output, &encoded.bytes)?;
    print(&text(&args.output, &surface, &encoded))
}

/// A deviation that is hard to see: 1/20000 of the diagonal.
fn fine(surface: &SubdivisionSurface) -> f64 {
    let bounds = wavelift_host::measure::Bounds::around(surface.positions.iter().copied());
    (bounds.diagonal() / 20_000.0).max(f64::MIN_POSITIVE)
}

/// What a file came to.
pub(super) fn text(path: &Path, surface: &SubdivisionSurface, encoded: &Encoded) -> String {
    let (bytes, vertices) = (encoded.bytes.len(), surface.positions.len());
    format!(
        "{}: {bytes} bytes, {:.2} bits a vertex, {} for the base mesh of {} vertices; rms {:.3e} along normals, {:.3e} in \
         all, at most {:.3e}\n",
        path.display(),
        8.0 * bytes as f64 / vertices as f64,
        encoded.base_bytes,
        surface.base_vertices(),
        encoded.deviation.rms_along_normals,
        encoded.deviation.rms,
        encoded.deviation.largest,
    )
}

/// Takes the name of a basis.
fn bases() -> impl TypedValueParser<Value = Basis> {
    PossibleValuesParser::new(Basis::ALL.map(Basis::name)).map(|name| {
        let found = Basis::ALL.into_iter().find(|basis| basis.name() == name);
        found.expect("only names of the list pass")
    })
}
