//! MetaImage files (`.mha`, `.mhd`): a header of text lines, then samples or the names of their files.
//!
//! Source: the MetaIO library's documentation of MetaImage. Axes are listed fastest first; positions are those of a
//! left-posterior-superior space. Samples may be compressed as one zlib stream.

mod error;
mod header;
mod meaning;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

pub use error::MetaImageError;
use header::{MetaHeader, type_name};

use super::format::{Format, has_extension};
use super::input::Input;
use super::joined::{Joined, PartLayout, beside, listed, numbered};
use super::rearranged::ordered_sink;
use super::stored::{Encoding, StoredSink};
use super::{Axis, ByteOrder, Created, FileFormat, Header, ReadError, Source, WriteError, WriteOptions};
use crate::atomic::AtomicFile;

/// First bytes of a gzip member, which the library takes for zlib data as well.
const GZIP: &[u8] = &[0x1f, 0x8b];

/// The format of MetaIO and ITK.
pub(super) struct MetaImage;

impl Format for MetaImage {
    fn format(&self) -> FileFormat {
        FileFormat::MetaImage
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(path, &["mha", "mhd"])
    }

    fn begins(&self, first: &[u8]) -> bool {
        first.starts_with(b"ObjectType = Image")
    }

    fn compresses(&self, _: &Path) -> bool {
        true
    }

    fn open_input(&self, mut input: Input) -> Result<Box<dyn Source>, ReadError> {
        let file = MetaHeader::read(&mut input)?;
        let path = input.path().to_owned();
        let fault = |cause: MetaImageError| ReadError::Format {
            path: path.clone(),
            format: FileFormat::MetaImage,
            cause: Box::new(cause),
        };
        let mut layout = PartLayout {
            encoding: if file.is_compressed { Encoding::Zlib } else { Encoding::Raw },
            byte_order: file.byte_order,
            line_skip: 0,
            byte_skip: file.header_size,
        };
        let data_file = file.data_file.clone();
        let header = meaning::read(file).map_err(|cause| fault(MetaImageError::Extent(cause)))?;
        let files = match data_files(&data_file, &path).map_err(fault)? {
            DataFiles::Local => None,
            DataFiles::Listed => Some(listed(&mut input)?),
            DataFiles::Named(files) => Some(files),
        };
        let mut data = match files.as_deref() {
            None => input,
            Some([]) => return Err(fault(MetaImageError::Files { files: 0 })),
            Some([first, ..]) => Input::open(first)?,
        };
        if layout.encoding == Encoding::Zlib && data.starts_with(GZIP)? {
            layout.encoding = Encoding::Gzip;
        }
        if layout.byte_skip.is_none() && (layout.encoding != Encoding::Raw || data.left().is_none()) {
            return Err(fault(MetaImageError::SkipToEnd));
        }
        match files {
            Some(files) if files.len() > 1 => {
                let count = files.len();
                let joined = Joined::new(header, files, layout);
                Ok(Box::new(joined.ok_or_else(|| fault(MetaImageError::Files { files: count }))?))
            }
            _ => Ok(Box::new(layout.open(data, header)?)),
        }
    }

    fn writes(&self, path: &Path) -> Vec<PathBuf> {
        let data: &[&str] = if has_extension(path, &["mhd"]) { &["raw", "zraw"] } else { &[] };
        let data = data.iter().map(|extension| path.with_extension(extension));
        std::iter::once(path.to_owned()).chain(data).collect()
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        let encoding = if options.gzip { Encoding::Zlib } else { Encoding::Raw };
        let order = options.byte_order.unwrap_or(header.metadata.source.byte_order);
        let fault = |cause| WriteError::Io { path: path.to_owned(), cause };
        let axes = axes_of(header);
        let (mut text, losses) = header_text(header, &axes, order, encoding);
        if !has_extension(path, &["mhd"]) {
            // ITK needs the length of compressed samples that lie behind a header; it is known at the end only.
            let size_at = (encoding == Encoding::Zlib).then(|| {
                text += "CompressedDataSize = ";
                let digits = text.len() as u64;
                text += "00000000000000000000\n";
                digits
            });
            text += "ElementDataFile = LOCAL\n";
            let mut file = AtomicFile::create(path).map_err(fault)?;
            file.write_all(text.as_bytes()).map_err(fault)?;
            let mut sink = StoredSink::new(file, path, header, encoding, order);
            if let Some(digits) = size_at {
                sink = sink.with_size_at(digits);
            }
            return Ok(Created { sink: ordered_sink(sink, path, header, &axes)?, losses });
        }
        let data = path.with_extension(if options.gzip { "zraw" } else { "raw" });
        if data.exists() && !belongs_to(&data, path) {
            return Err(WriteError::DataFileExists { path: path.to_owned(), data });
        }
        let name = data.file_name().and_then(|name| name.to_str());
        let name = name
            .filter(|name| is_plain(name))
            .ok_or_else(|| fault(std::io::ErrorKind::InvalidFilename.into()))?;
        text += &format!("ElementDataFile = {name}\n");
        let mut header_file = AtomicFile::create(path).map_err(fault)?;
        header_file.write_all(text.as_bytes()).and_then(|()| header_file.flush()).map_err(fault)?;
        let file = AtomicFile::create(&data).map_err(|cause| WriteError::Io { path: data.clone(), cause })?;
        let sink = StoredSink::new(file, &data, header, encoding, order).followed_by(header_file, path);
        Ok(Created { sink: ordered_sink(sink, path, header, &axes)?, losses })
    }
}

