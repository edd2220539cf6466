//! Files as one volume: which belong together, in what order, and where they are in space.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::dataset::{DataSet, Tag, Value, decimals, text};
use super::frame::Layout;
use super::{DicomError, POSITION};
use crate::volume::error::excerpt;
use crate::volume::{ByteOrder, FileFormat, Header, HeaderLine, Metadata};

pub(super) const SERIES: Tag = 0x0020_000E;
const MODALITY: Tag = 0x0008_0060;
const DESCRIPTION: Tag = 0x0008_103E;
const INSTANCE: Tag = 0x0020_0013;
pub(super) const ORIENTATION: Tag = 0x0020_0037;
pub(super) const PIXEL_SPACING: Tag = 0x0028_0030;
pub(super) const THICKNESS: Tag = 0x0018_0050;
const SLICE_SPACING: Tag = 0x0018_0088;
/// Of planes of dose from the first one, along the normal (Grid Frame Offset Vector).
const FRAME_OFFSETS: Tag = 0x3004_000C;
/// Intercept and slope: a value for each file where they differ.
pub(super) const RESCALE: [Tag; 2] = [0x0028_1052, 0x0028_1053];

/// Group of what the extent, type and order of samples say already.
pub(super) const MADE: [Tag; 12] = [
    0x0028_0002,
    0x0028_0006,
    0x0028_0008,
    0x0028_0010,
    0x0028_0011,
    0x0028_0100,
    0x0028_0101,
    0x0028_0102,
    0x0028_0103,
    POSITION,
    ORIENTATION,
    PIXEL_SPACING,
];

type Files = Vec<(PathBuf, DataSet)>;

/// Those files that are of one series: the one that is named, or the only one.
pub(super) fn one_of(sets: Files, uid: Option<&str>) -> Result<Files, DicomError> {
    let mut series: BTreeMap<String, Files> = BTreeMap::new();
    for (path, set) in sets {
        series.entry(set.text(SERIES).unwrap_or_default()).or_default().push((path, set));
    }
    if let Some(uid) = uid {
        return series.remove(uid).ok_or(DicomError::NoFiles);
    }
    if series.len() > 1 {
        let lines = series.iter().map(|(uid, files)| {
            let about = [MODALITY, DESCRIPTION].map(|tag| files[0].1.text(tag).unwrap_or_default());
            format!("\n  {uid}: {} files, {}", files.len(), excerpt(&about.join(" ")))
        });
        return Err(DicomError::SeveralSeries { list: lines.collect() });
    }
    series.into_values().next().ok_or(DicomError::NoFiles)
}

/// One of the files.
struct File {
    path: PathBuf,
    set: DataSet,
    layout: Layout,
}

/// A slice in its place: a frame of a file.
#[derive(Clone, Copy)]
struct Part {
    file: usize,
    frame: u64,
    /// Where it is along the normal of slices, if it is known.
    at: Option<f64>,
    number: i64,
}

/// Files or frames as slices of a volume.
pub(super) struct Series {
    files: Vec<File>,
    parts: Vec<Part>,
    slices: u64,
    steps: u64,
    /// Directions of x and y, and their product.
    axes: Option<[[f64; 3]; 3]>,
}

impl Series {
    /// Puts files, or the frames of the only one, in order: along the normal of slices, then by number.
    pub(super) fn of(mut sets: Files) -> Result<Self, DicomError> {
        sets.sort_by(|(one, _), (other, _)| one.cmp(other));
        let mut files = Vec::new();
        for (path, set) in sets {
            let layout = Layout::of(&set)?;
            files.push(File { path, set, layout });
        }
        let axes = files.first().and_then(|file| axes(&file.set));
        let mut series = Self { files, parts: Vec::new(), slices: 0, steps: 1, axes };
        series.check_alike()?;
        series.parts = series.unordered();
        series.slices = series.parts.len() as u64;
        if series.parts.len() == 1 || series.parts.iter().any(|part| part.at.is_none()) {
            series.parts.sort_by_key(|part| part.number);
            return Ok(series);
        }
        series.parts.sort_by(|one, other| {
            let along = one.at.partial_cmp(&other.at).unwrap_or(std::cmp::Ordering::Equal);
            along.then(one.number.cmp(&other.number))
        });
        series.find_steps();
        let gaps = series.check_gaps();
        if gaps.is_err() && series.files.len() == 1 {
            // Frames that make no grid stay as they follow each other, and nowhere.
            series.parts = series.unordered();
            (series.slices, series.steps, series.axes) = (series.parts.len() as u64, 1, None);
            return Ok(series);
        }
        gaps.map(|()| series)
    }

