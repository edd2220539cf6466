//! NumPy's archives of arrays (`.npz`): ZIP files with a `.npy` file for each array.
//!
//! Source: NumPy, `numpy.savez` and `numpy.savez_compressed`, which store members as they are or by Deflate.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use flate2::read::DeflateDecoder;
use rawzip::{CompressionMethod, RECOMMENDED_BUFFER_SIZE, ReaderAt, ZipArchive, ZipArchiveEntryWayfinder};

use super::NpyError;
use crate::volume::error::excerpt;
use crate::volume::format::{Format, array_of, has_extension};
use crate::volume::input::Input;
use crate::volume::{Created, FileFormat, Header, ReadError, Source, WriteError, WriteOptions};

/// A byte of Deflate stands for at most so many, beside a few at the ends.
const DEFLATE_RATIO: u64 = 1032;

/// Names of arrays that a message has at most.
const MOST_NAMES: usize = 16;

/// NumPy's archive of arrays, which is read only.
pub(in crate::volume) struct Npz;

impl Format for Npz {
    fn format(&self) -> FileFormat {
        FileFormat::Npy
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(&array_of(path, &["npz"]).0, &["npz"])
    }

    fn open(&self, path: &Path) -> Result<Box<dyn Source>, ReadError> {
        let (path, name) = array_of(path, &["npz"]);
        open(Input::open(&path)?, name.as_deref())
    }

    fn open_input(&self, input: Input) -> Result<Box<dyn Source>, ReadError> {
        open(input, None)
    }

    fn create(&self, path: &Path, _: &Header, _: &WriteOptions) -> Result<Created, WriteError> {
        let what = "an archive of arrays: write .npy".to_owned();
        Err(WriteError::CannotHold { path: path.to_owned(), format: FileFormat::Npy, what })
    }
}

/// An array of an archive.
struct Member {
    name: String,
    place: ZipArchiveEntryWayfinder,
    method: CompressionMethod,
}

/// Opens the array of that name, or the only one.
fn open(input: Input, wanted: Option<&str>) -> Result<Box<dyn Source>, ReadError> {
    let path = input.path().to_owned();
    let fault = |cause| ReadError::Npy { path: path.clone(), cause };
    let members = || {
        let mut buffer = vec![0; RECOMMENDED_BUFFER_SIZE];
        let archive = ZipArchive::from_seekable(input, &mut buffer)?;
        let mut entries = archive.entries(&mut buffer);
        let mut members = Vec::new();
        while let Some(entry) = entries.next_entry()? {
            let name = String::from_utf8_lossy(entry.file_path().as_ref()).into_owned();
            if let Some(name) = name.strip_suffix(".npy") {
                let (place, method) = (entry.wayfinder(), entry.compression_method());
                members.push(Member { name: name.to_owned(), place, method });
            }
        }
        Ok::<_, rawzip::Error>((archive, members))
    };
    let (archive, mut members) =
        members().map_err(|cause| fault(NpyError::Archive { cause: cause.to_string() }))?;
    let found = match wanted {
        Some(wanted) => members.iter().position(|member| member.name == wanted),
        None => (members.len() == 1).then_some(0),
    };
    let Some(found) = found else { return Err(fault(NpyError::Arrays { names: names(&members) })) };
    let file = extracted(&archive, &members.swap_remove(found)).map_err(|cause| match cause.kind() {
        io::ErrorKind::InvalidData | io::ErrorKind::UnexpectedEof => {
            fault(NpyError::Archive { cause: cause.to_string() })
        }
        _ => ReadError::Io { path: path.clone(), cause },
    })?;
    super::open(Input::of_file(file, &path)?)
}

fn names(members: &[Member]) -> String {
    let mut names: Vec<String> =
        members.iter().take(MOST_NAMES).map(|member| excerpt(&member.name)).collect();
    if members.len() > MOST_NAMES {
        names.push(format!("{} more", members.len() - MOST_NAMES));
    }
    match names.is_empty() {
        true => "no array".to_owned(),
        false => format!("the arrays {}", names.join(", ")),
    }
}

