//! Files as they are written: a directory and the samples of a page, then the next.
//!
//! Everything a directory points to lies behind it, so that a file is written from its first byte to its last. That
//! is why it is done here: encoders in crates go back to put in offsets. More than 4 GiB make a BigTIFF.

use std::io::Write;
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::series::{Series, line, pixels, samples_of_channel};
use super::text::{BITS, NUMBERS, PHOTOMETRIC, RESOLUTIONS, TEXTS, usual_photometric};
use crate::atomic::AtomicFile;
use crate::volume::element::{reorder, write_samples};
use crate::volume::metadata::is_same_name;
use crate::volume::planes::{PlaneSink, PlaneWriter};
use crate::volume::{
    ByteOrder, Created, ElementType, FileFormat, Header, HeaderLine, Metadata, WriteError, WriteOptions,
    losses,
};

/// Bytes of a directory at most, but for texts: about twenty tags.
const DIRECTORY_BYTES: u64 = 1024;

/// Begins a file.
pub(super) fn create(path: &Path, header: &Header, options: &WriteOptions) -> Result<Created, WriteError> {
    let cannot = |what: &str| WriteError::CannotHold {
        path: path.to_owned(),
        format: FileFormat::Tiff,
        what: what.to_owned(),
    };
    let [x, y, _] = header.extent.map(|axis| u32::try_from(axis).ok().filter(|axis| *axis < 1 << 31));
    let (Some(width), Some(height)) = (x, y) else {
        return Err(cannot("2^31 samples along x or y: write .nrrd"));
    };
    let plan = Plan::of(header);
    let order = options.byte_order.unwrap_or(header.metadata.source.byte_order);
    let page_bytes = header.plane_bytes().unwrap_or(u64::MAX) / u64::from(plan.channels);
    let pages = header.extent[2].saturating_mul(header.steps).saturating_mul(plan.channels.into());
    // Deflate adds five bytes to a block of 32 KiB that does not compress.
    let most = page_bytes.saturating_add(page_bytes / 4096 + DIRECTORY_BYTES).saturating_mul(pages);
    let texts: u64 = plan.texts.iter().map(|(_, text)| text.len() as u64 + 2).sum();
    let is_big = most.saturating_add(texts + plan.numbers_bytes()) > u64::from(u32::MAX);
    if !is_big && page_bytes > u64::from(u32::MAX) {
        return Err(cannot("pages of that size"));
    }
    let file = AtomicFile::create(path).map_err(|cause| WriteError::Io { path: path.to_owned(), cause })?;
    let mut left = losses(&plan.left);
    for name in left.iter_mut().filter(|name| plan.holds_spacings && *name == "space directions") {
        *name += " (only the distances of samples are kept)";
    }
    if header.metadata.time_step().is_some() && plan.holds_spacings {
        left.push("the spacing of time steps".to_owned());
    }
    let form = Form { order, is_big, is_deflated: options.gzip };
    let writer = Writer {
        file,
        path: path.to_owned(),
        form,
        plan,
        width,
        height,
        element: header.element,
        pages,
        index: 0,
        at: 0,
    };
    Ok(Created { sink: Box::new(PlaneSink::new(path, header, Box::new(writer))), losses: left })
}

/// How numbers and samples are written.
#[derive(Clone, Copy, Debug)]
struct Form {
    order: ByteOrder,
    /// Whether offsets have 8 bytes.
    is_big: bool,
    is_deflated: bool,
}

impl Form {
    /// The lower `count` bytes of a number.
    fn bytes(self, number: u64, count: usize) -> Vec<u8> {
        let mut bytes = number.to_le_bytes()[..count].to_vec();
        if self.order == ByteOrder::Big {
            bytes.reverse();
        }
        bytes
    }

    /// Bytes of an offset.
    const fn width(self) -> usize {
        if self.is_big { 8 } else { 4 }
    }

    /// Bytes before the first directory.
    const fn head(self) -> u64 {
        if self.is_big { 16 } else { 8 }
    }
}

/// What each page holds, and what its directory says.
struct Plan {
    /// Pages for the components of a sample.
    channels: u32,
    /// Components in a page.
    samples: u32,
    photometric: u16,
    /// Texts of the first page.
    texts: Vec<(u16, String)>,
    /// Numbers of the first page.
    color_map: Vec<u64>,
    extra_samples: Vec<u64>,
    resolutions: [Option<(u32, u32)>; 2],
    resolution_unit: u64,
    /// Whether the distances of samples along all axes are in the file.
    holds_spacings: bool,
    /// What no page can hold.
    left: Metadata,
}

