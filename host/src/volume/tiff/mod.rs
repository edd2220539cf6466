//! TIFF files: pages as slices, with the orders of channels, slices and frames that ImageJ and OME-TIFF write.
//!
//! Sources: *TIFF Revision 6.0* (Adobe, 1992); *Adobe Photoshop TIFF Technical Notes* (2002) for deflate; the BigTIFF
//! design of Aware Systems. The `tiff` crate reads directories and their values. Samples are taken out of strips and
//! tiles here, so that they stay as they are stored, whatever their colours mean.

mod chunk;
mod page;
mod series;
#[cfg(test)]
mod tests;
mod text;
mod write;

use std::path::Path;

use ::tiff::TiffError as CrateError;
use page::Pages;
use series::Series;

use super::format::{Format, has_extension};
use super::input::Input;
use super::planes::{PlaneSource, Planes};
use super::{ByteOrder, Created, FileFormat, Header, Metadata, ReadError, Source, WriteError, WriteOptions};

/// What keeps a file from being read as a volume. Texts from the file are quoted and shortened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TiffError {
    /// The verdict of the crate on a directory.
    #[error("{0}")]
    Directory(CrateError),
    /// Directories that lead back to one another.
    #[error("its list of pages never ends")]
    Cycle,
    /// A tag that is missing or has a value that cannot be.
    #[error("page {page} has no {tag} that makes sense")]
    Tag {
        /// Which page, counted from 1.
        page: usize,
        /// Name of the tag.
        tag: &'static str,
    },
    /// A compression that is not read.
    #[error("compression {code} ({name}) is not read: convert with `tiffcp -c zip` or `-c none`")]
    Compression {
        /// Value of the tag.
        code: u16,
        /// Its name.
        name: &'static str,
    },
    /// Samples of a type that is not read.
    #[error("samples are {what}, which are not read: convert them to integers or floats of 8 to 64 bits")]
    Samples {
        /// What they are.
        what: String,
    },
    /// A page unlike the first.
    #[error("page {page} has {found}, page 1 has {expected}: take the pages apart, as with `tiffsplit`")]
    Differs {
        /// Which page, counted from 1.
        page: usize,
        /// Its extent and type.
        found: String,
        /// Those of the first page.
        expected: String,
    },
    /// A description of more planes than there are.
    #[error(
        "its OME-XML describes {described} pages, the file has {found}: data in several files are not read"
    )]
    Several {
        /// Pages according to the description.
        described: u64,
        /// Pages of the file.
        found: u64,
    },
    /// Data that do not decompress to what they should.
    #[error("page {page}: its data are damaged")]
    Damaged {
        /// Which page, counted from 1.
        page: usize,
    },
}

/// Tagged image file format.
pub(super) struct Tiff;

impl Format for Tiff {
    fn format(&self) -> FileFormat {
        FileFormat::Tiff
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(path, &["tif", "tiff", "btf", "tf8"])
    }

    fn magic(&self) -> Option<&'static [u8]> {
        None
    }

    fn compresses(&self, _: &Path) -> bool {
        true
    }

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        open(input)
    }

    fn create(&self, path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
        write::create(path, header, options)
    }
}

fn fault(path: &Path, cause: TiffError) -> ReadError {
    match cause {
        TiffError::Directory(CrateError::IoError(cause)) if cause.raw_os_error().is_some() => {
            ReadError::Io { path: path.to_owned(), cause }
        }
        cause => {
            ReadError::Format { path: path.to_owned(), format: FileFormat::Tiff, cause: Box::new(cause) }
        }
    }
}

fn open(input: Input) -> Result<Box<dyn Source>, ReadError> {
    let path = input.path().to_owned();
    let fault = |cause| fault(&path, cause);
    let mut pages = Pages::open(input).map_err(fault)?;
    let first = pages.page(0).map_err(fault)?;
    let description = pages.text(::tiff::tags::Tag::ImageDescription);
    let series = Series::of(description.as_deref(), &first, pages.count()).map_err(fault)?;
    let is_slice = series.count() == 1 && series.is_plain();
    let mut metadata = Metadata::plain(if is_slice { 2 } else { 3 }, FileFormat::Tiff);
    metadata.source.byte_order =
        if first.element.bytes() > 1 { pages.byte_order() } else { ByteOrder::Little };
    metadata.lines = text::lines(&mut pages, &first, &series, description.as_deref());
    let header = Header {
        extent: [first.width.into(), first.height.into(), series.slices],
        components: u32::try_from(series.channels * u64::from(first.samples)).unwrap_or(u32::MAX),
        steps: series.frames,
        element: first.element,
        metadata,
    };
    let stack = Stack { pages, series, page_bytes: first.bytes() as usize };
    Ok(Box::new(PlaneSource::new(&path, header, stack)?))
}

/// Pages, in the order that the file has for them.
struct Stack {
    pages: Pages,
    series: Series,
    page_bytes: usize,
}

impl Planes for Stack {
    fn read(&mut self, index: u64, out: &mut [u8]) -> Result<(), ReadError> {
        let (slice, frame) = (index % self.series.slices, index / self.series.slices);
        let path = self.pages.path().to_owned();
        if self.series.channels == 1 {
            let page = self.series.page(0, slice, frame);
            return self
                .pages
                .read(page, self.series.is_contiguous, out)
                .map_err(|cause| fault(&path, cause));
        }
        let mut plane = vec![0; self.page_bytes];
        let first = self.pages.page(0).map_err(|cause| fault(&path, cause))?;
        let sample = usize::from(first.samples) * first.element.bytes();
        for channel in 0..self.series.channels {
            let page = self.series.page(channel, slice, frame);
            let read = self.pages.read(page, self.series.is_contiguous, &mut plane);
            read.map_err(|cause| fault(&path, cause))?;
            let places = out.chunks_mut(sample * self.series.channels as usize);
            for (to, from) in places.zip(plane.chunks(sample)) {
                to[channel as usize * sample..][..sample].copy_from_slice(from);
            }
        }
        Ok(())
    }
}
