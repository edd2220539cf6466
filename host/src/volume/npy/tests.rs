use std::path::Path;

use super::*;
use crate::volume::synthetic::{Kind, generate};
use crate::volume::{Found, Volume, WriteOptions, read_all};

fn file(version: u8, literal: &str, samples: &[u8]) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    bytes.extend_from_slice(&[version, 0]);
    match version {
        1 => bytes.extend_from_slice(&(literal.len() as u16).to_le_bytes()),
        _ => bytes.extend_from_slice(&(literal.len() as u32).to_le_bytes()),
    }
    bytes.extend_from_slice(literal.as_bytes());
    bytes.extend_from_slice(samples);
    bytes
}

fn read_bytes(bytes: &[u8]) -> Result<Volume, ReadError> {
    read_all(Path::new("memory"), Npy.open_input(Input::from_bytes(bytes))?)
}

fn fault(bytes: &[u8]) -> NpyError {
    match read_bytes(bytes).unwrap_err() {
        ReadError::Npy { cause, .. } => cause,
        other => panic!("{other}"),
    }
}

#[test]
fn all_versions_and_both_orders_of_axes_are_read() {
    for version in 1..=3 {
        let c = "{'descr': '<u2', 'fortran_order': False, 'shape': (1, 2, 3), }\n";
        let volume = read_bytes(&file(version, c, &[1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0])).unwrap();
        assert_eq!((volume.extent, volume.element), ([3, 2, 1], ElementType::U16));
        assert_eq!((volume.rank(), volume.metadata.source.fortran_order), (3, false));
        let fortran = "{'descr': '>u2', 'fortran_order': True, 'shape': (3, 2), }\n";
        let volume = read_bytes(&file(version, fortran, &[0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6])).unwrap();
        assert_eq!((volume.extent, volume.rank()), ([3, 2, 1], 2));
        assert_eq!(volume.samples, [1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0]);
        assert_eq!(volume.metadata.source.byte_order, ByteOrder::Big);
        assert!(volume.metadata.source.fortran_order);
    }
}

#[test]
fn headers_are_those_of_numpy() {
    let mut volume = generate(Kind::Noise, [5, 1, 1], ElementType::U8, 0);
    let bytes = header_bytes(&volume.header(), &[5], ByteOrder::Little);
    let literal = "{'descr': '|u1', 'fortran_order': False, 'shape': (5,), }";
    assert_eq!(bytes.len(), 128);
    assert_eq!(bytes[..10], *b"\x93NUMPY\x01\x00\x76\x00");
    assert_eq!(str::from_utf8(&bytes[10..]).unwrap(), format!("{literal:117}\n"));
    volume.element = ElementType::F64;
    volume.metadata.source.fortran_order = true;
    let bytes = header_bytes(&volume.header(), &[5, 1, 7], ByteOrder::Big);
    assert!(bytes[10..].starts_with(b"{'descr': '>f8', 'fortran_order': True, 'shape': (5, 1, 7), } "));
    assert_eq!(header_bytes(&volume.header(), &[u64::MAX; 32], ByteOrder::Big).len() % 64, 0);
}

#[test]
fn what_is_written_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npy");
    let mut extents = [[5, 4, 3], [5, 4, 1], [5, 1, 1]].into_iter().cycle();
    for element in ElementType::ALL {
        for byte_order in [ByteOrder::Little, ByteOrder::Big] {
            for fortran_order in [false, true] {
                let mut volume = generate(Kind::Noise, extents.next().unwrap(), element, 1);
                let byte_order = if element.bytes() == 1 { ByteOrder::Little } else { byte_order };
                volume.metadata.source = Origin { format: FileFormat::Npy, byte_order, fortran_order };
                assert!(crate::volume::write(&volume, &path, &WriteOptions::default()).unwrap().is_empty());
                assert_eq!(crate::volume::read(&path, None).unwrap(), volume);
            }
        }
    }
}

#[test]
fn arrays_of_more_axes_have_components_and_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npy");
    for (shape, fortran, extent, components, steps) in [
        ("(5, 4, 3, 6)", "False", [6, 3, 4], 1, 5),
        ("(5, 4, 3, 2)", "False", [3, 4, 5], 2, 1),
        ("(5, 4, 3, 2)", "True", [5, 4, 3], 1, 2),
        ("(2, 5, 4, 3, 7)", "False", [3, 4, 5], 7, 2),
        ("(2, 2, 5, 4, 3, 7)", "False", [3, 4, 5], 7, 4),
    ] {
        let literal = format!("{{'descr': '|u1', 'fortran_order': {fortran}, 'shape': {shape}, }}");
        let count = components * extent.iter().product::<u64>() * steps;
        let samples: Vec<u8> = (0..count).map(|value| value as u8).collect();
        let before = MAGIC.len() + 4;
        let literal = format!(
            "{literal:width$}\n",
            width = (before + literal.len() + 1).next_multiple_of(64) - before - 1
        );
        let bytes = file(1, &literal, &samples);
        let mut source = Npy.open_input(Input::from_bytes(&bytes)).unwrap();
        let header = source.header().clone();
        assert_eq!(
            (header.extent, u64::from(header.components), header.steps),
            (extent, components, steps),
            "{shape}"
        );
        let mut found = vec![0; samples.len()];
        source.read(&mut found).unwrap();
        assert_eq!(found, samples);
        let Created { mut sink, losses } =
            crate::volume::create(&path, &header, &WriteOptions::default()).unwrap();
        sink.write(&found).unwrap();
        sink.finish().unwrap();
        assert!(losses.is_empty());
        assert!(std::fs::read(&path).unwrap() == bytes, "{shape}");
    }
    let mut header = Header::scalar([4, 4, 1], ElementType::U8, Metadata::plain(2, FileFormat::Raw));
    header.components = 3;
    let losses = crate::volume::create(&path, &header, &WriteOptions::default()).unwrap().losses;
    assert_eq!(losses, ["which axes hold components and time"]);
}

