//! Data sets whose files hold planes, each decoded or encoded as a whole.

use std::path::{Path, PathBuf};

use super::{Header, ReadError, Sink, Source, WriteError};

/// Planes that can be had in any order.
pub(super) trait Planes: Send {
    /// Fills `out` with plane `index`, its values as [`Header`] orders them; planes are counted along z, then time.
    fn read(&mut self, index: u64, out: &mut [u8]) -> Result<(), ReadError>;

    /// The files that they are in, if there are others than the one that was opened.
    fn files(&self) -> Option<Vec<PathBuf>> {
        None
    }
}

/// A source of planes. At most one is held: that of which a part was read.
pub(super) struct PlaneSource<P> {
    header: Header,
    path: PathBuf,
    planes: P,
    held: Vec<u8>,
    /// Which plane is held.
    index: Option<u64>,
    plane_bytes: u64,
    bytes: u64,
    at: u64,
}

impl<P: Planes> PlaneSource<P> {
    /// The planes that `header` promises, which are checked to be there as far as the file's length can tell.
    ///
    /// # Errors
    /// [`ReadError::TooLarge`] if 64 bits do not count the bytes, or memory does not hold a plane.
    pub(super) fn new(path: &Path, header: Header, planes: P) -> Result<Self, ReadError> {
        let too_large = |bytes| ReadError::TooLarge { path: path.to_owned(), bytes };
        let plane_bytes = header.plane_bytes().ok_or_else(|| too_large(u64::MAX))?;
        let bytes = header.bytes().ok_or_else(|| too_large(u64::MAX))?;
        let fits =
            usize::try_from(plane_bytes).is_ok_and(|plane| Vec::<u8>::new().try_reserve_exact(plane).is_ok());
        if !fits {
            return Err(too_large(plane_bytes));
        }
        Ok(Self {
            header,
            path: path.to_owned(),
            planes,
            held: Vec::new(),
            index: None,
            plane_bytes,
            bytes,
            at: 0,
        })
    }

    /// Makes plane `index` the one that is held.
    fn hold(&mut self, index: u64) -> Result<(), ReadError> {
        if self.index != Some(index) {
            self.index = None;
            if self.held.is_empty() {
                self.held = vec![0; self.plane_bytes as usize];
            }
            self.planes.read(index, &mut self.held)?;
            self.index = Some(index);
        }
        Ok(())
    }
}

impl<P: Planes> Source for PlaneSource<P> {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&mut self, mut out: &mut [u8]) -> Result<(), ReadError> {
        if out.len() as u64 > self.bytes.saturating_sub(self.at) {
            return Err(ReadError::BeyondEnd { path: self.path.clone() });
        }
        while !out.is_empty() {
            let (index, start) = (self.at / self.plane_bytes, self.at % self.plane_bytes);
            let count = (self.plane_bytes - start).min(out.len() as u64) as usize;
            let (now, later) = out.split_at_mut(count);
            if count as u64 == self.plane_bytes && self.index != Some(index) {
                self.planes.read(index, now)?;
            } else {
                self.hold(index)?;
                now.copy_from_slice(&self.held[start as usize..][..count]);
            }
            self.at += count as u64;
            out = later;
        }
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.at = position;
        Ok(())
    }

    fn is_random(&self) -> bool {
        true
    }

    fn files(&self) -> Vec<PathBuf> {
        self.planes.files().unwrap_or_else(|| vec![self.path.clone()])
    }
}

/// Where planes go, in their order.
pub(super) trait PlaneWriter: Send {
    /// Takes the next plane.
    fn write(&mut self, plane: &[u8]) -> Result<(), WriteError>;

    /// Puts the file in its place.
    fn finish(self: Box<Self>) -> Result<(), WriteError>;
}

/// A sink that puts planes together.
pub(super) struct PlaneSink {
    writer: Box<dyn PlaneWriter>,
    path: PathBuf,
    plane: Vec<u8>,
    plane_bytes: u64,
    expected: u64,
    written: u64,
}

