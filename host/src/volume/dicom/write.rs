//! Volumes as DICOM: a file for each slice, or one of many frames.
//!
//! Sources: DICOM PS3.3, A.8 (secondary capture, of one frame and of many), C.7.6.2 (image plane), C.7.6.3 (image pixel),
//! C.7.6.16 (functional groups). What the source said in `dicom.` lines goes on, so that slices of a CT stay slices of that
//! patient's CT; without such lines it is a secondary capture of nobody.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::dataset::Tag;
use super::elements::{Elements, beginning, decimal, head, uid_of};
use super::series::{MADE, ORIENTATION, PIXEL_SPACING, RESCALE, SERIES, THICKNESS};
use super::{POSITION, frame};
use hmac_sha256::Hash;

use crate::atomic::{AtomicFile, AtomicFolder};
use crate::volume::format::has_extension;
use crate::volume::planes::{PlaneSink, PlaneWriter};
use crate::volume::slices::Pattern;
use crate::volume::{
    Created, ElementType, FileFormat, Header, HeaderLine, Metadata, Space, WriteError, losses,
};

const CHARACTERS: Tag = 0x0008_0005;
const CLASS: Tag = 0x0008_0016;
const INSTANCE_UID: Tag = 0x0008_0018;
/// What rescaled values are: of no unit that is known.
const RESCALE_TYPE: Tag = 0x0028_1054;
const CONVERSION: Tag = 0x0008_0064;
const STUDY: Tag = 0x0020_000D;
const NUMBER: Tag = 0x0020_0013;
const PLACE: Tag = 0x0020_0052;
const FRAMES: Tag = frame::FRAMES;
const PHOTOMETRIC: Tag = frame::PHOTOMETRIC;
const SHARED: Tag = 0x5200_9229;
const PER_FRAME: Tag = 0x5200_9230;
const PIXELS: Tag = 0x7FE0_0010;

/// Classes of objects of one image, and the one of anything.
const IMAGES: &str = "1.2.840.10008.5.1.4.1.1.";
const CAPTURE: &str = "1.2.840.10008.5.1.4.1.1.7";

/// Elements that have to be there, if only without a value.
const EMPTY: [Tag; 12] = [
    0x0008_0020,
    0x0008_0030,
    0x0008_0050,
    0x0008_0090,
    0x0010_0010,
    0x0010_0020,
    0x0010_0030,
    0x0010_0040,
    0x0020_0010,
    0x0020_0011,
    0x0020_0020,
    0x0020_1040,
];

/// Begins a file, or a file for each slice.
pub(super) fn create(path: &Path, header: &Header) -> Result<Created, WriteError> {
    let cannot = |what| WriteError::CannotHold { path: path.to_owned(), format: FileFormat::Dicom, what };
    check(path, header).map_err(cannot)?;
    let io = |cause| WriteError::Io { path: path.to_owned(), cause };
    let mut left = header.metadata.clone();
    let object = Object::new(header, &mut left);
    let path = path.to_owned();
    let writer: Box<dyn PlaneWriter> = match Pattern::of_path(&path) {
        Some(pattern) => {
            if let Some((count, first)) = pattern.found() {
                return Err(WriteError::SlicesExist { path, count, first });
            }
            let folder = AtomicFolder::create(pattern.folder()).map_err(io)?;
            Box::new(Slices { folder, pattern, object, path: path.clone(), index: 0 })
        }
        None => {
            let mut file = AtomicFile::create(&path).map_err(io)?;
            file.write_all(&object.of_frames()).map_err(io)?;
            Box::new(Frames { file, path: path.clone(), object, hash: Hash::new() })
        }
    };
    Ok(Created { sink: Box::new(PlaneSink::new(&path, header, writer)), losses: losses(&left) })
}

/// What no file can hold.
fn check(path: &Path, header: &Header) -> Result<(), String> {
    let [width, height, depth] = header.extent;
    let bytes = header.bytes().unwrap_or(u64::MAX);
    let is_stack = Pattern::of_path(path).is_some();
    let what = match (header.components, header.element) {
        _ if !has_extension(path, &["dcm"]) => "what is written under this name: end it with .dcm",
        (1, ElementType::U64 | ElementType::I64 | ElementType::F32 | ElementType::F64) => {
            "64-bit integers or floating-point numbers: write .nrrd, .mha or .nii"
        }
        (1, _) | (3, ElementType::U8) if width.max(height) > u64::from(u16::MAX) => {
            "more than 65,535 samples a row or rows"
        }
        (1, _) | (3, ElementType::U8) if header.steps > 1 => "time steps: write .nrrd, .mha or .nii",
        (1, _) | (3, ElementType::U8) if !is_stack && (bytes >= 1 << 32 || depth >= 1 << 31) => {
            "4 GiB in one file: write a file for each slice, as in \"slice_%04d.dcm\""
        }
        (1, _) | (3, ElementType::U8) => return Ok(()),
        _ => "components but three of u8, as colours: write .nrrd, .mha or .nii",
    };
    Err(what.to_owned())
}

