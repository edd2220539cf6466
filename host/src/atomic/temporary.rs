//! Files that are not in their place yet.

use std::fs::{self, File};
use std::io;
use std::path::Path;

use tempfile::{Builder, NamedTempFile};

use super::register::Pending;

/// A file that vanishes unless it is put into a place: even when the process is killed, where the system has files
/// without names (Linux, on most file systems); else it has a name like `.wavelift-1a2b3c.part` until then.
#[derive(Debug)]
pub(super) enum Temporary {
    #[cfg(target_os = "linux")]
    Nameless(File),
    Named(NamedTempFile),
}

impl Temporary {
    /// A file in `folder`, with the mode of ordinary new files.
    pub(super) fn create(folder: &Path) -> io::Result<(Self, Pending)> {
        #[cfg(target_os = "linux")]
        if let Some(file) = nameless::create(folder) {
            return Ok((Self::Nameless(file), Pending::nameless()));
        }
        Self::named(folder)
    }

    fn named(folder: &Path) -> io::Result<(Self, Pending)> {
        let (file, pending) = Pending::named(|| builder().tempfile_in(folder), NamedTempFile::path)?;
        Ok((Self::Named(file), pending))
    }

    pub(super) fn file(&self) -> &File {
        match self {
            #[cfg(target_os = "linux")]
            Self::Nameless(file) => file,
            Self::Named(file) => file.as_file(),
        }
    }

    /// Puts the file at `path`, in place of what is there.
    pub(super) fn persist(self, path: &Path) -> io::Result<()> {
        match self {
            #[cfg(target_os = "linux")]
            Self::Nameless(file) => nameless::persist(&file, path),
            Self::Named(file) => {
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
                let (temporary, _pending) = create(folder.path()).unwrap();
                temporary.file().write_all(bytes).unwrap();
                temporary.persist(&path).unwrap();
                assert_eq!((fs::read(&path).unwrap(), files(folder.path())), (bytes.to_vec(), 1));
            }
            drop(create(folder.path()).unwrap());
            assert_eq!(files(folder.path()), 1);
            create(&folder.path().join("none")).unwrap_err();
            let (taken, _pending) = create(folder.path()).unwrap();
            taken.persist(&folder.path().join("none/a")).unwrap_err();
            assert_eq!(files(folder.path()), 1);
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_of_the_system_has_files_without_names() {
        let folder = Path::new("/dev/shm");
        if folder.is_dir() {
            assert!(matches!(Temporary::create(folder), Ok((Temporary::Nameless(_), _))));
        }
    }
}
