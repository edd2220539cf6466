use std::fs;
use std::path::Path;

use super::*;
use crate::volume::{ElementType, Fault, Geometry, HeaderLine, Metadata, Space};

/// A header as ITK writes it, with a key of its own.
const RICH: &str = "ObjectType = Image
NDims = 3
BinaryData = True
BinaryDataByteOrderMSB = True
CompressedData = False
TransformMatrix = 0.6 0.8 0 -0.8 0.6 0 0 0 1
Offset = -10.5 1e-3 7
CenterOfRotation = 0 0 0
AnatomicalOrientation = RAI
ElementSpacing = 0.7 0.7 2.50
Modality = MET_MOD_CT
Comment = a head = in slices
scanner = made by hand
nrrd.sample_units = HU
DimSize = 3 2 1
ElementType = MET_USHORT
ElementDataFile = LOCAL
";

const RICH_SAMPLES: [u8; 12] = [0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6];

fn values(mut source: Box<dyn Source>) -> Result<(Header, Vec<u8>), ReadError> {
    let header = source.header().clone();
    let mut values = vec![0; header.bytes().unwrap() as usize];
    source.read(&mut values)?;
    Ok((header, values))
}

fn read_bytes(bytes: &[u8]) -> Result<(Header, Vec<u8>), ReadError> {
    values(MetaImage.open_input(Input::from_bytes(bytes))?)
}

fn read(path: &Path) -> Result<(Header, Vec<u8>), ReadError> {
    values(crate::volume::open(path, None)?)
}

fn write(path: &Path, header: &Header, values: &[u8], gzip: bool) -> Vec<String> {
    let options = WriteOptions { byte_order: None, gzip };
    let Created { mut sink, losses } = crate::volume::create(path, header, &options).unwrap();
    values.chunks(8).for_each(|piece| sink.write(piece).unwrap());
    sink.finish().unwrap();
    losses
}

#[test]
fn a_header_comes_back_with_its_keys() {
    let bytes = [RICH.as_bytes(), &RICH_SAMPLES].concat();
    let (header, found) = read_bytes(&bytes).unwrap();
    assert_eq!((header.extent, header.element), ([3, 2, 1], ElementType::U16));
    assert_eq!(found, [1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0]);
    let geometry = header.metadata.geometry().unwrap();
    assert_eq!(geometry.space, Space::LeftPosteriorSuperior);
    assert_eq!(geometry.directions[1], [-0.8 * 0.7, 0.6 * 0.7, 0.0]);
    assert_eq!(geometry.origin, [-10.5, 1e-3, 7.0]);
    assert_eq!(header.metadata.field("sample units"), Some("HU"));
    assert_eq!(header.metadata.key_value("scanner"), Some("made by hand"));
    assert_eq!(header.metadata.key_value("metaimage.Comment"), Some("a head = in slices"));
    let folder = tempfile::tempdir().unwrap();
    for name in ["b.mha", "b.mhd", "b.nrrd"] {
        for gzip in [false, true] {
            let between = folder.path().join(name);
            assert!(write(&between, &header, &found, gzip).is_empty(), "{name}");
            let (header, found) = read(&between).unwrap();
            let again = folder.path().join("c.mha");
            assert!(write(&again, &header, &found, false).is_empty());
            let written = fs::read(&again).unwrap();
            assert!(written == bytes, "{name}: {}", String::from_utf8_lossy(&written));
        }
    }
}

#[test]
fn a_part_lies_where_it_was_cut_out() {
    let bytes = [RICH.as_bytes(), &RICH_SAMPLES].concat();
    let (header, _) = read_bytes(&bytes).unwrap();
    let part = Header { extent: [1, 1, 1], metadata: header.metadata.of_part([1, 1, 0], 2), ..header };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mha");
    assert!(write(&path, &part, &[1, 2], false).is_empty());
    let (found, _) = read(&path).unwrap();
    let (found, expected) = (found.metadata.geometry().unwrap(), part.metadata.geometry().unwrap());
    assert_eq!(found.origin, expected.origin);
    for (one, other) in found.directions.iter().flatten().zip(expected.directions.iter().flatten()) {
        assert!((one - other).abs() < 1e-12);
    }
    let text = fs::read(&path).unwrap();
    assert!(String::from_utf8_lossy(&text).contains("ElementSpacing = 1.4 1.4 5\n"));
}

