//! From the lines of a MetaImage header to the words of metadata, and back.

use super::header::{MetaHeader, is_structure};
use crate::volume::{
    Axis, ExtentError, FileFormat, Geometry, Header, HeaderLine, Metadata, Origin, Space, name_of,
};

/// What stands before keys of the format in keys of metadata.
const PREFIX: &str = "metaimage.";

/// What stands before the names of NRRD's fields in lines of a MetaImage header.
const FIELD: &str = "nrrd.";

/// Keys that say where samples lie, each by its three names.
const DIRECTIONS: [&str; 3] = ["TransformMatrix", "Rotation", "Orientation"];
const OFFSETS: [&str; 3] = ["Offset", "Position", "Origin"];
const SPACING: &str = "ElementSpacing";
const ANATOMY: &str = "AnatomicalOrientation";

/// The other keys of the format; all that it does not have belong to whoever wrote them.
const KNOWN: [&str; 16] = [
    "Comment",
    "ObjectSubType",
    "TransformType",
    "Name",
    "ID",
    "ParentID",
    "Color",
    "CenterOfRotation",
    "DistanceUnits",
    "AcquisitionDate",
    "ElementSize",
    "ElementNBits",
    "ElementMin",
    "ElementMax",
    "Modality",
    "SequenceID",
];

fn is_place(key: &str) -> bool {
    DIRECTIONS.contains(&key) || OFFSETS.contains(&key) || key == SPACING || key == ANATOMY
}

/// The data set that a header speaks of. Its axes are channels, x, y, z, and time from the fourth on.
pub(super) fn read(file: MetaHeader) -> Result<Header, ExtentError> {
    let channels = (file.channels > 1).then_some((Axis::Component(file.channels), u64::from(file.channels)));
    let space = |(index, &count): (usize, &u64)| {
        (Axis::SPACE.get(index).copied().unwrap_or(Axis::Time(count)), count)
    };
    let axes = channels.into_iter().chain(file.sizes.iter().enumerate().map(space));
    let (axes, counts): (Vec<Axis>, Vec<u64>) = axes.unzip();
    let source = Origin { format: FileFormat::MetaImage, byte_order: file.byte_order, fortran_order: false };
    let mut metadata = Metadata { axes, source, lines: Vec::new() };
    let rank = file.sizes.len();
    let place = Place::of(|key| value_of(&file.pairs, key).map(str::to_owned), rank);
    for (key, value) in file.pairs {
        if let Some(name) = key.strip_prefix(FIELD) {
            metadata.lines.push(HeaderLine::Field { name: name.replace('_', " "), value });
        } else {
            let is_own = is_place(&key) || KNOWN.contains(&key.as_str());
            let key = if is_own { format!("{PREFIX}{key}") } else { key };
            metadata.lines.push(HeaderLine::KeyValue { key, value });
        }
    }
    if let Some(step) = place.time_step {
        metadata.set_axis_entry("spacings", Axis::Time(0), &step.to_string());
    }
    match place.geometry {
        Some(geometry) if place.is_oriented => metadata.set_geometry(&geometry),
        Some(geometry) => {
            for (axis, step) in Axis::SPACE.into_iter().zip(geometry.spacing()).take(rank) {
                metadata.set_axis_entry("spacings", axis, &step.to_string());
            }
        }
        None => {}
    }
    Header::of_axes(&counts, file.element, metadata)
}

fn value_of<'a>(pairs: &'a [(String, String)], key: &str) -> Option<&'a str> {
    pairs.iter().find(|(found, _)| found == key).map(|(_, value)| value.as_str())
}

/// What a header says of positions.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    geometry: Option<Geometry>,
    /// Whether it says more than spacings.
    is_oriented: bool,
    time_step: Option<f64>,
}

impl Place {
    /// Reads positions; each row of the matrix is the direction of one axis.
    fn of(value: impl Fn(&str) -> Option<String>, rank: usize) -> Self {
        let numbers = |keys: &[&str], count: usize| -> Option<Vec<f64>> {
            let text = keys.iter().find_map(|key| value(key))?;
            let numbers =
                text.split_whitespace().map(|word| word.parse().ok().filter(|value: &f64| value.is_finite()));
            numbers.collect::<Option<Vec<f64>>>().filter(|numbers| numbers.len() == count)
        };
        let spacing = numbers(&[SPACING], rank).filter(|steps| steps.iter().all(|step| *step > 0.0));
        let matrix = numbers(&DIRECTIONS, rank * rank);
        let offset = numbers(&OFFSETS, rank);
        let time_step = spacing.as_ref().and_then(|spacing| spacing.get(3).copied());
        let is_oriented = matrix.is_some() || offset.is_some();
        if spacing.is_none() && !is_oriented {
            return Self { geometry: None, is_oriented, time_step };
        }
        let entry =
            |of: &Option<Vec<f64>>, index: usize, default: f64| of.as_ref().map_or(default, |of| of[index]);
        let mut geometry = Geometry::along_axes([1.0; 3], [0.0; 3]);
        for axis in 0..rank.min(3) {
            let step = entry(&spacing, axis, 1.0);
            for part in 0..rank.min(3) {
                let default = if axis == part { 1.0 } else { 0.0 };
                geometry.directions[axis][part] = step * entry(&matrix, axis * rank + part, default);
            }
            geometry.origin[axis] = entry(&offset, axis, 0.0);
        }
        // Anatomy has three axes.
        if rank > 2 && value(ANATOMY).is_some_and(|letters| !letters.contains('?')) {
            geometry.space = Space::LeftPosteriorSuperior;
        }
        Self { geometry: Some(geometry), is_oriented, time_step }
    }
}