impl Plan {
    fn of(header: &Header) -> Self {
        let metadata = &header.metadata;
        let description = metadata.key_value("tiff.ImageDescription").unwrap_or_default();
        // tifffile's description is that of a shape, which is made anew.
        let description = if description.starts_with("{\"shape\"") { "" } else { description };
        let is_color = matches!(header.components, 3 | 4)
            && matches!(header.element, ElementType::U8 | ElementType::U16)
            && line(description, "channels").is_none()
            && (pixels(description).is_none() || samples_of_channel(description) == header.components);
        let is_together = is_color || metadata.key_value("tiff.ExtraSamples").is_some();
        let samples = if is_together { header.components } else { 1 };
        let channels = header.components / samples;
        let numbers = |key: &str| -> Vec<u64> {
            let words = metadata.key_value(key).unwrap_or_default().split_whitespace();
            words.map(|word| word.parse().ok()).collect::<Option<_>>().unwrap_or_default()
        };
        let photometric = metadata.key_value(PHOTOMETRIC).and_then(|text| text.parse().ok());
        let color_map = numbers("tiff.ColorMap");
        let has_map = color_map.len() == 3 << (header.element.bytes() * 8).min(16) && samples == 1;
        let photometric =
            photometric.filter(|code| (*code != 3 || has_map) && (samples > 1 || *code < 2 || *code == 3));
        let extra = samples.saturating_sub(if samples >= 3 { 3 } else { 1 }) as usize;
        let mut extra_samples = numbers("tiff.ExtraSamples");
        if extra_samples.len() >= samples as usize || extra_samples.is_empty() {
            // Alpha where there is a fourth colour, which is not multiplied in; else anything.
            extra_samples = vec![if is_color { 2 } else { 0 }; extra];
        }
        let mut plan = Self {
            channels,
            samples,
            photometric: photometric.unwrap_or(if samples >= 3 { usual_photometric(samples) } else { 1 }),
            texts: Vec::new(),
            color_map: if photometric == Some(3) { color_map } else { Vec::new() },
            extra_samples,
            resolutions: [None; 2],
            resolution_unit: 1,
            holds_spacings: false,
            left: metadata.clone(),
        };
        plan.describe(header, description);
        plan
    }

    /// Fills in texts and distances, and takes what they say out of what is left.
    fn describe(&mut self, header: &Header, old: &str) {
        let metadata = &header.metadata;
        let spacings = spacings(metadata);
        let units = units(metadata);
        let unit = units.first().copied().filter(|unit| units.iter().all(|other| other == unit));
        let is_ome = self.is_of_ome(header, old);
        let needs_imagej = self.channels > 1 || header.steps > 1 || old.starts_with("ImageJ=");
        let has_unit = matches!(unit, None | Some("inch" | "cm"));
        let is_imagej = !is_ome
            && (needs_imagej
                || old.is_empty()
                    && (header.extent[2] > 1 || header.rank() == 3 || !has_unit && !spacings.is_empty()));
        self.resolution_unit = match unit {
            Some("inch") if !is_imagej => 2,
            Some("cm") if !is_imagej => 3,
            _ => 1,
        };
        for (axis, (_, key)) in RESOLUTIONS.iter().enumerate() {
            let kept = metadata.key_value(key).and_then(ratio);
            let spacing = spacings.get(axis).copied().filter(|spacing| spacing.is_finite() && *spacing > 0.0);
            self.resolutions[axis] = match (kept, spacing) {
                (Some(_), _) if is_ome => kept,
                (Some((n, d)), Some(spacing)) if f64::from(d) / f64::from(n) == spacing => kept,
                (_, Some(spacing)) => fraction(1.0 / spacing),
                (kept, None) => kept,
            };
        }
        let mut description = old.to_owned();
        if is_imagej {
            description = imagej(header, self.channels, unit, spacings.get(2).copied(), old);
        }
        let is_lost = is_imagej && !old.is_empty() && !old.starts_with("ImageJ=");
        for (tag, key) in TEXTS {
            let text = if key == "tiff.ImageDescription" {
                Some(description.as_str()).filter(|text| !text.is_empty())
            } else {
                metadata.key_value(key)
            };
            self.texts
                .extend(text.filter(|text| !text.contains('\0')).map(|text| (tag.to_u16(), text.to_owned())));
        }
        let holds_spacings = is_imagej || is_ome || has_unit && header.extent[2] == 1;
        self.holds_spacings = holds_spacings && spacings.iter().all(|spacing| *spacing > 0.0);
        self.left.lines.retain(|line| match line {
            HeaderLine::Field { name, .. } => {
                !(holds_spacings && (is_same_name(name, "spacings") || is_same_name(name, "units")))
            }
            HeaderLine::KeyValue { key, .. } => {
                let known = TEXTS.iter().chain(&NUMBERS).chain(&RESOLUTIONS).any(|(_, known)| known == key);
                !(known || key == PHOTOMETRIC || key == BITS) || key == "tiff.ImageDescription" && is_lost
            }
            HeaderLine::Comment(_) => true,
        });
    }

