//! Raw files: samples only, in a layout that the user knows.

use std::fmt;
use std::path::{Path, PathBuf};

use super::format::{Format, has_extension};
use super::input::Input;
use super::rearranged::{ordered, ordered_sink};
use super::stored::{Encoding, GZIP, Place, Stored, StoredSink};
use super::{
    Axis, AxisOrder, ByteOrder, Created, ElementType, ExtentError, FileFormat, Found, Header, Metadata,
    RankedExtent, ReadError, Source, WriteError, WriteOptions, losses,
};
use crate::atomic::AtomicFile;

/// Layout of a raw file, from the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawLayout {
    /// Samples along x, y and z.
    pub extent: RankedExtent,
    /// Type of a value.
    pub element: ElementType,
    /// Order of the bytes of a value in the file.
    pub byte_order: ByteOrder,
    /// Values of a sample.
    pub components: u32,
    /// Volumes that follow each other in time.
    pub steps: u64,
    /// Which axis varies fastest in the file, and which follow it.
    pub order: AxisOrder,
    /// Bytes before the first value, of the file as it is before compression.
    pub skip: u64,
}

impl RawLayout {
    /// One volume of little-endian samples, x fastest, and nothing else.
    pub fn new(extent: RankedExtent, element: ElementType) -> Self {
        let (byte_order, order) = (ByteOrder::default(), AxisOrder::default());
        Self { extent, element, byte_order, components: 1, steps: 1, order, skip: 0 }
    }

    /// What files of it hold.
    ///
    /// # Errors
    /// [`ExtentError`]: no components or steps, or more values than the bytes of can be counted.
    fn header(&self) -> Result<Header, ExtentError> {
        let axes = self.order.axes(self.extent.rank(), self.components, self.steps);
        let counts: Vec<u64> = axes
            .iter()
            .map(|axis| match *axis {
                Axis::Component(count) => count.into(),
                Axis::Time(count) => count,
                space => self.extent.axes()[usize::from(space.place()) - 1],
            })
            .collect();
        let mut metadata = Metadata { axes, ..Metadata::plain(self.extent.rank(), FileFormat::Raw) };
        metadata.source.byte_order = self.byte_order;
        Header::of_axes(&counts, self.element, metadata)
    }
}

impl fmt::Display for RawLayout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}", self.extent, self.element)?;
        if self.components != 1 {
            write!(f, " with {} components", self.components)?;
        }
        if self.steps != 1 {
            write!(f, " in {} time steps", self.steps)?;
        }
        if self.skip > 0 {
            write!(f, " behind {} bytes", self.skip)?;
        }
        Ok(())
    }
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

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        Err(ReadError::NoLayout { path: input.path().to_owned() })
    }

    fn compresses(&self, path: &Path) -> bool {
        has_extension(path, &["gz"])
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        let file =
            AtomicFile::create(path).map_err(|cause| WriteError::Io { path: path.to_owned(), cause })?;
        let order = options.byte_order.unwrap_or(header.metadata.source.byte_order);
        // Raw files come back as they were; all others have given up their own order of axes with their header.
        let is_raw = header.metadata.source.format == FileFormat::Raw;
        let axes = header.own_axes().filter(|_| is_raw).unwrap_or_default();
        let encoding = if has_extension(path, &["gz"]) { Encoding::Gzip } else { Encoding::Raw };
        let sink = StoredSink::new(file, path, header, encoding, order);
        let sink = ordered_sink(sink, path, header, &axes)?;
        Ok(Created { sink, losses: losses(&header.metadata) })
    }
}

/// Opens a file of that layout; one that is named as if it were compressed with gzip, and begins so, is.
pub(super) fn open(mut input: Input, layout: &RawLayout) -> Result<Box<dyn Source>, ReadError> {
    let path = input.path().to_owned();
    let header = layout.header().map_err(|cause| ReadError::Layout { path: path.clone(), cause })?;
    let is_packed = has_extension(&path, &["gz"]) && input.starts_with(GZIP)?;
    let encoding = if is_packed { Encoding::Gzip } else { Encoding::Raw };
    let place = Place { encoding, byte_order: layout.byte_order, skip: layout.skip, is_open_ended: false };
    let axes = header.metadata.axes.clone();
    let stored = Stored::new(input, header, place).map_err(|error| name_layout(error, layout))?;
    ordered(RawSource { stored, layout: *layout }, &path, &axes)
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
            layout: layout.to_string(),
            expected,
            found,
            hint: hint(layout, found),
        },
        other => other,
    }
}

fn hint(layout: &RawLayout, found: Found) -> &'static str {
    let others = u64::from(layout.components).saturating_mul(layout.steps);
    let samples = layout.extent.samples().saturating_mul(others);
    match found {
        Found::Exactly(0) => " (the file is empty)",
        Found::Exactly(bytes) if bytes == samples => " (it would fit samples of 1 byte, as u8)",
        Found::Exactly(bytes) if bytes == samples * 2 => " (it would fit samples of 2 bytes, as u16)",
        Found::Exactly(bytes) if bytes == samples * 4 => " (it would fit samples of 4 bytes, as f32)",
        Found::Exactly(bytes) if bytes == samples * 8 => " (it would fit samples of 8 bytes, as f64)",
        Found::Exactly(bytes) if bytes > samples * layout.element.bytes() as u64 => {
            "; `skip` passes over a header, `components` and `steps` take more values a sample and more volumes"
        }
        Found::Exactly(_) | Found::MoreThan(_) | Found::AtMost(_) => "",
    }
}
