use super::*;
use crate::volume::jpeg::tests::LOSSLESS;
use crate::volume::{ElementType, Fault, HeaderLine, create as create_volume, open as open_volume};

fn read(bytes: &[u8]) -> Result<(Header, Vec<u8>), ReadError> {
    let mut source = Tiff.open_input(Input::from_bytes(bytes))?;
    let header = source.header().clone();
    // What a file of a few hundred bytes can promise.
    assert!(header.bytes().unwrap() < 1 << 24);
    let mut values = vec![0; header.bytes().unwrap() as usize];
    source.read(&mut values)?;
    Ok((header, values))
}

fn write(header: &Header, values: &[u8], options: WriteOptions) -> (Vec<u8>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tif");
    let mut created = create_volume(&path, header, &options).unwrap();
    values.chunks(7).for_each(|part| created.sink.write(part).unwrap());
    created.sink.finish().unwrap();
    assert_eq!(open_volume(&path, None).unwrap().header().extent, header.extent);
    (std::fs::read(&path).unwrap(), created.losses)
}

fn header(extent: [u64; 3], components: u32, steps: u64, element: ElementType) -> Header {
    Header { components, steps, ..Header::scalar(extent, element, Metadata::plain(3, FileFormat::Tiff)) }
}

fn values(header: &Header) -> Vec<u8> {
    (0..header.bytes().unwrap()).map(|at| (at * 37 % 251) as u8).collect()
}

#[test]
fn all_shapes_and_types_come_back() {
    for element in ElementType::ALL {
        for (extent, components, steps) in
            [([5, 3, 1], 1, 1), ([5, 3, 4], 1, 1), ([3, 3, 2], 3, 1), ([3, 1, 2], 2, 3), ([1, 2, 1], 5, 2)]
        {
            for byte_order in [ByteOrder::Little, ByteOrder::Big] {
                for gzip in [false, true] {
                    let header = header(extent, components, steps, element);
                    let values = values(&header);
                    let options = WriteOptions { byte_order: Some(byte_order), gzip };
                    let (file, losses) = write(&header, &values, options);
                    let (found, read) = read(&file).unwrap();
                    assert_eq!(losses, [""; 0]);
                    assert_eq!(
                        (found.extent, found.components, found.steps, found.element),
                        (extent, components, steps, element)
                    );
                    assert!(read == values);
                }
            }
        }
    }
}

#[test]
fn distances_and_texts_come_back() {
    let mut header = header([4, 3, 2], 1, 1, ElementType::U16);
    let field =
        |name: &str, value: &str| HeaderLine::Field { name: name.to_owned(), value: value.to_owned() };
    header.metadata.lines = vec![
        field("spacings", "0.3 0.125 1.7"),
        field("units", "\"µm\" \"µm\" \"µm\""),
        field("content", "x"),
    ];
    let (file, losses) = write(&header, &values(&header), WriteOptions::default());
    assert_eq!(losses, ["content"]);
    let (found, _) = read(&file).unwrap();
    assert_eq!(found.metadata.lines[..2], header.metadata.lines[..2]);
    let (again, losses) = write(&found, &values(&header), WriteOptions::default());
    assert_eq!(losses, [""; 0]);
    assert!(again == file);
}

#[test]
fn hostile_files_return() {
    for (gzip, components) in [(false, 1), (true, 3)] {
        let header = header([5, 4, 2], components, 1, ElementType::U16);
        let options = WriteOptions { byte_order: Some(ByteOrder::Big), gzip };
        let (file, _) = write(&header, &values(&header), options);
        for end in (0..file.len() - 2).step_by(3) {
            assert_eq!(read(&file[..end]).unwrap_err().kind(), Fault::Data, "{end}");
        }
        for index in 0..file.len() {
            for change in [1, 16, 128, 255] {
                let mut changed = file.clone();
                changed[index] ^= change;
                let _either = read(&changed);
            }
        }
    }
}

/// A page of 3 by 2 samples of 16 bits in one strip of JPEG, with tables of their own or not.
fn jpeg(has_tables: bool) -> Vec<u8> {
    let entry = |tag: u16, kind: u16, count: usize, value: usize| {
        let [count, value] = [count, value].map(|number| (number as u32).to_le_bytes());
        [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &count, &value].concat()
    };
    // The table of the codes stands behind the mark of the start.
    let (start, table, rest) = (&LOSSLESS[..2], &LOSSLESS[2..27], &LOSSLESS[27..]);
    let strip = if has_tables { [start, rest].concat() } else { LOSSLESS.to_vec() };
    let tables = [start, table, &[0xFF, 0xD9]].concat();
    let numbers = [(256, 3), (257, 2), (258, 16), (259, 7), (262, 1), (273, 8), (277, 1), (278, 2)];
    let mut entries: Vec<_> = numbers.map(|(tag, number)| entry(tag, 3, 1, number)).into();
    entries.push(entry(279, 4, 1, strip.len()));
    if has_tables {
        entries.push(entry(347, 7, tables.len(), 8 + strip.len()));
    }
    let directory = [&(entries.len() as u16).to_le_bytes()[..], &entries.concat(), &[0; 4]].concat();
    let place = (8 + strip.len() + tables.len()) as u32;
    [&b"II*\0"[..], &place.to_le_bytes(), &strip, &tables, &directory].concat()
}

