//! Raw files: samples only, in a layout that the user knows.

use super::element::reorder;
use super::input::Input;
use super::{ByteOrder, ElementType, FileFormat, Found, Metadata, RankedExtent, ReadError, Volume};

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

pub(super) fn read(mut input: Input, layout: &RawLayout) -> Result<Volume, ReadError> {
    let RawLayout { extent, element, byte_order } = *layout;
    let bytes = extent.samples() * element.bytes() as u64;
    let mut samples = input.samples(bytes).map_err(|error| name_layout(error, layout))?;
    reorder(&mut samples, element, byte_order);
    let mut metadata = Metadata::plain(extent.rank(), FileFormat::Raw);
    metadata.source.byte_order = byte_order;
    Ok(Volume { extent: extent.axes(), element, samples, metadata })
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
