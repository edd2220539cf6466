//! Values that lie in several files, one after another: a slice in each, or a time step.

use std::io;
use std::path::{Path, PathBuf};

use super::input::Input;
use super::stored::{Encoding, Place, Stored};
use super::{ByteOrder, ElementType, FileFormat, Header, Metadata, ReadError, Source};

/// Most files of one data set.
const MAX_FILES: u64 = 1 << 20;

/// How values lie in each file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PartLayout {
    pub(super) encoding: Encoding,
    pub(super) byte_order: ByteOrder,
    pub(super) line_skip: u64,
    /// Bytes to pass over before the first value; `None` if the last value ends where the file does.
    pub(super) byte_skip: Option<u64>,
}

impl PartLayout {
    /// Values of `header` in one file, which stands where lines and bytes are passed over from.
    pub(super) fn open(&self, mut input: Input, header: Header) -> Result<Stored, ReadError> {
        input.skip_lines(self.line_skip)?;
        let skip = match (self.byte_skip, input.left()) {
            (Some(bytes), _) => bytes,
            (None, left) => left.unwrap_or(0).saturating_sub(header.bytes().unwrap_or(u64::MAX)),
        };
        let place =
            Place { encoding: self.encoding, byte_order: self.byte_order, skip, is_open_ended: false };
        Stored::new(input, header, place)
    }
}

/// A source of values in several files, each of which has as many; one of them is open at a time.
pub(super) struct Joined {
    header: Header,
    files: Vec<PathBuf>,
    layout: PartLayout,
    /// What one file holds, as a line of values.
    part: Header,
    part_bytes: u64,
    open: Option<(usize, Stored)>,
    at: u64,
}

impl Joined {
    /// Values of `header` in `files`, each of which is looked at when it is needed.
    ///
    /// `None` if the values cannot be divided among so many files.
    pub(super) fn new(header: Header, files: Vec<PathBuf>, layout: PartLayout) -> Option<Self> {
        let bytes = header.bytes()?;
        let count = files.len() as u64;
        let sample = header.element.bytes() as u64;
        if count == 0 || !bytes.is_multiple_of(count * sample) {
            return None;
        }
        let part = line_of(bytes / count / sample, header.element);
        Some(Self { header, files, layout, part, part_bytes: bytes / count, open: None, at: 0 })
    }

    /// The file that holds byte `at`, where that is next.
    fn stored(&mut self) -> Result<&mut Stored, ReadError> {
        let index = (self.at / self.part_bytes) as usize;
        let path =
            self.files.get(index).ok_or_else(|| ReadError::BeyondEnd { path: self.files[0].clone() })?;
        let stored = match self.open.take() {
            Some((open, stored)) if open == index => stored,
            _ => {
                let mut stored = self.layout.open(Input::open(path)?, self.part.clone())?;
                stored.seek(self.at % self.part_bytes)?;
                stored
            }
        };
        Ok(&mut self.open.insert((index, stored)).1)
    }
}

/// A line of single values.
fn line_of(values: u64, element: ElementType) -> Header {
    Header::scalar([values, 1, 1], element, Metadata::plain(1, FileFormat::Raw))
}

impl Source for Joined {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        let mut rest = out;
        while !rest.is_empty() {
            let left = self.part_bytes - self.at % self.part_bytes;
            let (piece, more) = rest.split_at_mut(left.min(rest.len() as u64) as usize);
            self.stored()?.read(piece)?;
            self.at += piece.len() as u64;
            rest = more;
        }
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.at = position;
        match &mut self.open {
            Some((open, stored)) if *open as u64 == position / self.part_bytes => {
                stored.seek(position % self.part_bytes)
            }
            _ => Ok(()),
        }
    }

    fn is_random(&self) -> bool {
        self.layout.encoding == Encoding::Raw
    }

    fn files(&self) -> Vec<PathBuf> {
        self.files.clone()
    }
}