#[test]
fn jpeg_is_read() {
    let expected = [1_u16, 2048, 4095, 100, 3000, 7].map(u16::to_le_bytes).concat();
    for file in [jpeg(false), jpeg(true)] {
        let (header, values) = read(&file).unwrap();
        assert_eq!((header.extent, header.element, &values), ([3, 2, 1], ElementType::U16, &expected));
        for at in 0..file.len() {
            for by in [1, 0x10, 0x80, 0xFF] {
                let mut changed = file.clone();
                changed[at] ^= by;
                let _either = read(&changed);
            }
            let _either = read(&file[..at]);
        }
    }
}

/// A page of samples of one byte: its extent, how it is compressed, what kind it is, its description, what is stored.
struct Stored<'a> {
    extent: [usize; 2],
    compression: usize,
    kind: usize,
    description: &'a str,
    strip: &'a [u8],
}

/// A file of such pages.
fn pages(pages: &[Stored<'_>]) -> Vec<u8> {
    let mut file = b"II*\0\0\0\0\0".to_vec();
    let mut link = 4;
    for page in pages {
        let text = [page.description.as_bytes(), &[0; 5]].concat();
        let [strip, description] = [file.len(), file.len() + page.strip.len()];
        file.extend([page.strip, &text].concat());
        let here = file.len() as u32;
        file[link..link + 4].copy_from_slice(&here.to_le_bytes());
        let [width, height] = page.extent;
        let entries = [
            (254, 4, 1, page.kind),
            (256, 4, 1, width),
            (257, 4, 1, height),
            (258, 3, 1, 8),
            (259, 3, 1, page.compression),
            (262, 3, 1, 1),
            (270, 2, text.len(), description),
            (273, 4, 1, strip),
            (278, 4, 1, height),
            (279, 4, 1, page.strip.len()),
        ];
        file.extend((entries.len() as u16).to_le_bytes());
        for (tag, kind, count, value) in entries {
            file.extend([tag as u16, kind].into_iter().flat_map(u16::to_le_bytes));
            file.extend([count as u32, value as u32].into_iter().flat_map(u32::to_le_bytes));
        }
        link = file.len();
        file.extend([0; 4]);
    }
    file
}

#[test]
fn smaller_pictures_of_a_page_are_no_slices() {
    let page =
        |extent: [usize; 2], kind, strip| Stored { extent, compression: 1, kind, description: "", strip };
    let whole = [1, 2, 3, 4, 5, 6];
    let file = pages(&[page([3, 2], 0, &whole), page([2, 1], 1, &[9, 9]), page([3, 2], 4, &[8; 6])]);
    let (header, values) = read(&file).unwrap();
    assert_eq!((header.extent, values), ([3, 2, 1], whole.to_vec()));
    assert_eq!(header.metadata.key_value("tiff.left_out"), Some("2 smaller pictures or masks"));
    // But the only page is one, whatever it says.
    assert_eq!(read(&pages(&[page([3, 2], 1, &whole)])).unwrap().1, whole);
}

#[test]
fn shapes_of_tifffile_tell_time_from_slices() {
    let shaped = |description: &str, count: u8| {
        let strips: Vec<[u8; 2]> = (0..count).map(|page| [page, page]).collect();
        let stack: Vec<Stored<'_>> = strips
            .iter()
            .map(|strip| Stored { extent: [2, 1], compression: 1, kind: 0, description, strip })
            .collect();
        let (header, values) = read(&pages(&stack)).unwrap();
        (
            header.extent[2],
            header.steps,
            header.components,
            values.iter().step_by(2).copied().collect::<Vec<_>>(),
        )
    };
    let all = || (0..6).collect::<Vec<u8>>();
    assert_eq!(shaped(r#"{"shape": [6, 1, 2]}"#, 6), (6, 1, 1, all()));
    assert_eq!(shaped(r#"{"shape": [2, 3, 1, 2]}"#, 6), (3, 2, 1, all()));
    assert_eq!(shaped(r#"{"shape": [3, 2, 1, 2], "axes": "ZTYX"}"#, 6), (3, 2, 1, vec![0, 2, 4, 1, 3, 5]));
    // Two channels: values 0 and 3 of the first sample stand side by side, then again for the second.
    let (slices, steps, channels, values) = shaped(r#"{"shape": [2, 3, 1, 2], "axes": "CZYX"}"#, 6);
    assert_eq!((slices, steps, channels, values), (3, 1, 2, vec![0, 0, 1, 1, 2, 2]));
    for odd in
        [r#"{"shape": [7, 1, 2]}"#, r#"{"shape": [2, 3, 1, 2], "axes": "QQYX"}"#, "{", r#"{"shape": []}"#]
    {
        assert_eq!(shaped(odd, 6), (6, 1, 1, all()), "{odd}");
    }
}

#[test]
fn zstandard_is_read() {
    let samples: Vec<u8> = (0..600).map(|at| (at / 7) as u8).collect();
    let strip = ruzstd::encoding::compress_to_vec(&samples[..], ruzstd::encoding::CompressionLevel::Fastest);
    let page = Stored { extent: [30, 20], compression: 50_000, kind: 0, description: "", strip: &strip };
    let file = pages(&[page]);
    assert_eq!(read(&file).unwrap().1, samples);
    for at in 8..8 + strip.len() {
        for by in [1, 0x10, 0x80, 0xFF] {
            let mut changed = file.clone();
            changed[at] ^= by;
            let _either = read(&changed);
        }
    }
}