    /// Files in the order of their names, or the frames of the only one.
    fn unordered(&self) -> Vec<Part> {
        let mut parts = Vec::new();
        for (index, file) in self.files.iter().enumerate() {
            let number = file.set.text(INSTANCE).and_then(|text| text.parse().ok()).unwrap_or(0);
            let is_turned = turns(&file.set, file.layout.frames);
            parts.extend((0..file.layout.frames).map(|frame| {
                let normal = self.axes.map(|[_, _, normal]| normal).filter(|_| !is_turned);
                let place = position(&file.set, file.layout.frames, frame, normal);
                let at = normal.zip(place).map(|(normal, place)| dot(normal, place));
                Part { file: index, frame, at, number }
            }));
        }
        parts
    }

    fn name(&self, file: usize) -> String {
        self.files[file].path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    fn check_alike(&self) -> Result<(), DicomError> {
        let is_alone = self.files.len() == 1;
        let shape = |file: &File| match !is_alone && file.layout.frames > 1 {
            true => format!("{} in {} frames", file.layout.shape(), file.layout.frames),
            false => file.layout.shape(),
        };
        let turned = |file: &File| file.set.text(ORIENTATION).unwrap_or_default();
        let Some(first) = self.files.first() else { return Err(DicomError::NoFiles) };
        for (index, file) in self.files.iter().enumerate() {
            let differs = |found: String, expected: String| DicomError::Differs {
                file: self.name(index),
                found,
                first: self.name(0),
                expected,
            };
            if !is_alone && file.layout.frames > 1 {
                let alone = "to be alone: give one file of many frames at a time".to_owned();
                return Err(differs(shape(file), alone));
            }
            if shape(file) != shape(first) {
                return Err(differs(shape(file), shape(first)));
            }
            let is_turned = decimals_of(&turned(file)).zip(decimals_of(&turned(first)));
            if is_turned.is_some_and(|(one, other)| are_apart(&one, &other)) {
                return Err(differs(format!("orientation {}", turned(file)), turned(first)));
            }
        }
        Ok(())
    }

    /// Time steps: where each place has the same number of files, which are in order of their numbers.
    fn find_steps(&mut self) {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (index, part) in self.parts.iter().enumerate() {
            match groups.last_mut() {
                Some(group) if is_near(self.parts[group[0]].at, part.at) => group.push(index),
                _ => groups.push(vec![index]),
            }
        }
        let steps = groups[0].len();
        if steps == 1 || groups.iter().any(|group| group.len() != steps) {
            return;
        }
        let mut order: Vec<usize> = (0..self.parts.len()).collect();
        order.sort_by_key(|index| (index % steps, index / steps));
        self.parts = order.into_iter().map(|index| self.parts[index]).collect();
        self.slices = groups.len() as u64;
        self.steps = steps as u64;
    }

    /// Distances of slices of the first time step.
    fn distances(&self) -> Vec<f64> {
        let places: Vec<f64> = self.parts[..self.slices as usize].iter().filter_map(|part| part.at).collect();
        places.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }

    fn check_gaps(&self) -> Result<(), DicomError> {
        let distances = self.distances();
        let mut sorted = distances.clone();
        sorted.sort_by(f64::total_cmp);
        if sorted.is_empty() {
            return Ok(());
        }
        // Where many lie in the same place, the usual distance is that of the others.
        let usual = usual_of(&sorted);
        match distances.iter().position(|distance| *distance > usual * 1.5 || *distance < usual * 0.5) {
            Some(at) => {
                let [before, after] = [at, at + 1].map(|part| self.name(self.parts[part].file));
                let [found, usual] = [distances[at], usual].map(|distance| format!("{distance:.4}"));
                Err(match distances[at] < usual_of(&sorted) * 0.5 {
                    true => DicomError::Crowded { before, after, found, usual },
                    false => DicomError::Gap { before, after, found, usual },
                })
            }
            None => Ok(()),
        }
    }

    /// The file of plane `index`, and the frame in it.
    pub(super) fn place(&self, index: u64) -> (usize, u64) {
        let part = self.parts[index as usize];
        (part.file, part.frame)
    }

    /// All files.
    pub(super) fn files(&self) -> Vec<PathBuf> {
        self.files.iter().map(|file| file.path.clone()).collect()
    }

    pub(super) fn path(&self, file: usize) -> &Path {
        &self.files[file].path
    }

    pub(super) fn layout(&self, file: usize) -> &Layout {
        &self.files[file].layout
    }

    pub(super) fn header(&self) -> Header {
        let File { layout, set, .. } = &self.files[self.parts[0].file];
        // Where it is known where a slice lies, it has a third axis.
        let geometry = self.geometry();
        let is_slice = self.is_slice() && geometry.len() < 2;
        let mut metadata = Metadata::plain(if is_slice { 2 } else { 3 }, FileFormat::Dicom);
        metadata.source.byte_order =
            if layout.element.bytes() > 1 { layout.byte_order } else { ByteOrder::Little };
        metadata.lines = geometry;
        metadata.lines.extend(set.elements.iter().filter_map(|(tag, value)| self.line(*tag, value)));
        if let Some(meaning) = layout.meaning() {
            metadata.set_key_value("dicom.0028,0004", meaning);
        }
        metadata.lines.extend(RESCALE.into_iter().filter_map(|tag| self.rescale_of_frames(tag)));
        let extent = [layout.columns.into(), layout.rows.into(), self.slices];
        Header {
            components: layout.samples.into(),
            steps: self.steps,
            ..Header::scalar(extent, layout.element, metadata)
        }
    }

    fn is_slice(&self) -> bool {
        self.slices == 1 && self.steps == 1
    }

    /// Places and directions, or distances alone, in millimetres; left, posterior, superior.
    fn geometry(&self) -> Vec<HeaderLine> {
        let set = &self.files[self.parts[0].file].set;
        let field = |name: &str, value: String| HeaderLine::Field { name: name.to_owned(), value };
        let spacing = set.decimals(PIXEL_SPACING).filter(|spacing| spacing.len() == 2);
        let Some((spacing, [x, y, normal])) = spacing.clone().zip(self.axes) else {
            let third = if self.is_slice() { "" } else { " nan" };
            let distances = |spacing: Vec<f64>| format!("{} {}{third}", spacing[1], spacing[0]);
            let spacings = spacing.map(|spacing| field("spacings", distances(spacing)));
            return spacings.into_iter().collect();
        };
        let last = (self.slices - 1) as usize;
        let [first, end] = [0, last].map(|index| {
            let part = self.parts[index];
            let File { set, layout, .. } = &self.files[part.file];
            position(set, layout.frames, part.frame, Some(normal))
        });
        let step = first
            .zip(end)
            .filter(|_| last > 0)
            .map(|(first, end)| [0, 1, 2].map(|axis| (end[axis] - first[axis]) / last as f64));
        let step = step.filter(|step| step.iter().any(|part| *part != 0.0)).unwrap_or_else(|| {
            let told =
                [SLICE_SPACING, THICKNESS].into_iter().find_map(|tag| Some(*set.decimals(tag)?.first()?));
            normal.map(|part| part * told.filter(|distance| *distance > 0.0).unwrap_or(1.0))
        });
        let vector = |parts: [f64; 3]| format!("({},{},{})", parts[0], parts[1], parts[2]);
        let directions = [x.map(|part| part * spacing[1]), y.map(|part| part * spacing[0]), step].map(vector);
        let mut lines = vec![
            field("space", "left-posterior-superior".to_owned()),
            field("space directions", directions.join(" ")),
            field("space units", "\"mm\" \"mm\" \"mm\"".to_owned()),
        ];
        lines.extend(first.map(|place| field("space origin", vector(place))));
        lines
    }

    /// The line for an element that all files have in common, or that tells how to rescale each.
    fn line(&self, tag: Tag, value: &Value) -> Option<HeaderLine> {
        if tag >> 16 == 2 || MADE.contains(&tag) || tag & 0xFFFF == 0 {
            return None;
        }
        let of_all = || self.parts.iter().map(|part| self.files[part.file].set.elements.get(&tag));
        let words = words(value, self.files[0].set.syntax.byte_order)?;
        if of_all().all(|other| other == Some(value)) {
            return Some(HeaderLine::KeyValue { key: key(tag) + kind_of(value), value: words });
        }
        let each = || {
            of_all()
                .map(|other| other.map(|value| text(&value.bytes)).unwrap_or_default())
                .collect::<Vec<_>>()
        };
        RESCALE.contains(&tag).then(|| pair(tag, each().join(";")))
    }

    /// The line that tells how to rescale the frames of the only file, where no element of the file does.
    fn rescale_of_frames(&self, tag: Tag) -> Option<HeaderLine> {
        let [File { set, layout, .. }] = &self.files[..] else { return None };
        let shared = set.shared.get(&tag).filter(|_| !set.elements.contains_key(&tag))?;
        let of_frames = set.of_frames(tag, layout.frames).unwrap_or_default();
        if of_frames.iter().all(|value| value == shared) {
            return Some(pair(tag, text(&shared.bytes)));
        }
        let each = self.parts.iter().map(|part| text(&of_frames[part.frame as usize].bytes));
        Some(pair(tag, each.collect::<Vec<_>>().join(";")))
    }
}

/// The distance of most, of distances in their order, but for those that are nothing.
fn usual_of(sorted: &[f64]) -> f64 {
    let apart = sorted.partition_point(|distance| *distance < 1e-3);
    let counted = if apart == sorted.len() { sorted } else { &sorted[apart..] };
    counted[(counted.len() - 1) / 2]
}

fn pair(tag: Tag, value: String) -> HeaderLine {
    HeaderLine::KeyValue { key: key(tag), value }
}

fn key(tag: Tag) -> String {
    format!("dicom.{:04x},{:04x}", tag >> 16, tag & 0xFFFF)
}

/// What stands behind the key of numbers that are no texts, so that they can be written again.
fn kind_of(value: &Value) -> &'static str {
    match &value.vr {
        b"US" => " US",
        b"SS" => " SS",
        b"UL" => " UL",
        b"SL" => " SL",
        _ => "",
    }
}

