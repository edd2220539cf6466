//! Folders that appear whole or not at all, and replace others whole.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use tempfile::TempDir;

use super::folder::{new_folder_mode, sync};
use super::register::Pending;
use super::{behind_links, folder_of};

/// A folder with all that is in it, under construction: it shows at its path only with [`commit`](Self::commit).
///
/// Unlike files of an [`AtomicFolder`](super::AtomicFolder), it is one thing, and takes the place of an old one.
/// Until then it is a temporary folder beside the target, which is removed with all its files when this value is
/// dropped. A folder at the path stays as it is up to the moment when the new one takes its place, whole for whole;
/// then it is removed. A symbolic link is followed, so that the link remains.
#[derive(Debug)]
pub struct AtomicTree {
    folder: TempDir,
    pending: Pending,
    path: PathBuf,
}

impl AtomicTree {
    /// Makes a temporary folder beside `path`.
    ///
    /// # Errors
    ///
    /// When the folder around is missing or not writable, or `path` is a file.
    pub fn create(path: &Path) -> io::Result<Self> {
        let path = behind_links(path)?;
        if path.exists() && !path.is_dir() {
            return Err(io::ErrorKind::NotADirectory.into());
        }
        let around = folder_of(&path);
        fs::metadata(around).map_err(|cause| match cause.kind() {
            io::ErrorKind::NotFound => {
                io::Error::new(cause.kind(), format!("the folder {} does not exist", around.display()))
            }
            _ => cause,
        })?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(".wavelift-").suffix(".part");
        if let Some(mode) = new_folder_mode() {
            builder.permissions(mode);
        }
        let (folder, pending) = Pending::named(|| builder.tempdir_in(around), TempDir::path)?;
        Ok(Self { folder, pending, path })
    }

    /// The temporary folder, to put files into.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Makes the storage keep all files, and puts the folder in its place. Where the system can exchange two folders
    /// (Linux), there is one at the path all the time; elsewhere an old one is moved aside for a moment.
    ///
    /// # Errors
    ///
    /// When any of this fails; the old folder, if there was one, is then still there.
    pub fn commit(self) -> io::Result<()> {
        let Self { folder, pending, path } = self;
        let (mut files, mut folders) = (Vec::new(), vec![folder.path().to_owned()]);
        while let Some(inner) = folders.pop() {
            for entry in fs::read_dir(inner)? {
                let entry = entry?;
                match entry.file_type()?.is_dir() {
                    true => folders.push(entry.path()),
                    false => files.push(entry.path()),
                }
            }
        }
        files.par_iter().try_for_each(|file| File::open(file)?.sync_all())?;
        pending.appear(|| match path.is_dir() {
            true => replace(folder.path(), &path),
            false => fs::rename(folder.path(), &path),
        })?;
        sync(folder_of(&path));
        // What has the temporary name now is the old folder, if there was one.
        match folder.close() {
            Err(cause) if cause.kind() != io::ErrorKind::NotFound => Err(cause),
            _ => Ok(()),
        }
    }
}

/// Exchanges a new folder with the old one at `path`.
#[cfg(target_os = "linux")]
fn replace(new: &Path, path: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    match renameat_with(CWD, new, CWD, path, RenameFlags::EXCHANGE) {
        Err(rustix::io::Errno::INVAL | rustix::io::Errno::NOSYS) => replace_in_turn(new, path),
        result => Ok(result?),
    }
}

#[cfg(not(target_os = "linux"))]
fn replace(new: &Path, path: &Path) -> io::Result<()> {
    replace_in_turn(new, path)
}

/// Moves the old folder aside, the new one to its place, and the old one to the new one's name.
fn replace_in_turn(new: &Path, path: &Path) -> io::Result<()> {
    let aside = new.with_extension("old");
    fs::rename(path, &aside)?;
    if let Err(cause) = fs::rename(new, path) {
        fs::rename(&aside, path)?;
        return Err(cause);
    }
    fs::rename(aside, new)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_folder_shows_when_it_is_whole_and_replaces_the_old_one() {
        let around = tempfile::tempdir().unwrap();
        let path = around.path().join("a");
        for name in ["one", "two"] {
            let folder = AtomicTree::create(&path).unwrap();
            fs::create_dir(folder.path().join("inner")).unwrap();
            fs::write(folder.path().join("inner").join(name), name).unwrap();
            assert_eq!(path.exists(), name == "two");
            folder.commit().unwrap();
            assert_eq!(names_in(&path.join("inner")), [name]);
            assert_eq!(names_in(around.path()), ["a"]);
        }
        let abandoned = AtomicTree::create(&path).unwrap();
        fs::write(abandoned.path().join("three"), "").unwrap();
        drop(abandoned);
        assert_eq!(names_in(around.path()), ["a"]);
        assert_eq!(names_in(&path), ["inner"]);
        let new = around.path().join(".new.part");
        fs::create_dir(&new).unwrap();
        replace_in_turn(&new, &path).unwrap();
        assert_eq!((names_in(&path), names_in(&new)), (vec![], vec!["inner".to_owned()]));
    }

    #[test]
    fn files_and_missing_folders_are_errors() {
        let around = tempfile::tempdir().unwrap();
        let file = around.path().join("file");
        fs::write(&file, "").unwrap();
        assert_eq!(AtomicTree::create(&file).unwrap_err().kind(), io::ErrorKind::NotADirectory);
        let missing = AtomicTree::create(&around.path().join("none/a")).unwrap_err();
        assert!(missing.to_string().ends_with("none does not exist"), "{missing}");
        assert_eq!(names_in(around.path()), ["file"]);
    }
}
