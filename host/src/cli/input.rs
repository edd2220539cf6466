//! Arguments that several commands share: the layout of a raw file, and names to choose from.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::builder::{PathBufValueParser, PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::value_parser;
use wavelift_host::codec::Container;
use wavelift_host::volume::{
    self, AxisOrder, ByteOrder, ElementType, Fault, RankedExtent, RawLayout, ReadError, Source, Volume,
};
use wavelift_kernel::Wavelet;

use super::exit::Failure;

/// How a raw file lies, which it does not say itself. Other formats need none of these.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Layout of a raw file")]
pub(crate) struct RawArgs {
    /// Samples along x, y and z: 64x64x93 (or 64,64,93), 512x512, 1000
    #[arg(long, value_name = "XxYxZ")]
    extent: Option<RankedExtent>,
    /// Type of a value; NumPy's names, such as uint16, are taken too
    #[arg(long = "type", value_name = "T", value_parser = element_names())]
    element: Option<ElementType>,
    /// Order of the bytes of a value in the file [default: little]
    #[arg(long, value_name = "ORDER", value_parser = byte_order_names())]
    byte_order: Option<ByteOrder>,
    /// Values of a sample, such as 3 for colours or vectors [default: 1]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..))]
    components: Option<u32>,
    /// Volumes that follow each other in time [default: 1]
    #[arg(long, value_name = "N", value_parser = value_parser!(u64).range(1..))]
    steps: Option<u64>,
    /// Order of the axes in the file, the one that varies fastest first, c for components and t for time: zyx for
    /// array[x, y, z] of NumPy, xyzc for components as volumes one after another [default: cxyzt]
    #[arg(long, value_name = "ORDER")]
    axes: Option<AxisOrder>,
    /// Bytes to pass over before the first value
    #[arg(long, value_name = "BYTES")]
    skip: Option<u64>,
}

impl RawArgs {
    /// The layout, if one is given. `default` is the type of a file that has only one.
    ///
    /// # Errors
    /// A usage failure for half a layout.
    pub(crate) fn layout(&self, default: Option<ElementType>) -> Result<Option<RawLayout>, Failure> {
        match (self.extent, self.element, self.element.or(default)) {
            (Some(extent), _, Some(element)) => Ok(Some(self.over(RawLayout::new(extent, element)))),
            (Some(_), _, None) => Err(usage("--extent is given, but not --type: a raw file needs both")),
            (None, Some(_), _) => Err(usage("--type is given, but not --extent: a raw file needs both")),
            (None, None, _) if self.is_given() => Err(usage(
                "--byte-order, --components, --steps, --axes and --skip are for raw files: give --extent and --type \
                 with them, or leave them out",
            )),
            (None, None, _) => Ok(None),
        }
    }

    /// The layout with `known` in place of what is not given; `None` if nothing is given.
    pub(crate) fn completed_by(&self, known: RawLayout) -> Option<RawLayout> {
        self.is_given().then(|| self.over(known))
    }

    fn over(&self, known: RawLayout) -> RawLayout {
        RawLayout {
            extent: self.extent.unwrap_or(known.extent),
            element: self.element.unwrap_or(known.element),
            byte_order: self.byte_order.unwrap_or(known.byte_order),
            components: self.components.unwrap_or(known.components),
            steps: self.steps.unwrap_or(known.steps),
            order: self.axes.unwrap_or(known.order),
            skip: self.skip.unwrap_or(known.skip),
        }
    }

    /// Whether any part of a layout is given.
    pub(crate) const fn is_given(&self) -> bool {
        let is_of_bytes = self.element.is_some() || self.byte_order.is_some() || self.skip.is_some();
        let is_of_axes = self.extent.is_some() || self.axes.is_some();
        is_of_bytes || is_of_axes || self.components.is_some() || self.steps.is_some()
    }
}

/// Reads a volume.
///
/// # Errors
/// A [`Failure`], which tells a compressed file from a raw one without a layout.
pub(crate) fn read_volume(path: &Path, layout: Option<&RawLayout>) -> Result<Volume, Failure> {
    volume::read(path, layout).map_err(|error| failure(path, error))
}

/// Opens a data set of any format.
///
/// # Errors
/// As [`read_volume`].
pub(crate) fn open_source(path: &Path, layout: Option<&RawLayout>) -> Result<Box<dyn Source>, Failure> {
    volume::open(path, layout).map_err(|error| failure(path, error))
}

/// As [`open_source`], for something that is to be written to `output`.
///
/// # Errors
/// As [`open_source`], and a usage failure if that would overwrite what is read.
pub(crate) fn open_source_for(
    path: &Path,
    layout: Option<&RawLayout>,
    output: &Path,
) -> Result<Box<dyn Source>, Failure> {
    let source = open_source(path, layout)?;
    refuse_overwriting(&source.files(), output)?;
    Ok(source)
}

/// As [`read_volume`], for something that is to be written to `output`.
///
/// # Errors
/// As [`open_source_for`].
pub(crate) fn read_volume_for(
    path: &Path,
    layout: Option<&RawLayout>,
    output: &Path,
) -> Result<Volume, Failure> {
    Ok(volume::read_all(path, open_source_for(path, layout, output)?)?)
}

fn failure(path: &Path, error: ReadError) -> Failure {
    match error {
        // What came through a pipe is gone, and cannot be looked at again.
        ReadError::NoLayout { .. } | ReadError::LayoutMismatch { .. }
            if path.is_file() && Container::is_container(path) =>
        {
            Failure::at(path, Fault::Usage, "is a wavelift file already: decompress it first")
        }
        other => other.into(),
    }
}

