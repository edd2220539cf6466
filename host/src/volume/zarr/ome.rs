//! Images of OME-Zarr: axes, scales, places and units, and NRRD's words for them.
//!
//! Source: *OME-Zarr specification* (Open Microscopy Environment), versions 0.4 and 0.5, `multiscales`. A sample with
//! index i along an axis lies at scale · i + translation; the transformations of the whole image follow those of the
//! level. Axes are in the order time, channel, z, y, x.

use serde_json::{Map, Value, json};

use super::lines::{ATTRIBUTES, NRRD, field, from_json, is_pair, json_of, pair, to_json};
use super::node::multiscales;
use crate::volume::metadata::is_same_name;
use crate::volume::{Axis, FileFormat, Header, HeaderLine, Metadata};

/// Key of the pair that keeps the attributes of an image, as JSON.
const KEY: &str = "ome.attributes";

/// Units in the words of OME-Zarr, and in those that NRRD files use.
const UNITS: [(&str, &str); 9] = [
    ("millimeter", "mm"),
    ("micrometer", "um"),
    ("nanometer", "nm"),
    ("meter", "m"),
    ("centimeter", "cm"),
    ("kilometer", "km"),
    ("second", "s"),
    ("millisecond", "ms"),
    ("microsecond", "us"),
];

/// What an image says of one axis.
#[derive(Clone, Debug)]
struct OmeAxis {
    /// Its name, type and unit.
    axis: Value,
    scale: f64,
    translation: f64,
}

impl OmeAxis {
    fn plain(name: &str, kind: &str) -> Self {
        Self { axis: json!({ "name": name, "type": kind }), scale: 1.0, translation: 0.0 }
    }

    fn is_of(&self, kind: &str, name: &str) -> bool {
        match self.axis.get("type").and_then(Value::as_str) {
            Some(found) => found == kind,
            None => self.axis.get("name").and_then(Value::as_str) == Some(name),
        }
    }
}

/// The lines of a level of an image with these attributes. `header` has no lines yet.
pub(super) fn lines(attributes: &Map<String, Value>, level: usize, header: &Header) -> Vec<HeaderLine> {
    let kept = attributes.get(NRRD).and_then(from_json);
    if let Some(kept) = &kept {
        let mut same = header.clone();
        same.metadata.lines.clone_from(kept);
        if level == 0 && self::attributes(&same) == *attributes {
            return same.metadata.lines;
        }
    }
    let mut lines = said(attributes, level, &header.metadata.axes);
    let others = kept.into_iter().flatten();
    lines.extend(others.filter(|line| !matches!(line, HeaderLine::Field { .. })));
    lines.push(pair(KEY, &Value::Object(attributes.clone())));
    lines
}

/// What the attributes say, in NRRD's words, with entries for these axes.
fn said(attributes: &Map<String, Value>, level: usize, of: &[Axis]) -> Vec<HeaderLine> {
    let Some(image) = multiscales(attributes) else { return Vec::new() };
    let axes = axes(image, level);
    let mut space: Vec<_> =
        axes.iter().filter(|axis| !axis.is_of("time", "t") && !axis.is_of("channel", "c")).collect();
    space.reverse();
    let rank = space.len();
    if rank == 0 {
        return Vec::new();
    }
    let direction = |axis: usize| {
        let parts =
            (0..rank).map(|row| if row == axis { space[axis].scale.to_string() } else { "0".to_owned() });
        format!("({})", parts.collect::<Vec<_>>().join(","))
    };
    let directions: Vec<String> = (0..rank).map(direction).collect();
    let origin: Vec<String> = space.iter().map(|axis| axis.translation.to_string()).collect();
    let mut lines = vec![
        field("space dimension", rank.to_string()),
        field("space directions", directions.join(" ")),
        field("space origin", format!("({})", origin.join(","))),
    ];
    let unit = |axis: &&OmeAxis| axis.axis.get("unit").and_then(Value::as_str).map_or("", short).to_owned();
    let units: Vec<String> = space.iter().map(unit).collect();
    if units.iter().any(|unit| !unit.is_empty()) {
        let quoted: Vec<String> = units.iter().map(|unit| format!("\"{}\"", unit.replace('"', ""))).collect();
        lines.push(field("space units", quoted.join(" ")));
    }
    if let Some(name) = image.get("name").and_then(Value::as_str).filter(|name| !name.trim().is_empty()) {
        lines.push(field("content", name.trim().to_owned()));
    }
    if of.iter().any(|axis| axis.is_like(Axis::Time(0)))
        && let Some(time) = axes.iter().find(|axis| axis.is_of("time", "t"))
    {
        let mut metadata = Metadata::plain(rank as u8, FileFormat::Zarr);
        metadata.lines = lines;
        lines = metadata.lines_for(of);
        lines.extend(said_of_time(time, of));
    }
    lines
}

