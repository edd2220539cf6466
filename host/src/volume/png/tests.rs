use super::*;
use crate::volume::{Fault, create as create_volume, open as open_volume};

/// Header and values of a file.
fn read(bytes: &[u8]) -> Result<(Header, Vec<u8>), ReadError> {
    let mut source = Png.open_input(Input::from_bytes(bytes))?;
    let header = source.header().clone();
    let mut values = vec![0; header.bytes().unwrap() as usize];
    source.read(&mut values)?;
    Ok((header, values))
}

fn write(header: &Header, values: &[u8]) -> (Vec<u8>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let mut created = create_volume(&path, header, &WriteOptions::default()).unwrap();
    values.chunks(5).for_each(|part| created.sink.write(part).unwrap());
    created.sink.finish().unwrap();
    assert_eq!(open_volume(&path, None).unwrap().header().extent, header.extent);
    (std::fs::read(&path).unwrap(), created.losses)
}

fn slice(width: u64, components: u32, element: ElementType) -> Header {
    Header { components, ..Header::scalar([width, 3, 1], element, Metadata::plain(2, FileFormat::Png)) }
}

/// A file as the crate's encoder makes it.
fn file(
    color: ColorType,
    depth: BitDepth,
    samples: &[u8],
    more: impl FnOnce(&mut Encoder<'_, &mut Vec<u8>>),
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, 3, 2);
    encoder.set_color(color);
    encoder.set_depth(depth);
    more(&mut encoder);
    encoder.write_header().unwrap().write_image_data(samples).unwrap();
    bytes
}

#[test]
fn all_types_come_back() {
    for components in 1..=4 {
        for element in [ElementType::U8, ElementType::U16] {
            let mut header = slice(5, components, element);
            if element == ElementType::U16 {
                header.metadata.source.byte_order = ByteOrder::Big;
            }
            let values: Vec<u8> = (0..header.bytes().unwrap()).map(|at| (at * 37 % 251) as u8).collect();
            let (file, losses) = write(&header, &values);
            assert_eq!((read(&file).unwrap(), losses), ((header, values), vec![]));
        }
    }
    for bits in [1_u8, 2, 4] {
        for width in 1..20 {
            let mut header = slice(width, 1, ElementType::U8);
            header.metadata.lines.push(pair(BITS, bits.to_string()));
            let mut values: Vec<u8> =
                (0..width * 3).map(|at| (at * 37 % 11) as u8 & ((1 << bits) - 1)).collect();
            let (file, _) = write(&header, &values);
            assert_eq!(file[24], bits);
            assert_eq!(read(&file).unwrap(), (header.clone(), values.clone()));
            values[2] = 1 << bits;
            let (file, _) = write(&header, &values);
            assert_eq!((file[24], read(&file).unwrap().1), (8, values));
        }
    }
}

#[test]
fn palettes_are_looked_up() {
    const COLORS: [u8; 9] = [1, 2, 3, 40, 50, 60, 7, 8, 9];
    let indices = [0b0001_1000, 0b0100_0000];
    let plain =
        file(ColorType::Indexed, BitDepth::Two, &indices, |encoder| encoder.set_palette(COLORS.as_slice()));
    let (header, values) = read(&plain).unwrap();
    assert_eq!((header.components, header.element, header.metadata.lines.len()), (3, ElementType::U8, 0));
    assert_eq!(values, [1, 2, 3, 40, 50, 60, 7, 8, 9, 40, 50, 60, 1, 2, 3, 1, 2, 3]);
    let alpha = file(ColorType::Indexed, BitDepth::Two, &indices, |encoder| {
        encoder.set_palette(COLORS.as_slice());
        encoder.set_trns(&[9][..]);
    });
    let (header, values) = read(&alpha).unwrap();
    assert_eq!((header.components, &values[..8]), (4, &[1, 2, 3, 9, 40, 50, 60, 255][..]));
}

