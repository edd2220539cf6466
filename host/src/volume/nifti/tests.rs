use std::fs;
use std::path::Path;

use super::*;
use crate::volume::{ByteOrder, ElementType, Fault, Geometry, Metadata, Space};

/// A header and its values, read through `read` in pieces.
fn read(path: &Path) -> Result<(Header, Vec<u8>), ReadError> {
    values(crate::volume::open(path, None)?)
}

fn values(mut source: Box<dyn Source>) -> Result<(Header, Vec<u8>), ReadError> {
    let header = source.header().clone();
    let mut values = vec![0; header.bytes().unwrap() as usize];
    source.read(&mut values)?;
    Ok((header, values))
}

fn write(path: &Path, header: &Header, values: &[u8]) -> Vec<String> {
    let Created { mut sink, losses } = crate::volume::create(path, header, &WriteOptions::default()).unwrap();
    let sample = header.element.bytes();
    values.chunks(7 * sample).for_each(|piece| sink.write(piece).unwrap());
    sink.finish().unwrap();
    losses
}

/// Bytes of a header of version 1 with this shape and type, and whatever `change` does to it.
fn header_bytes(dim: &[u16], datatype: i16, order: ByteOrder, change: impl Fn(&mut [u8])) -> Vec<u8> {
    let file = NiftiHeader {
        version: fields::Version::One,
        order,
        is_pair: false,
        dim: dim.iter().map(|&count| count.into()).collect(),
        datatype,
        offset: 352,
        fields: fields::Fields::default(),
        extensions: Vec::new(),
    };
    let (mut bytes, losses) = file.to_bytes();
    assert!(losses.is_empty());
    change(&mut bytes);
    bytes
}

fn count_up(bytes: usize) -> Vec<u8> {
    (0..bytes).map(|index| (index * 7 % 251) as u8).collect()
}

/// Everything that a header can say, in version 1: an oblique place, a scale, texts that are no UTF-8, an extension.
fn rich() -> Vec<u8> {
    let mut bytes = header_bytes(&[4, 3, 2], 4, ByteOrder::Little, |bytes| {
        let mut put = |place: usize, more: &[u8]| bytes[place..place + more.len()].copy_from_slice(more);
        let floats =
            |numbers: &[f32]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
        put(39, &[0x39]);
        put(56, &floats(&[1.5, -0.0, f32::MIN_POSITIVE]));
        put(68, &1007_i16.to_le_bytes());
        put(76, &floats(&[-1.0, 0.7, 0.8, 2.5, 1.9, 0.0, 0.0, f32::NAN]));
        put(112, &floats(&[0.1, -1024.0]));
        put(123, &[2 | 8]);
        put(124, &floats(&[1e10, -1e-10]));
        put(148, b"made by hand");
        put(228, b"\xff\xfe");
        put(252, &[1, 0, 4, 0]);
        put(256, &floats(&[0.1, 0.2, 0.3, -5.0, 6.25, 7.0]));
        put(280, &floats(&[0.6, -0.0, 0.1, -12.7, 0.0, 0.8, 0.2, 33.3, 0.01, 0.02, 2.5, 1e-3]));
        put(328, b"thickness");
        put(108, &(352.0_f32 + 32.0).to_le_bytes());
        put(348, &[1]);
    });
    let text = b"a comment, padded\0\0\0\0\0\0\0";
    bytes.extend([&32_i32.to_le_bytes()[..], &6_i32.to_le_bytes(), text].concat());
    bytes.extend(count_up(48));
    bytes
}

