//! Output that appears whole or not at all.

mod folder;
mod register;
mod temporary;
mod tree;

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

pub use folder::AtomicFolder;
use register::Pending;
pub use register::abandon_all;
use temporary::Temporary;
pub use tree::AtomicTree;

/// A file under construction: what is written shows at its path only with [`commit`](Self::commit).
///
/// Until then the bytes are in a temporary file in the folder of the target, which is gone when this value is dropped.
/// On Linux and most of its file systems that file has no name, and is gone too when the process is killed; elsewhere
/// a killed process leaves it behind, under a name like `.wavelift-1a2b3c.part`. An old file at the path stays as it is up to the moment when the new one takes its place; a symbolic link is
/// followed, so that the link remains and the file behind it is replaced, or made if it is not there. A new file gets
/// the mode that the process's umask gives, a replaced one keeps its own.
///
/// A device, a FIFO, and anything in `/dev` or `/proc` (such as `/dev/stdout`) cannot be replaced: bytes go straight
/// into it as they come. Writes are buffered either way.
///
/// ```
/// use std::io::Write;
/// use wavelift_host::atomic::AtomicFile;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("new.raw");
/// let mut file = AtomicFile::create(&path)?;
/// file.write_all(b"samples")?;
/// assert!(!path.exists());
/// file.commit()?;
/// assert_eq!(std::fs::read(&path)?, b"samples");
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct AtomicFile {
    target: Target,
    pending: Pending,
}

#[derive(Debug)]
enum Target {
    Replaced { file: BufWriter<File>, temporary: Temporary, path: PathBuf },
    Direct(BufWriter<File>),
}

impl AtomicFile {
    /// Opens a temporary file beside `path`, or `path` itself where it cannot be replaced.
    ///
    /// # Errors
    ///
    /// When the folder is missing or not writable, `path` is a folder or a read-only file, links lead in a circle, or a
    /// device cannot be opened.
    pub fn create(path: &Path) -> io::Result<Self> {
        let path = behind_links(path)?;
        if is_direct(&path) {
            let file = OpenOptions::new().write(true).open(path)?;
            return Ok(Self { target: Target::Direct(BufWriter::new(file)), pending: Pending::nameless() });
        }
        if path.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        let folder = folder_of(&path);
        fs::metadata(folder).map_err(|cause| match cause.kind() {
            io::ErrorKind::NotFound => {
                io::Error::new(cause.kind(), format!("the folder {} does not exist", folder.display()))
            }
            _ => cause,
        })?;
        let old = fs::metadata(&path);
        if old.as_ref().is_ok_and(|old| old.permissions().readonly()) {
            let words = "it is there already, and read-only: give another name, or remove it";
            return Err(io::Error::new(io::ErrorKind::PermissionDenied, words));
        }
        let (temporary, pending) = Temporary::create(folder)?;
        if let Ok(old) = old {
            temporary.file().set_permissions(old.permissions())?;
        }
        let file = BufWriter::new(temporary.file().try_clone()?);
        Ok(Self { target: Target::Replaced { file, temporary, path }, pending })
    }

    /// Writes what is buffered, makes the storage keep it, and puts the file in its place; where the system can do so
    /// for folders, the storage keeps its name there as well.
    ///
    /// # Errors
    ///
    /// When any of the three fails; the old file, if there was one, is then still there, and no other.
    pub fn commit(self) -> io::Result<()> {
        Self::commit_in_turn([self]).map_err(|(_, cause)| cause)
    }

    /// Commits several files, which appear one after another, but all of them where the program is to end meanwhile.
    ///
    /// # Errors
    ///
    /// As [`commit`](Self::commit), with the index of the file that fails; those before it may have appeared.
    pub(crate) fn commit_in_turn<const N: usize>(files: [Self; N]) -> Result<(), (usize, io::Error)> {
        let (mut stored, mut pending) = (Vec::new(), Vec::new());
        for (index, file) in files.into_iter().enumerate() {
            stored.push(file.target.store().map_err(|cause| (index, cause))?);
            pending.push(file.pending);
        }
        Pending::appear_together(pending, || {
            let files = stored.into_iter().enumerate();
            let mut placed = files.filter_map(|(index, file)| Some((index, file?)));
            placed.try_for_each(|(index, (temporary, path))| {
                temporary.persist(&path).map_err(|cause| (index, cause))?;
                folder::sync(folder_of(&path));
                Ok(())
            })
        })
    }
}

impl Target {
    /// Writes what is buffered, and makes the storage keep it: the file that is to be put in its place, if it is one.
    fn store(self) -> io::Result<Option<(Temporary, PathBuf)>> {
        match self {
            Self::Direct(mut file) => file.flush().map(|()| None),
            Self::Replaced { file, temporary, path } => {
                file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
                Ok(Some((temporary, path)))
            }
        }
    }
}