/// Whether an image says how far time steps are from each other, or in which unit.
pub(super) fn tells_time(attributes: &Map<String, Value>, level: usize) -> bool {
    let axes = multiscales(attributes).map(|image| axes(image, level)).unwrap_or_default();
    axes.iter().any(|axis| axis.is_of("time", "t") && (axis.scale != 1.0 || axis.axis.get("unit").is_some()))
}

/// The axes of a data set in the order component, x, y, z, time.
pub(super) fn in_order(header: &Header) -> Vec<Axis> {
    let mut axes = header.axes();
    axes.sort_by_key(|axis| axis.place());
    axes
}

/// Distance of time steps, and its unit if there is one.
fn said_of_time(time: &OmeAxis, of: &[Axis]) -> Vec<HeaderLine> {
    let unit = time.axis.get("unit").and_then(Value::as_str).map_or("", short).replace('"', "");
    let entries = |others: &str, own: &str| {
        let entry =
            |axis: &Axis| if axis.is_like(Axis::Time(0)) { own.to_owned() } else { others.to_owned() };
        of.iter().map(entry).collect::<Vec<_>>().join(" ")
    };
    let mut lines = vec![field("spacings", entries("nan", &time.scale.to_string()))];
    if !unit.is_empty() {
        lines.push(field("units", entries("\"\"", &format!("\"{unit}\""))));
    }
    lines
}

/// The axes of an image, and how a level lies along them.
fn axes(image: &Map<String, Value>, level: usize) -> Vec<OmeAxis> {
    let list = |value: Option<&Value>| value.and_then(Value::as_array).cloned().unwrap_or_default();
    let dataset = list(image.get("datasets")).into_iter().nth(level).unwrap_or_default();
    let of_level = list(dataset.get("coordinateTransformations"));
    let of_image = list(image.get("coordinateTransformations"));
    let part = |list: &[Value], kind: &str, axis: usize| {
        let found = list.iter().find(|one| one.get("type").and_then(Value::as_str) == Some(kind));
        found.and_then(|one| one.get(kind)?.get(axis)?.as_f64())
    };
    let axes = list(image.get("axes")).into_iter().enumerate();
    axes.map(|(at, axis)| {
        let outer = part(&of_image, "scale", at).unwrap_or(1.0);
        OmeAxis {
            axis,
            scale: outer * part(&of_level, "scale", at).unwrap_or(1.0),
            translation: outer * part(&of_level, "translation", at).unwrap_or(0.0)
                + part(&of_image, "translation", at).unwrap_or(0.0),
        }
    })
    .collect()
}

/// Attributes of an image of version 0.5 that has these samples as its only level, `0`.
pub(super) fn attributes(header: &Header) -> Map<String, Value> {
    let base = match json_of(&header.metadata, KEY) {
        Some(Value::Object(base)) if multiscales(&base).is_some() => Some(base),
        _ => None,
    };
    let axes = axes_of(header);
    let all = |part: fn(&OmeAxis) -> f64| axes.iter().map(part).collect::<Vec<f64>>();
    let mut image = base.as_ref().and_then(multiscales).cloned().unwrap_or_default();
    image.remove("version");
    image.remove("coordinateTransformations");
    image.insert("axes".to_owned(), axes.iter().map(|axis| axis.axis.clone()).collect());
    let transformations = json!([
        { "type": "scale", "scale": all(|axis| axis.scale) },
        { "type": "translation", "translation": all(|axis| axis.translation) },
    ]);
    image.insert(
        "datasets".to_owned(),
        json!([{ "path": "0", "coordinateTransformations": transformations }]),
    );
    match header.metadata.name() {
        Some(name) => image.insert("name".to_owned(), json!(name)),
        None => image.remove("name"),
    };

    let has_base = base.is_some();
    let mut attributes = base.unwrap_or_default();
    let mut ome = match attributes.remove("ome") {
        Some(Value::Object(ome)) => ome,
        _ => Map::new(),
    };
    for key in ["omero", "labels", "image-label"] {
        if let Some(value) = attributes.remove(key) {
            ome.insert(key.to_owned(), value);
        }
    }
    attributes.remove("multiscales");
    ome.insert("version".to_owned(), json!("0.5"));
    ome.insert("multiscales".to_owned(), json!([image]));
    attributes.insert("ome".to_owned(), Value::Object(ome));
    attributes.remove(NRRD);
    // With a time step, lines have entries for all axes, in the order that a reader finds.
    let (mut lines, of) = match header.metadata.time_step() {
        Some(_) => (header.metadata.lines_for(&in_order(header)), in_order(header)),
        None => (header.metadata.lines.clone(), header.metadata.axes.clone()),
    };
    lines.retain(|line| !is_pair(line, KEY) && !is_pair(line, ATTRIBUTES));
    if !has_base || said(&attributes, 0, &of) != lines {
        attributes.insert(NRRD.to_owned(), to_json(lines.iter()));
    }
    attributes
}