/// The lines of a header between its structure, and what has no place in it.
pub(super) fn written(header: &Header, axes: &[Axis]) -> (Vec<String>, Vec<String>) {
    let metadata = &header.metadata;
    let rank = axes.iter().filter(|axis| !matches!(axis, Axis::Component(_))).count();
    let kept = Place::of(|key| metadata.key_value(&format!("{PREFIX}{key}")).map(str::to_owned), rank);
    let now = Place {
        geometry: metadata.geometry(),
        is_oriented: metadata.field("space directions").is_some(),
        time_step: metadata.time_step(),
    };
    let is_same = Place { geometry: kept.geometry.map(flat(rank)), ..kept }
        == Place { geometry: now.geometry.map(flat(rank)), ..now };
    let mut lines = if is_same { Vec::new() } else { place_lines(&now, rank) };
    let mut losses = Vec::new();
    for line in &metadata.lines_for(axes) {
        let pair = match line {
            HeaderLine::Comment(_) => None,
            _ if line.is_geometry() && now.geometry.is_some() => continue,
            HeaderLine::Field { name, value } => Some((format!("{FIELD}{}", name.replace(' ', "_")), value)),
            HeaderLine::KeyValue { key, value } => match key.strip_prefix(PREFIX) {
                Some(key) if is_place(key) && !is_same => continue,
                Some(key) if is_place(key) || KNOWN.contains(&key) => Some((key.to_owned(), value)),
                Some(_) => None,
                None => Some((key.clone(), value))
                    .filter(|(key, _)| !is_place(key) && !KNOWN.contains(&key.as_str())),
            },
        };
        match pair.filter(|(key, value)| is_line(key, value)) {
            Some((key, value)) => lines.push(format!("{key} = {value}")),
            None => losses.push(name_of(line)),
        }
    }
    (lines, losses)
}

/// What positions say of the first `rank` axes.
fn flat(rank: usize) -> impl Fn(Geometry) -> Geometry {
    move |mut geometry| {
        for direction in geometry.directions.iter_mut().skip(rank) {
            *direction = [0.0; 3];
        }
        geometry
    }
}

/// Whether a reader finds the same key and value in `key = value`.
fn is_line(key: &str, value: &str) -> bool {
    let is_word = !key.is_empty() && !key.contains(|letter: char| letter.is_whitespace() || letter == '=');
    is_word
        && !is_structure(key)
        && value.trim() == value
        && !value.is_empty()
        && !value.contains(['\n', '\r'])
}

/// Positions in LPS, if their space has a name.
fn place_lines(place: &Place, rank: usize) -> Vec<String> {
    let Some(geometry) = &place.geometry else { return Vec::new() };
    let is_named = geometry.space != Space::Unnamed;
    let geometry = geometry.in_space(if is_named { Space::LeftPosteriorSuperior } else { Space::Unnamed });
    let lengths = geometry.spacing();
    let of_axes = |of: &dyn Fn(usize) -> f64| -> String {
        (0..rank).map(|axis| of(axis).to_string()).collect::<Vec<_>>().join(" ")
    };
    let spacing = |axis: usize| match axis {
        0..3 if lengths[axis] > 0.0 => lengths[axis],
        3 => place.time_step.unwrap_or(1.0),
        _ => 1.0,
    };
    let spacing_line = format!("{SPACING} = {}", of_axes(&spacing));
    if !place.is_oriented {
        return vec![spacing_line];
    }
    let row = |axis: usize| {
        of_axes(&|part| match (axis, part) {
            (0..3, 0..3) => geometry.directions[axis][part] / spacing(axis),
            _ if axis == part => 1.0,
            _ => 0.0,
        })
    };
    let offset = |axis: usize| if axis < 3 { geometry.origin[axis] } else { 0.0 };
    let matrix: Vec<String> = (0..rank).map(row).collect();
    let mut lines = vec![
        format!("{} = {}", DIRECTIONS[0], matrix.join(" ")),
        format!("{} = {}", OFFSETS[0], of_axes(&offset)),
        format!("CenterOfRotation = {}", of_axes(&|_| 0.0)),
        spacing_line,
    ];
    let letters: String = geometry.directions.iter().map(side_of).collect();
    lines.insert(3, format!("{ANATOMY} = {}", if is_named { &letters } else { "???" }));
    lines
}

/// The side of the patient that an axis comes from, in LPS coordinates.
fn side_of(direction: &[f64; 3]) -> char {
    let longest =
        (0..3).max_by(|&one, &other| direction[one].abs().total_cmp(&direction[other].abs())).unwrap_or(0);
    let sides = [('R', 'L'), ('A', 'P'), ('I', 'S')][longest];
    if direction[longest] < 0.0 { sides.1 } else { sides.0 }
}
