use std::fs;
use std::path::PathBuf;

use super::synthetic::{Kind, generate};
use super::*;

fn layout(extent: &str, element: ElementType, byte_order: ByteOrder) -> RawLayout {
    RawLayout { extent: extent.parse().unwrap(), element, byte_order }
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
        "4x3x2 of u16 is 48 bytes, the file has 24: check --extent and --type (it would fit samples of 1 byte, as u8)"
    );
    assert_eq!(
        message("5x2", ElementType::U16),
        "5x2 of u16 is 20 bytes, the file has 24: check --extent and --type, and whether a header stands before the \
         samples"
    );
    assert_eq!(
        message("100", ElementType::U8),
        "100 of u8 is 100 bytes, the file has 24: check --extent and --type"
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
    assert!(error.to_string().contains("give --extent XxYxZ and --type T"));
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
        write(&volume, &folder.path().join(name), &WriteOptions::default()).unwrap()
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
        let error = write(&volume, &folder.path().join(name), &gzip).unwrap_err();
        assert_eq!(error.kind(), Fault::Usage);
    }
    for name in ["a.raw", "a.npy", "a.nrrd", "a.nhdr"] {
        let error =
            write(&volume, &folder.path().join("none").join(name), &WriteOptions::default()).unwrap_err();
        assert_eq!(error.kind(), Fault::Io);
    }
    volume.samples.pop();
    let error = write(&volume, &folder.path().join("a.raw"), &WriteOptions::default()).unwrap_err();
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
