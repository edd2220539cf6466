use super::elements::Elements;
use super::*;
use crate::volume::jpeg::tests::LOSSLESS;
use crate::volume::{ElementType, Fault, Metadata};

/// An element of explicit representation, little-endian.
fn element(tag: Tag, vr: &[u8; 2], value: &[u8]) -> Vec<u8> {
    let head = [((tag >> 16) as u16).to_le_bytes(), (tag as u16).to_le_bytes(), *vr].concat();
    let length = value.len() as u32;
    let length = match vr {
        b"OW" | b"SQ" => [&[0; 2][..], &length.to_le_bytes()].concat(),
        _ => (length as u16).to_le_bytes().to_vec(),
    };
    [head, length, value.to_vec()].concat()
}

/// A slice of 3 by 2 signed samples of 12 bits.
fn file(position: &[u8], values: [u16; 6]) -> Vec<u8> {
    let pixels = element(0x7FE0_0010, b"OW", &values.map(u16::to_le_bytes).concat());
    file_with(b"1.2.840.10008.1.2.1\0", position, pixels)
}

/// The same in JPEG without loss, in so many parts.
fn jpeg_file(parts: usize) -> Vec<u8> {
    let item = |bytes: &[u8]| {
        [&0xE000_FFFE_u32.to_le_bytes()[..], &(bytes.len() as u32).to_le_bytes(), bytes].concat()
    };
    let picture = [&LOSSLESS[..], &[0]].concat();
    let parts: Vec<u8> = picture.chunks(picture.len() / parts).flat_map(item).collect();
    let head = [0xE0, 0x7F, 0x10, 0x00, b'O', b'B', 0, 0, 0xFF, 0xFF, 0xFF, 0xFF];
    let pixels = [&head[..], &item(&[]), &parts, &0xE0DD_FFFE_u32.to_le_bytes(), &[0; 4]].concat();
    file_with(b"1.2.840.10008.1.2.4.70", b"1\\2\\3 ", pixels)
}

fn file_with(syntax: &[u8], position: &[u8], pixels: Vec<u8>) -> Vec<u8> {
    let short = |tag, number: u16| element(tag, b"US", &number.to_le_bytes());
    let item = element(0x0008_1150, b"UI", b"1.2\0");
    let item = [&0xE000_FFFE_u32.to_le_bytes()[..], &(item.len() as u32).to_le_bytes(), &item].concat();
    [
        vec![0; 128],
        b"DICM".to_vec(),
        element(0x0002_0010, b"UI", syntax),
        element(0x0008_1140, b"SQ", &item),
        element(0x0010_0010, b"PN", b"Doe^Jane"),
        element(0x0020_000E, b"UI", b"1.2.3\0"),
        element(0x0020_0032, b"DS", position),
        element(0x0020_0037, b"DS", b"1\\0\\0\\0\\1\\0 "),
        element(0x0028_0030, b"DS", b"0.5\\0.25"),
        short(0x0028_0010, 2),
        short(0x0028_0011, 3),
        short(0x0028_0100, 16),
        short(0x0028_0101, 12),
        short(0x0028_0102, 11),
        short(0x0028_0103, 1),
        element(0x0028_1052, b"DS", b"-5"),
        pixels,
    ]
    .concat()
}

fn read(bytes: &[u8]) -> Result<(Header, Vec<u8>), ReadError> {
    let mut source = Dicom.open_input(Input::from_bytes(bytes))?;
    let header = source.header().clone();
    assert!(header.bytes().unwrap() < 1 << 24);
    let mut values = vec![0; header.bytes().unwrap() as usize];
    source.read(&mut values)?;
    Ok((header, values))
}

#[test]
fn bits_that_count_are_taken_with_their_sign() {
    let (header, values) = read(&file(b"1\\2\\3 ", [1, 0xF001, 0xFFF, 0x0FFE, 0x800, 0x7FF])).unwrap();
    let expected = [1, 1, -1, -2, -2048, 2047].map(i16::to_le_bytes).concat();
    assert_eq!((header.extent, values), ([3, 2, 1], expected));
    let metadata = &header.metadata;
    assert_eq!(metadata.field("space directions"), Some("(0.25,0,0) (0,0.5,0) (0,0,1)"));
    assert_eq!(metadata.field("space origin"), Some("(1,2,3)"));
    assert_eq!(metadata.geometry().unwrap().spacing(), [0.25, 0.5, 1.0]);
    assert_eq!(metadata.key_value("dicom.0028,1052"), Some("-5"));
    assert_eq!(metadata.key_value("dicom.0010,0010"), Some("Doe^Jane"));
}

