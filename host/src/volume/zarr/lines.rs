//! Lines of metadata in the attributes of Zarr, which keep them all.
//!
//! The attribute `nrrd` is a list of objects: `{"field": "content", "value": "head"}`, `{"key": …, "value": …}` or
//! `{"comment": …}`.

use serde_json::{Map, Value, json};

use crate::volume::{HeaderLine, Metadata};

/// Name of the attribute.
pub(super) const NRRD: &str = "nrrd";

/// Key of the pair that keeps the other attributes of an array, as JSON.
pub(super) const ATTRIBUTES: &str = "zarr.attributes";

/// Key of the pair that keeps names of axes, as JSON.
pub(super) const NAMES: &str = "zarr.dimension_names";

/// A pair of a key and JSON.
pub(super) fn pair(key: &str, value: &Value) -> HeaderLine {
    HeaderLine::KeyValue { key: key.to_owned(), value: value.to_string() }
}

/// A field.
pub(super) fn field(name: &str, value: String) -> HeaderLine {
    HeaderLine::Field { name: name.to_owned(), value }
}

/// The JSON of a pair, if there is such a one.
pub(super) fn json_of(metadata: &Metadata, key: &str) -> Option<Value> {
    serde_json::from_str(metadata.key_value(key)?).ok()
}

/// Whether a line is the pair of that key.
pub(super) fn is_pair(line: &HeaderLine, wanted: &str) -> bool {
    matches!(line, HeaderLine::KeyValue { key, .. } if key == wanted)
}

/// Lines as the value of the attribute.
pub(super) fn to_json<'a>(lines: impl Iterator<Item = &'a HeaderLine>) -> Value {
    lines
        .map(|line| match line {
            HeaderLine::Comment(text) => json!({ "comment": text }),
            HeaderLine::Field { name, value } => json!({ "field": name, "value": value }),
            HeaderLine::KeyValue { key, value } => json!({ "key": key, "value": value }),
        })
        .collect()
}

/// The lines that [`to_json`] was given; `None` for anything else.
pub(super) fn from_json(value: &Value) -> Option<Vec<HeaderLine>> {
    let text = |object: &Value, key: &str| Some(object.get(key)?.as_str()?.to_owned());
    let line = |object: &Value| {
        if let Some(comment) = text(object, "comment") {
            return Some(HeaderLine::Comment(comment));
        }
        let value = text(object, "value")?;
        match text(object, "field") {
            Some(name) => Some(HeaderLine::Field { name, value }),
            None => Some(HeaderLine::KeyValue { key: text(object, "key")?, value }),
        }
    };
    value.as_array()?.iter().map(line).collect()
}

/// Attributes of an array that is no image: those it was read with, and its lines.
pub(super) fn attributes(metadata: &Metadata) -> Map<String, Value> {
    let mut attributes = match json_of(metadata, ATTRIBUTES) {
        Some(Value::Object(kept)) => kept,
        _ => Map::new(),
    };
    let lines: Vec<_> =
        metadata.lines.iter().filter(|line| !is_pair(line, ATTRIBUTES) && !is_pair(line, NAMES)).collect();
    if !lines.is_empty() {
        attributes.insert(NRRD.to_owned(), to_json(lines.into_iter()));
    }
    attributes
}

/// The lines of an array that is no image.
pub(super) fn of_attributes(mut attributes: Map<String, Value>, names: Option<&Value>) -> Vec<HeaderLine> {
    // The mark that zarrs puts into every array says nothing of the samples.
    attributes.remove("_zarrs");
    let kept = attributes.get(NRRD).and_then(from_json);
    if kept.is_some() {
        attributes.remove(NRRD);
    }
    let mut lines = kept.unwrap_or_default();
    if !attributes.is_empty() {
        lines.push(pair(ATTRIBUTES, &Value::Object(attributes)));
    }
    lines.extend(names.map(|names| pair(NAMES, names)));
    lines
}