#[test]
fn truth_values_halves_and_complex_numbers_become_what_holds_them() {
    let read = |descr: &str, shape: &str, samples: &[u8]| {
        let literal = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}}}");
        let mut source = open(Input::from_bytes(&file(1, &literal, samples))).unwrap();
        let header = source.header().clone();
        let mut values = vec![0; header.bytes().unwrap() as usize];
        source.read(&mut values).unwrap();
        // A part from the middle is the same.
        let bytes = header.element.bytes();
        source.seek(bytes as u64).unwrap();
        let mut second = vec![0; bytes];
        source.read(&mut second).unwrap();
        assert_eq!(second, values[bytes..2 * bytes]);
        (header.element, header.extent, header.components, values)
    };
    assert_eq!(read("|b1", "(3,)", &[0, 1, 1]), (ElementType::U8, [3, 1, 1], 1, vec![0, 1, 1]));
    let floats =
        |numbers: &[f32]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    // 1.5, -2, the largest, the smallest above 0, infinity, -0.
    let halves: [u16; 6] = [0x3E00, 0xC000, 0x7BFF, 0x0001, 0x7C00, 0x8000];
    let expected = floats(&[1.5, -2.0, 65_504.0, 2.0_f32.powi(-24), f32::INFINITY, -0.0]);
    for (sign, bytes) in
        [('<', halves.map(u16::to_le_bytes).concat()), ('>', halves.map(u16::to_be_bytes).concat())]
    {
        let found = read(&format!("{sign}f2"), "(2, 3)", &bytes);
        assert_eq!(found, (ElementType::F32, [3, 2, 1], 1, expected.clone()), "{sign}");
    }
    let parts = floats(&[1.0, 2.0, 3.0, 4.0]);
    assert_eq!(read("<c8", "(2, 1)", &parts), (ElementType::F32, [1, 2, 1], 2, parts.clone()));
}

#[test]
fn other_arrays_are_refused_by_name() {
    let descr = |descr: &str| {
        fault(&file(1, &format!("{{'descr': {descr}, 'fortran_order': False, 'shape': (1,)}}"), &[]))
    };
    for (text, meaning) in [
        ("<f16", "floats of another width"),
        ("<c32", "complex numbers of another width"),
        ("|S5", "texts"),
        ("<U5", "texts"),
        ("|O", "Python objects"),
        ("<M8[s]", "times"),
        ("|V3", "bytes without a meaning"),
        ("<u3", "of an unknown type"),
        ("", "of an unknown type"),
        ("é", "of an unknown type"),
    ] {
        assert_eq!(descr(&format!("'{text}'")), NpyError::Element { descr: excerpt(text), meaning });
    }
    for text in ["f4", "=f4", "|f4", "<<f4"] {
        assert_eq!(descr(&format!("'{text}'")), NpyError::ByteOrder { descr: excerpt(text) });
    }
    assert_eq!(descr("[('a', '<i4'), ('b', '<f4')]"), NpyError::Records);
    let shape = |shape: &str| {
        fault(&file(1, &format!("{{'descr': '|u1', 'fortran_order': False, 'shape': {shape}}}"), &[]))
    };
    assert_eq!(shape("()"), NpyError::Axes { found: 0 });
    assert_eq!(shape(&format!("({})", "1, ".repeat(33))), NpyError::Axes { found: 33 });
    assert_eq!(shape("(4, 0)"), NpyError::Extent(ExtentError::ZeroAxis { axis: 'x' }));
    assert_eq!(shape("(4294967296, 4294967296)"), NpyError::Extent(ExtentError::TooLarge));
    assert_eq!(fault(b"\x93NUMPX\x01\x00"), NpyError::Magic);
    assert_eq!(fault(b"\x93NUMPY\x04\x00"), NpyError::Version { major: 4, minor: 0 });
    assert_eq!(fault(b"\x93NUMPY\x02\x00\xff\xff\xff\xff"), NpyError::HeaderTooLong { bytes: u32::MAX });
}

#[test]
fn every_prefix_is_an_error_and_every_changed_byte_returns() {
    let literal = "{'descr': '<u2', 'fortran_order': False, 'shape': (2, 3), }\n";
    let bytes = file(1, literal, &[7; 12]);
    for end in 0..bytes.len() {
        let error = read_bytes(&bytes[..end]).unwrap_err();
        let in_samples =
            matches!(error, ReadError::SampleBytes { expected: 12, found: Found::Exactly(_), .. });
        let in_header = matches!(error, ReadError::Npy { cause: NpyError::Truncated, .. });
        assert!(if end < 10 + literal.len() { in_header } else { in_samples }, "{end}: {error}");
    }
    let longer = read_bytes(&[&bytes[..], &[0]].concat()).unwrap_err();
    assert!(matches!(longer, ReadError::SampleBytes { found: Found::Exactly(13), .. }));
    for index in 0..bytes.len() - 12 {
        for change in 1..=255 {
            let mut changed = bytes.clone();
            changed[index] ^= change;
            if let Ok(volume) = read_bytes(&changed) {
                // As many bytes as there are, but where they are floats of 16 bits now.
                assert!(matches!(volume.samples.len(), 12 | 24), "{index}");
            }
        }
    }
}