#[test]
fn jpeg_without_loss_is_read() {
    // Twelve bits with a sign.
    let expected = [1, -2048, -1, 100, -1096, 7].map(i16::to_le_bytes).concat();
    for parts in [1, 2, 4] {
        let (header, values) = read(&jpeg_file(parts)).unwrap();
        assert_eq!((header.extent, &values), ([3, 2, 1], &expected));
    }
    let whole = jpeg_file(1);
    for end in 0..whole.len() - 9 {
        assert_eq!(read(&whole[..end]).unwrap_err().kind(), Fault::Data, "{end}");
    }
    let other = file_with(b"1.2.840.10008.1.2.4.80", b"0", vec![]);
    let told = read(&other).unwrap_err().to_string();
    assert!(told.contains("1.2.840.10008.1.2.4.80 (JPEG-LS)") && told.contains("dcmdjpls"), "{told}");
}

#[test]
fn a_folder_is_sorted_by_position() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, z: u16| {
        let place = format!("0\\0\\{:4}", z * 2);
        std::fs::write(folder.path().join(name), file(place.as_bytes(), [z; 6])).unwrap();
    };
    for (name, z) in [("a", 3), ("b", 0), ("c", 2), ("d", 1)] {
        write(name, z);
    }
    let mut source = crate::volume::open(folder.path(), None).unwrap();
    let mut values = vec![0; 48];
    source.read(&mut values).unwrap();
    assert_eq!(source.header().extent, [3, 2, 4]);
    assert!(source.header().metadata.field("space directions").unwrap().ends_with("(0,0,2)"));
    assert!(values.iter().step_by(12).copied().eq(0..4));
    std::fs::remove_file(folder.path().join("c")).unwrap();
    let error = crate::volume::open(folder.path(), None).err().unwrap();
    assert!(error.to_string().contains("a slice is missing: \"d\" and \"a\" are 4.0000 mm apart"), "{error}");
}

#[test]
fn hostile_files_return() {
    let whole = file(b"1\\2\\3 ", [1, 2, 3, 4, 5, 6]);
    for end in 0..whole.len() {
        assert_eq!(read(&whole[..end]).unwrap_err().kind(), Fault::Data, "{end}");
    }
    for whole in [whole, jpeg_file(2)] {
        for index in 128..whole.len() {
            for change in 1..=255 {
                let mut changed = whole.clone();
                changed[index] ^= change;
                let _either = read(&changed);
            }
        }
    }
}

/// A volume with what files of a CT say, and words of NRRD's own.
fn volume(element: ElementType, components: u32, extent: [u64; 3]) -> (Header, Vec<u8>) {
    let mut metadata = Metadata::plain(3, FileFormat::Nrrd);
    for (name, value) in [
        ("space", "left-posterior-superior"),
        ("space directions", "(0.3,0.4,0) (0,0,-0.75) (-2,1.5,0)"),
        ("space origin", "(-100.5,0.25,0.00001)"),
        ("space units", "\"mm\" \"mm\" \"mm\""),
    ] {
        metadata.set_field(name, value);
    }
    for (key, value) in [
        ("dicom.0008,0016", "1.2.840.10008.5.1.4.1.1.2"),
        ("dicom.0008,0060", "CT"),
        ("dicom.0010,0010", "Müller^Jane"),
        ("dicom.0018,0050", "2.5"),
        ("dicom.0020,000d", "1.2.3"),
        ("dicom.0028,0120 SS", "-2000"),
        ("dicom.0028,1052", "-1024;-1000;-976"),
        ("dicom.0028,1053", "1"),
        ("dicom.0011,1001", "whatever that is"),
        ("other", "not DICOM's"),
    ] {
        metadata.set_key_value(key, value);
    }
    let header = Header { components, ..Header::scalar(extent, element, metadata) };
    let count = header.bytes().unwrap();
    (header, (0..count).map(|at| (at * 37 % 251) as u8).collect())
}

fn write(path: &Path, header: &Header, values: &[u8]) -> Vec<String> {
    let Created { mut sink, losses } = crate::volume::create(path, header, &WriteOptions::default()).unwrap();
    values.chunks(5).for_each(|part| sink.write(part).unwrap());
    sink.finish().unwrap();
    losses
}

fn read_path(path: &Path) -> (Header, Vec<u8>) {
    let mut source = crate::volume::open(path, None).unwrap();
    let mut values = vec![0; source.header().bytes().unwrap() as usize];
    source.read(&mut values).unwrap();
    (source.header().clone(), values)
}

