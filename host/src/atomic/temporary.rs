//! Files that are not in their place yet.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile};

/// Names that are to go when the program ends before their files are in place.
static NAMES: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Nothing is abandoned while this is held.
pub(super) fn names() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    NAMES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all files of this process that are not in their place yet, and keeps any from being made or put there.
///
/// Threads that try to wait for ever: it is for a program that ends at once, as on Ctrl-C.
pub fn abandon_all() {
    let mut names = names();
    remove_all(&mut names);
    std::mem::forget(names);
}

fn remove_all(names: &mut BTreeSet<PathBuf>) {
    for path in std::mem::take(names) {
        // What cannot be removed stays; nobody is left to be told. Others may still be writing into a folder.
        let is_gone = || fs::remove_file(&path).is_ok() || fs::remove_dir_all(&path).is_ok();
        let _ = (0..8).any(|_| is_gone());
    }
}

/// A name among [`NAMES`], until this is dropped.
#[derive(Debug)]
pub(super) struct Name(PathBuf);

impl Name {
    /// Makes a file or a folder, and notes its name.
    pub(super) fn of<T>(
        make: impl FnOnce() -> io::Result<T>,
        path: impl Fn(&T) -> &Path,
    ) -> io::Result<(T, Self)> {
        let mut names = names();
        let made = make()?;
        let path = path(&made).to_owned();
        names.insert(path.clone());
        Ok((made, Self(path)))
    }
}

impl Drop for Name {
    fn drop(&mut self) {
        names().remove(&self.0);
    }
}

/// A file that vanishes unless it is put into a place: even when the process is killed, where the system has files
/// without names (Linux, on most file systems); else it has a name like `.wavelift-1a2b3c.part` until then.
#[derive(Debug)]
pub(super) enum Temporary {
    #[cfg(target_os = "linux")]
    Nameless(File),
    /// The name outlives the file.
    Named(NamedTempFile, Name),
}

impl Temporary {
    /// A file in `folder`, with the mode of ordinary new files.
    pub(super) fn create(folder: &Path) -> io::Result<Self> {
        #[cfg(target_os = "linux")]
        if let Some(file) = nameless::create(folder) {
            return Ok(Self::Nameless(file));
        }
        Self::named(folder)
    }

    fn named(folder: &Path) -> io::Result<Self> {
        let (file, name) = Name::of(|| builder().tempfile_in(folder), NamedTempFile::path)?;
        Ok(Self::Named(file, name))
    }

    pub(super) fn file(&self) -> &File {
        match self {
            #[cfg(target_os = "linux")]
            Self::Nameless(file) => file,
            Self::Named(file, _) => file.as_file(),
        }
    }

    /// Puts the file at `path`, in place of what is there.
    pub(super) fn persist(self, path: &Path) -> io::Result<()> {
        match self {
            #[cfg(target_os = "linux")]
            Self::Nameless(file) => {
                let _nothing_is_abandoned_now = names();
                nameless::persist(&file, path)
            }
            Self::Named(file, _name) => {
                let _nothing_is_abandoned_now = names();
                file.persist(path)?;
                Ok(())
            }
        }
    }
}

fn builder() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(".wavelift-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The system takes from it what the umask forbids.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder
}

/// Files without names: `O_TMPFILE` in open(2), and `/proc/self/fd` in linkat(2).
#[cfg(target_os = "linux")]
mod nameless {
    use std::fs::{File, OpenOptions};
    use std::io;
    use std::os::fd::AsRawFd;
    use std::os::unix::fs::OpenOptionsExt;
    use std::path::Path;

    use rustix::fs::{AtFlags, CWD, OFlags, linkat};

    /// A file in `folder`, where it can be made and given a name later.
    pub(super) fn create(folder: &Path) -> Option<File> {
        let flags = i32::try_from(OFlags::TMPFILE.bits()).ok()?;
        let file = OpenOptions::new().read(true).write(true).custom_flags(flags).open(folder).ok()?;
        Path::new(&handle(&file)).exists().then_some(file)
    }

    /// Gives the file its name. An old file of that name is replaced by way of a temporary one, for a moment.
    pub(super) fn persist(file: &File, path: &Path) -> io::Result<()> {
        if link(file, path).is_ok() {
            return Ok(());
        }
        let named = super::builder().make_in(super::super::folder_of(path), |path| link(file, path))?;
        named.persist(path)?;
        Ok(())
    }

    fn link(file: &File, path: &Path) -> io::Result<()> {
        Ok(linkat(CWD, handle(file), CWD, path, AtFlags::SYMLINK_FOLLOW)?)
    }

    fn handle(file: &File) -> String {
        format!("/proc/self/fd/{}", file.as_raw_fd())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn files(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn files_with_and_without_names_come_into_place_or_vanish() {
        for create in [Temporary::create, Temporary::named] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a");
            for bytes in [b"1", b"2"] {
                let temporary = create(folder.path()).unwrap();
                temporary.file().write_all(bytes).unwrap();
                temporary.persist(&path).unwrap();
                assert_eq!((fs::read(&path).unwrap(), files(folder.path())), (bytes.to_vec(), 1));
            }
            drop(create(folder.path()).unwrap());
            assert_eq!(files(folder.path()), 1);
            create(&folder.path().join("none")).unwrap_err();
            let taken = create(folder.path()).unwrap();
            taken.persist(&folder.path().join("none/a")).unwrap_err();
            assert_eq!(files(folder.path()), 1);
        }
    }

    #[test]
    fn names_are_removed_where_work_is_abandoned() {
        let folder = tempfile::tempdir().unwrap();
        let Temporary::Named(file, name) = Temporary::named(folder.path()).unwrap() else { unreachable!() };
        assert!(names().contains(file.path()));
        let mut own = BTreeSet::from([file.path().to_owned(), folder.path().join("none")]);
        remove_all(&mut own);
        assert_eq!((own.len(), files(folder.path())), (0, 0));
        let path = file.path().to_owned();
        drop((file, name));
        assert!(!names().contains(&path));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_of_the_system_has_files_without_names() {
        let folder = Path::new("/dev/shm");
        if folder.is_dir() {
            assert!(matches!(Temporary::create(folder), Ok(Temporary::Nameless(_))));
        }
    }
}
