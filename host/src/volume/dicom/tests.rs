use super::*;
use crate::volume::Fault;
use crate::volume::jpeg::tests::LOSSLESS;

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
    assert!(told.contains("1.2.840.10008.1.2.4.80 (JPEG-LS)") && told.contains("gdcmconv --raw"), "{told}");
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
