//! Whether writing a file would replace one that it is made from.

use std::fs;
use std::path::{Path, PathBuf};

use super::format::{self, Format};

/// The first of `files`, as a source tells them, that would not be what it is any more once `output` is written: it is
/// that, or the file of its samples, or lies in the folder that it replaces; or is a folder that it lies in.
///
/// Symbolic links are followed.
pub fn overwritten(files: &[PathBuf], output: &Path) -> Option<PathBuf> {
    let format = format::of_path(output);
    let written = format.map_or_else(|| vec![output.to_owned()], |format| format.writes(output));
    // Any other folder is in the way of a file, and stays.
    let is_folder = format.is_some_and(Format::takes_folders);
    let written: Vec<PathBuf> = written.iter().map(|path| resolved(path)).collect();
    let is_hit = |file: &&PathBuf| {
        let file = resolved(file);
        // Of a relation between a folder and what is in it, or of one file to itself.
        written.iter().any(|path| path.starts_with(&file) || is_folder && file.starts_with(path))
    };
    files.iter().find(is_hit).cloned()
}

/// The path without links, whether there is anything at its end or not.
fn resolved(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = || Some(fs::canonicalize(folder).ok()?.join(path.file_name()?));
    fs::canonicalize(path).ok().or_else(beside).unwrap_or_else(|| path.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_and_folders_of_a_source_are_known() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("a.raw"), "samples").unwrap();
        fs::create_dir(path("b.zarr")).unwrap();
        fs::create_dir(path("c")).unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink(path("a.raw"), path("link")).unwrap();
        let files = [path("a.raw"), path("b.zarr")];
        let cases = [
            ("a.raw", Some(0)),
            ("c/../a.raw", Some(0)),
            ("a.nhdr", Some(0)),
            ("a.mhd", Some(0)),
            ("a.nrrd", None),
            ("b.zarr", Some(1)),
            ("b.zarr/0", Some(1)),
            ("b.raw", None),
            ("none/a.raw", None),
            ("", None),
        ];
        for (output, expected) in cases {
            let found = overwritten(&files, &path(output));
            assert_eq!(found, expected.map(|file: usize| files[file].clone()), "{output}");
        }
        #[cfg(unix)]
        assert!(overwritten(&files, &path("link")).is_some());
        // A folder that is replaced with all that is in it.
        assert!(overwritten(&[path("b.zarr/zarr.json")], &path("b.zarr")).is_some());
        assert!(overwritten(&[], &path("a.raw")).is_none());
    }
}