impl AtomicFile {
    /// Writes over bytes that were written before, such as a length that is known only now, and goes back to the end.
    /// Does nothing where bytes go straight into a device or a pipe, and are gone.
    ///
    /// # Errors
    ///
    /// When the system cannot write.
    pub(crate) fn overwrite(&mut self, position: u64, bytes: &[u8]) -> io::Result<()> {
        let Target::Replaced { file, .. } = &mut self.target else { return Ok(()) };
        file.seek(SeekFrom::Start(position))?;
        file.write_all(bytes)?;
        file.seek(SeekFrom::End(0))?;
        Ok(())
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.target {
            Target::Replaced { file, .. } => file.write(bytes),
            Target::Direct(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.target {
            Target::Replaced { file, .. } => file.flush(),
            Target::Direct(file) => file.flush(),
        }
    }
}

/// Links that are followed one after another; Linux follows as many.
const MAX_LINKS: usize = 40;

/// What `path` leads to through symbolic links, whether that is there or not, or the link that is direct already.
fn behind_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..=MAX_LINKS {
        match fs::read_link(&path) {
            Ok(next) if !is_direct(&path) => path = folder_of(&path).join(next),
            _ => return Ok(path),
        }
    }
    // The system's own error for so many links.
    fs::canonicalize(path)
}

/// Whether bytes must go straight into `path`: it is no regular file, or its folder belongs to the system.
fn is_direct(path: &Path) -> bool {
    let special = fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    let folder = fs::canonicalize(folder_of(path)).unwrap_or_default();
    special || folder == Path::new("/dev") || folder.starts_with("/proc")
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use std::fs::Permissions;

    use super::*;

    fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut file = AtomicFile::create(path)?;
        file.write_all(bytes)?;
        file.commit()
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn an_abandoned_file_leaves_the_old_one_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "old").unwrap();
        let mut file = AtomicFile::create(&path).unwrap();
        file.write_all(&[0; 100_000]).unwrap();
        file.flush().unwrap();
        assert!(names(folder.path()).len() <= 2);
        drop(file);
        assert_eq!(names(folder.path()), ["a"]);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        write(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["a"]);
    }

    #[test]
    fn missing_folders_and_folders_as_targets_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        let missing = AtomicFile::create(&folder.path().join("none/a")).unwrap_err();
        assert_eq!(missing.kind(), io::ErrorKind::NotFound);
        assert!(missing.to_string().ends_with("none does not exist"), "{missing}");
        let directory = AtomicFile::create(folder.path()).unwrap_err();
        assert_eq!(directory.kind(), io::ErrorKind::IsADirectory);
        assert!(names(folder.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn modes_are_those_of_ordinary_files_and_links_stay_links() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let folder = tempfile::tempdir().unwrap();
        let [plain, path, link] = ["plain", "new", "link"].map(|name| folder.path().join(name));
        File::create(&plain).unwrap();
        write(&path, b"1").unwrap();
        assert_eq!(mode(&path), mode(&plain));

        fs::set_permissions(&path, Permissions::from_mode(0o640)).unwrap();
        symlink("new", &link).unwrap();
        fs::set_permissions(&path, Permissions::from_mode(0o440)).unwrap();
        assert_eq!(write(&link, b"no").unwrap_err().kind(), io::ErrorKind::PermissionDenied);
        fs::set_permissions(&path, Permissions::from_mode(0o640)).unwrap();
        write(&link, b"2").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"2");
        assert_eq!(mode(&path), 0o640);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_to_files_that_are_not_there_yet() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let [links, link, file] = ["links", "links/a", "file"].map(|name| folder.path().join(name));
        fs::create_dir(&links).unwrap();
        symlink("b", &link).unwrap();
        symlink("../file", links.join("b")).unwrap();
        for bytes in [b"1", b"2"] {
            write(&link, bytes).unwrap();
            assert_eq!(fs::read(&file).unwrap(), bytes);
        }
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(names(&links), ["a", "b"]);
        assert_eq!(names(folder.path()), ["file", "links"]);

        symlink("none/file", links.join("lost")).unwrap();
        let missing = write(&links.join("lost"), b"3").unwrap_err();
        assert!(missing.to_string().ends_with("links/none does not exist"), "{missing}");
        symlink("circle", links.join("circle")).unwrap();
        write(&links.join("circle"), b"4").unwrap_err();
        assert_eq!(names(&links), ["a", "b", "circle", "lost"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_straight() {
        write(Path::new("/dev/null"), b"gone").unwrap();
        let full = write(Path::new("/dev/full"), b"no room").unwrap_err();
        assert_eq!(full.kind(), io::ErrorKind::StorageFull);
        let missing = AtomicFile::create(Path::new("/dev/no-such-device")).unwrap_err();
        assert_eq!(missing.kind(), io::ErrorKind::NotFound);
        assert!(is_direct(Path::new("/dev/stdout")));
        assert!(is_direct(Path::new("/dev/fd/1")));
        assert!(!is_direct(Path::new("/dev/shm/volume.raw")));

        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("link");
        std::os::unix::fs::symlink("/dev/fd/1", &link).unwrap();
        assert!(is_direct(&behind_links(&link).unwrap()));
    }
}
