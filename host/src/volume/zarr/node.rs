//! Arrays and groups in folders, and which of them a path means.
//!
//! Sources: *Zarr core specification*, versions 2 and 3 (the names of metadata files); *OME-Zarr specification*,
//! versions 0.4 and 0.5 (`multiscales`, whose first dataset has the full resolution; `bioformats2raw.layout`).

use std::fs::{self, File};
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use serde_json::{Map, Value};

use super::ZarrError;
use crate::volume::error::excerpt;

/// Longest metadata file that is read; consolidated metadata of a large hierarchy may have megabytes.
const METADATA_BYTES: u64 = 1 << 26;

/// Folders above an array in which its image is looked for.
const ANCESTORS: usize = 4;

/// What a folder is.
#[derive(Debug)]
pub(super) enum Node {
    /// An array, with its metadata, in which version 2 has its attributes, too.
    Array(Map<String, Value>),
    /// A group, with its attributes.
    Group(Map<String, Value>),
}

/// An array, and the image that it is a level of.
#[derive(Debug)]
pub(super) struct Place {
    pub(super) folder: PathBuf,
    pub(super) metadata: Map<String, Value>,
    /// Attributes of the image's group, and the number of the level in it.
    pub(super) image: Option<(Map<String, Value>, usize)>,
}

/// Whether a folder is an array or a group.
pub(super) fn is_node(folder: &Path) -> bool {
    ["zarr.json", ".zarray", ".zgroup", ".zattrs"].iter().any(|name| folder.join(name).is_file())
}

/// Finds the array that a path means: itself, or the full resolution of the image that it is.
pub(super) fn find(path: &Path) -> Result<Place, ZarrError> {
    let mut folder = path.to_owned();
    for _ in 0..ANCESTORS {
        let attributes = match node(&folder)? {
            Node::Array(metadata) => {
                let image = image_above(&folder);
                return Ok(Place { folder, metadata, image });
            }
            Node::Group(attributes) => attributes,
        };
        folder = match inner(&folder, &attributes) {
            Some(inner) => inner,
            None => return Err(ZarrError::Group { arrays: arrays_in(&folder) }),
        };
    }
    Err(ZarrError::Group { arrays: arrays_in(path) })
}

/// The part of a group that stands for it: the full resolution, the first image of a file with several, or the only
/// array.
fn inner(folder: &Path, attributes: &Map<String, Value>) -> Option<PathBuf> {
    if let Some(image) = multiscales(attributes) {
        return dataset(image, 0).and_then(|name| below(folder, name));
    }
    let ome = attributes.get("ome").and_then(Value::as_object).unwrap_or(attributes);
    if ome.contains_key("bioformats2raw.layout") {
        return below(folder, "0");
    }
    match &children(folder)[..] {
        [only] => Some(only.clone()),
        _ => None,
    }
}

/// The image of a group's attributes: those of version 0.5 are in `ome`.
pub(super) fn multiscales(attributes: &Map<String, Value>) -> Option<&Map<String, Value>> {
    let ome = attributes.get("ome").and_then(Value::as_object).unwrap_or(attributes);
    ome.get("multiscales")?.as_array()?.first()?.as_object()
}

/// Path of a level of an image.
fn dataset(image: &Map<String, Value>, level: usize) -> Option<&str> {
    image.get("datasets")?.as_array()?.get(level)?.get("path")?.as_str()
}

/// The image that an array is a level of.
fn image_above(folder: &Path) -> Option<(Map<String, Value>, usize)> {
    for above in folder.ancestors().skip(1).take(ANCESTORS) {
        let Ok(Node::Group(attributes)) = node(above) else { continue };
        let Some(image) = multiscales(&attributes) else { continue };
        let levels = image.get("datasets")?.as_array()?.len();
        let level = (0..levels).find(|&level| {
            dataset(image, level).and_then(|name| below(above, name)).is_some_and(|found| found == folder)
        })?;
        return Some((attributes, level));
    }
    None
}

/// A path within a folder, unless it leads out of it.
fn below(folder: &Path, name: &str) -> Option<PathBuf> {
    let is_inside = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
    is_inside.then(|| folder.join(name))
}

/// Folders in a folder that are arrays, in the order of their names; some thousand at most are looked at.
fn children(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().take(4096);
    let folders = entries.map(|entry| entry.path()).filter(|path| path.is_dir());
    let mut arrays: Vec<_> = folders.filter(|path| matches!(node(path), Ok(Node::Array(_)))).collect();
    arrays.sort();
    arrays
}

fn arrays_in(folder: &Path) -> String {
    let names = children(folder).into_iter().take(32);
    let names: Vec<String> =
        names.filter_map(|path| Some(excerpt(&path.file_name()?.to_string_lossy()))).collect();
    if names.is_empty() { "of which there are none".to_owned() } else { names.join(", ") }
}

/// Reads the metadata of a folder.
fn node(folder: &Path) -> Result<Node, ZarrError> {
    if let Some(mut metadata) = json(folder, "zarr.json")? {
        return match metadata.get("node_type").and_then(Value::as_str) {
            Some("array") => Ok(Node::Array(metadata)),
            Some("group") => match metadata.remove("attributes") {
                Some(Value::Object(attributes)) => Ok(Node::Group(attributes)),
                _ => Ok(Node::Group(Map::new())),
            },
            _ => Err(ZarrError::Metadata { what: "node_type" }),
        };
    }
    let attributes = json(folder, ".zattrs")?;
    if let Some(mut metadata) = json(folder, ".zarray")? {
        metadata.insert("attributes".to_owned(), Value::Object(attributes.unwrap_or_default()));
        return Ok(Node::Array(metadata));
    }
    match attributes {
        Some(attributes) => Ok(Node::Group(attributes)),
        None if folder.join(".zgroup").is_file() => Ok(Node::Group(Map::new())),
        None => Err(ZarrError::NoNode),
    }
}

/// Reads a file of JSON that is an object, if it is there.
fn json(folder: &Path, name: &str) -> Result<Option<Map<String, Value>>, ZarrError> {
    let fault = |cause: String| ZarrError::Json { file: name.to_owned(), cause };
    let path = folder.join(name);
    if !path.is_file() {
        return Ok(None);
    }
    let mut text = Vec::new();
    let file = File::open(path).map_err(|cause| fault(cause.to_string()))?;
    file.take(METADATA_BYTES + 1).read_to_end(&mut text).map_err(|cause| fault(cause.to_string()))?;
    if text.len() as u64 > METADATA_BYTES {
        return Err(fault(format!("it is longer than {METADATA_BYTES} bytes")));
    }
    serde_json::from_slice(&text).map(Some).map_err(|cause| fault(cause.to_string()))
}