/// Where samples are.
enum DataFiles {
    /// Behind the header.
    Local,
    /// In the files whose names follow, one a line.
    Listed,
    /// In these.
    Named(Vec<PathBuf>),
}

/// Understands the value of `ElementDataFile`: `LOCAL`, `LIST`, a pattern and three numbers, or a name.
fn data_files(value: &str, header: &Path) -> Result<DataFiles, MetaImageError> {
    let words: Vec<&str> = value.split_whitespace().collect();
    let numbers: Option<Vec<i64>> = words.iter().skip(1).map(|word| word.parse().ok()).collect();
    match (words.as_slice(), numbers.as_deref()) {
        ([], _) => Err(MetaImageError::Missing { key: "ElementDataFile" }),
        ([word], _) if word.eq_ignore_ascii_case("local") => Ok(DataFiles::Local),
        (["LIST", ..], Some(_)) => Ok(DataFiles::Listed),
        ([pattern, _, _, ..], Some([first, last, rest @ ..])) if pattern.contains('%') => {
            let step = rest.first().copied().unwrap_or(1);
            let files = numbered(header, pattern, *first, *last, step);
            files.map(DataFiles::Named).ok_or_else(|| MetaImageError::Value {
                key: "ElementDataFile",
                value: super::error::excerpt(value),
                expected: "a pattern such as slice%03d.raw, the first and the last number, and a step",
            })
        }
        _ => Ok(DataFiles::Named(vec![beside(header, value)])),
    }
}

/// Channels, axes of space, time: the only order that the format has, in the number of axes that the source has.
fn axes_of(header: &Header) -> Vec<Axis> {
    let mut axes = header.axes();
    axes.retain(|axis| !matches!(axis, Axis::Component(_)));
    axes.sort_by_key(|axis| axis.place());
    if axes.iter().any(|axis| matches!(axis, Axis::Time(_))) || is_out_of_plane(header) {
        // Time is the fourth axis, after as many of space as there may be; and places have as many numbers as axes.
        let missing = axes.iter().filter(|axis| axis.is_space()).count()..3;
        let at = missing.start;
        missing.rev().for_each(|axis| axes.insert(at, Axis::SPACE[axis]));
    }
    if header.components > 1 {
        axes.insert(0, Axis::Component(header.components));
    }
    axes
}

/// Whether a line or slice lies in a space of more axes than it has.
fn is_out_of_plane(header: &Header) -> bool {
    let rank = header.rank();
    let geometry = header.metadata.geometry().filter(|_| header.metadata.field("space directions").is_some());
    let vectors = geometry.map(|geometry| [&geometry.directions[..rank], &[geometry.origin]].concat());
    vectors.is_some_and(|vectors| vectors.iter().any(|vector| vector[rank..].iter().any(|part| *part != 0.0)))
}

/// Header up to where the samples, or the name of their file, follow.
fn header_text(
    header: &Header,
    axes: &[Axis],
    order: ByteOrder,
    encoding: Encoding,
) -> (String, Vec<String>) {
    let sizes: Vec<String> = axes
        .iter()
        .filter(|axis| !matches!(axis, Axis::Component(_)))
        .map(|axis| header.count(*axis).to_string())
        .collect();
    let truth = |is_true| if is_true { "True" } else { "False" };
    let mut text = format!("ObjectType = Image\nNDims = {}\nBinaryData = True\n", sizes.len());
    text += &format!("BinaryDataByteOrderMSB = {}\n", truth(order == ByteOrder::Big));
    text += &format!("CompressedData = {}\n", truth(encoding != Encoding::Raw));
    let (lines, losses) = meaning::written(header, axes);
    for line in lines {
        text += &(line + "\n");
    }
    text += &format!("DimSize = {}\n", sizes.join(" "));
    if header.components > 1 {
        text += &format!("ElementNumberOfChannels = {}\n", header.components);
    }
    text += &format!("ElementType = {}\n", type_name(header.element));
    (text, losses)
}

/// Whether a name can be told from a list, a pattern and the samples themselves.
fn is_plain(name: &str) -> bool {
    name.trim() == name
        && !name.contains(['\n', '\r', '%'])
        && !name.starts_with("LIST")
        && !name.eq_ignore_ascii_case("local")
}

/// Whether a header is there already and names these data: then the two are replaced together.
fn belongs_to(data: &Path, header: &Path) -> bool {
    let named = Input::open(header).and_then(|mut input| MetaHeader::read(&mut input));
    let named = named.ok().and_then(|found| fs::canonicalize(beside(header, &found.data_file)).ok());
    named.is_some() && named == fs::canonicalize(data).ok()
}

#[cfg(test)]
mod tests;