#[test]
fn every_type_order_form_and_number_of_axes_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let shapes: [(&[u64], u32); 6] =
        [(&[5], 1), (&[5, 4], 3), (&[5, 4, 3], 1), (&[5, 4, 3], 2), (&[5, 4, 3, 2], 1), (&[5, 4, 1, 2], 4)];
    for element in ElementType::ALL {
        for (sizes, channels) in shapes {
            for order in [ByteOrder::Little, ByteOrder::Big] {
                let extent = std::array::from_fn(|axis| sizes.get(axis).copied().unwrap_or(1));
                let mut header =
                    Header::scalar(extent, element, Metadata::plain(sizes.len() as u8, FileFormat::Raw));
                header.components = channels;
                header.steps = sizes.get(3).copied().unwrap_or(1);
                let count = header.bytes().unwrap() as usize;
                let samples: Vec<u8> = (0..count).map(|index| (index * 7 % 251) as u8).collect();
                for name in ["a.mha", "a.mhd"] {
                    for gzip in [false, true] {
                        let path = folder.path().join(name);
                        let options = WriteOptions { byte_order: Some(order), gzip };
                        let Created { mut sink, losses } =
                            crate::volume::create(&path, &header, &options).unwrap();
                        assert!(losses.is_empty());
                        sink.write(&samples).unwrap();
                        sink.finish().unwrap();
                        let (found, values) = read(&path).unwrap();
                        assert_eq!((found.extent, found.components), (extent, channels));
                        assert_eq!((found.steps, found.element), (header.steps, element));
                        assert!(values == samples);
                        fs::remove_dir_all(folder.path()).unwrap();
                        fs::create_dir(folder.path()).unwrap();
                    }
                }
            }
        }
    }
}

#[test]
fn places_of_other_spaces_become_those_of_the_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mha");
    let mut metadata = Metadata::plain(3, FileFormat::Nifti);
    let geometry = Geometry {
        space: Space::RightAnteriorSuperior,
        directions: [[0.0, 0.5, 0.0], [-0.25, 0.0, 0.0], [0.0, 0.0, 2.0]],
        origin: [1.0, 2.0, 3.0],
    };
    for (space, letters) in [(Space::RightAnteriorSuperior, "PRI"), (Space::Unnamed, "???")] {
        let geometry = Geometry { space, ..geometry };
        metadata.set_geometry(&geometry);
        metadata.set_key_value("nifti.descrip", "made by hand");
        metadata.set_key_value("no key", "x");
        metadata.lines.push(HeaderLine::Comment(" x".to_owned()));
        let header = Header::scalar([2, 2, 2], ElementType::U8, metadata.clone());
        assert_eq!(write(&path, &header, &[7; 8], true), ["key \"no key\"", "comment \" x\""]);
        metadata.lines.pop();
        let (found, _) = read(&path).unwrap();
        assert_eq!(found.metadata.geometry().unwrap().in_space(space), geometry);
        assert_eq!(found.metadata.key_value("metaimage.AnatomicalOrientation"), Some(letters));
        assert_eq!(found.metadata.key_value("nifti.descrip"), Some("made by hand"));
    }
}

#[test]
fn samples_in_several_files_are_joined() {
    let folder = tempfile::tempdir().unwrap();
    for (index, bytes) in [b"#ab", b"#cd", b"#ef"].iter().enumerate() {
        fs::write(folder.path().join(format!("s{index}.raw")), bytes).unwrap();
    }
    let path = folder.path().join("a.mhd");
    for (files, expected) in [
        ("s%d.raw 0 2 1", b"abcdef"),
        ("s%d.raw 2 0 -1", b"efcdab"),
        ("LIST 2\ns0.raw\ns2.raw\ns1.raw", b"abefcd"),
    ] {
        for size in ["1", "-1"] {
            let header =
                format!("NDims = 3\nDimSize = 2 1 3\nElementType = MET_UCHAR\nHeaderSize = {size}\n");
            fs::write(&path, format!("{header}ElementDataFile = {files}\n")).unwrap();
            assert_eq!(read(&path).unwrap().1, expected);
        }
    }
}