/// Where slices are: millimetres; left, posterior, superior.
struct Places {
    /// Directions of rows and columns, and the distances of columns and of rows.
    orientation: String,
    spacing: String,
    distance: f64,
    origin: [f64; 3],
    step: [f64; 3],
}

impl Places {
    /// Those of a volume whose rows and columns are at right angles. Positions in no named space are taken as they are.
    fn of(metadata: &Metadata) -> Option<Self> {
        let geometry = metadata.geometry()?.in_space(Space::LeftPosteriorSuperior);
        let unit = match metadata.field("space units") {
            Some(units) => unit(units.split('"').nth(1)?)?,
            None => 1.0,
        };
        let [x, y, step] = geometry.directions.map(|axis| axis.map(|part| part * unit));
        let length = |vector: [f64; 3]| vector.iter().map(|part| part * part).sum::<f64>().sqrt();
        let [dx, dy] = [x, y].map(length);
        let cosines: Vec<f64> =
            x.iter().map(|part| part / dx).chain(y.iter().map(|part| part / dy)).collect();
        let product: f64 = (0..3).map(|axis| cosines[axis] * cosines[axis + 3]).sum();
        let is_sound = dx > 0.0 && dy > 0.0 && length(step) > 0.0 && product.abs() < 1e-4;
        is_sound.then(|| Self {
            orientation: joined(&cosines),
            spacing: joined(&[dy, dx]),
            distance: length(step),
            origin: geometry.origin.map(|part| part * unit),
            step,
        })
    }

    fn position(&self, index: u64) -> String {
        let place: Vec<f64> =
            self.origin.iter().zip(self.step).map(|(origin, step)| origin + step * index as f64).collect();
        joined(&place)
    }
}

/// Millimetres of a unit.
fn unit(name: &str) -> Option<f64> {
    Some(match name {
        "mm" => 1.0,
        "um" | "µm" | "micron" | "microns" => 1e-3,
        "cm" => 10.0,
        "m" => 1e3,
        _ => return None,
    })
}

fn joined(numbers: &[f64]) -> String {
    numbers.iter().map(|number| decimal(*number)).collect::<Vec<_>>().join("\\")
}

/// What is to be said of every slice.
struct Object {
    elements: Elements,
    /// Values of the elements that tell how to rescale each slice.
    each: Vec<(Tag, Vec<String>)>,
    places: Option<Places>,
    /// Class of a file of one slice.
    class: String,
    header: Header,
    /// Identifiers that are made here, as the source had none, or those of something else.
    made: Vec<Tag>,
    /// What they are made of.
    identity: String,
}

impl Object {
    /// Takes from `left` what it says.
    fn new(header: &Header, left: &mut Metadata) -> Self {
        let (mut elements, mut each) = (Elements::default(), Vec::new());
        let mut class = CAPTURE.to_owned();
        left.lines.retain(|line| {
            let HeaderLine::KeyValue { key, value } = line else { return true };
            let Some((tag, kind)) = tag_of(key) else { return true };
            match tag {
                CLASS => class = value.clone(),
                SERIES | INSTANCE_UID | NUMBER | CHARACTERS | CONVERSION | PHOTOMETRIC => {}
                _ if RESCALE.contains(&tag) && value.contains(';') => {
                    each.push((tag, value.split(';').map(str::to_owned).collect()));
                }
                _ => match encoded(kind, value) {
                    Some(bytes) => elements.bytes(tag, bytes),
                    None => elements.text(tag, value),
                },
            }
            false
        });
        let places = Places::of(&header.metadata);
        if places.is_some() {
            left.lines.retain(|line| {
                let is_units = matches!(line, HeaderLine::Field { name, .. } if name == "space units");
                !line.is_geometry() && !is_units
            });
        }
        if !class.starts_with(IMAGES) || header.components > 1 {
            class = CAPTURE.to_owned();
        }
        elements.supply(0x0008_0060, "OT");
        EMPTY.into_iter().for_each(|tag| elements.supply(tag, ""));
        let mut made = vec![SERIES];
        made.extend([STUDY].into_iter().filter(|tag| !elements.has(*tag)));
        if let Some(places) = &places {
            made.extend([PLACE].into_iter().filter(|tag| !elements.has(*tag)));
            elements.supply(THICKNESS, &decimal(places.distance));
        }
        if elements.has_letters_beyond_ascii() {
            elements.text(CHARACTERS, "ISO_IR 192");
        }
        pixels(&mut elements, header);
        let identity = String::new();
        let mut object = Self { elements, each, places, class, header: header.clone(), made, identity };
        object.identify(&[]);
        object
    }