#[test]
fn a_header_comes_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nii");
    fs::write(&path, rich()).unwrap();
    let (header, found) = read(&path).unwrap();
    assert_eq!(found, count_up(48));
    let geometry = header.metadata.geometry().unwrap();
    assert_eq!(geometry.space, Space::RightAnteriorSuperior);
    assert_eq!(geometry.directions, [[0.6, 0.0, 0.01], [0.0, 0.8, 0.02], [0.1, 0.2, 2.5]]);
    assert_eq!(geometry.origin, [-12.7, 33.3, 0.001]);
    assert_eq!(header.metadata.field("space units"), Some("\"mm\" \"mm\" \"mm\""));
    for (key, value) in [
        ("descrip", "made by hand"),
        ("aux_file", "base64://4="),
        ("intent_name", "thickness"),
        ("scl_slope", "0.1"),
        ("intent_p", "1.5 -0 0.000000000000000000000000000000000000011754944"),
        ("extension.0", "6 YSBjb21tZW50LCBwYWRkZWQAAAAAAAAA"),
    ] {
        assert_eq!(header.metadata.key_value(&format!("nifti.{key}")), Some(value));
    }
    for name in ["b.nii", "b.nii.gz", "b.nrrd"] {
        let between = folder.path().join(name);
        assert!(write(&between, &header, &found).is_empty(), "{name}");
        let (header, found) = read(&between).unwrap();
        let again = folder.path().join("c.nii");
        assert!(write(&again, &header, &found).is_empty());
        assert!(fs::read(&again).unwrap() == rich(), "through {name}");
    }
}

#[test]
fn every_type_order_shape_and_form_comes_back() {
    let shapes: [&[u16]; 8] = [
        &[5],
        &[5, 4],
        &[5, 4, 3],
        &[5, 4, 3, 2],
        &[5, 4, 3, 1, 3],
        &[5, 4, 3, 2, 3],
        &[5, 4, 1, 1, 2, 1, 2],
        &[5, 4, 3, 1],
    ];
    let folder = tempfile::tempdir().unwrap();
    for (index, datatype) in
        [2, 4, 8, 16, 32, 64, 128, 256, 512, 768, 1024, 1280, 1792, 2304].into_iter().enumerate()
    {
        for order in [ByteOrder::Little, ByteOrder::Big] {
            for dim in shapes.into_iter().skip(index % 2).step_by(2) {
                let bytes = header_bytes(dim, datatype, order, |_| {});
                let (element, lead) = header::layout_of(datatype).unwrap();
                let count: usize = dim.iter().map(|&count| usize::from(count)).product();
                let file = [bytes, count_up(count * element.bytes() * lead as usize)].concat();
                let path = folder.path().join("a.nii");
                fs::write(&path, &file).unwrap();
                let (header, found) = read(&path).unwrap();
                assert_eq!(header.element, element);
                let extent: Vec<u64> = dim.iter().take(3).map(|&count| count.into()).collect();
                assert_eq!(header.extent[..extent.len()], extent);
                let name = ["b.nii", "b.nii.gz", "b.hdr", "b.img.gz", "b.nrrd"][index % 5];
                let between = folder.path().join(name);
                write(&between, &header, &found);
                let (again, values) = read(&between).unwrap();
                assert_eq!(
                    (again.extent, again.components, again.steps),
                    (header.extent, header.components, header.steps)
                );
                assert!(values == found, "{datatype} {dim:?} {name}");
                let back = folder.path().join("c.nii");
                write(&back, &again, &values);
                let written = fs::read(&back).unwrap();
                let same = written[..40] == file[..40]
                    && written[40..56] == file[40..56]
                    && written[352..] == file[352..];
                assert!(same, "{datatype} {dim:?} {order} {name}");
            }
        }
    }
}

#[test]
fn vectors_lie_as_volumes_and_colours_together() {
    let samples = count_up(2 * 2 * 3);
    for (datatype, is_together) in [(2, false), (128, true)] {
        let dim: &[u16] = if is_together { &[2, 2] } else { &[2, 2, 1, 1, 3] };
        let bytes = [header_bytes(dim, datatype, ByteOrder::Little, |_| {}), samples.clone()].concat();
        let (header, found) = values(Nifti.open_input(Input::from_bytes(&bytes)).unwrap()).unwrap();
        assert_eq!((header.components, header.extent), (3, [2, 2, 1]));
        let second: Vec<u8> =
            if is_together { samples[3..6].to_vec() } else { [1, 5, 9].map(|at| samples[at]).to_vec() };
        assert_eq!(found[3..6], second);
        let kind = header.metadata.axis_entry("kinds", Axis::Component(0));
        assert_eq!(kind, is_together.then_some("RGB-color"));
    }
}

