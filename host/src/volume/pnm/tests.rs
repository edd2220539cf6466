use super::*;
use crate::volume::{Fault, InMemory, create as create_volume, open as open_volume};

/// Header and values of a file.
fn read(bytes: &[u8]) -> Result<(Header, Vec<u8>), ReadError> {
    let mut source = open(Input::from_bytes(bytes))?;
    let header = source.header().clone();
    let mut values = vec![0; header.bytes().unwrap() as usize];
    source.read(&mut values)?;
    Ok((header, values))
}

fn values(numbers: &[u16]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

#[test]
fn each_kind_is_read() {
    let (header, found) = read(b"P2 # a\n#b c\n3 2\n4095\n1 2 3\n4 5 4095").unwrap();
    assert_eq!((header.extent, header.element, header.components), ([3, 2, 1], ElementType::U16, 1));
    assert_eq!(found, values(&[1, 2, 3, 4, 5, 4095]));
    assert_eq!(header.metadata.key_value(MAXVAL), Some("4095"));
    let comments = [" a", "b c"].map(|text| HeaderLine::Comment(text.to_owned()));
    assert_eq!(header.metadata.lines[..2], comments);

    let (header, found) = read(b"P3\n1 2 255\n1 2 3\n250 251 252\n").unwrap();
    assert_eq!((header.extent, header.components, found), ([1, 2, 1], 3, vec![1, 2, 3, 250, 251, 252]));
    let (header, found) = read(b"P5\n2 1\n65535\n\x01\x02\x03\x04").unwrap();
    assert_eq!((header.metadata.lines.len(), found), (0, values(&[0x102, 0x304])));
    let (header, found) = read(b"P6 1 1 255 abc").unwrap();
    assert_eq!((header.components, found), (3, b"abc".to_vec()));
    let floats = [1.5_f32, -2.0, 3e9, f32::NAN];
    let bytes: Vec<u8> = floats.iter().flat_map(|value| value.to_le_bytes()).collect();
    let (header, found) = read(&[b"Pf\n2 2\n-0.5\n", &bytes[..]].concat()).unwrap();
    assert_eq!(found, [&bytes[8..], &bytes[..8]].concat());
    assert_eq!(header.metadata.key_value(SCALE), Some("0.5"));
}

#[test]
fn files_come_back_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    for (name, file) in [
        ("a.pgm", &b"P5\n# one\n3 2\n4095\n\x00\x01\x00\x02\x00\x03\x0f\xff\x00\x05\x00\x06"[..]),
        ("a.pgm", b"P5\n3 1\n7\n\x00\x07\x03"),
        ("a.pnm", b"P6\n1 2\n255\nabcdef"),
        ("a.pfm", b"PF\n1 2\n2.5\n\x3f\x80\0\0\x40\0\0\0\x40\x40\0\0\x40\x80\0\0\x7f\xc0\0\x01\xff\x80\0\0"),
        ("a.pfm", b"Pf\n3 1\n-1.0\n\0\0\x80\x3f\0\0\0\x40\x01\0\0\0"),
    ] {
        let (header, found) = read(file).unwrap();
        let path = folder.path().join(name);
        let mut created = create_volume(&path, &header, &WriteOptions::default()).unwrap();
        assert_eq!(created.losses, [""; 0]);
        found.chunks(5).for_each(|part| created.sink.write(part).unwrap());
        created.sink.finish().unwrap();
        assert!(std::fs::read(&path).unwrap() == file, "{name}");
        let again = open_volume(&path, None).unwrap();
        assert_eq!(again.header(), &header);
    }
}

#[test]
fn what_cannot_be_held_is_said() {
    let plain = |extent, element| Header::scalar(extent, element, Metadata::plain(2, FileFormat::Raw));
    let create = |name: &str, header: &Header| match create(Path::new(name), header, &WriteOptions::default())
    {
        Err(WriteError::CannotHold { what, .. }) => what,
        other => panic!("{other:?}"),
    };
    assert!(create("a.pgm", &plain([2, 2, 1], ElementType::I16)).contains("i16"));
    assert!(create("a.pgm", &plain([2, 2, 2], ElementType::U8)).contains("slice_%04d.pgm"));
    assert!(create("a.pgm", &plain([2, 2, 1], ElementType::F32)).ends_with("write .pfm"));
    assert!(
        create("a.pgm", &Header { components: 3, ..plain([2, 2, 1], ElementType::U8) })
            .ends_with("write .ppm")
    );
    assert!(
        create("a.ppm", &Header { components: 2, ..plain([2, 2, 1], ElementType::U8) })
            .contains("2 components")
    );

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pgm");
    let (header, _) = read(b"P5 1 1 7 \x07").unwrap();
    let mut created = create_volume(&path, &header, &WriteOptions::default()).unwrap();
    created.sink.write(&[8]).unwrap();
    created.sink.finish().unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"P5\n1 1\n255\n\x08");
}

#[test]
fn hostile_files_return() {
    for file in [
        &b"P5\n# one\n3 2\n4095\n\x00\x01\x00\x02\x00\x03\x0f\xff\x00\x05\x00\x06"[..],
        b"P2\n3 2 200 \n1 2 3 4 5 6 ",
        b"Pf\n3 1\n-1.0\n\0\0\x80\x3f\0\0\0\x40\x01\0\0\0",
    ] {
        for end in 0..file.len() - 2 {
            assert_eq!(read(&file[..end]).unwrap_err().kind(), Fault::Data, "{end}");
        }
        for index in 0..file.len() {
            for change in 1..=255 {
                let mut changed = file.to_vec();
                changed[index] ^= change;
                let _either = read(&changed);
            }
        }
    }
    let promise = b"P5 4000000000 4000000000 255 ";
    assert!(read(promise).unwrap_err().to_string().contains("promises 16000000000000000000 bytes"));
    let long = [b"P5 #".to_vec(), vec![b'x'; 1 << 17]].concat();
    assert!(read(&long).unwrap_err().to_string().contains("longer than 65536 bytes"));
    for (file, part) in [
        (&b"P4 1 1 \0"[..], "single bits"),
        (b"P7\n", "arbitrary channels"),
        (b"GIF8", "begins with \"GI\""),
        (b"P5 0 1 255 ", "width is 0"),
        (b"P5 1 1 65536 \0", "largest value is 65536"),
        (b"P5 1 -1 255 \0", "\"-1\" stands where the height belongs"),
        (b"P2 1 1 255 256", "value of a sample is 256"),
        (b"Pf 1 1 nan \0\0\0\0", "scale"),
    ] {
        let error = read(file).unwrap_err();
        assert!(error.to_string().contains(part), "{error}");
    }
}

#[test]
fn a_volume_in_memory_goes_out_slice_by_slice() {
    let folder = tempfile::tempdir().unwrap();
    let header = Header::scalar([2, 2, 3], ElementType::U8, Metadata::default());
    let samples: Vec<u8> = (0..12).collect();
    let mut memory = InMemory::of(header.clone(), &samples).unwrap();
    let path = folder.path().join("new/s_%02d.pgm");
    let mut created = create_volume(&path, &header, &WriteOptions::default()).unwrap();
    let mut all = vec![0; 12];
    memory.read(&mut all).unwrap();
    created.sink.write(&all).unwrap();
    created.sink.finish().unwrap();
    assert_eq!(std::fs::read(folder.path().join("new/s_02.pgm")).unwrap(), b"P5\n2 2\n255\n\x08\x09\x0a\x0b");
}
