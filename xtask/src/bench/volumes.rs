//! The volumes that are measured: the built-in ones, and those of folders with a manifest.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::Options;

/// The repository's own data and where it is described.
const BUILT_IN: [&str; 2] = ["vectors", "vectors/MANIFEST.toml"];

/// Where more data is looked for when no folder is named.
const DEFAULT_FOLDER: &str = "../shared/data";

const MANIFEST: &str = "MANIFEST.tsv";

/// Error bounds of floating-point volumes: what the record calls them, and the part of the range of the samples.
const BOUNDS: [(&str, f64); 2] = [("error 1e-3", 1e-3), ("error 1e-5", 1e-5)];

/// Samples from here on are taken for marks of missing values, which many climate models write as 1e20.
const MISSING: f64 = 1e19;

/// A raw file of little-endian samples.
#[derive(Clone, Serialize)]
pub(super) struct Listed {
    pub(super) name: String,
    /// Left out of records, which outlive the machine that it is good on.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub(super) path: String,
    /// Samples along x, y and z; x varies fastest.
    pub(super) extent: [u64; 3],
    #[serde(rename = "type")]
    pub(super) element: String,
    pub(super) bounds: Vec<Bound>,
}

/// An error bound for the samples of one volume.
#[derive(Clone, Serialize)]
pub(super) struct Bound {
    task: String,
    absolute: f64,
}

impl Listed {
    pub(super) fn samples(&self) -> u64 {
        self.extent.iter().product()
    }

    /// What coding the volume without loss is called in the record.
    pub(super) fn task(&self) -> &'static str {
        if self.element.starts_with('f') { "lossless floats" } else { "lossless" }
    }

    /// Bytes of the samples.
    pub(super) fn bytes(&self) -> u64 {
        let bits: u64 = self.element.trim_start_matches(char::is_alphabetic).parse().unwrap_or(8);
        self.samples() * bits / 8
    }
}

/// The volumes that `options` ask for, each name once.
pub(super) fn list(options: &Options) -> Result<Vec<Listed>, String> {
    let mut volumes = built_in()?;
    let folders = match options.data.as_slice() {
        [] if Path::new(DEFAULT_FOLDER).is_dir() => &[DEFAULT_FOLDER.into()],
        folders => folders,
    };
    for folder in folders {
        for listed in of_folder(folder)? {
            if volumes.iter().all(|volume| volume.name != listed.name) {
                volumes.push(listed);
            }
        }
    }
    if !options.only.is_empty() {
        volumes.retain(|volume| options.only.contains(&volume.name));
    }
    volumes.iter_mut().try_for_each(add_bounds)?;
    Ok(volumes)
}

/// `[[data]]` of the vectors' manifest.
#[derive(Deserialize)]
struct Vectors {
    data: Vec<Data>,
}

#[derive(Deserialize)]
struct Data {
    id: String,
    file: String,
    extent: [u64; 3],
    #[serde(rename = "type")]
    element: String,
}

fn built_in() -> Result<Vec<Listed>, String> {
    let [folder, manifest] = BUILT_IN;
    let vectors: Vectors =
        toml::from_str(&read(Path::new(manifest))?).map_err(|error| format!("{manifest}: {error}"))?;
    let listed = |data: Data| Listed {
        name: data.id,
        path: format!("{folder}/{}", data.file),
        extent: data.extent,
        element: data.element,
        bounds: vec![],
    };
    Ok(vectors.data.into_iter().map(listed).collect())
}

/// Every line of a folder's manifest but meshes.
fn of_folder(folder: &Path) -> Result<Vec<Listed>, String> {
    let manifest = folder.join(MANIFEST);
    parse(&read(&manifest)?, folder).map_err(|error| format!("{}: {error}", manifest.display()))
}

/// A manifest of columns parted by tabs, the first line naming them.
fn parse(text: &str, folder: &Path) -> Result<Vec<Listed>, String> {
    let mut lines = text.lines();
    let columns: Vec<&str> = lines.next().unwrap_or("").split('\t').collect();
    let place = |name: &str| {
        columns.iter().position(|column| *column == name).ok_or_else(|| format!("no column {name}"))
    };
    let [name, file, kind, extent, element] =
        [place("name")?, place("file")?, place("kind")?, place("extent")?, place("type")?];
    let mut volumes = vec![];
    for line in lines {
        let cells: Vec<&str> = line.split('\t').collect();
        let cell =
            |place: usize| cells.get(place).copied().ok_or_else(|| format!("a column is missing in: {line}"));
        if cell(kind)? != "mesh" {
            volumes.push(Listed {
                name: cell(name)?.to_owned(),
                path: folder.join(cell(file)?).display().to_string(),
                extent: parse_extent(cell(extent)?)?,
                element: cell(element)?.to_owned(),
                bounds: vec![],
            });
        }
    }
    Ok(volumes)
}

/// `XxYxZ`, or fewer axes.
fn parse_extent(text: &str) -> Result<[u64; 3], String> {
    let wrong = || format!("{text} is no extent");
    let mut extent = [1; 3];
    for (index, axis) in text.split('x').enumerate() {
        *extent.get_mut(index).ok_or_else(wrong)? = axis.parse().map_err(|_| wrong())?;
    }
    Ok(extent)
}

/// Sets the error bounds of a volume of 32-bit floating-point numbers.
fn add_bounds(volume: &mut Listed) -> Result<(), String> {
    if volume.element == "f32" {
        let bytes = std::fs::read(&volume.path).map_err(|error| format!("{}: {error}", volume.path))?;
        let range = range(bytes.as_chunks().0.iter().map(|&bytes| f64::from(f32::from_le_bytes(bytes))));
        let bound = |(task, part): (&str, f64)| Bound { task: task.to_owned(), absolute: part * range };
        volume.bounds = BOUNDS.into_iter().map(bound).collect();
    }
    Ok(())
}

/// Range of the samples that are not missing.
fn range(samples: impl Iterator<Item = f64>) -> f64 {
    let present = samples.filter(|sample| sample.abs() < MISSING);
    let (least, most) = present.fold((f64::MAX, f64::MIN), |(least, most), x| (least.min(x), most.max(x)));
    (most - least).max(0.0)
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_manifest_is_read_by_the_names_of_its_columns() {
        let text = "file\tname\tkind\ttype\textent\na.raw\ta\tvolume\tu16\t4x3x2\nb.ply\tb\tmesh\tply\t9 9\n";
        let volumes = parse(text, Path::new("data")).ok().unwrap();
        assert_eq!(volumes.len(), 1);
        assert_eq!((volumes[0].name.as_str(), volumes[0].extent), ("a", [4, 3, 2]));
        assert_eq!((volumes[0].samples(), volumes[0].bytes()), (24, 48));
        assert!(parse("name\tfile\n", Path::new("")).err().unwrap().contains("kind"));
    }

    #[test]
    fn extents_have_up_to_three_axes() {
        assert_eq!(parse_extent("7x5"), Ok([7, 5, 1]));
        assert!(parse_extent("1x2x3x4").is_err());
        assert!(parse_extent("9 9").is_err());
    }

    #[test]
    fn missing_values_are_no_part_of_the_range() {
        assert_eq!(range([1.0, 1e20, -2.0, f64::NAN].into_iter()), 3.0);
        assert_eq!(range([1e20].into_iter()), 0.0);
    }
}
