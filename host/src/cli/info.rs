//! `wavelift info`.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use wavelift_host::codec::Container;
use wavelift_host::volume::{HeaderLine, sample_bytes};
use wavelift_kernel::Wavelet;

use super::bound;
use super::exit::Failure;
use super::output::{print, print_json};

/// Tell what a compressed file holds, without decoding it
///
/// Extent, type, wavelet, levels, bricks, sizes, and the header of the volume's source.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift info head.wlift
  wavelift info head.wlift --json")]
pub(crate) struct Args {
    /// Compressed file
    pub(crate) input: PathBuf,
    /// Write one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// Tells what a compressed file holds.
///
/// # Errors
/// A [`Failure`] if it is not a whole container.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let container =
        Container::open(&args.input).map_err(|error| Failure::of_container(&args.input, &error))?;
    if args.json { print_json(&document(&args.input, &container)) } else { print(&text(&container)) }
}

fn document(input: &Path, container: &Container) -> Value {
    let index = container.index();
    let metadata = &index.metadata;
    let mut document = json!({
        "input": input.display().to_string(),
        "extent": index.grid.extent,
        "type": index.element.name(),
        "sample_bytes": sample_bytes(index.grid.extent, index.element),
        "bytes": container.bytes(),
        "bits_per_sample": bits(container),
        "brick": index.grid.sides,
        "bricks": index.bricks.len(),
        "effort": index.effort.name(),
        "wavelet": index.wavelet.map_or("none", Wavelet::name),
        "levels": index.levels,
        "readable_levels": index.readable_levels,
        "source": {
            "format": metadata.source.format.name(),
            "byte_order": metadata.source.byte_order.name(),
            "fortran_order": metadata.source.fortran_order,
            "rank": metadata.rank(),
        },
        "name": metadata.name(),
        "spacing": metadata.spacing(),
        "origin": metadata.origin(),
        "header": metadata.lines.iter().map(entry).collect::<Vec<_>>(),
    });
    if let Value::Object(fields) = &mut document {
        fields.extend(bound::fields(index));
    }
    document
}

fn entry(line: &HeaderLine) -> Value {
    match line {
        HeaderLine::Comment(text) => json!({ "comment": text }),
        HeaderLine::Field { name, value } => json!({ "field": name, "value": value }),
        HeaderLine::KeyValue { key, value } => json!({ "key": key, "value": value }),
    }
}

fn text(container: &Container) -> String {
    let index = container.index();
    let ([x, y, z], [a, b, c]) = (index.grid.extent, index.grid.sides);
    let source = index.metadata.source;
    let fortran = if source.fortran_order { ", Fortran order" } else { "" };
    let mut lines = vec![
        format!("extent    {x} x {y} x {z}, x fastest"),
        format!("type      {}", index.element),
        format!("effort    {}", index.effort),
        match index.wavelet {
            Some(wavelet) => format!("wavelet   {}, {} levels", wavelet.name(), index.levels),
            None => "wavelet   none (no transform)".to_owned(),
        },
        match index.readable_levels {
            0 => "levels    0, full resolution only".to_owned(),
            coarsest => format!("levels    0 to {coarsest} can be read"),
        },
        format!("bricks    {} of {a} x {b} x {c}", index.bricks.len()),
        format!("size      {} bytes, {:.3} bits a sample", container.bytes(), bits(container)),
        format!("source    {}, {} endian{fortran}", source.format.name(), source.byte_order.name()),
    ];
    lines.extend(bound::lines(index));
    lines.extend(index.metadata.lines.iter().map(|line| match line {
        HeaderLine::Comment(text) => format!("          #{text}"),
        HeaderLine::Field { name, value } => format!("          {name}: {value}"),
        HeaderLine::KeyValue { key, value } => format!("          {key} := {value}"),
    }));
    lines.join("\n") + "\n"
}

fn bits(container: &Container) -> f64 {
    let samples: f64 = container.index().grid.extent.into_iter().map(|axis| axis as f64).product();
    8.0 * container.bytes() as f64 / samples
}