/// A nameless temporary file of an array, at its beginning.
fn extracted(archive: &ZipArchive<impl ReaderAt>, member: &Member) -> io::Result<File> {
    let invalid = |cause: String| io::Error::new(io::ErrorKind::InvalidData, cause);
    let entry = archive.get_entry(member.place).map_err(|cause| invalid(cause.to_string()))?;
    let (start, end) = entry.compressed_data_range();
    let bytes = member.place.uncompressed_size_hint();
    let decoder: Box<dyn Read + '_> = match member.method {
        CompressionMethod::STORE => Box::new(entry.reader()),
        CompressionMethod::DEFLATE => Box::new(DeflateDecoder::new(entry.reader())),
        other => return Err(invalid(format!("it is compressed by method {other:?}, which is not read"))),
    };
    if bytes / DEFLATE_RATIO > end.saturating_sub(start) {
        return Err(invalid("it promises more than its bytes can stand for".to_owned()));
    }
    let mut file = tempfile::tempfile()?;
    io::copy(&mut entry.verifying_reader(decoder).take(bytes.saturating_add(1)), &mut file)?;
    file.flush()?;
    io::Seek::rewind(&mut file)?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use rawzip::ZipArchiveWriter;

    use super::*;
    use crate::volume::{Fault, Volume, read_all};

    /// A file of the numbers from `first` on.
    fn array(first: u8) -> Vec<u8> {
        let literal = b"{'descr': '|u1', 'fortran_order': False, 'shape': (3, 40), }\n";
        let length = (literal.len() as u16).to_le_bytes();
        let values: Vec<u8> = (0..120).map(|value| first + value).collect();
        [super::super::MAGIC, &[1, 0], &length, literal, &values].concat()
    }

    fn archive(names: &[&str], method: CompressionMethod) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut archive = ZipArchiveWriter::new(&mut bytes);
        for (first, name) in (0..).zip(names) {
            let (mut entry, config) = archive.new_file(name).compression_method(method).start().unwrap();
            let encoder: Box<dyn Write + '_> = match method {
                CompressionMethod::STORE => Box::new(&mut entry),
                _ => Box::new(flate2::write::DeflateEncoder::new(&mut entry, flate2::Compression::best())),
            };
            let mut writer = config.wrap(encoder);
            writer.write_all(&array(first)).unwrap();
            let (encoder, descriptor) = writer.finish().unwrap();
            drop(encoder);
            entry.finish(descriptor).unwrap();
        }
        archive.finish().unwrap();
        bytes
    }

    fn read(bytes: &[u8], name: Option<&str>) -> Result<Volume, ReadError> {
        read_all(Path::new("memory"), open(Input::from_bytes(bytes), name)?)
    }

    #[test]
    fn the_only_array_is_read_or_one_by_name() {
        for method in [CompressionMethod::STORE, CompressionMethod::DEFLATE] {
            let one = read(&archive(&["readme.txt", "a.npy"], method), None).unwrap();
            assert_eq!((one.extent, one.samples[0]), ([40, 3, 1], 1));
            let two = archive(&["a.npy", "b.npy"], method);
            assert_eq!(read(&two, Some("b")).unwrap().samples[0], 1);
            for name in [None, Some("c")] {
                let told = read(&two, name).unwrap_err().to_string();
                assert!(told.contains("the arrays \"a\", \"b\": give one as FILE#NAME"), "{told}");
            }
        }
        let none = archive(&["a.txt"], CompressionMethod::STORE);
        assert!(read(&none, None).unwrap_err().to_string().contains("it holds no array"));
    }

    #[test]
    fn damaged_archives_are_errors() {
        for method in [CompressionMethod::STORE, CompressionMethod::DEFLATE] {
            let whole = archive(&["a.npy"], method);
            let expected = read(&whole, None).unwrap();
            for end in 0..whole.len() {
                assert_eq!(read(&whole[..end], None).unwrap_err().kind(), Fault::Data, "{end}");
            }
            for at in 0..whole.len() {
                let mut other = whole.clone();
                other[at] ^= 0x41;
                // Dates and other marks may be any.
                assert!(
                    read(&other, None).is_ok_and(|found| found.samples == expected.samples)
                        || read(&other, None).is_err()
                );
            }
        }
    }
}