/// Names of files in a pattern such as `slice%03d.raw`, for numbers from `first` to `last` by `step`, beside `header`.
///
/// `None` if the pattern is none, the step leads nowhere, or the files are too many.
pub(super) fn numbered(
    header: &Path,
    pattern: &str,
    first: i64,
    last: i64,
    step: i64,
) -> Option<Vec<PathBuf>> {
    let (before, rest) = pattern.split_once('%')?;
    let end = rest.find(['d', 'i', 'u'])?;
    let (flags, after) = (&rest[..end], &rest[end + 1..]);
    let width: usize = if flags.is_empty() { 0 } else { flags.parse().ok().filter(|width| *width < 64)? };
    let is_padded = flags.starts_with('0');
    let count = last.checked_sub(first)?.checked_div(step)?.checked_add(1)?;
    let count = u64::try_from(count).ok().filter(|count| (1..=MAX_FILES).contains(count))?;
    let name = |number: i64| match is_padded {
        true => format!("{before}{number:0width$}{after}"),
        false => format!("{before}{number:width$}{after}"),
    };
    Some((0..count as i64).map(|index| beside(header, &name(first + index * step))).collect())
}

/// Names of files, one in each line up to the end of `input`.
pub(super) fn listed(input: &mut Input) -> Result<Vec<PathBuf>, ReadError> {
    /// Most bytes of names that are read.
    const LIST_BYTES: u64 = 1 << 24;
    let mut text = Vec::new();
    let path = input.path().to_owned();
    io::Read::read_to_end(&mut io::Read::take(&mut *input, LIST_BYTES), &mut text)
        .map_err(|cause| ReadError::Io { path: path.clone(), cause })?;
    let text = String::from_utf8_lossy(&text);
    let names = text.lines().map(str::trim).filter(|name| !name.is_empty());
    Ok(names.take(MAX_FILES as usize).map(|name| beside(&path, name)).collect())
}

/// A file named in a header, in the header's folder unless it says another.
pub(super) fn beside(header: &Path, name: &str) -> PathBuf {
    header.parent().unwrap_or(Path::new("")).join(name)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn names_are_made_of_patterns() {
        let named = |pattern, first, last, step| {
            let names = numbered(Path::new("/a/b.nhdr"), pattern, first, last, step)?;
            Some(names.iter().map(|name| name.display().to_string()).collect::<Vec<_>>().join(" "))
        };
        assert_eq!(named("s%03d.raw", 8, 10, 1).unwrap(), "/a/s008.raw /a/s009.raw /a/s010.raw");
        assert_eq!(named("%d", 3, -1, -2).unwrap(), "/a/3 /a/1 /a/-1");
        assert_eq!(named("%2i.x", 9, 10, 1).unwrap(), "/a/ 9.x /a/10.x");
        for (pattern, first, last, step) in [
            ("none", 0, 1, 1),
            ("%x", 0, 1, 1),
            ("%999d", 0, 1, 1),
            ("%d", 0, 1, 0),
            ("%d", 0, 5, -1),
            ("%d", 0, i64::MAX, 1),
            ("%d", i64::MIN, i64::MAX, 1),
        ] {
            assert_eq!(named(pattern, first, last, step), None, "{pattern}");
        }
    }

    #[test]
    fn values_go_on_in_the_next_file() {
        let folder = tempfile::tempdir().unwrap();
        let files: Vec<PathBuf> = (0..3).map(|index| folder.path().join(format!("{index}.raw"))).collect();
        for (index, path) in files.iter().enumerate() {
            let values = (0..4).map(|value| (4 * index + value) as u8);
            fs::write(path, [b"line\nab".to_vec(), values.collect()].concat()).unwrap();
        }
        for byte_skip in [Some(2), None] {
            let layout = PartLayout {
                encoding: Encoding::Raw,
                byte_order: ByteOrder::Little,
                line_skip: 1,
                byte_skip,
            };
            let joined = |values| Joined::new(line_of(values, ElementType::U8), files.clone(), layout);
            assert!(joined(13).is_none());
            let mut source = joined(12).unwrap();
            for start in [0, 3, 4, 9] {
                let mut values = vec![0; 12 - start];
                source.seek(start as u64).unwrap();
                values.chunks_mut(5).for_each(|piece| source.read(piece).unwrap());
                assert_eq!(values, (start as u8..12).collect::<Vec<_>>());
            }
            assert!(matches!(source.read(&mut [0]), Err(ReadError::BeyondEnd { .. })));
        }
        fs::write(&files[1], b"line\nab123").unwrap();
        let layout = PartLayout {
            encoding: Encoding::Raw,
            byte_order: ByteOrder::Little,
            line_skip: 1,
            byte_skip: Some(2),
        };
        let mut source = Joined::new(line_of(12, ElementType::U8), files, layout).unwrap();
        assert!(matches!(source.read(&mut [0; 12]), Err(ReadError::SampleBytes { expected: 4, .. })));
    }
}
