//! `wavelift convert`.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use wavelift_host::codec::Container;
use wavelift_host::volume::{self, ByteOrder, Created, Fault, FileFormat, Header, WriteOptions};

use super::exit::Failure;
use super::input::{RawArgs, byte_order_names, input_path, open_source_for, refuse_same_file};
use super::output::{JSON_AND_OUTPUT, output_path, print_json, refuse_standard_output, say_losses, tell};
use super::progress::Bar;

/// Write a volume in another format, without compression
///
/// Samples keep their bits; what the format of OUTPUT has no place for is told. Both files may be larger than memory.
/// OUTPUT appears whole or not at all.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift convert head.nrrd head.npy
  wavelift convert engine.raw engine.nrrd --extent 256x256x128 --type u8 --gzip")]
pub(crate) struct Args {
    /// File to read: of any format that wavelift knows, or raw samples with --extent and --type
    #[arg(value_parser = input_path())]
    pub(crate) input: PathBuf,
    /// File to write: its extension says the format; raw samples for an unknown one
    #[arg(value_parser = output_path())]
    pub(crate) output: PathBuf,
    /// Order of the bytes of a sample in OUTPUT [default: as in INPUT]
    #[arg(long, value_name = "ORDER", value_parser = byte_order_names())]
    pub(crate) output_byte_order: Option<ByteOrder>,
    /// Compress the samples in OUTPUT with gzip, where its format can
    #[arg(long)]
    pub(crate) gzip: bool,
    /// Report what was written as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) raw: RawArgs,
}

/// Copies a data set from one format to another.
///
/// # Errors
/// A [`Failure`]; OUTPUT is what it was then.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    refuse_compressed(args)?;
    refuse_same_file(&args.input, &args.output)?;
    if args.json {
        refuse_standard_output(&args.output, JSON_AND_OUTPUT)?;
    }
    let mut source = open_source_for(&args.input, args.raw.layout(None)?.as_ref(), &args.output)?;
    let header = source.header().clone();
    let options = WriteOptions { byte_order: args.output_byte_order, gzip: args.gzip };
    let Created { sink, losses } = volume::create(&args.output, &header, &options)?;
    let sample_bytes = header.components as usize * header.element.bytes();
    let bar = Bar::new("converting", samples(&header), sample_bytes);
    volume::copy(source.as_mut(), sink, &|samples| bar.count(samples))?;
    drop(bar);
    let format = FileFormat::of_path(&args.output);
    if args.json {
        return print_json(&document([&args.input, &args.output], &header, &losses));
    }
    say_losses(&args.output, &losses);
    tell(format_args!("{}: {}, {}", args.output.display(), in_words(&header), format.name()));
    Ok(())
}

/// What a volume was written as, and what its format has no place for.
pub(crate) fn document([input, output]: [&Path; 2], header: &Header, losses: &[String]) -> Value {
    json!({
        "input": input.display().to_string(),
        "output": output.display().to_string(),
        "format": FileFormat::of_path(output).name(),
        "extent": header.extent,
        "components": header.components,
        "steps": header.steps,
        "type": header.element.name(),
        "sample_bytes": header.bytes(),
        "not_kept": losses,
    })
}

/// Sends those with compressed files to the commands for them.
fn refuse_compressed(args: &Args) -> Result<(), Failure> {
    let is_named = |path: &Path| path.extension().is_some_and(|name| name.eq_ignore_ascii_case("wlift"));
    if is_named(&args.output) {
        let message = "wavelift files are written by `wavelift compress`";
        return Err(Failure::at(&args.output, Fault::Usage, message));
    }
    if is_named(&args.input) || args.input.is_file() && Container::is_container(&args.input) {
        let message = "wavelift files are read by `wavelift decompress`, which writes any format too";
        return Err(Failure::at(&args.input, Fault::Usage, message));
    }
    Ok(())
}

fn samples(header: &Header) -> u64 {
    header.extent.into_iter().fold(header.steps, u64::saturating_mul)
}

pub(crate) fn in_words(header: &Header) -> String {
    let [x, y, z] = header.extent;
    let mut text = format!("{x}x{y}x{z} {}", header.element);
    if header.components > 1 {
        text += &format!(" of {} components", header.components);
    }
    if header.steps > 1 {
        text += &format!(", {} time steps", header.steps);
    }
    text
}

#[cfg(test)]
mod tests {
    use wavelift_host::volume::{ElementType, Metadata};

    use super::*;

    #[test]
    fn data_sets_are_told_in_words() {
        let metadata = Metadata::default();
        let mut header = Header::scalar([4, 3, 2], ElementType::U16, metadata);
        assert_eq!((in_words(&header).as_str(), samples(&header)), ("4x3x2 u16", 24));
        (header.components, header.steps) = (3, 5);
        assert_eq!(in_words(&header), "4x3x2 u16 of 3 components, 5 time steps");
        assert_eq!(samples(&header), 120);
    }
}