    /// Whether a description is OME-XML of just these pages, in just this order.
    fn is_of_ome(&self, header: &Header, description: &str) -> bool {
        let Some(pixels) = pixels(description) else { return false };
        let size = |name| super::series::attribute(pixels, name).and_then(|text| text.parse().ok());
        let [x, y, z] = header.extent;
        let sizes = [
            ("SizeX", x),
            ("SizeY", y),
            ("SizeZ", z),
            ("SizeC", header.components.into()),
            ("SizeT", header.steps),
        ];
        let name = match header.element {
            ElementType::U8 => "uint8",
            ElementType::I8 => "int8",
            ElementType::U16 => "uint16",
            ElementType::I16 => "int16",
            ElementType::U32 => "uint32",
            ElementType::I32 => "int32",
            ElementType::F32 => "float",
            ElementType::F64 => "double",
            ElementType::U64 | ElementType::I64 => return false,
        };
        let order = super::series::attribute(pixels, "DimensionOrder").unwrap_or_default();
        let order =
            Series::sized([self.channels.into(), z, header.steps], order.get(2..).unwrap_or_default());
        super::series::attribute(pixels, "Type") == Some(name)
            && sizes.iter().all(|(name, expected)| size(name) == Some(*expected))
            && samples_of_channel(description) == self.samples
            && order.is_in_order()
    }

    fn numbers_bytes(&self) -> u64 {
        2 * (self.color_map.len() + 3 * self.samples as usize) as u64
    }
}

/// Distances of samples along x, y and z; not a number where nobody says. Those of a space are its steps' lengths.
fn spacings(metadata: &Metadata) -> Vec<f64> {
    let given = metadata.space_entries("spacings");
    let given = given.map(|all| all.iter().map(|(_, text)| text.parse().unwrap_or(f64::NAN)).collect());
    let of_space = || metadata.spacing().map(Vec::from);
    given.filter(|all: &Vec<f64>| all.iter().any(|one| !one.is_nan())).or_else(of_space).unwrap_or_default()
}

/// Units of those.
fn units(metadata: &Metadata) -> Vec<&str> {
    let quoted = |text: &'_ str| text.split('"').nth(1).is_some();
    let given = metadata.space_entries("units").unwrap_or_default();
    let given: Vec<&str> =
        given.iter().filter(|(_, text)| quoted(text)).map(|(_, text)| text.trim_matches('"')).collect();
    match metadata.field("space units") {
        Some(text) if given.iter().all(|unit| unit.is_empty()) => {
            text.split('"').skip(1).step_by(2).collect()
        }
        _ => given,
    }
}

/// ImageJ's description of a stack; lines of an old one that say nothing of its shape stay.
fn imagej(header: &Header, channels: u32, unit: Option<&str>, spacing: Option<f64>, old: &str) -> String {
    let slices = header.extent[2];
    let version = line(old, "ImageJ").unwrap_or("1.54f");
    let images = slices.saturating_mul(header.steps).saturating_mul(channels.into());
    let mut text = format!("ImageJ={version}\nimages={images}\n");
    for (name, count) in [("channels", channels.into()), ("slices", slices), ("frames", header.steps)] {
        if count > 1 {
            text += &format!("{name}={count}\n");
        }
    }
    if channels > 1 || header.steps > 1 {
        text += "hyperstack=true\n";
    }
    if let Some(unit) = unit {
        text += &format!("unit={}\n", unit.replace('µ', "\\u00B5"));
    }
    if let Some(spacing) = spacing.filter(|spacing| spacing.is_finite()) {
        text += &format!("spacing={spacing}\n");
    }
    const MADE: [&str; 8] =
        ["ImageJ", "images", "channels", "slices", "frames", "hyperstack", "unit", "spacing"];
    let is_made =
        |line: &str| MADE.iter().any(|key| line.strip_prefix(key).is_some_and(|rest| rest.starts_with('=')));
    if old.starts_with("ImageJ=") {
        old.lines().filter(|line| !is_made(line)).for_each(|line| text += &format!("{line}\n"));
    }
    text
}