    /// Makes identifiers that are those of these elements, places and `contents` alone.
    fn identify(&mut self, contents: &[u8]) {
        let mut elements = self.elements.clone();
        self.made.iter().for_each(|tag| elements.text(*tag, ""));
        let places = self.places.as_ref().map(|places| {
            let ends = [0, self.header.extent[2] - 1].map(|index| places.position(index));
            [places.orientation.clone(), places.spacing.clone(), ends.concat()].concat()
        });
        let each: Vec<String> = self.each.iter().map(|(_, values)| values.join(";")).collect();
        let words = [places.unwrap_or_default(), each.concat()].concat();
        self.identity = uid_of(&[&elements.encoded(), words.as_bytes(), contents]);
        for tag in self.made.clone() {
            let uid = self.uid(&tag.to_le_bytes());
            self.elements.text(tag, &uid);
        }
    }

    /// The identifier of a part of it.
    fn uid(&self, part: &[u8]) -> String {
        uid_of(&[self.identity.as_bytes(), part])
    }

    fn bytes(&self) -> u64 {
        self.header.bytes().unwrap_or(0)
    }

    /// What comes before the samples of a file of one slice.
    fn of_slice(&self, index: u64, samples: &[u8]) -> Vec<u8> {
        let mut elements = self.elements.clone();
        let instance = self.uid(&[&index.to_le_bytes(), samples].concat());
        elements.text(NUMBER, &(index + 1).to_string());
        for (tag, values) in &self.each {
            elements.text(*tag, values.get(index as usize).map_or("", String::as_str));
        }
        if let Some(places) = &self.places {
            elements.text(POSITION, &places.position(index));
            elements.text(ORIENTATION, &places.orientation);
            elements.text(PIXEL_SPACING, &places.spacing);
        }
        self.finished(elements, (&self.class, &instance), self.bytes() / self.header.extent[2])
    }

    /// What comes before the samples of a file of all slices.
    fn of_frames(&self) -> Vec<u8> {
        if self.header.extent[2] == 1 {
            return self.of_slice(0, &[]);
        }
        let mut elements = self.elements.clone();
        elements.text(NUMBER, "1");
        elements.text(FRAMES, &self.header.extent[2].to_string());
        if let Some(places) = &self.places {
            let distance = decimal(places.distance);
            let mut shared = group(0x0028_9110, &[(THICKNESS, &distance), (PIXEL_SPACING, &places.spacing)]);
            shared.extend(group(0x0020_9116, &[(ORIENTATION, &places.orientation)]));
            elements.sequence(SHARED, &[shared]);
        }
        if self.places.is_some() || !self.each.is_empty() {
            let frames: Vec<Elements> =
                (0..self.header.extent[2]).map(|index| self.of_frame(index)).collect();
            elements.sequence(PER_FRAME, &frames);
        }
        let class = match (self.header.components, self.header.element.bytes()) {
            (3, _) => "1.2.840.10008.5.1.4.1.1.7.4",
            (_, 1) => "1.2.840.10008.5.1.4.1.1.7.2",
            _ => "1.2.840.10008.5.1.4.1.1.7.3",
        };
        self.finished(elements, (class, &self.uid(b"frames")), self.bytes())
    }

    /// What is to be said of one of many frames.
    fn of_frame(&self, index: u64) -> Elements {
        let mut frame = Elements::default();
        if let Some(places) = &self.places {
            frame.extend(group(0x0020_9113, &[(POSITION, &places.position(index))]));
        }
        if !self.each.is_empty() {
            let each = self.each.iter().map(|(tag, values)| (*tag, values.get(index as usize)));
            let each = each.map(|(tag, value)| (tag, value.map_or("", String::as_str)));
            let unit = [(RESCALE_TYPE, "US")];
            frame.extend(group(0x0028_9145, &each.chain(unit).collect::<Vec<_>>()));
        }
        frame
    }

    fn finished(&self, mut elements: Elements, (class, instance): (&str, &str), bytes: u64) -> Vec<u8> {
        elements.text(CLASS, class);
        elements.text(INSTANCE_UID, instance);
        if class.starts_with(CAPTURE) {
            elements.text(CONVERSION, "WSD");
        }
        let mut file = beginning(class, instance);
        file.extend(elements.encoded());
        head(&mut file, PIXELS, (bytes as u32).next_multiple_of(2));
        file
    }
}

/// A sequence of one item of texts.
fn group(tag: Tag, values: &[(Tag, &str)]) -> Elements {
    let (mut inner, mut outer) = (Elements::default(), Elements::default());
    values.iter().for_each(|(tag, value)| inner.text(*tag, value));
    outer.sequence(tag, &[inner]);
    outer
}

