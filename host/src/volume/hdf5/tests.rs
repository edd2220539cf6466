//! Tests of HDF5 and NetCDF: files made by hand and by h5py.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;

use crate::volume::{self, ElementType, ReadError, Source, Volume, WriteOptions};

/// A file of HDF5 in zlib, made by h5py 3.16: `heat`, 1000 to 1023 of `>i2` in the shape (2, 3, 4), chunks of (1, 2, 4),
/// shuffled, in gzip; attributes `units` and `range`.
const HEAT: &str = "\
    eNrr9HBx4+WS4mLm4GCAgf9QECAB4RtAxedXOP/x93AJYmKoYBJCVggDXEwMjAwMbPwMQIolIzWxZDPMSFcG6oDi7WengZ3AyMDI\
    aMLAwMTMyMgElWOG0ixQGpc4Mw8DowAnTF6AgRXoamZubjEGRiYmkAcYwTKMYAjSwyHMAFLDArSJhYmZaz8jxBhRIZAsehDwmIMs\
    ZGMQAUmW5mWWFDNIMjICbWEAY4heDqgNYCYYgNgCQAW3oYY7wzwsgTssfKuLdrg5ergwMIpwwfwmB/X0hO/2Ff7OHt4w5/AAHcRQ\
    lJiXnsogwAELCgUGJkZE8MHoF8Dw+g/EOc8aFrg5ujgxMMJ8DHOMCJIjRLCIaWARs8Ei9iCX9TnDKBgFo2AUjIIBAe7O/j6MDNDa\
    CV5BIWhvNPU3+EfDbBSMglEwCkbBKBgFo2AUjIJRMApGwSgYaqAiLjmtrUFcP35v3edvd6sZlAzYS0FiQMDQxC9vX8t2kUHSgfky\
    RJ1+/P7a/x8/X89nUH7AfhWuzr7+/1/2iwxSFSzMAOgjcQ8=";

fn heat() -> Vec<u8> {
    let mut bytes = Vec::new();
    let packed = STANDARD.decode(HEAT).unwrap();
    ZlibDecoder::new(&packed[..]).read_to_end(&mut bytes).unwrap();
    bytes
}

/// A file of NetCDF in its first form: `time` of two doubles, and `wind` of 2 x 3 x 5 shorts from 0 on, of which every
/// time is a record.
fn wind() -> Vec<u8> {
    let numbers = |file: &mut Vec<u8>, numbers: &[u32]| {
        numbers.iter().for_each(|number| file.extend(number.to_be_bytes()));
    };
    let text = |file: &mut Vec<u8>, text: &str| {
        numbers(file, &[text.len() as u32]);
        file.extend(text.as_bytes());
        file.resize(file.len().next_multiple_of(4), 0);
    };
    // Two records; three dimensions, that of records without a count; no attributes of the whole; two variables.
    let mut file = b"CDF\x01".to_vec();
    numbers(&mut file, &[2, 10, 3]);
    for (name, count) in [("time", 0), ("y", 3), ("x", 5)] {
        text(&mut file, name);
        numbers(&mut file, &[count]);
    }
    numbers(&mut file, &[0, 0, 11, 2]);
    let variable = |file: &mut Vec<u8>, name: &str, axes: &[u32], place: [u32; 3]| {
        text(file, name);
        numbers(file, &[axes.len() as u32]);
        numbers(file, axes);
        // One attribute, a text.
        numbers(file, &[12, 1]);
        text(file, "units");
        numbers(file, &[2]);
        text(file, "m/s");
        numbers(file, &place);
    };
    let variables = |start: u32| {
        let mut variables = Vec::new();
        variable(&mut variables, "time", &[0], [6, 8, start]);
        variable(&mut variables, "wind", &[0, 1, 2], [3, 32, start + 8]);
        variables
    };
    let start = file.len() + variables(0).len();
    file.extend(variables(start as u32));
    for record in 0..2_i16 {
        file.extend(f64::from(record).to_be_bytes());
        (0..15).for_each(|value| file.extend((15 * record + value).to_be_bytes()));
        file.extend([0; 2]);
    }
    file
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    }
}

