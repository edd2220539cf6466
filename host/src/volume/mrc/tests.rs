//! Tests of MRC.

use std::fs;
use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::*;
use crate::volume::synthetic::{Kind, generate};
use crate::volume::{self, ByteOrder, ElementType, Geometry, Volume, open, read_all};

/// A file as CCP4 has it: 3 x 2 x 2 samples of that mode, axes z, y, x of a cell of 10 x 20 x 30 Å in 5 x 10 x 15 steps,
/// an extended header of 4 bytes, one label.
fn file(order: ByteOrder, mode: i32, samples: &[u8]) -> Vec<u8> {
    let mut header = MrcHeader::empty(order);
    header.set_integers(field::COUNTS, [3, 2, 2]);
    header.set_integers(field::MODE, [mode]);
    header.set_integers(field::SAMPLING, [5, 10, 15]);
    header.set_integers(field::AXES, [3, 2, 1]);
    header.set_integers(field::EXTENSION, [4]);
    header.set_reals(field::CELL, [10.0, 20.0, 30.0]);
    header.set_reals(field::ORIGIN, [-1.0, 0.5, 7.0]);
    header.set_integers(220, [1]);
    header.bytes[224..232].copy_from_slice(b"a label ");
    [&header.bytes[..], b"more", samples].concat()
}

fn read_bytes(bytes: &[u8]) -> Result<Volume, ReadError> {
    read_all(Path::new("memory"), Mrc.open_input(Input::from_bytes(bytes))?)
}

fn fault(bytes: &[u8]) -> String {
    match read_bytes(bytes).unwrap_err() {
        ReadError::Format { cause, .. } => cause.to_string(),
        other => panic!("{other}"),
    }
}

#[test]
fn headers_are_understood_in_both_orders_of_bytes() {
    let values: Vec<i16> = (0..12).map(|value| 1000 * value - 5000).collect();
    let little: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let big: Vec<u8> = values.iter().flat_map(|value| value.to_be_bytes()).collect();
    for (order, samples) in [(ByteOrder::Little, &little), (ByteOrder::Big, &big)] {
        let found = read_bytes(&file(order, 1, samples)).unwrap();
        assert_eq!((found.extent, found.element), ([3, 2, 2], ElementType::I16));
        assert_eq!((&found.samples, found.metadata.source.byte_order), (&little, order));
        let geometry = found.metadata.geometry().unwrap();
        assert_eq!(geometry.directions, [[0.0, 0.0, 2.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]]);
        assert_eq!(geometry.origin, [-1.0, 0.5, 7.0]);
        assert_eq!(found.metadata.key_value("mrc.label.0"), Some("a label"));
    }
}

#[test]
fn every_mode_has_its_type() {
    let of = |mode, bytes| read_bytes(&file(ByteOrder::Little, mode, &vec![0; bytes])).unwrap();
    let expected = [
        (0, 12, ElementType::I8),
        (2, 48, ElementType::F32),
        (6, 24, ElementType::U16),
        (12, 24, ElementType::F32),
    ];
    for (mode, bytes, element) in expected {
        assert_eq!(of(mode, bytes).element, element, "{mode}");
    }
    let mut halves = file(ByteOrder::Big, 12, &[0x3C, 0].repeat(12));
    assert_eq!(read_bytes(&halves).unwrap().samples, 1_f32.to_le_bytes().repeat(12));
    for mode in [5, 7, 101, -1] {
        halves[field::MODE..field::MODE + 4].copy_from_slice(&i32::to_be_bytes(mode));
        assert!(fault(&halves).contains(&format!("mode {mode} ")));
    }
    // Bytes of IMOD say whether they have a sign.
    let mut bytes = file(ByteOrder::Little, 0, &[200; 12]);
    bytes[field::IMOD_STAMP..field::IMOD_STAMP + 4].copy_from_slice(&1_146_047_817_i32.to_le_bytes());
    assert_eq!(read_bytes(&bytes).unwrap().element, ElementType::U8);
    bytes[field::IMOD_FLAGS] = 1;
    assert_eq!(read_bytes(&bytes).unwrap().element, ElementType::I8);
}

