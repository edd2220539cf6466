//! What a file says beside its samples, as lines of metadata.

use ::tiff::tags::Tag;

use super::page::{Page, Pages};
use super::series::{Author, Series, attribute, line, pixels};
use crate::volume::HeaderLine;

/// Tags of texts, and their keys.
pub(super) const TEXTS: [(Tag, &str); 7] = [
    (Tag::ImageDescription, "tiff.ImageDescription"),
    (Tag::Make, "tiff.Make"),
    (Tag::Model, "tiff.Model"),
    (Tag::Software, "tiff.Software"),
    (Tag::DateTime, "tiff.DateTime"),
    (Tag::Artist, "tiff.Artist"),
    (Tag::Copyright, "tiff.Copyright"),
];

/// Tags of numbers, and their keys; what they are where the tag is missing goes without saying.
pub(super) const NUMBERS: [(Tag, &str); 3] = [
    (Tag::ColorMap, "tiff.ColorMap"),
    (Tag::ExtraSamples, "tiff.ExtraSamples"),
    (Tag::ResolutionUnit, "tiff.ResolutionUnit"),
];

/// Keys of the samples per unit of length, as a fraction.
pub(super) const RESOLUTIONS: [(Tag, &str); 2] =
    [(Tag::XResolution, "tiff.XResolution"), (Tag::YResolution, "tiff.YResolution")];

/// Key of what grey levels or colours mean, where it is not the usual.
pub(super) const PHOTOMETRIC: &str = "tiff.PhotometricInterpretation";

/// Key of the bits of a value, where they made no bytes in the file.
pub(super) const BITS: &str = "tiff.BitsPerSample";

/// Key of pages that were not read.
const LEFT_OUT: &str = "tiff.left_out";

/// Distances between samples, and their units; each may be unknown.
struct Spacing {
    distance: Option<f64>,
    unit: String,
}

/// Lines for what the first page says.
pub(super) fn lines(
    pages: &mut Pages,
    first: &Page,
    series: &Series,
    description: Option<&str>,
) -> Vec<HeaderLine> {
    let mut lines = spacings(pages, series, description);
    let mut pair = |key: &str, value: String| lines.push(HeaderLine::KeyValue { key: key.to_owned(), value });
    for (tag, key) in TEXTS {
        if let Some(text) = pages.text(tag) {
            pair(key, text);
        }
    }
    for (tag, key) in RESOLUTIONS {
        if let Some((numerator, denominator)) = pages.ratio(tag) {
            pair(key, format!("{numerator}/{denominator}"));
        }
    }
    for (tag, key) in NUMBERS {
        if let Some(numbers) = pages.numbers(tag) {
            let texts: Vec<String> = numbers.iter().map(u64::to_string).collect();
            pair(key, texts.join(" "));
        }
    }
    if first.photometric != usual_photometric(first.samples.into()) {
        pair(PHOTOMETRIC, first.photometric.to_string());
    }
    if pages.left_out > 0 {
        pair(LEFT_OUT, format!("{} smaller pictures or masks", pages.left_out));
    }
    if usize::from(first.bits) != first.element.bytes() * 8 {
        pair(BITS, first.bits.to_string());
    }
    lines
}

/// Black is zero, or red, green and blue.
pub(super) const fn usual_photometric(samples: u32) -> u16 {
    if samples == 3 || samples == 4 { 2 } else { 1 }
}

fn spacings(pages: &mut Pages, series: &Series, description: Option<&str>) -> Vec<HeaderLine> {
    let text = description.unwrap_or_default();
    let axes = match (series.author, pixels(text)) {
        (Author::Ome, Some(pixels)) => ["X", "Y", "Z"].map(|axis| Spacing {
            distance: attribute(pixels, &format!("PhysicalSize{axis}")).and_then(|text| text.parse().ok()),
            unit: attribute(pixels, &format!("PhysicalSize{axis}Unit")).unwrap_or("µm").to_owned(),
        }),
        _ => of_resolution(pages, text),
    };
    let rank = if series.count() == 1 && series.is_plain() { 2 } else { 3 };
    let axes = &axes[..rank];
    let is_known = |distance: &f64| distance.is_finite() && *distance > 0.0;
    if !axes.iter().any(|axis| axis.distance.filter(is_known).is_some()) {
        return Vec::new();
    }
    let field = |name: &str, value: String| HeaderLine::Field { name: name.to_owned(), value };
    let distances = axes.iter().map(|axis| match axis.distance.filter(is_known) {
        Some(distance) => distance.to_string(),
        None => "nan".to_owned(),
    });
    let mut lines = vec![field("spacings", distances.collect::<Vec<_>>().join(" "))];
    let is_plain = |unit: &str| !unit.is_empty() && !unit.contains(['"', '\n', '\\']);
    if axes.iter().all(|axis| is_plain(&axis.unit)) {
        let units = axes.iter().map(|axis| format!("\"{}\"", axis.unit));
        lines.push(field("units", units.collect::<Vec<_>>().join(" ")));
    }
    lines
}

/// Samples per inch, centimetre, or ImageJ's unit, and ImageJ's distance of slices.
fn of_resolution(pages: &mut Pages, description: &str) -> [Spacing; 3] {
    let is_imagej = description.starts_with("ImageJ=");
    let unit = match (
        line(description, "unit").filter(|_| is_imagej),
        pages.numbers(Tag::ResolutionUnit).as_deref(),
    ) {
        (Some(unit), _) => unit.replace("\\u00B5", "µ"),
        (None, None | Some([2])) if !is_imagej => "inch".to_owned(),
        (None, Some([3])) => "cm".to_owned(),
        _ => String::new(),
    };
    let [x, y] = RESOLUTIONS.map(|(tag, _)| {
        let (numerator, denominator) = pages.ratio(tag)?;
        // One sample a unit, without a unit, is what programs write that know nothing.
        let is_empty = unit.is_empty() && numerator == denominator;
        (numerator > 0 && denominator > 0 && !is_empty).then(|| f64::from(denominator) / f64::from(numerator))
    });
    let z = line(description, "spacing").filter(|_| is_imagej).and_then(|text| text.parse().ok());
    [x, y, z].map(|distance| Spacing { distance, unit: unit.clone() })
}