fn shorts(volume: &Volume) -> Vec<i16> {
    volume.samples.as_chunks().0.iter().map(|&bytes| i16::from_le_bytes(bytes)).collect()
}

fn message(path: &Path) -> String {
    match volume::read(path, None).unwrap_err() {
        ReadError::Format { cause, .. } => cause.to_string(),
        other => panic!("{other}"),
    }
}

#[test]
fn variables_are_read_with_what_is_said_of_them() {
    let folder = Folder::new();
    let expected = [("heat.h5", heat(), [4, 3, 2], 1000, "K"), ("wind.nc", wind(), [5, 3, 2], 0, "m/s")];
    for (name, bytes, extent, first, unit) in expected {
        let path = folder.file(name, &bytes);
        let found = volume::read(&path, None).unwrap();
        assert_eq!((found.extent, found.element), (extent, ElementType::I16));
        assert!(shorts(&found).into_iter().eq(first..first + found.samples.len() as i16 / 2));
        assert_eq!(found.metadata.field("content"), name.split('.').next());
        assert_eq!(found.metadata.field("sample units"), Some(unit));
        // By its first bytes too.
        assert_eq!(volume::read(folder.file("other", &bytes), None).unwrap(), found);
        let named = format!("{}#{}", path.display(), found.metadata.field("content").unwrap());
        assert_eq!(volume::read(named, None).unwrap(), found);
    }
    let heat = volume::read(folder.0.path().join("heat.h5"), None).unwrap();
    assert_eq!(
        (heat.metadata.key_value("hdf5.range"), heat.metadata.field("spacings")),
        (Some("1000 1023"), None)
    );
    // Of the axes of `wind` only time has coordinates.
    let wind = volume::read(folder.0.path().join("wind.nc"), None).unwrap();
    assert_eq!(wind.metadata.field("spacings"), Some("nan nan 1"));
    assert_eq!(wind.metadata.field("units"), Some("\"\" \"\" \"m/s\""));
}

#[test]
fn any_place_is_found_in_little_memory() {
    let folder = Folder::new();
    for bytes in [heat(), wind()] {
        let path = folder.file("file", &bytes);
        let whole = volume::read(&path, None).unwrap().samples;
        let mut source = super::source::open_within(&path, 4).unwrap();
        for position in (0..whole.len()).step_by(6).rev() {
            let mut value = [0; 2];
            source.seek(position as u64).unwrap();
            source.read(&mut value).unwrap();
            assert_eq!(value, whole[position..position + 2]);
        }
        let mut again = vec![0; whole.len()];
        source.seek(0).unwrap();
        source.read(&mut again).unwrap();
        assert_eq!(again, whole);
        source.read(&mut [0; 2]).unwrap_err();
    }
}

#[test]
fn what_is_not_there_is_told() {
    let folder = Folder::new();
    let path = folder.file("wind.nc", &wind());
    let named = |name: &str| PathBuf::from(format!("{}#{name}", path.display()));
    assert_eq!(volume::read(named("time"), None).unwrap().extent, [2, 1, 1]);
    let known = "it holds the variables \"time\", \"wind\"";
    assert!(message(&named("rain")).ends_with(known), "{}", message(&named("rain")));
    assert!(message(&folder.file("old.mat", b"MATLAB 5.0 MAT-file")).contains("-v7.3"));
    let refused = volume::write(
        &volume::read(&path, None).unwrap(),
        folder.0.path().join("new.h5"),
        &WriteOptions::default(),
    );
    assert!(refused.unwrap_err().to_string().contains("only read"));
}

#[test]
fn damaged_files_are_errors_and_no_panics() {
    let folder = Folder::new();
    for bytes in [heat(), wind()] {
        for at in (0..bytes.len()).step_by(bytes.len() / 300 + 1) {
            let mut changed = bytes.clone();
            changed[at] ^= 0xFF;
            let _either = volume::read(folder.file("changed", &changed), None);
            let _either = volume::read(folder.file("short", &bytes[..at]), None);
        }
    }
}
