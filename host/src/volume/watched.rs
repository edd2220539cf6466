//! A watch over the files of a source: whoever writes to them while they are read is noticed.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::{Header, ReadError, Source};

/// A source whose files are to stay what they were when it was opened.
///
/// Length and time of the last change are compared whenever its last value is read. Pipes and devices have neither,
/// and a file that is gone or replaced is no matter for a source that holds it open; one that opens it anew will tell.
pub(super) struct Watched {
    inner: Box<dyn Source>,
    stamps: Vec<(PathBuf, Stamp)>,
    bytes: u64,
    at: u64,
}

/// What changes with a file that is written to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Stamp {
    bytes: u64,
    modified: Option<SystemTime>,
}

impl Stamp {
    /// That of a file or folder; `None` for anything else.
    fn of(path: &Path) -> Option<Self> {
        let found = fs::metadata(path).ok()?;
        let is_stored = found.is_file() || found.is_dir();
        is_stored.then(|| Self { bytes: found.len(), modified: found.modified().ok() })
    }
}

impl Watched {
    pub(super) fn new(inner: Box<dyn Source>) -> Self {
        let files = inner.files().into_iter();
        let stamps = files.filter_map(|path| Stamp::of(&path).map(|stamp| (path, stamp))).collect();
        let bytes = inner.header().bytes().unwrap_or(u64::MAX);
        Self { inner, stamps, bytes, at: 0 }
    }

    fn check(&self) -> Result<(), ReadError> {
        let has_changed =
            |(path, stamp): &&(PathBuf, Stamp)| Stamp::of(path).is_some_and(|now| now != *stamp);
        match self.stamps.iter().find(has_changed) {
            Some((path, _)) => Err(ReadError::Changed { path: path.clone() }),
            None => Ok(()),
        }
    }
}

impl Source for Watched {
    fn header(&self) -> &Header {
        self.inner.header()
    }

    fn read(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        // Samples that cannot be decoded may be so because somebody writes them just now.
        let read = self.inner.read(out);
        self.at = self.at.saturating_add(out.len() as u64);
        if read.is_err() || self.at == self.bytes {
            self.check()?;
        }
        read
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.at = position;
        self.inner.seek(position)
    }

    fn is_random(&self) -> bool {
        self.inner.is_random()
    }

    fn hold_at_most(&mut self, bytes: u64) -> u64 {
        self.inner.hold_at_most(bytes)
    }

    fn files(&self) -> Vec<PathBuf> {
        self.inner.files()
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;
    use crate::volume::synthetic::{Kind, generate};
    use crate::volume::{ElementType, WriteOptions, create, open};

    /// Files of every way of reading that there is.
    const NAMES: [&str; 10] = [
        "a.nrrd",
        "a.npy",
        "a.nhdr",
        "a.mhd",
        "a.nii.gz",
        "a.tif",
        "a_%02d.png",
        "a_%02d.pgm",
        "a.vti",
        "a.vtk",
    ];

    #[test]
    fn writing_to_any_file_of_a_source_is_noticed() {
        let volume = generate(Kind::Waves, [9, 7, 5], ElementType::U8, 1);
        for name in NAMES {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(name);
            let header = Header { ..volume.header() };
            let mut sink = create(&path, &header, &WriteOptions::default()).unwrap().sink;
            sink.write(&volume.samples).unwrap();
            sink.finish().unwrap();
            let mut out = vec![0; volume.samples.len()];
            let mut source = open(&path, None).unwrap();
            source.read(&mut out).unwrap();
            assert!(out == volume.samples, "{name}");
            let files = source.files();
            let data = files.last().unwrap();
            fs::OpenOptions::new().append(true).open(data).unwrap().write_all(b"more").unwrap();
            source.seek(0).unwrap();
            let told = source.read(&mut out).unwrap_err();
            assert!(matches!(&told, ReadError::Changed { path } if path == data), "{name}: {told}");
        }
    }
}