#[test]
fn what_is_written_is_read_again() {
    for (element, components) in [
        (ElementType::U8, 1),
        (ElementType::I8, 1),
        (ElementType::U16, 1),
        (ElementType::I16, 1),
        (ElementType::U32, 1),
        (ElementType::I32, 1),
        (ElementType::U8, 3),
    ] {
        for (name, depth) in [("s/%02d.dcm", 3), ("v.dcm", 3), ("v.dcm", 1)] {
            let folder = tempfile::tempdir().unwrap();
            let (header, values) = volume(element, components, [5, 3, depth]);
            assert_eq!(write(&folder.path().join(name), &header, &values), ["1 key/value pair"]);
            let place = folder.path().join(name.split('/').next().unwrap());
            let (found, back) = read_path(&place);
            assert!(back == values, "{element} {name}");
            assert_eq!((found.extent, found.components), (header.extent, components));
            let is =
                |name: &str| assert_eq!(found.metadata.field(name), header.metadata.field(name), "{name}");
            ["space", "space directions", "space origin", "space units"].into_iter().for_each(is);
            let key = |key: &str| found.metadata.key_value(key).map(str::to_owned);
            assert_eq!(key("dicom.0010,0010").as_deref(), Some("Müller^Jane"));
            assert_eq!(key("dicom.0020,000d").as_deref(), Some("1.2.3"));
            assert_eq!(key("dicom.0011,1001").as_deref(), Some("whatever that is"));
            if name.starts_with('s') {
                assert_eq!(key("dicom.0028,1052").as_deref(), Some("-1024;-1000;-976"));
            }
        }
    }
}

#[test]
fn equal_volumes_have_equal_files_and_others_have_other_identifiers() {
    for (name, depth) in [("s/%02d.dcm", 3), ("v.dcm", 3), ("v.dcm", 1)] {
        let (header, values) = volume(ElementType::U16, 1, [5, 3, depth]);
        let mut other = values.clone();
        other[0] ^= 1;
        let files = [&values, &values, &other].map(|values| {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(name);
            write(&path, &header, values);
            let first = if name.contains('%') { folder.path().join("s/00.dcm") } else { path };
            std::fs::read(first).unwrap()
        });
        assert!(files[0] == files[1], "{name}");
        let identifiers = files.each_ref().map(|bytes| {
            let set = DataSet::read(&mut Input::from_bytes(bytes)).unwrap();
            [0x0008_0018, 0x0020_000E].map(|tag| set.text(tag).unwrap())
        });
        assert!((0..2).all(|tag| identifiers[0][tag] != identifiers[2][tag]), "{identifiers:?}");
    }
}

#[test]
fn rescaling_of_each_frame_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("v.dcm");
    let (header, values) = volume(ElementType::I16, 1, [5, 3, 3]);
    write(&path, &header, &values);
    let (found, _) = read_path(&path);
    assert_eq!(found.metadata.key_value("dicom.0028,1052"), Some("-1024;-1000;-976"));
}

/// A file of frames of one sample of u8 in these places along z.
fn frames(places: &[f64], offsets: &str) -> Vec<u8> {
    let text = |tag: Tag, words: &str| {
        let mut elements = Elements::default();
        elements.text(tag, words);
        elements
    };
    let mut all = text(0x0020_0037, "1\\0\\0\\0\\1\\0");
    all.extend(text(0x0028_0030, "1\\1"));
    all.extend(text(0x0028_0008, &places.len().to_string()));
    for (tag, number) in
        [(0x0028_0010, 1), (0x0028_0011, 1), (0x0028_0100, 8), (0x0028_0101, 8), (0x0028_0102, 7)]
    {
        all.numbers(tag, &[number]);
    }
    if offsets.is_empty() {
        let frames: Vec<Elements> = places
            .iter()
            .map(|place| {
                let mut frame = Elements::default();
                frame.sequence(0x0020_9113, &[text(super::POSITION, &format!("0\\0\\{place}"))]);
                frame
            })
            .collect();
        all.sequence(super::dataset::PER_FRAME, &frames);
    } else {
        all.extend(text(super::POSITION, "0\\0\\5"));
        all.extend(text(0x3004_000C, offsets));
    }
    let mut file = super::elements::beginning("1.2", "1.2.3");
    file.extend(all.encoded());
    super::elements::head(&mut file, 0x7FE0_0010, places.len().next_multiple_of(2) as u32);
    file.extend((0..places.len().next_multiple_of(2)).map(|frame| frame as u8));
    file
}