#[test]
fn chunks_are_kept_and_written_again() {
    let original = file(ColorType::Grayscale, BitDepth::Eight, &[1, 2, 3, 4, 5, 6], |encoder| {
        encoder.set_source_gamma(::png::ScaledFloat::new(0.45));
        encoder.set_pixel_dims(Some(::png::PixelDimensions {
            xppu: 3125,
            yppu: 3937,
            unit: ::png::Unit::Meter,
        }));
        encoder.add_text_chunk("Title".to_owned(), "Größe".to_owned()).unwrap();
        encoder.add_ztxt_chunk("Comment".to_owned(), "long\n".repeat(9)).unwrap();
        encoder.add_itxt_chunk("Author".to_owned(), "Ωmega".to_owned()).unwrap();
    });
    let (header, values) = read(&original).unwrap();
    let metadata = &header.metadata;
    assert_eq!(metadata.field("spacings"), Some("0.00032 0.000254000508001016"));
    assert_eq!(metadata.key_value("png.text.Title"), Some("Größe"));
    assert_eq!(metadata.key_value("png.text.Author"), Some("Ωmega"));
    assert_eq!(metadata.key_value("png.text.Comment").map(str::len), Some(45));
    assert_eq!(metadata.key_value("png.gAMA"), Some("AACvyA=="));
    let (file, losses) = write(&header, &values);
    assert_eq!(losses, [""; 0]);
    let sorted = |mut header: Header| {
        header.metadata.lines.sort_by_key(|line| format!("{line:?}"));
        header
    };
    assert_eq!(sorted(read(&file).unwrap().0), sorted(header.clone()));

    let mut inexact = header;
    inexact.metadata.lines.retain(|line| matches!(line, HeaderLine::KeyValue { .. }));
    for (name, value) in [("spacings", "0.3 0.5"), ("units", "\"mm\" \"mm\""), ("content", "head")] {
        inexact.metadata.lines.push(HeaderLine::Field { name: name.to_owned(), value: value.to_owned() });
    }
    inexact.metadata.lines.push(pair("dicom.0028,1052", "-1024".to_owned()));
    let lost = ["spacings", "units", "content", r#"rescaling ("dicom.0028,1052" "-1024")"#];
    assert_eq!(write(&inexact, &values).1, lost);
}

#[test]
fn what_cannot_be_held_is_said() {
    let what = |header: &Header| match create(Path::new("a.png"), header) {
        Err(WriteError::CannotHold { what, .. }) => what,
        other => panic!("{other:?}"),
    };
    assert!(what(&slice(2, 1, ElementType::F32)).starts_with("f32, only u8 and u16"));
    assert!(what(&slice(2, 1, ElementType::I16)).starts_with("i16"));
    assert!(what(&slice(2, 5, ElementType::U8)).starts_with("5 components"));
    let mut deep = slice(2, 1, ElementType::U8);
    deep.extent[2] = 2;
    assert!(what(&deep).ends_with("\"slice_%04d.png\""));
}

#[test]
fn hostile_files_return() {
    let full = file(ColorType::Rgb, BitDepth::Sixteen, &[7; 36], |encoder| {
        encoder.add_ztxt_chunk("Comment".to_owned(), "long\n".repeat(9)).unwrap();
        encoder.add_itxt_chunk("Author".to_owned(), "Ωmega".to_owned()).unwrap();
    });
    let few_bits =
        file(ColorType::Indexed, BitDepth::Two, &[24, 64], |encoder| encoder.set_palette(&[5; 9][..]));
    for bytes in [full, few_bits] {
        // The last chunk says nothing.
        for end in 0..bytes.len() - 16 {
            assert_eq!(read(&bytes[..end]).unwrap_err().kind(), Fault::Data, "{end}");
        }
        for index in 0..bytes.len() {
            for change in 1..=255 {
                let mut changed = bytes.clone();
                changed[index] ^= change;
                let _either = read(&changed);
            }
        }
    }
    let mut wide = file(ColorType::Grayscale, BitDepth::Eight, &[0; 6], |_| ());
    wide[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    let header: [u8; 17] = wide[12..29].try_into().unwrap();
    wide[29..33].copy_from_slice(&crc(&header).to_be_bytes());
    assert_eq!(read(&wide).unwrap_err().kind(), Fault::Data);
}

fn crc(bytes: &[u8]) -> u32 {
    let mut crc = flate2::Crc::new();
    crc.update(bytes);
    crc.sum()
}