fn ratio(text: &str) -> Option<(u32, u32)> {
    let (numerator, denominator) = text.split_once('/')?;
    Some((numerator.parse().ok()?, denominator.parse().ok()?))
}

/// The fraction of 32-bit numbers nearest to `value`, of those that its continued fraction gives.
fn fraction(value: f64) -> Option<(u32, u32)> {
    let (mut before, mut now) = ((0_u64, 1_u64), (1_u64, 0_u64));
    let mut rest = value;
    for _ in 0..40 {
        let whole = rest.floor();
        if !(0.0..=f64::from(u32::MAX)).contains(&whole) {
            break;
        }
        let next = (whole as u64 * now.0 + before.0, whole as u64 * now.1 + before.1);
        if next.0.max(next.1) > u64::from(u32::MAX) {
            break;
        }
        (before, now) = (now, next);
        if now.0 as f64 / now.1 as f64 == value || rest == whole {
            break;
        }
        rest = 1.0 / (rest - whole);
    }
    (now.0 > 0 && now.1 > 0).then_some((now.0 as u32, now.1 as u32))
}

/// An entry of a directory: a tag, the type and number of its values, and their bytes.
struct Entry {
    tag: u16,
    kind: u16,
    count: u64,
    bytes: Vec<u8>,
}

/// A file that is being written.
struct Writer {
    file: AtomicFile,
    path: PathBuf,
    form: Form,
    plan: Plan,
    width: u32,
    height: u32,
    element: ElementType,
    /// Pages in all, and those that were written.
    pages: u64,
    index: u64,
    /// Bytes that were written.
    at: u64,
}

impl PlaneWriter for Writer {
    fn write(&mut self, plane: &[u8]) -> Result<(), WriteError> {
        let write = |writer: &mut Self| {
            let bytes = writer.element.bytes();
            let channels = writer.plan.channels as usize;
            if channels == 1 {
                return writer.write_page(plane);
            }
            (0..channels).try_for_each(|channel| {
                let values = plane.chunks(bytes).skip(channel).step_by(channels);
                let page: Vec<u8> = values.flatten().copied().collect();
                writer.write_page(&page)
            })
        };
        write(self).map_err(|cause| WriteError::Io { path: self.path.clone(), cause })
    }

    fn finish(self: Box<Self>) -> Result<(), WriteError> {
        let Self { file, path, .. } = *self;
        file.commit().map_err(|cause| WriteError::Io { path, cause })
    }
}

impl Writer {
    /// Writes a directory and the samples behind it, which end at an even byte.
    fn write_page(&mut self, page: &[u8]) -> std::io::Result<()> {
        let form = self.form;
        if self.index == 0 {
            self.file.write_all(if form.order == ByteOrder::Little { b"II" } else { b"MM" })?;
            self.file.write_all(&match form.is_big {
                true => [form.bytes(43, 2), form.bytes(8, 2), form.bytes(0, 2), form.bytes(16, 8)].concat(),
                false => [form.bytes(42, 2), form.bytes(8, 4)].concat(),
            })?;
            self.at = form.head();
        }
        let deflated = match form.is_deflated {
            true => {
                let mut samples = page.to_vec();
                reorder(&mut samples, self.element, form.order);
                let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
                encoder.write_all(&samples)?;
                Some(encoder.finish()?)
            }
            false => None,
        };
        let stored = deflated.as_ref().map_or(page.len(), Vec::len) as u64;
        self.index += 1;
        let directory = self.directory(stored);
        self.file.write_all(&directory)?;
        match deflated {
            Some(deflated) => self.file.write_all(&deflated)?,
            None => write_samples(&mut self.file, page, self.element, form.order)?,
        }
        self.file.write_all(&[0][..(stored % 2) as usize])?;
        self.at += directory.len() as u64 + stored + stored % 2;
        Ok(())
    }