#[test]
fn frames_are_sorted_by_their_places() {
    let (header, values) = read(&frames(&[4.0, 0.0, 2.0], "")).unwrap();
    assert_eq!((header.extent, values), ([1, 1, 3], vec![1, 2, 0]));
    assert_eq!(header.metadata.geometry().unwrap().directions[2], [0.0, 0.0, 2.0]);
    // Time steps, in the order of the file.
    let (header, values) = read(&frames(&[4.0, 0.0, 0.0, 4.0], "")).unwrap();
    assert_eq!((header.extent, header.steps, values), ([1, 1, 2], 2, vec![1, 0, 2, 3]));
    // No grid: as they follow each other, and nowhere.
    let (header, values) = read(&frames(&[9.0, 0.0, 1.0, 2.0], "")).unwrap();
    assert_eq!((header.extent, values), ([1, 1, 4], vec![0, 1, 2, 3]));
    assert_eq!(header.metadata.geometry(), None);
    // Planes of dose.
    let (header, values) = read(&frames(&[0.0; 3], "0\\3\\6")).unwrap();
    assert_eq!((header.extent, values), ([1, 1, 3], vec![0, 1, 2]));
    assert_eq!(header.metadata.field("space origin"), Some("(0,0,5)"));
    assert_eq!(header.metadata.geometry().unwrap().directions[2], [0.0, 0.0, 3.0]);
}

#[test]
fn bits_are_read_across_bytes_and_frames() {
    let mut all = Elements::default();
    all.text(0x0028_0008, "3");
    for (tag, number) in
        [(0x0028_0010, 1), (0x0028_0011, 5), (0x0028_0100, 1), (0x0028_0101, 1), (0x0028_0102, 0)]
    {
        all.numbers(tag, &[number]);
    }
    let mut file = super::elements::beginning("1.2", "1.2.3");
    file.extend(all.encoded());
    super::elements::head(&mut file, 0x7FE0_0010, 2);
    file.extend([0b1010_0111, 0b0110_0001]);
    let (header, values) = read(&file).unwrap();
    assert_eq!((header.extent, header.element), ([5, 1, 3], ElementType::U8));
    assert_eq!(values, [1, 1, 1, 0, 0, 1, 0, 1, 1, 0, 0, 0, 0, 1, 1]);
    file.pop();
    assert_eq!(read(&file).unwrap_err().kind(), Fault::Data);
}

#[test]
fn a_copy_of_a_slice_is_told() {
    let folder = tempfile::tempdir().unwrap();
    for (name, z) in [("a", 0_u16), ("b", 2), ("c", 4), ("copy", 2)] {
        let bytes = file(format!("0\\0\\{z:4}").as_bytes(), [z; 6]);
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let error = crate::volume::open(folder.path(), None).err().unwrap().to_string();
    assert!(error.contains("\"b\" and \"copy\" are 0.0000 mm apart, others 2.0000 mm: a copy"), "{error}");
}

#[test]
fn samples_of_nowhere_stay_in_their_order() {
    let folder = tempfile::tempdir().unwrap();
    let metadata = Metadata::default();
    let header = Header::scalar([4, 2, 12], ElementType::U8, metadata);
    let values: Vec<u8> = (0..96).collect();
    assert!(write(&folder.path().join("n_%d.dcm"), &header, &values).is_empty());
    let (found, back) = read_path(folder.path());
    assert_eq!((found.extent, back), ([4, 2, 12], values));
    assert_eq!(found.metadata.geometry(), None);
    // No file is written among others of such names.
    assert!(
        crate::volume::create(folder.path().join("n_%d.dcm"), &header, &WriteOptions::default()).is_err()
    );
}

#[test]
fn what_dicom_cannot_hold_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, header: &Header| {
        let created = crate::volume::create(folder.path().join(name), header, &WriteOptions::default());
        created.map(|_| ()).unwrap_err().to_string()
    };
    let of = |element, extent| volume(element, 1, extent).0;
    let scalar = |extent| Header { extent, ..of(ElementType::U8, [1; 3]) };
    assert!(refused("a.dcm", &of(ElementType::F32, [2; 3])).contains("floating-point numbers"));
    assert!(refused("a.dcm", &volume(ElementType::U16, 3, [2; 3]).0).contains("three of u8"));
    assert!(refused("a.dcm", &scalar([70_000, 1, 1])).contains("65,535"));
    assert!(refused("a.dcm", &scalar([65_535, 65_535, 2])).contains("slice_%04d.dcm"));
    assert!(refused("a.dcm", &Header { steps: 2, ..scalar([2; 3]) }).contains("time steps"));
    assert!(std::fs::read_dir(folder.path()).unwrap().next().is_none());
}
