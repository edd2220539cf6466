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
