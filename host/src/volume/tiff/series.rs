//! What pages are: channels, slices and frames, as ImageJ or OME-TIFF describe them.
//!
//! Sources: the class `ij.io.TiffDecoder` of ImageJ, for its description in lines of `key=value`; the OME data model,
//! element `Pixels`; the module tifffile of Python, for shapes in JSON.

use serde::Deserialize;

use super::TiffError;
use super::chunk::Compression;
use super::page::Page;

/// What tifffile describes an array with.
#[derive(Deserialize)]
struct Shape {
    shape: Vec<u64>,
    axes: Option<String>,
}

/// Who wrote the description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Author {
    ImageJ,
    Ome,
    /// Nobody who says anything about pages.
    Other,
}

/// Numbers of pages, and where each lies among them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Series {
    pub(super) author: Author,
    /// Pages of one slice, beside the components that a page has.
    pub(super) channels: u64,
    pub(super) slices: u64,
    pub(super) frames: u64,
    /// Pages from one channel, slice, and frame to the next.
    steps: [u64; 3],
    /// Whether the file lists one page, and the others follow it.
    pub(super) is_contiguous: bool,
}

impl Series {
    /// The series that a description tells of, or pages as slices.
    pub(super) fn of(description: Option<&str>, first: &Page, pages: u64) -> Result<Self, TiffError> {
        let plain = Self::ordered(Author::Other, [1, pages, 1], "CZT");
        let Some(text) = description else { return Ok(plain) };
        if text.starts_with("ImageJ=") {
            return Ok(Self::of_imagej(text, first, pages).unwrap_or(plain));
        }
        match pixels(text) {
            Some(pixels) => Self::of_ome(pixels, first, pages).unwrap_or(Ok(plain)),
            None => Ok(Self::of_shape(text, pages).unwrap_or(plain)),
        }
    }

    /// The series of an array whose shape, and perhaps axes, stand in JSON. Of two axes before those of a page, the
    /// first is time.
    fn of_shape(text: &str, pages: u64) -> Option<Self> {
        let described: Shape = serde_json::from_str(text).ok()?;
        let before = (1..described.shape.len()).find(|count| {
            let product =
                described.shape[..*count].iter().try_fold(1_u64, |product, axis| product.checked_mul(*axis));
            product == Some(pages)
        })?;
        let letters: String = match described.axes {
            Some(axes) if axes.len() == described.shape.len() => axes.chars().take(before).collect(),
            _ => ["Z", "TZ"].get(before - 1).copied()?.to_owned(),
        };
        let mut sizes = [1; 3];
        for (letter, &size) in letters.chars().zip(&described.shape) {
            let axis = "CZT".find(letter).filter(|axis| sizes[*axis] == 1)?;
            sizes[axis] = size;
        }
        let order: String = letters.chars().rev().collect();
        Some(Self::ordered(Author::Other, sizes, &order))
    }

    fn ordered(author: Author, [channels, slices, frames]: [u64; 3], order: &str) -> Self {
        let mut steps = [1; 3];
        let mut step = 1_u64;
        for letter in order.chars() {
            let Some(axis) = "CZT".find(letter) else { continue };
            steps[axis] = step;
            step = step.saturating_mul([channels, slices, frames][axis]);
        }
        Self { author, channels, slices, frames, steps, is_contiguous: false }
    }

    /// Pages of these numbers of channels, slices and frames, in the order of the letters.
    pub(super) fn sized(sizes: [u64; 3], order: &str) -> Self {
        Self::ordered(Author::Other, sizes, order)
    }

    fn of_imagej(text: &str, first: &Page, pages: u64) -> Option<Self> {
        let number =
            |key| line(text, key).map_or(Some(1), |value| value.parse().ok()).filter(|count| *count > 0);
        let [channels, mut slices, frames] = [number("channels")?, number("slices")?, number("frames")?];
        let images: u64 = number("images")?;
        if channels == 1 && slices == 1 && frames == 1 {
            slices = images;
        }
        let series = Self::ordered(Author::ImageJ, [channels, slices, frames], "CZT");
        let is_contiguous = pages == 1 && images > 1 && first.compression == Compression::None;
        let count = if is_contiguous { images } else { pages };
        (series.count() == count).then_some(Self { is_contiguous, ..series })
    }