/// The tag that a line is about, and the representation of its numbers; none for what samples say themselves.
fn tag_of(key: &str) -> Option<(Tag, &str)> {
    let rest = key.strip_prefix("dicom.")?;
    let (tag, kind) = rest.split_once(' ').unwrap_or((rest, ""));
    let (group, element) = tag.split_once(',')?;
    let tag = Tag::from(u16::from_str_radix(group, 16).ok()?) << 16
        | Tag::from(u16::from_str_radix(element, 16).ok()?);
    let is_ours = (0x0008_0001..0x5200_0000).contains(&tag) && tag & 0xFFFF != 0 && !MADE.contains(&tag);
    // Palettes are bytes, which are not kept.
    let is_palette = (0x0028_1101..=0x0028_1223).contains(&tag);
    (is_ours && !is_palette).then_some((tag, kind))
}

/// Numbers of a representation; `None` for texts.
fn encoded(kind: &str, value: &str) -> Option<Vec<u8>> {
    let words = || value.split('\\');
    let bytes = |number: i64| match kind {
        "US" => u16::try_from(number).ok().map(|number| number.to_le_bytes().to_vec()),
        "SS" => i16::try_from(number).ok().map(|number| number.to_le_bytes().to_vec()),
        "UL" => u32::try_from(number).ok().map(|number| number.to_le_bytes().to_vec()),
        "SL" => i32::try_from(number).ok().map(|number| number.to_le_bytes().to_vec()),
        _ => None,
    };
    let all: Option<Vec<Vec<u8>>> = words().map(|word| bytes(word.parse().ok()?)).collect();
    Some(all?.concat())
}

/// How samples are stored.
fn pixels(elements: &mut Elements, header: &Header) {
    let bits = 8 * header.element.bytes() as u16;
    let is_signed = matches!(header.element, ElementType::I8 | ElementType::I16 | ElementType::I32);
    let photometric = match (header.components, header.metadata.key_value("dicom.0028,0004")) {
        (3, Some("YBR_FULL")) => "YBR_FULL",
        (3, _) => "RGB",
        (_, Some("MONOCHROME1")) => "MONOCHROME1",
        _ => "MONOCHROME2",
    };
    elements.text(PHOTOMETRIC, photometric);
    elements.numbers(frame::SAMPLES, &[header.components as u16]);
    if header.components > 1 {
        elements.numbers(frame::PLANAR, &[0]);
    }
    elements.numbers(frame::ROWS, &[header.extent[1] as u16]);
    elements.numbers(frame::COLUMNS, &[header.extent[0] as u16]);
    elements.numbers(frame::ALLOCATED, &[bits]);
    elements.numbers(frame::STORED, &[bits]);
    elements.numbers(frame::HIGH_BIT, &[bits - 1]);
    elements.numbers(frame::SIGNED, &[u16::from(is_signed)]);
}

/// A file for each slice.
struct Slices {
    folder: AtomicFolder,
    pattern: Pattern,
    object: Object,
    path: PathBuf,
    index: u64,
}

impl Slices {
    fn slice(&mut self, plane: &[u8]) -> io::Result<()> {
        if self.index == 0 {
            // Those of the series stand in the first file already, so they cannot be made of all samples.
            self.object.identify(plane);
        }
        let name = self.pattern.name(self.index, self.object.header.extent[2]);
        let mut file = AtomicFile::create(&self.folder.path().join(name))?;
        file.write_all(&self.object.of_slice(self.index, plane))?;
        file.write_all(plane)?;
        file.write_all(&[0][..plane.len() % 2])?;
        file.commit()
    }
}

impl PlaneWriter for Slices {
    fn write(&mut self, plane: &[u8]) -> Result<(), WriteError> {
        self.slice(plane).map_err(|cause| WriteError::Io { path: self.path.clone(), cause })?;
        self.index += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), WriteError> {
        let Self { folder, path, .. } = *self;
        folder.commit().map_err(|cause| WriteError::Io { path, cause })
    }
}

/// One file of all slices.
struct Frames {
    file: AtomicFile,
    path: PathBuf,
    object: Object,
    /// Of all samples.
    hash: Hash,
}

impl Frames {
    /// Writes the head again, of which the identifiers are known now.
    fn end(self) -> io::Result<()> {
        let Self { mut file, mut object, hash, .. } = self;
        file.write_all(&[0][..(object.bytes() % 2) as usize])?;
        object.identify(&hash.finalize());
        file.overwrite(0, &object.of_frames())?;
        file.commit()
    }
}

impl PlaneWriter for Frames {
    fn write(&mut self, plane: &[u8]) -> Result<(), WriteError> {
        self.hash.update(plane);
        self.file.write_all(plane).map_err(|cause| WriteError::Io { path: self.path.clone(), cause })
    }

    fn finish(self: Box<Self>) -> Result<(), WriteError> {
        let path = self.path.clone();
        self.end().map_err(|cause| WriteError::Io { path, cause })
    }
}