    /// The directory of the page whose `stored` bytes follow it, which is the last or points behind those.
    fn directory(&self, stored: u64) -> Vec<u8> {
        let form = self.form;
        let width = form.width();
        let mut entries = self.entries(stored);
        entries.sort_by_key(|entry| entry.tag);
        let (count_bytes, entry_bytes) = if form.is_big { (8, 20) } else { (2, 12) };
        let start = count_bytes + entries.len() * entry_bytes + width;
        let pad = |bytes: usize| bytes.div_ceil(8) * 8;
        let outside: usize =
            entries.iter().map(|entry| entry.bytes.len()).filter(|bytes| *bytes > width).map(pad).sum();
        let length = pad(start) + outside;
        let data = self.at + length as u64;
        let mut head = form.bytes(entries.len() as u64, count_bytes);
        let mut tail = vec![0; pad(start) - start];
        for mut entry in entries {
            if entry.tag == STRIP_OFFSETS {
                entry.bytes = form.bytes(data, width);
            }
            head.extend(form.bytes(entry.tag.into(), 2));
            head.extend(form.bytes(entry.kind.into(), 2));
            head.extend(form.bytes(entry.count, width));
            if entry.bytes.len() > width {
                head.extend(form.bytes(self.at + (start + tail.len()) as u64, width));
                entry.bytes.resize(pad(entry.bytes.len()), 0);
                tail.extend(entry.bytes);
            } else {
                entry.bytes.resize(width, 0);
                head.extend(entry.bytes);
            }
        }
        let next = if self.index < self.pages { data + stored + stored % 2 } else { 0 };
        head.extend(form.bytes(next, width));
        head.extend(tail);
        head
    }

    fn entries(&self, stored: u64) -> Vec<Entry> {
        let (form, plan) = (self.form, &self.plan);
        let shorts = |tag: u16, numbers: &[u64]| Entry {
            tag,
            kind: 3,
            count: numbers.len() as u64,
            bytes: numbers.iter().flat_map(|number| form.bytes(*number, 2)).collect(),
        };
        let long = |tag: u16, number: u64| Entry { tag, kind: 4, count: 1, bytes: form.bytes(number, 4) };
        let offset = |tag: u16, number: u64| Entry {
            tag,
            kind: if form.is_big { 16 } else { 4 },
            count: 1,
            bytes: form.bytes(number, form.width()),
        };
        let each = |number: u64| vec![number; plan.samples as usize];
        let format = match self.element {
            element if element.is_float() => 3,
            element if element.is_signed_integer() => 2,
            _ => 1,
        };
        let mut entries = vec![
            long(256, self.width.into()),
            long(257, self.height.into()),
            shorts(258, &each(self.element.bytes() as u64 * 8)),
            shorts(259, &[if form.is_deflated { 8 } else { 1 }]),
            shorts(262, &[plan.photometric.into()]),
            offset(STRIP_OFFSETS, 0),
            shorts(277, &[plan.samples.into()]),
            long(278, self.height.into()),
            offset(279, stored),
            shorts(284, &[1]),
            shorts(339, &each(format)),
        ];
        if !plan.extra_samples.is_empty() {
            entries.push(shorts(338, &plan.extra_samples));
        }
        if !plan.color_map.is_empty() {
            entries.push(shorts(320, &plan.color_map));
        }
        for (tag, resolution) in [282, 283].into_iter().zip(plan.resolutions) {
            entries.extend(resolution.map(|(numerator, denominator)| Entry {
                tag,
                kind: 5,
                count: 1,
                bytes: [form.bytes(numerator.into(), 4), form.bytes(denominator.into(), 4)].concat(),
            }));
        }
        if plan.resolutions.iter().any(Option::is_some) {
            entries.push(shorts(296, &[plan.resolution_unit]));
        }
        if self.index == 1 {
            entries.extend(plan.texts.iter().map(|(tag, text)| {
                let bytes = [text.as_bytes(), &[0]].concat();
                Entry { tag: *tag, kind: 2, count: bytes.len() as u64, bytes }
            }));
        }
        entries
    }
}

/// Tag of the place of the samples.
const STRIP_OFFSETS: u16 = 273;