    fn of_ome(pixels: &str, first: &Page, pages: u64) -> Option<Result<Self, TiffError>> {
        let number = |key| attribute(pixels, key)?.parse().ok().filter(|count: &u64| *count > 0);
        let components = number("SizeC")?;
        let channels = components / u64::from(first.samples);
        let sizes = [channels.max(1), number("SizeZ")?, number("SizeT")?];
        let series = Self::ordered(Author::Ome, sizes, attribute(pixels, "DimensionOrder")?.get(2..)?);
        let described = series.count();
        match described.cmp(&pages) {
            std::cmp::Ordering::Equal => Some(Ok(series)),
            std::cmp::Ordering::Greater => Some(Err(TiffError::Several { described, found: pages })),
            std::cmp::Ordering::Less => None,
        }
    }

    /// Pages in all.
    pub(super) fn count(&self) -> u64 {
        self.channels.saturating_mul(self.slices).saturating_mul(self.frames)
    }

    /// Whether pages are slices because nobody says anything else.
    pub(super) fn is_plain(&self) -> bool {
        self.author == Author::Other
    }

    /// Which page holds a channel of a slice of a frame.
    pub(super) fn page(&self, channel: u64, slice: u64, frame: u64) -> u64 {
        let [of_channel, of_slice, of_frame] = self.steps;
        channel * of_channel + slice * of_slice + frame * of_frame
    }

    /// Whether pages lie as they are written here: channels before slices before frames.
    pub(super) fn is_in_order(&self) -> bool {
        let sizes = [self.channels, self.slices, self.frames];
        let ours = Self::ordered(self.author, sizes, "CZT");
        (0..3).all(|axis| sizes[axis] == 1 || self.steps[axis] == ours.steps[axis])
    }
}

/// Value of a line `key=value` of ImageJ's description.
pub(super) fn line<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix('='))
}

/// The start tag of the one `Pixels` element of an OME-XML document.
pub(super) fn pixels(text: &str) -> Option<&str> {
    if !text.contains("openmicroscopy.org") {
        return None;
    }
    let mut found = text.match_indices("Pixels ").filter(|(at, _)| text[..*at].ends_with(['<', ':']));
    let (at, _) = found.next()?;
    let rest = &text[at..];
    found.next().is_none().then_some(&rest[..rest.find('>')?])
}

/// Samples of a page of the first channel that an OME-XML document describes.
pub(super) fn samples_of_channel(text: &str) -> u32 {
    let channel = text.match_indices("Channel ").find(|(at, _)| text[..*at].ends_with(['<', ':']));
    let tag = channel.map(|(at, _)| text[at..].split('>').next().unwrap_or_default());
    tag.and_then(|tag| attribute(tag, "SamplesPerPixel")?.parse().ok()).unwrap_or(1)
}

/// Value of an attribute in a start tag.
pub(super) fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let (at, _) = tag.match_indices(name).find(|(at, _)| {
        tag[..*at].ends_with(char::is_whitespace) && tag[at + name.len()..].trim_start().starts_with('=')
    })?;
    let value = tag[at + name.len()..].trim_start().strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|letter| matches!(letter, '"' | '\''))?;
    value[1..].split(quote).next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_and_lines_are_found() {
        let xml = r#"<?xml?><OME xmlns="http://www.openmicroscopy.org/Schemas/OME"><Image>
            <Pixels ID="Pixels:0" DimensionOrder="XYZCT" SizeZ='3' BigSizeZ="9" PhysicalSizeX = "0.5"><Channel/>"#;
        let tag = pixels(xml).unwrap();
        assert_eq!(attribute(tag, "SizeZ"), Some("3"));
        assert_eq!(attribute(tag, "PhysicalSizeX"), Some("0.5"));
        assert_eq!(attribute(tag, "DimensionOrder"), Some("XYZCT"));
        assert_eq!(attribute(tag, "SizeC"), None);
        assert_eq!(samples_of_channel(xml), 1);
        assert_eq!(samples_of_channel("<Pixels><x:Channel ID=\"0\" SamplesPerPixel=\"3\"><a/>"), 3);
        assert_eq!(pixels("<Pixels >"), None);
        assert_eq!(line("ImageJ=1\nimages=6\n", "images"), Some("6"));
    }

    #[test]
    fn pages_follow_the_order_that_is_named() {
        let series = Series::ordered(Author::Ome, [2, 3, 4], "ZCT");
        assert_eq!([series.page(0, 1, 0), series.page(1, 0, 0), series.page(1, 2, 3)], [1, 3, 23]);
        assert!(!series.is_in_order());
        assert!(Series::ordered(Author::Ome, [1, 3, 4], "ZTC").is_in_order());
        assert!(!Series::ordered(Author::Ome, [1, 3, 4], "TZC").is_in_order());
    }
}