/// A value that is a text or numbers; others say nothing to people.
fn words(value: &Value, order: ByteOrder) -> Option<String> {
    let numbers = |bytes: usize, is_signed: bool| {
        let parts = value.bytes.chunks_exact(bytes).map(|part| {
            let fold = |number: u32, byte: &u8| number << 8 | u32::from(*byte);
            let number = match order {
                ByteOrder::Little => part.iter().rev().fold(0, fold),
                ByteOrder::Big => part.iter().fold(0, fold),
            };
            match (is_signed, bytes) {
                (true, 2) => (number as u16).cast_signed().to_string(),
                (true, _) => number.cast_signed().to_string(),
                _ => number.to_string(),
            }
        });
        parts.collect::<Vec<_>>().join("\\")
    };
    Some(match &value.vr {
        b"US" => numbers(2, false),
        b"SS" => numbers(2, true),
        b"UL" => numbers(4, false),
        b"SL" => numbers(4, true),
        b"OB" | b"OW" | b"OF" | b"OD" | b"OL" | b"OV" | b"UN" | b"AT" | b"FL" | b"FD" | b"SV" | b"UV" => {
            return None;
        }
        _ => {
            let words = text(&value.bytes);
            // Without a representation, numbers of two bytes look like texts with odd letters.
            let is_text =
                words.chars().all(|letter| !letter.is_control() || letter == '\n' || letter == '\r');
            return is_text.then_some(words);
        }
    })
}