impl PlaneSink {
    /// Planes of `header` for the file that will be at `path`.
    pub(super) fn new(path: &Path, header: &Header, writer: Box<dyn PlaneWriter>) -> Self {
        let [plane_bytes, expected] =
            [header.plane_bytes(), header.bytes()].map(|bytes| bytes.unwrap_or(u64::MAX));
        Self { writer, path: path.to_owned(), plane: Vec::new(), plane_bytes, expected, written: 0 }
    }
}

impl Sink for PlaneSink {
    fn write(&mut self, mut values: &[u8]) -> Result<(), WriteError> {
        self.written += values.len() as u64;
        if self.written > self.expected {
            let (expected, found) = (self.expected, self.written);
            return Err(WriteError::SampleBytes { path: self.path.clone(), expected, found });
        }
        while !values.is_empty() {
            let missing = self.plane_bytes - self.plane.len() as u64;
            let (now, later) = values.split_at(missing.min(values.len() as u64) as usize);
            if now.len() as u64 == self.plane_bytes {
                self.writer.write(now)?;
            } else {
                self.plane.extend_from_slice(now);
                if self.plane.len() as u64 == self.plane_bytes {
                    self.writer.write(&self.plane)?;
                    self.plane.clear();
                }
            }
            values = later;
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), WriteError> {
        let Self { writer, path, expected, written, .. } = *self;
        if written != expected {
            return Err(WriteError::SampleBytes { path, expected, found: written });
        }
        writer.finish()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use super::*;
    use crate::volume::{ElementType, Metadata};

    fn header() -> Header {
        Header { steps: 2, ..Header::scalar([3, 2, 2], ElementType::U8, Metadata::default()) }
    }

    struct Counted(Vec<u64>);

    impl Planes for Counted {
        fn read(&mut self, index: u64, out: &mut [u8]) -> Result<(), ReadError> {
            self.0.push(index);
            (0..).zip(out).for_each(|(at, value)| *value = index as u8 * 6 + at);
            Ok(())
        }
    }

    #[test]
    fn planes_are_decoded_once_as_they_are_read_in_order() {
        for piece in 1..24 {
            let mut source = PlaneSource::new(Path::new("a"), header(), Counted(vec![])).unwrap();
            let mut all = [0; 24];
            all.chunks_mut(piece).for_each(|part| source.read(part).unwrap());
            assert!(all.iter().copied().eq(0..24));
            assert_eq!(source.planes.0, [0, 1, 2, 3], "{piece}");
            source.read(&mut [0]).unwrap_err();
            source.seek(7).unwrap();
            source.read(&mut all[..2]).unwrap();
            assert_eq!(all[..2], [7, 8]);
        }
    }

    struct Kept(Arc<Mutex<Vec<Vec<u8>>>>);

    impl PlaneWriter for Kept {
        fn write(&mut self, plane: &[u8]) -> Result<(), WriteError> {
            self.0.lock().unwrap().push(plane.to_vec());
            Ok(())
        }

        fn finish(self: Box<Self>) -> Result<(), WriteError> {
            Ok(())
        }
    }

    #[test]
    fn planes_are_put_together_from_any_pieces() {
        let all: Vec<u8> = (0..24).collect();
        for piece in 1..=24 {
            let planes = Arc::new(Mutex::new(vec![]));
            let mut sink =
                Box::new(PlaneSink::new(Path::new("a"), &header(), Box::new(Kept(Arc::clone(&planes)))));
            all.chunks(piece).for_each(|part| sink.write(part).unwrap());
            sink.write(&[0]).unwrap_err();
            assert_eq!(planes.lock().unwrap().concat(), all);
            assert_eq!(planes.lock().unwrap().len(), 4);
            sink.finish().unwrap_err();
        }
    }
}
