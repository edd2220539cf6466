use std::fs;
use std::path::PathBuf;

use super::synthetic::{Kind, generate};
use super::*;

fn layout(extent: &str, element: ElementType, byte_order: ByteOrder) -> RawLayout {
    RawLayout { byte_order, ..RawLayout::new(extent.parse().unwrap(), element) }
}

fn file(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

#[test]
fn raw_files_come_back_byte_for_byte() {
    for element in ElementType::ALL {
        for order in [ByteOrder::Little, ByteOrder::Big] {
            let bytes: Vec<u8> = (0..24 * element.bytes()).map(|n| n as u8).collect();
            let (folder, path) = file("a.raw", &bytes);
            let volume = read(&path, Some(&layout("4x3x2", element, order))).unwrap();
            assert_eq!((volume.extent, volume.element), ([4, 3, 2], element));
            assert_eq!(volume.samples == bytes, order == ByteOrder::Little || element.bytes() == 1);
            let again = folder.path().join("b.dat");
            assert!(write(&volume, &again, &WriteOptions::default()).unwrap().is_empty());
            assert_eq!(fs::read(again).unwrap(), bytes);
        }
    }
}

#[test]
fn the_rows_of_a_box_are_those_of_its_samples() {
    let volume = generate(Kind::Noise, [5, 4, 3], ElementType::U16, 1);
    let rows: Vec<_> = volume.rows([1, 2, 1], [3, 2, 2]).collect();
    let firsts = [31, 36, 51, 56].map(|first| 2 * first);
    assert_eq!(rows, firsts.map(|first| &volume.samples[first..first + 6]));
    assert_eq!(volume.rows([0; 3], [5, 4, 3]).flatten().copied().collect::<Vec<_>>(), volume.samples);
}

#[test]
fn a_layout_that_does_not_fit_says_what_to_check() {
    let (_folder, path) = file("a.raw", &[0; 24]);
    let message = |extent: &str, element| {
        let error = read(&path, Some(&layout(extent, element, ByteOrder::Little))).unwrap_err();
        assert_eq!(error.kind(), Fault::Usage);
        error.to_string().split_once("a.raw: ").unwrap().1.to_owned()
    };
    assert_eq!(
        message("4x3x2", ElementType::U16),
        "4x3x2 of u16 is 48 bytes, the file has 24: check extent and type (it would fit samples of 1 byte, as u8)"
    );
    assert_eq!(
        message("5x2", ElementType::U16),
        "5x2 of u16 is 20 bytes, the file has 24: check extent and type; `skip` passes over a header, `components` and \
         `steps` take more values a sample and more volumes"
    );
    assert_eq!(
        message("100", ElementType::U8),
        "100 of u8 is 100 bytes, the file has 24: check extent and type"
    );
}

#[test]
fn files_are_known_by_name_then_by_their_first_bytes() {
    let nrrd = b"NRRD0001\ntype: uchar\ndimension: 1\nsizes: 2\nencoding: raw\n\nab";
    let (_folder, path) = file("volume", nrrd);
    assert_eq!(read(&path, None).unwrap().metadata.source.format, FileFormat::Nrrd);
    let whole = format!("{}", nrrd.len());
    let as_raw = read(&path, Some(&layout(&whole, ElementType::U8, ByteOrder::Little))).unwrap();
    assert_eq!(as_raw.samples, nrrd);
    let (folder, path) = file("volume.npy", b"");
    write(&as_raw, &path, &WriteOptions::default()).unwrap();
    let path_without_name = folder.path().join("volume.dat");
    fs::rename(&path, &path_without_name).unwrap();
    let path = path_without_name;
    assert_eq!(read(&path, None).unwrap().metadata.source.format, FileFormat::Npy);
    let (_folder, path) = file("volume.raw", b"ab");
    let error = read(&path, None).unwrap_err();
    assert_eq!(error.kind(), Fault::Usage);
    assert!(error.to_string().ends_with("a format that is read: give its layout"));
    let (_folder, path) = file("volume.NPY", b"ab");
    assert_eq!(read(&path, None).unwrap_err().kind(), Fault::Data);
    let error = read(Path::new("/no/such/volume.nrrd"), None).unwrap_err();
    assert_eq!(error.kind(), Fault::Io);
    assert_eq!(error.to_string(), "/no/such/volume.nrrd: cannot read: No such file or directory");
    let error = read(Path::new("/"), None).unwrap_err();
    assert_eq!(error.kind(), Fault::Data);
    assert!(error.to_string().starts_with("/: there are no slices"), "{error}");
}

#[test]
fn other_names_hide_no_format() {
    let folder = tempfile::tempdir().unwrap();
    let volume = generate(Kind::Waves, [5, 4, 3], ElementType::I16, 1);
    for (name, format) in [
        ("a.nrrd", FileFormat::Nrrd),
        ("a.npy", FileFormat::Npy),
        ("a.mha", FileFormat::MetaImage),
        ("a.mrc", FileFormat::Mrc),
        ("a.nii", FileFormat::Nifti),
        ("a.nii.gz", FileFormat::Nifti),
        ("a.tif", FileFormat::Tiff),
        ("a.dcm", FileFormat::Dicom),
        ("a.vtk", FileFormat::VtkLegacy),
        ("a.vti", FileFormat::VtkXml),
    ] {
        let [named, unnamed] = [name, "scan"].map(|name| folder.path().join(name));
        write(&volume, &named, &WriteOptions::default()).unwrap();
        fs::rename(&named, &unnamed).unwrap();
        let found = read(&unnamed, None).unwrap();
        assert_eq!((found.metadata.source.format, found.samples), (format, volume.samples.clone()), "{name}");
    }
    let told = |name: &str| {
        let (_folder, path) = file(name, b"ab");
        read(&path, None).unwrap_err().to_string()
    };
    assert!(told("a.fits").contains("save it as") && told("a.zip").contains("unpack"));
    assert!(told("a.bin").contains("neither name nor first bytes"));
}

#[test]
fn raw_files_may_have_a_header_components_steps_and_any_order() {
    // A value tells its place: c + 2 x + 6 y + 18 z + 36 t.
    let values: Vec<u8> = (0..108).collect();
    let whole = RawLayout { components: 2, steps: 3, ..layout("3x3x2", ElementType::U8, ByteOrder::Little) };
    let order: AxisOrder = "ztyxc".parse().unwrap();
    let mut turned = vec![0; 108];
    for place in 0..108_usize {
        let (c, x, y, z, t) = (place % 2, place / 2 % 3, place / 6 % 3, place / 18 % 2, place / 36);
        turned[z + 2 * t + 6 * y + 18 * x + 54 * c] = place as u8;
    }
    let layout = RawLayout { order, skip: 7, ..whole };
    let (folder, path) = file("a.raw", &[b"header ", &turned[..]].concat());
    let mut source = open(&path, Some(&layout)).unwrap();
    let mut found = vec![0; 108];
    source.read(&mut found).unwrap();
    assert_eq!((source.header().components, source.header().steps), (2, 3));
    assert_eq!(found, values);
    // Back in the order it had, and packed where the name says so.
    for name in ["b.raw", "b.raw.gz"] {
        let back = folder.path().join(name);
        let mut sink = create(&back, source.header(), &WriteOptions::default()).unwrap().sink;
        sink.write(&found).unwrap();
        sink.finish().unwrap();
        let bytes = fs::read(&back).unwrap();
        assert_eq!(bytes == turned, name == "b.raw");
        let mut again = open(&back, Some(&RawLayout { skip: 0, ..layout })).unwrap();
        again.read(&mut found).unwrap();
        assert_eq!(found, values, "{name}");
    }
    // Other formats have x, y and z in their own order.
    for name in ["b.nrrd", "b.npy", "b.tif", "b.nii"] {
        let other = folder.path().join(name);
        let mut sink = create(&other, source.header(), &WriteOptions::default()).unwrap().sink;
        sink.write(&values).unwrap();
        sink.finish().unwrap();
        let mut again = open(&other, None).unwrap();
        again.read(&mut found).unwrap();
        assert_eq!((again.header().extent, &found), ([3, 3, 2], &values), "{name}");
    }
    let error = open(&path, Some(&whole)).err().unwrap().to_string();
    assert!(error.contains("3x3x2 of u8 with 2 components in 3 time steps is 108 bytes"), "{error}");
    assert!(error.contains("`skip`"), "{error}");
    for wrong in [RawLayout { components: 0, ..whole }, RawLayout { steps: u64::MAX, ..whole }] {
        assert_eq!(open(&path, Some(&wrong)).err().unwrap().kind(), Fault::Usage);
    }
}

#[test]
fn a_known_layout_is_for_raw_files_only() {
    let known = layout("2x1", ElementType::U8, ByteOrder::Little);
    let (_folder, path) = file("volume.raw", b"ab");
    assert_eq!(read_known(&path, &known).unwrap(), read(&path, Some(&known)).unwrap());
    let (_folder, path) =
        file("volume", b"NRRD0001\ntype: uchar\ndimension: 1\nsizes: 1\nencoding: raw\n\na");
    assert_eq!(read_known(&path, &known).unwrap().extent, [1, 1, 1]);
}

#[test]
fn what_a_format_cannot_hold_is_told() {
    let mut volume = generate(Kind::Waves, [4, 3, 2], ElementType::F32, 1);
    let pair = HeaderLine::KeyValue { key: "a".into(), value: "b".into() };
    volume.metadata.lines = vec![
        HeaderLine::Comment("one".into()),
        HeaderLine::Field { name: "spacings".into(), value: "1 2 3".into() },
        pair.clone(),
        pair,
    ];
    let folder = tempfile::tempdir().unwrap();
    let told = |name: &str| -> Vec<String> {
        write(&volume, folder.path().join(name), &WriteOptions::default()).unwrap()
    };
    let lost = ["spacings", "1 comment", "2 key/value pairs"];
    assert_eq!(told("a.npy"), lost);
    assert_eq!(told("a.raw"), lost);
    assert!(told("a.nrrd").is_empty());
}

#[test]
fn what_cannot_be_written_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut volume = generate(Kind::Steps, [4, 3, 2], ElementType::U8, 1);
    let gzip = WriteOptions { byte_order: None, gzip: true };
    for name in ["a.raw", "a.npy"] {
        let error = write(&volume, folder.path().join(name), &gzip).unwrap_err();
        assert_eq!(error.kind(), Fault::Usage);
    }
    for name in ["a.raw", "a.npy", "a.nrrd", "a.nhdr"] {
        let error =
            write(&volume, folder.path().join("none").join(name), &WriteOptions::default()).unwrap_err();
        assert_eq!(error.kind(), Fault::Io);
    }
    volume.samples.pop();
    let error = write(&volume, folder.path().join("a.raw"), &WriteOptions::default()).unwrap_err();
    assert_eq!(error.kind(), Fault::Data);
    assert!(error.to_string().ends_with("has 23 bytes of samples where its extent and type need 24"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn rank_is_that_of_the_source_or_what_is_needed() {
    let mut volume = generate(Kind::Constant, [4, 3, 1], ElementType::U8, 1);
    assert_eq!(volume.rank(), 2);
    for (rank, expected) in [(0, 2), (1, 2), (2, 2), (3, 3), (200, 3)] {
        volume.metadata = Metadata::plain(rank, FileFormat::Raw);
        assert_eq!(volume.rank(), expected);
    }
    volume.extent = [1, 1, 1];
    volume.metadata.axes.clear();
    assert_eq!(volume.rank(), 1);
    assert_eq!(sample_bytes([u64::MAX, 1, 1], ElementType::U16), None);
}

#[cfg(unix)]
#[test]
fn a_fifo_is_read_to_its_end() {
    for (length, found) in [(23, Found::Exactly(23)), (24, Found::Exactly(24)), (500, Found::MoreThan(24))] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fifo");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        let result = std::thread::scope(|scope| {
            scope.spawn(|| fs::write(&path, vec![1; length]));
            read(&path, Some(&layout("4x3x2", ElementType::U8, ByteOrder::Little)))
        });
        match result {
            Ok(volume) => assert_eq!((volume.samples.len(), length), (24, 24)),
            Err(ReadError::LayoutMismatch { found: actual, .. }) => assert_eq!(actual, found),
            Err(other) => panic!("{other}"),
        }
    }
}

#[test]
fn a_lost_rescaling_is_named() {
    for (key, value, is_named) in [
        ("nifti.scl_slope", "2.5", true),
        ("nifti.scl_slope", "0", false),
        ("nifti.scl_slope", "NaN", false),
        ("nifti.scl_inter", "0", false),
        ("dicom.0028,1052", "-1024.0", true),
        ("dicom.0028,1053", "1.0;1.0;1.1", true),
        ("dicom.0028,1053", "1.0;1.0", false),
        ("other", "2.5", false),
    ] {
        let mut metadata = Metadata::default();
        metadata.set_key_value(key, value);
        let expected = if is_named {
            format!("rescaling (\"{key}\" \"{value}\")")
        } else {
            "1 key/value pair".to_owned()
        };
        assert_eq!(losses(&metadata), [expected]);
    }
}