fn decimals_of(words: &str) -> Option<Vec<f64>> {
    decimals(&Value { vr: *b"DS", bytes: words.as_bytes().to_vec() })
}

/// Directions of x and y, and the normal.
fn axes(set: &DataSet) -> Option<[[f64; 3]; 3]> {
    let cosines = set.decimals(ORIENTATION)?;
    let (&[x, y], []) = cosines.as_chunks::<3>() else { return None };
    let normal =
        [0, 1, 2].map(|axis| x[(axis + 1) % 3] * y[(axis + 2) % 3] - x[(axis + 2) % 3] * y[(axis + 1) % 3]);
    Some([x, y, normal])
}

/// Where a frame of so many begins: as it says itself, as the file says, or so far along the normal from there.
fn position(set: &DataSet, frames: u64, frame: u64, normal: Option<[f64; 3]>) -> Option<[f64; 3]> {
    let place = |value: &Value| decimals(value)?.try_into().ok();
    if let Some(values) = set.of_frames(POSITION, frames) {
        return place(values.get(frame as usize)?);
    }
    let first: [f64; 3] = place(set.value(POSITION)?)?;
    if frame == 0 {
        return Some(first);
    }
    let offsets = set.decimals(FRAME_OFFSETS).filter(|offsets| offsets.len() as u64 == frames)?;
    let along = offsets[frame as usize] - offsets[0];
    normal.map(|normal| [0, 1, 2].map(|axis| first[axis] + normal[axis] * along))
}

/// Whether frames have several orientations.
fn turns(set: &DataSet, frames: u64) -> bool {
    let all = set.of_frames(ORIENTATION, frames).unwrap_or_default();
    let Some(first) = all.first().and_then(decimals) else { return false };
    all.iter().any(|value| decimals(value).is_none_or(|other| are_apart(&first, &other)))
}

/// Whether directions differ by more than their decimals do.
fn are_apart(one: &[f64], other: &[f64]) -> bool {
    one.iter().zip(other).any(|(one, other)| (one - other).abs() > 1e-3)
}

fn dot(one: [f64; 3], other: [f64; 3]) -> f64 {
    one.iter().zip(other).map(|(one, other)| one * other).sum()
}

/// Whether two places are the same, but for rounding in their decimals.
fn is_near(one: Option<f64>, other: Option<f64>) -> bool {
    one.zip(other).is_some_and(|(one, other)| (one - other).abs() < 1e-3)
}