/// Axes of the array that an image of this data set has: time and channel if there are several, or if the image that
/// was read had them.
fn axes_of(header: &Header) -> Vec<OmeAxis> {
    let metadata = &header.metadata;
    let base = json_of(metadata, KEY);
    let base = base.as_ref().and_then(Value::as_object).and_then(multiscales);
    let base = base.map(|image| axes(image, 0)).unwrap_or_default();
    let mut found = Vec::new();
    for (kind, name, count) in [("time", "t", header.steps), ("channel", "c", u64::from(header.components))] {
        let known = base.iter().find(|axis| axis.is_of(kind, name)).cloned();
        if count > 1 || known.is_some() {
            let mut axis = known.unwrap_or_else(|| OmeAxis::plain(name, kind));
            if let Some(step) = metadata.time_step().filter(|_| kind == "time") {
                axis.scale = step;
                let unit = metadata.axis_entry("units", Axis::Time(0)).unwrap_or_default().trim_matches('"');
                if !unit.is_empty() {
                    axis.axis["unit"] = json!(long(unit));
                }
            }
            found.push(axis);
        }
    }
    let rank = header.rank().max(2);
    let (scales, origin, units) = (scales(metadata), metadata.origin().unwrap_or_default(), units(metadata));
    for axis in (0..rank).rev() {
        let mut space = OmeAxis::plain(["x", "y", "z"][axis], "space");
        if let Some(unit) = units.get(axis).filter(|unit| !unit.is_empty()) {
            space.axis["unit"] = json!(long(unit));
        }
        space.scale = scales.get(axis).copied().unwrap_or(1.0);
        space.translation = origin.get(axis).copied().unwrap_or(0.0);
        found.push(space);
    }
    found
}

/// What lies along the axes of the array of an image: time, channel, and how many axes of space there are.
pub(super) fn shape_of(header: &Header) -> (bool, bool, usize) {
    let axes = axes_of(header);
    let has = |kind, name| axes.iter().any(|axis| axis.is_of(kind, name));
    (has("time", "t"), has("channel", "c"), header.rank().max(2))
}

/// Distances of samples; a single part of a direction is one as it stands, with its sign.
fn scales(metadata: &Metadata) -> Vec<f64> {
    let Some(directions) = metadata.directions() else {
        return metadata.spacing().map(Vec::from).unwrap_or_default();
    };
    let lengths = directions.iter().enumerate().map(|(axis, step)| {
        let is_upright = step.iter().enumerate().all(|(row, part)| row == axis || *part == 0.0);
        match step.get(axis) {
            Some(part) if is_upright => *part,
            _ => step.iter().map(|part| part * part).sum::<f64>().sqrt(),
        }
    });
    lengths.collect()
}

/// Units of x, y, z.
fn units(metadata: &Metadata) -> Vec<String> {
    let named = |name| {
        metadata.lines.iter().find_map(|line| match line {
            HeaderLine::Field { name: found, value } if is_same_name(found, name) => Some(value),
            _ => None,
        })
    };
    let text = named("space units").or_else(|| named("units"));
    let text = text.map(String::as_str).unwrap_or_default();
    text.split('"').skip(1).step_by(2).map(str::to_owned).collect()
}

fn short(unit: &str) -> &str {
    UNITS.iter().find(|(long, _)| *long == unit).map_or(unit, |(_, short)| short)
}

fn long(unit: &str) -> &str {
    UNITS.iter().find(|(_, short)| *short == unit).map_or(unit, |(long, _)| long)
}