/// Refuses to write a file over the one it is made from.
///
/// # Errors
/// A usage failure if the input is a regular file, and both paths lead to it, or the output's has its samples there.
pub(crate) fn refuse_same_file(input: &Path, output: &Path) -> Result<(), Failure> {
    if !input.is_file() {
        return Ok(());
    }
    match (input.canonicalize(), output.canonicalize()) {
        (Ok(input), Ok(output)) if input == output => {}
        _ => return refuse_overwriting(&[input.to_owned()], output),
    }
    Err(Failure::at(output, Fault::Usage, "is the input as well: give another output"))
}

/// Refuses to write a file over others that are read.
///
/// # Errors
/// A usage failure if [`volume::overwritten`] finds one.
pub(crate) fn refuse_overwriting(files: &[PathBuf], output: &Path) -> Result<(), Failure> {
    let Some(file) = volume::overwritten(files, output) else { return Ok(()) };
    let message = format_args!("would overwrite {}, which is read: give another output", file.display());
    Err(Failure::at(output, Fault::Usage, message))
}

fn usage(message: &str) -> Failure {
    Failure::new(Fault::Usage, message)
}

/// Takes a path; `-` is standard input, and `./-` a file of that name.
pub(crate) fn input_path() -> impl TypedValueParser<Value = PathBuf> {
    path_or("/dev/stdin")
}

/// Takes a path; `-` stands for `device`.
pub(crate) fn path_or(device: &'static str) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().map(move |path| if path == Path::new("-") { device.into() } else { path })
}

/// Takes the name of a sample type; NumPy's too, which help does not list.
pub(crate) fn element_names() -> impl TypedValueParser<Value = ElementType> {
    names(ElementType::ALL.map(|element| PossibleValue::new(element.name()).alias(element.long_name())))
}

/// Takes `little` or `big`.
pub(crate) fn byte_order_names() -> impl TypedValueParser<Value = ByteOrder> {
    names([ByteOrder::Little, ByteOrder::Big].map(|order| PossibleValue::new(order.name())))
}

/// Takes the name of one of the six wavelets.
pub(crate) fn wavelet_names() -> impl TypedValueParser<Value = Wavelet> {
    PossibleValuesParser::new(Wavelet::ALL.map(Wavelet::name)).map(|name| {
        let found = Wavelet::ALL.into_iter().find(|wavelet| wavelet.name() == name);
        found.expect("only names of the list pass")
    })
}

/// Takes one of `names`, so that help lists them and a misspelt one is told from them.
fn names<T, const N: usize>(names: [PossibleValue; N]) -> impl TypedValueParser<Value = T>
where
    T: FromStr + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names)
        .map(|name| name.parse().unwrap_or_else(|_| unreachable!("only names of the list pass")))
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Program {
        #[command(flatten)]
        raw: RawArgs,
        #[arg(long, value_parser = wavelet_names())]
        wavelet: Option<Wavelet>,
    }

    fn parse(words: &str) -> Result<Program, clap::Error> {
        Program::try_parse_from(["wavelift"].into_iter().chain(words.split_whitespace()))
    }

    #[test]
    fn a_whole_layout_or_none_is_taken() {
        let layout = |words, default| parse(words).unwrap().raw.layout(default);
        assert_eq!(layout("", None).unwrap(), None);
        assert_eq!(layout("", Some(ElementType::I32)).unwrap(), None);
        let whole = layout("--extent 4x3 --type u16 --byte-order big", None).unwrap().unwrap();
        assert_eq!((whole.extent.to_string().as_str(), whole.element), ("4x3", ElementType::U16));
        assert_eq!(whole.byte_order, ByteOrder::Big);
        let given = layout("--extent 4x3", Some(ElementType::I32)).unwrap().unwrap();
        assert_eq!((given.element, given.byte_order), (ElementType::I32, ByteOrder::Little));
        for half in ["--extent 4x3", "--type u8", "--byte-order big", "--type u8 --byte-order big"] {
            layout(half, None).unwrap_err();
        }
    }

    #[test]
    fn a_known_layout_gives_what_is_missing() {
        let known =
            parse("--extent 4x3 --type u16 --byte-order big").unwrap().raw.layout(None).unwrap().unwrap();
        let completed = |words| parse(words).unwrap().raw.completed_by(known);
        assert_eq!(completed(""), None);
        assert_eq!(completed("--extent 4x3"), Some(known));
        let other = completed("--type u8 --byte-order little").unwrap();
        assert_eq!((other.extent, other.element), (known.extent, ElementType::U8));
        assert_eq!(other.byte_order, ByteOrder::Little);
    }

    #[test]
    fn names_are_taken_from_their_lists() {
        for wavelet in Wavelet::ALL {
            assert_eq!(parse(&format!("--wavelet {}", wavelet.name())).unwrap().wavelet, Some(wavelet));
        }
        for element in ElementType::ALL {
            for name in [element.name(), element.long_name()] {
                let parsed = parse(&format!("--extent 4 --type {name}")).unwrap();
                assert_eq!(parsed.raw.element, Some(element));
            }
        }
        for wrong in ["--wavelet none", "--type U8", "--byte-order middle", "--extent 4x0"] {
            assert!(parse(wrong).is_err_and(|error| error.exit_code() == 2), "{wrong}");
        }
    }
}