#[test]
fn a_header_of_version_2_holds_long_axes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nii");
    let header = Header::scalar([40_000, 1, 1], ElementType::U8, Metadata::plain(1, FileFormat::Raw));
    write(&path, &header, &count_up(40_000));
    let bytes = fs::read(&path).unwrap();
    assert_eq!(bytes.len(), 544 + 40_000);
    let (again, found) = read(&path).unwrap();
    assert_eq!((again.extent, again.rank()), ([40_000, 1, 1], 1));
    assert!(found == count_up(40_000));
    for order in [ByteOrder::Little, ByteOrder::Big] {
        let options = WriteOptions { byte_order: Some(order), gzip: false };
        let Created { mut sink, .. } = crate::volume::create(&path, &again, &options).unwrap();
        sink.write(&found).unwrap();
        sink.finish().unwrap();
        assert_eq!(read(&path).unwrap().0.extent, [40_000, 1, 1]);
    }
}

#[test]
fn places_of_other_formats_are_said_in_both_ways() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nii");
    let mut metadata = Metadata::plain(3, FileFormat::Nrrd);
    metadata.set_geometry(&Geometry {
        space: Space::LeftPosteriorSuperior,
        directions: [[0.0, 0.5, 0.0], [-0.25, 0.0, 0.0], [0.0, 0.0, 2.0]],
        origin: [1.0, 2.0, 3.0],
    });
    metadata.set_field("content", "head");
    metadata.set_field("space units", "\"mm\" \"mm\" \"mm\"");
    metadata.set_field("measurement frame", "(1,0,0) (0,1,0) (0,0,1)");
    let header = Header::scalar([3, 2, 2], ElementType::F32, metadata.clone());
    assert_eq!(write(&path, &header, &count_up(48)), ["measurement frame"]);
    let (found, _) = read(&path).unwrap();
    let geometry = found.metadata.geometry().unwrap();
    assert_eq!(geometry.in_space(Space::LeftPosteriorSuperior), metadata.geometry().unwrap());
    assert_eq!(found.metadata.key_value("nifti.qform_code"), Some("1"));
    assert_eq!(found.metadata.key_value("nifti.descrip"), Some("head"));
    assert_eq!(found.metadata.key_value("nifti.xyzt_units"), Some("2"));

    let part = Header { metadata: found.metadata.of_part([1, 0, 0], 2), extent: [1, 1, 1], ..found };
    assert!(write(&path, &part, &count_up(4)).is_empty());
    let (part, _) = read(&path).unwrap();
    let geometry = part.metadata.geometry().unwrap();
    assert_eq!(geometry.origin, [-1.0, -2.5, 3.0]);
    assert_eq!(geometry.spacing(), [1.0, 0.5, 4.0]);
    assert_eq!(part.metadata.key_value("nifti.pixdim").unwrap().split(' ').nth(1), Some("1"));
}

#[test]
fn spacing_and_time_without_a_place_are_kept() {
    let bytes = header_bytes(&[2, 2, 2, 3], 2, ByteOrder::Little, |bytes| {
        for (axis, step) in [1.0_f32, 0.5, 0.5, 2.0, 1.5].into_iter().enumerate() {
            bytes[76 + 4 * axis..80 + 4 * axis].copy_from_slice(&step.to_le_bytes());
        }
        bytes[123] = 2 | 16;
    });
    let bytes = [bytes, count_up(24)].concat();
    let (header, found) = values(Nifti.open_input(Input::from_bytes(&bytes)).unwrap()).unwrap();
    assert_eq!((header.steps, header.metadata.spacing()), (3, Some([0.5, 0.5, 2.0])));
    assert_eq!(header.metadata.time_step(), Some(1.5));
    assert_eq!(header.metadata.field("units"), Some("\"mm\" \"mm\" \"mm\" \"ms\""));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nii");
    assert!(write(&path, &header, &found).is_empty());
    assert_eq!(fs::read(&path).unwrap(), bytes);
}