#[test]
fn files_come_back_byte_for_byte() {
    let folder = tempfile::tempdir().unwrap();
    let [from, to] = ["in.map", "out.mrc"].map(|name| folder.path().join(name));
    let samples: Vec<u8> = (0..48).collect();
    for (order, mode, bytes) in [
        (ByteOrder::Little, 2, 48),
        (ByteOrder::Big, 4, 96),
        (ByteOrder::Big, 3, 48),
        (ByteOrder::Little, 0, 12),
    ] {
        let written = file(order, mode, &samples.repeat(2)[..bytes]);
        fs::write(&from, &written).unwrap();
        let mut source = open(&from, None).unwrap();
        let created = volume::create(&to, source.header(), &WriteOptions::default()).unwrap();
        assert_eq!(created.losses, [""; 0]);
        volume::copy(source.as_mut(), created.sink, &crate::progress::ignore).unwrap();
        assert_eq!(fs::read(&to).unwrap(), written, "mode {mode}");
    }
}

#[test]
fn volumes_of_other_formats_are_written_with_their_places() {
    let folder = tempfile::tempdir().unwrap();
    let mut volume = generate(Kind::Waves, [7, 6, 5], ElementType::U16, 1);
    volume.metadata.set_geometry(&Geometry::along_axes([1.5, 1.5, 2.25], [10.0, 0.0, -3.0]));
    for name in ["new.mrc", "new.map.gz"] {
        let path = folder.path().join(name);
        let losses = volume::write(&volume, &path, &WriteOptions::default()).unwrap();
        assert_eq!(losses, [""; 0]);
        let found = volume::read(&path, None).unwrap();
        assert_eq!((found.extent, &found.samples), (volume.extent, &volume.samples));
        assert_eq!(found.metadata.geometry(), volume.metadata.geometry());
    }
    // In other units, and in a space with a name, which alone is lost.
    volume.metadata.set_field("space", "left-posterior-superior");
    volume.metadata.set_field("space units", "\"nm\" \"nm\" \"nm\"");
    let path = folder.path().join("new.mrc");
    assert_eq!(volume::write(&volume, &path, &WriteOptions::default()).unwrap(), ["space"]);
    let found = volume::read(&path, None).unwrap().metadata.geometry().unwrap();
    assert_eq!((found.spacing(), found.origin), ([15.0, 15.0, 22.5], [100.0, 0.0, -30.0]));
    volume.metadata.set_field("space directions", "(1,1,0) (-1,1,0) (0,0,1)");
    let losses = volume::write(&volume, folder.path().join("new.mrc"), &WriteOptions::default()).unwrap();
    assert!(losses.iter().any(|loss| loss == "space directions"), "{losses:?}");
    volume.metadata.set_field("space units", "\"px\" \"px\" \"px\"");
    let losses = volume::write(&volume, &path, &WriteOptions::default()).unwrap();
    assert!(losses.iter().any(|loss| loss == "space units"), "{losses:?}");
    let bytes = generate(Kind::Waves, [7, 6, 5], ElementType::U8, 1);
    volume::write(&bytes, folder.path().join("new.mrc"), &WriteOptions::default()).unwrap_err();
}

#[test]
fn stacks_of_volumes_are_time_steps() {
    let mut stack = MrcHeader::empty(ByteOrder::Little);
    stack.set_integers(field::COUNTS, [3, 2, 8]);
    stack.set_integers(field::SAMPLING, [3, 2, 4]);
    stack.set_integers(field::SPACE_GROUP, [401]);
    let bytes = [stack.bytes, vec![0; 48]].concat();
    let header = Mrc.open_input(Input::from_bytes(&bytes)).unwrap().header().clone();
    assert_eq!((header.extent, header.steps), ([3, 2, 4], 2));
    let (again, losses) = meaning::written(&header, ByteOrder::Little).unwrap();
    assert_eq!((again.bytes.as_slice(), losses.len()), (&bytes[..1024], 0));
}

#[test]
fn damaged_files_are_errors() {
    let whole = file(ByteOrder::Little, 1, &[0; 24]);
    for length in 0..whole.len() {
        read_bytes(&whole[..length]).unwrap_err();
    }
    read_bytes(&[&whole[..], b"x"].concat()).unwrap_err();
    for (place, value) in
        [(0, 0), (4, -1), (8, i32::MAX), (field::EXTENSION, -1), (field::EXTENSION, i32::MAX)]
    {
        let mut changed = whole.clone();
        changed[place..place + 4].copy_from_slice(&value.to_le_bytes());
        read_bytes(&changed).unwrap_err();
    }
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(&whole).unwrap();
    let packed = packed.finish().unwrap();
    assert_eq!(read_bytes(&packed).unwrap().samples, [0; 24]);
    read_bytes(&packed[..packed.len() - 12]).unwrap_err();
}
