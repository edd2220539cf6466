//! Everything that must hold between `vectors/MANIFEST.toml`, the files beside it, and the codec.

use std::collections::BTreeSet;
use std::path::Path;

use conformance::vectors::{Expect, Manifest, Vector, crc32, folder, outcome, sha256};

/// Folders of codestreams; each file in them has an entry.
const FOLDERS: [&str; 4] = ["v2", "streams", "handmade", "reject"];
/// A vector is small enough to read in a dump.
const MAX_BYTES: usize = 3 * 1024;
/// All of `vectors/`.
const MAX_FOLDER_BYTES: u64 = 1 << 20;

/// Checks all and prints counts; the error is a list of what is wrong, one a line.
pub(crate) fn run() -> Result<(), String> {
    let manifest = Manifest::read()?;
    let mut wrong = unlisted(&manifest)?;
    wrong.extend(repeated(&manifest));
    for data in &manifest.data {
        wrong.extend(check_data(&manifest, &data.id, &data.file, &data.sha256).err());
    }
    for vector in &manifest.vectors {
        wrong.extend(check_vector(&manifest, vector).err());
    }
    let bytes: usize = manifest.vectors.iter().filter_map(|vector| vector.bytes).sum();
    let recipes = manifest.vectors.iter().filter(|vector| vector.input.is_some()).count();
    let rejected = manifest.vectors.iter().filter(|vector| matches!(vector.expect, Expect::Error(_))).count();
    println!(
        "{} vectors ({recipes} from recipes, {rejected} to be rejected), {bytes} bytes; {} data files; {} wrong",
        manifest.vectors.len(),
        manifest.data.len(),
        wrong.len()
    );
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}

fn check_data(manifest: &Manifest, id: &str, file: &str, checksum: &str) -> Result<(), String> {
    let bytes = std::fs::read(folder().join(file)).map_err(|error| format!("vectors/{file}: {error}"))?;
    if sha256(&bytes) != checksum {
        return Err(format!("vectors/{file}: not the recorded checksum"));
    }
    manifest.data_samples(id).map(|_| ())
}

fn check_vector(manifest: &Manifest, vector: &Vector) -> Result<(), String> {
    let Vector { id, file, .. } = vector;
    let name = Path::new(file).file_stem().and_then(|stem| stem.to_str());
    let folder_name = file.split('/').next().unwrap_or_default();
    if name != Some(id) || !FOLDERS.contains(&folder_name) {
        return Err(format!("{id}: its file is vectors/{{v2,streams,handmade,reject}}/{id}.wlc, not {file}"));
    }
    if vector.recipe().is_ok_and(|(_, recipe)| recipe.slack() == 0) {
        let found = Expect::Crc32(crc32(&manifest.samples(vector)?));
        if found != vector.expect {
            return Err(format!("{id}: the input is {found:?}, the entry expects {:?}", vector.expect));
        }
    }
    if !folder().join(file).exists() {
        return Err(format!(
            "vectors/{file} is missing; a new one is written by: cargo xtask vectors add {id}"
        ));
    }
    let bytes = vector.read()?;
    if vector.bytes != Some(bytes.len()) || vector.sha256 != Some(sha256(&bytes)) {
        return Err(format!("vectors/{file}: not the recorded length and checksum"));
    }
    check_length(vector, &bytes)?;
    if let Some(difference) = first_difference(&bytes, &manifest.build(vector)?) {
        return Err(format!("vectors/{file}: not what its recipe makes: {difference}"));
    }
    let found = outcome(&bytes);
    if found != vector.expect {
        return Err(format!("vectors/{file}: decodes to {found:?}, the entry expects {:?}", vector.expect));
    }
    Ok(())
}

pub(crate) fn check_length(vector: &Vector, bytes: &[u8]) -> Result<(), String> {
    if bytes.len() <= MAX_BYTES {
        return Ok(());
    }
    Err(format!("vectors/{}: {} bytes, {MAX_BYTES} at most", vector.file, bytes.len()))
}

/// Where two byte strings differ first, in words; `None` when they are equal.
pub(crate) fn first_difference(old: &[u8], new: &[u8]) -> Option<String> {
    if old == new {
        return None;
    }
    let common = old.iter().zip(new).take_while(|(old, new)| old == new).count();
    let byte = |bytes: &[u8]| bytes.get(common).map_or("the end".to_owned(), |byte| format!("{byte:02x}"));
    let (old_byte, new_byte) = (byte(old), byte(new));
    Some(format!(
        "first difference at byte {common}: {old_byte} -> {new_byte}; {} -> {} bytes",
        old.len(),
        new.len()
    ))
}

/// Identifiers and files that stand in more than one entry.
fn repeated(manifest: &Manifest) -> Vec<String> {
    let mut seen = BTreeSet::new();
    let names = manifest.vectors.iter().flat_map(|vector| [&vector.id, &vector.file]);
    let names = names.chain(manifest.data.iter().flat_map(|data| [&data.id, &data.file]));
    names.filter(|name| !seen.insert(*name)).map(|name| format!("{name}: in more than one entry")).collect()
}

/// Files without an entry, and a folder that has grown too large.
fn unlisted(manifest: &Manifest) -> Result<Vec<String>, String> {
    let listed: BTreeSet<&str> = manifest.vectors.iter().map(|vector| vector.file.as_str()).collect();
    let data: BTreeSet<&str> = manifest.data.iter().map(|data| data.file.as_str()).collect();
    let own = ["MANIFEST.toml", "README.md"];
    let mut wrong = vec![];
    let mut total = 0;
    for inside in std::iter::once("").chain(FOLDERS) {
        for (path, bytes) in files(inside)? {
            total += bytes;
            let known = [&listed, &data].iter().any(|known| known.contains(path.as_str()));
            if !known && !own.contains(&path.as_str()) {
                wrong.push(format!("vectors/{path}: has no entry in MANIFEST.toml"));
            }
        }
    }
    if total > MAX_FOLDER_BYTES {
        wrong.push(format!("vectors/: {total} bytes, {MAX_FOLDER_BYTES} at most"));
    }
    Ok(wrong)
}

/// Path from `vectors/` and length of each file directly in a folder; of a folder that is not there, none.
fn files(inside: &str) -> Result<Vec<(String, u64)>, String> {
    let path = folder().join(inside);
    if !path.exists() {
        return Ok(vec![]);
    }
    let problem = |error: std::io::Error| format!("vectors/{inside}: {error}");
    let mut found = vec![];
    for entry in std::fs::read_dir(path).map_err(problem)? {
        let entry = entry.map_err(problem)?;
        let metadata = entry.metadata().map_err(problem)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if metadata.is_file() {
            let separator = if inside.is_empty() { "" } else { "/" };
            found.push((format!("{inside}{separator}{name}"), metadata.len()));
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_difference_is_told() {
        assert_eq!(first_difference(&[1, 2], &[1, 2]), None);
        let difference = first_difference(&[1, 2, 3], &[1, 0xFF, 3]).unwrap();
        assert_eq!(difference, "first difference at byte 1: 02 -> ff; 3 -> 3 bytes");
        let shorter = first_difference(&[1, 2], &[1]).unwrap();
        assert_eq!(shorter, "first difference at byte 1: 02 -> the end; 2 -> 1 bytes");
    }
}
