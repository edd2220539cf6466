//! Files that appear together or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::folder_of;
use super::register::Pending;

/// A folder of files under construction: they show in their folder only with [`commit`](Self::commit).
///
/// Until then they are in a temporary folder, which is removed when this value is dropped. Where the folder is a new
/// one, the temporary folder lies beside it and takes its name, so that all files appear at once. Where it is there
/// already, they are moved into it one after another, none over another file: if the program is killed between two,
/// those before remain. A program that is killed before leaves the temporary folder, `.wavelift-1a2b3c.part`.
#[derive(Debug)]
pub struct AtomicFolder {
    temporary: TempDir,
    pending: Pending,
    target: PathBuf,
    is_new: bool,
}

impl AtomicFolder {
    /// Makes a temporary folder for what will be in `target`.
    ///
    /// # Errors
    ///
    /// When the folder around `target`, or `target` if it is there, is missing, no folder, or not writable.
    pub fn create(target: &Path) -> io::Result<Self> {
        let target = if target.as_os_str().is_empty() { Path::new(".") } else { target };
        let is_new = !target.try_exists()?;
        let place = if is_new { folder_of(target) } else { target };
        if !place.is_dir() {
            let (kind, what) = match is_new {
                true => (io::ErrorKind::NotFound, "does not exist"),
                false => (io::ErrorKind::NotADirectory, "is no folder"),
            };
            return Err(io::Error::new(kind, format!("the folder {} {what}", place.display())));
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(".wavelift-").suffix(".part");
        if let Some(mode) = new_folder_mode() {
            builder.permissions(mode);
        }
        let (temporary, pending) = Pending::named(|| builder.tempdir_in(place), TempDir::path)?;
        Ok(Self { temporary, pending, target: target.to_owned(), is_new })
    }

    /// Where the files are to be written.
    pub fn path(&self) -> &Path {
        self.temporary.path()
    }

    /// Puts the files in their place.
    ///
    /// # Errors
    ///
    /// When one cannot be moved, as if another has its name by now; those that were moved are taken back.
    pub fn commit(self) -> io::Result<()> {
        let Self { temporary, pending, target, is_new } = self;
        if is_new {
            pending.appear(|| fs::rename(temporary.path(), &target))?;
            // The folder has another name now, and is nothing to be removed.
            let _moved = temporary.keep();
            sync(folder_of(&target));
            return Ok(());
        }
        let outcome = pending.appear(|| move_all(temporary.path(), &target));
        sync(&target);
        outcome
    }
}

/// Moves all files of a folder into another one, or none.
fn move_all(from: &Path, target: &Path) -> io::Result<()> {
    let mut moved = Vec::new();
    let outcome = fs::read_dir(from).and_then(|mut entries| {
        entries.try_for_each(|entry| {
            let to = target.join(entry?.file_name());
            move_file(from, &to)?;
            moved.push(to);
            Ok(())
        })
    });
    if outcome.is_err() {
        moved.iter().for_each(|path| {
            let _ = fs::remove_file(path);
        });
    }
    outcome
}

/// Moves the file that has the same name in `folder` to a path where none is.
fn move_file(folder: &Path, to: &Path) -> io::Result<()> {
    if fs::symlink_metadata(to).is_ok() {
        let text = format!("{} is there already", to.display());
        return Err(io::Error::new(io::ErrorKind::AlreadyExists, text));
    }
    fs::rename(folder.join(to.file_name().unwrap_or_default()), to)
}

/// Lets the storage keep the names in a folder. They are in their place already, and not every system can do this.
pub(super) fn sync(folder: &Path) {
    if let Ok(folder) = fs::File::open(folder) {
        let _ = folder.sync_all();
    }
}

/// Mode for a new folder, from which the system takes what the umask forbids.
#[cfg(unix)]
pub(super) fn new_folder_mode() -> Option<fs::Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(fs::Permissions::from_mode(0o777))
}

#[cfg(not(unix))]
pub(super) fn new_folder_mode() -> Option<fs::Permissions> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_new_folder_appears_with_all_its_files() {
        let around = tempfile::tempdir().unwrap();
        let target = around.path().join("new");
        let folder = AtomicFolder::create(&target).unwrap();
        fs::write(folder.path().join("a"), "1").unwrap();
        fs::write(folder.path().join("b"), "2").unwrap();
        assert!(!target.exists());
        folder.commit().unwrap();
        assert_eq!(names(&target), ["a", "b"]);
        assert_eq!(names(around.path()), ["new"]);
        let missing = AtomicFolder::create(&around.path().join("none/new")).unwrap_err();
        assert!(missing.to_string().ends_with("none does not exist"), "{missing}");
        drop(AtomicFolder::create(&around.path().join("other")).unwrap());
        assert_eq!(names(around.path()), ["new"]);
        AtomicFolder::create(&target.join("a")).unwrap_err();
    }

    #[test]
    fn files_join_those_of_a_folder_and_replace_none() {
        let around = tempfile::tempdir().unwrap();
        fs::write(around.path().join("old"), "0").unwrap();
        let folder = AtomicFolder::create(around.path()).unwrap();
        fs::write(folder.path().join("a"), "1").unwrap();
        folder.commit().unwrap();
        assert_eq!(names(around.path()), ["a", "old"]);

        let folder = AtomicFolder::create(around.path()).unwrap();
        for name in ["0", "old", "z"] {
            fs::write(folder.path().join(name), "2").unwrap();
        }
        let error = folder.commit().unwrap_err();
        assert!(error.to_string().ends_with("old is there already"), "{error}");
        assert_eq!(names(around.path()), ["a", "old"]);
        assert_eq!(fs::read(around.path().join("old")).unwrap(), b"0");
    }

    #[cfg(unix)]
    #[test]
    fn a_new_folder_has_the_usual_mode() {
        use std::os::unix::fs::PermissionsExt;
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let around = tempfile::tempdir().unwrap();
        let [plain, new] = ["plain", "new"].map(|name| around.path().join(name));
        fs::create_dir(&plain).unwrap();
        AtomicFolder::create(&new).unwrap().commit().unwrap();
        assert_eq!(mode(&new), mode(&plain));
    }
}