#[test]
fn analyze_is_read_as_a_pair_that_lies_nowhere() {
    for order in [ByteOrder::Little, ByteOrder::Big] {
        let mut head = header_bytes(&[3, 2, 2], 4, order, |bytes| {
            // Units and history are texts and numbers of its own; what a voxel measures is as in NIfTI.
            for place in [56..70, 120..124, 252..344] {
                bytes[place].fill(b'3');
            }
            bytes[108..112].fill(0);
            for (axis, step) in [0.0_f32, 0.5, 0.5, 2.0].into_iter().enumerate() {
                let step = if order == ByteOrder::Little { step.to_le_bytes() } else { step.to_be_bytes() };
                bytes[76 + 4 * axis..80 + 4 * axis].copy_from_slice(&step);
            }
        });
        head[344..348].fill(0);
        head.truncate(348);
        let folder = tempfile::tempdir().unwrap();
        let [head_path, data_path] = ["a.hdr", "a.img"].map(|name| folder.path().join(name));
        fs::write(&head_path, &head).unwrap();
        fs::write(&data_path, count_up(24)).unwrap();
        for path in [&head_path, &data_path] {
            let (header, values) = read(path).unwrap();
            assert_eq!((header.extent, header.element), ([3, 2, 2], ElementType::I16));
            assert_eq!(header.metadata.spacing(), Some([0.5, 0.5, 2.0]));
            assert_eq!(
                (header.metadata.field("space"), header.metadata.key_value("nifti.qform_code")),
                (None, None)
            );
            assert_eq!(values.len(), 24);
            let again = folder.path().join("b.nii");
            assert!(write(&again, &header, &values).is_empty());
            assert_eq!(read(&again).unwrap().1, values);
        }
    }
}

#[test]
fn what_cannot_be_read_is_named() {
    let message = |bytes: &[u8]| {
        let error = Nifti.open_input(Input::from_bytes(bytes)).and_then(values).unwrap_err();
        assert_eq!(error.kind(), Fault::Data);
        error.to_string()
    };
    assert!(message(&[]).ends_with("the file ends within its header"));
    assert!(message(&[1; 400]).contains("say 16843009, not 348 or 540"));
    let changed = |place: usize, value: &[u8]| {
        let bytes = header_bytes(&[2, 2], 2, ByteOrder::Little, |bytes| {
            bytes[place..place + value.len()].copy_from_slice(value);
        });
        message(&[bytes, vec![0; 4]].concat())
    };
    assert!(changed(344, b"n+2").contains("magic"));
    assert!(changed(40, &[0, 0]).contains("`dim` is 0 2 2 1"));
    assert!(changed(42, &[0, 0]).contains("at least one sample"));
    assert!(changed(70, &[1, 0]).contains("type 1 (single bits)"));
    assert!(changed(108, &f32::NAN.to_le_bytes()).contains("vox_offset"));
    assert!(changed(42, &[3, 0]).contains("promises 6 bytes of samples, the file has 4"));
}

#[test]
fn hostile_files_return() {
    let read = |bytes: &[u8]| values(Nifti.open_input(Input::from_bytes(bytes))?);
    let raw = rich();
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(&raw).unwrap();
    for bytes in [raw, encoder.finish().unwrap()] {
        for end in 0..bytes.len() {
            assert_eq!(read(&bytes[..end]).unwrap_err().kind(), Fault::Data, "{end}");
        }
        for index in 0..bytes.len() {
            for change in [1, 2, 4, 8, 16, 32, 64, 128, 255] {
                let mut changed = bytes.clone();
                changed[index] ^= change;
                if let Ok((header, values)) = read(&changed) {
                    assert_eq!(header.bytes(), Some(values.len() as u64));
                }
            }
        }
    }
}
