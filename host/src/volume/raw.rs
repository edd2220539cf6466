//! Raw files: samples only, in a layout that the user knows.

use std::path::{Path, PathBuf};

use super::format::Format;
use super::input::Input;
use super::stored::{Encoding, Place, Stored, StoredSink};
use super::{
    ByteOrder, Created, ElementType, FileFormat, Found, Header, Metadata, RankedExtent, ReadError, Source,
    WriteError, WriteOptions, losses,
};
use crate::atomic::AtomicFile;

/// Layout of a raw file, from the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawLayout {
    /// Samples per axis, x fastest.
    pub extent: RankedExtent,
    /// Type of a sample.
    pub element: ElementType,
    /// Order of the bytes of a sample in the file.
    pub byte_order: ByteOrder,
}

/// Samples only, and what has no name that says otherwise.
pub(super) struct Raw;

impl Format for Raw {
    fn format(&self) -> FileFormat {
        FileFormat::Raw
    }

    fn has_name(&self, _: &Path) -> bool {
        true
    }

    fn magic(&self) -> Option<&'static [u8]> {
        None
    }

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        Err(ReadError::NoLayout { path: input.path().to_owned() })
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        let file =
            AtomicFile::create(path).map_err(|cause| WriteError::Io { path: path.to_owned(), cause })?;
        let order = options.byte_order.unwrap_or(header.metadata.source.byte_order);
        let sink = StoredSink::new(file, path, header, Encoding::Raw, order);
        Ok(Created { sink: Box::new(sink), losses: losses(&header.metadata) })
    }
}

/// Opens a file of that layout.
pub(super) fn open(input: Input, layout: &RawLayout) -> Result<Box<dyn Source>, ReadError> {
    let RawLayout { extent, element, byte_order } = *layout;
    let mut metadata = Metadata::plain(extent.rank(), FileFormat::Raw);
    metadata.source.byte_order = byte_order;
    let header = Header::scalar(extent.axes(), element, metadata);
    let place = Place { encoding: Encoding::Raw, byte_order, skip: 0, is_open_ended: false };
    let stored = Stored::new(input, header, place).map_err(|error| name_layout(error, layout))?;
    Ok(Box::new(RawSource { stored, layout: *layout }))
}

/// A raw file, whose errors speak of the layout that was given.
struct RawSource {
    stored: Stored,
    layout: RawLayout,
}

impl Source for RawSource {
    fn header(&self) -> &Header {
        self.stored.header()
    }

    fn read(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        self.stored.read(out).map_err(|error| name_layout(error, &self.layout))
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.stored.seek(position)
    }

    fn is_random(&self) -> bool {
        self.stored.is_random()
    }

    fn files(&self) -> Vec<PathBuf> {
        self.stored.files()
    }
}

/// A wrong length is a fault of the layout here, since the file says nothing that could be wrong.
fn name_layout(error: ReadError, layout: &RawLayout) -> ReadError {
    match error {
        ReadError::SampleBytes { path, expected, found } => ReadError::LayoutMismatch {
            path,
            layout: format!("{} of {}", layout.extent, layout.element),
            expected,
            found,
            hint: hint(layout, found),
        },
        other => other,
    }
}

fn hint(layout: &RawLayout, found: Found) -> &'static str {
    let samples = layout.extent.samples();
    match found {
        Found::Exactly(0) => " (the file is empty)",
        Found::Exactly(bytes) if bytes == samples => " (it would fit samples of 1 byte, as u8)",
        Found::Exactly(bytes) if bytes == samples * 2 => " (it would fit samples of 2 bytes, as u16)",
        Found::Exactly(bytes) if bytes == samples * 4 => " (it would fit samples of 4 bytes, as f32)",
        Found::Exactly(bytes) if bytes == samples * 8 => " (it would fit samples of 8 bytes, as f64)",
        Found::Exactly(bytes) if bytes > samples * layout.element.bytes() as u64 => {
            ", and whether a header stands before the samples"
        }
        Found::Exactly(_) | Found::MoreThan(_) | Found::AtMost(_) => "",
    }
}