#[test]
fn a_detached_pair_replaces_its_own_files_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mhd");
    let header = Header::scalar([2, 2, 2], ElementType::U8, Metadata::default());
    fs::write(folder.path().join("a.raw"), "the only copy").unwrap();
    let error = crate::volume::create(&path, &header, &WriteOptions::default()).unwrap_err();
    assert!(matches!(error, WriteError::DataFileExists { .. }));
    fs::remove_file(folder.path().join("a.raw")).unwrap();
    for _ in 0..2 {
        write(&path, &header, &[7; 8], false);
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn what_is_no_image_is_refused_by_name() {
    let message = |text: &str| {
        let error = read_bytes(text.as_bytes()).unwrap_err();
        assert_eq!(error.kind(), Fault::Data);
        error.to_string()
    };
    let end = "DimSize = 2 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\nabcd";
    assert!(read_bytes(format!("NDims = 2\n{end}").as_bytes()).is_ok());
    for (text, expected) in [
        (String::new(), "no line `ElementDataFile"),
        ("ObjectType = Image\n".repeat(60_000), "ends the header within 1048576 bytes"),
        ("NDims\n".to_owned(), "line 1 of the header, \"NDims\""),
        (format!("ObjectType = Tube\nNDims = 2\n{end}"), "of type \"Tube\""),
        (format!("BinaryData = False\nNDims = 2\n{end}"), "the samples are text"),
        (end.to_owned(), "has no `NDims`"),
        (format!("NDims = 3\n{end}"), "as many numbers as `NDims`"),
        (format!("NDims = 11\n{end}"), "from 1 to 10"),
        (format!("NDims = 2\nElementNumberOfChannels = 0\n{end}"), "a number from 1 up"),
        (format!("NDims = 2\nElementNumberOfChannels = 2\n{end}"), "promises 8 bytes"),
        (format!("NDims = 2\nHeaderSize = -2\n{end}"), "-1 or a number from 0 up"),
        (
            format!("NDims = 2\nHeaderSize = -1\nCompressedData = True\n{end}"),
            "samples that are not compressed",
        ),
        (format!("NDims = 2\nCompressedData = True\n{end}"), "damaged"),
        (format!("NDims = 2\n{}", end.replace("UCHAR", "STRING")), "\"MET_STRING\""),
        (format!("NDims = 2\n{}", end.replace("2 2", "2 0")), "zero samples"),
        (format!("NDims = 2\n{}", end.replace("LOCAL", "s%d 1 0 1")), "a pattern such as"),
        (format!("NDims = 2\n{}", end.replace("LOCAL", "s%d 1 3 1")), "cannot read"),
    ] {
        let found = match expected {
            "cannot read" => read_bytes(text.as_bytes()).unwrap_err().to_string(),
            _ => message(&text),
        };
        assert!(found.contains(expected), "{found}");
    }
}

#[test]
fn hostile_files_return() {
    let raw = [RICH.as_bytes(), &RICH_SAMPLES].concat();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mha");
    let (header, found) = read_bytes(&raw).unwrap();
    write(&path, &header, &found, true);
    for bytes in [raw, fs::read(&path).unwrap()] {
        for end in 0..bytes.len() {
            // Without its last letters, `LOCAL` is the name of a file.
            let error = read_bytes(&bytes[..end]).unwrap_err();
            assert!(error.kind() == Fault::Data || matches!(error, ReadError::Io { .. }), "{end}");
        }
        for index in 0..bytes.len() {
            for change in [1, 2, 4, 8, 16, 32, 64, 128, 255] {
                let mut changed = bytes.clone();
                changed[index] ^= change;
                if let Ok((header, values)) = read_bytes(&changed) {
                    assert_eq!(header.bytes(), Some(values.len() as u64));
                }
            }
        }
    }
}
