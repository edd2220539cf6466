use std::fs;

use super::*;
use crate::volume::{ElementType, Fault, RawLayout, create as create_volume, open as open_volume};

fn pgm(folder: &Path, name: &str, width: u8, values: &[u8]) {
    let height = values.len() / usize::from(width);
    fs::write(folder.join(name), [format!("P5 {width} {height} 255\n").as_bytes(), values].concat()).unwrap();
}

fn all(source: &mut Box<dyn Source>, piece: usize) -> Vec<u8> {
    let mut values = vec![0; source.header().bytes().unwrap() as usize];
    values.chunks_mut(piece).for_each(|part| source.read(part).unwrap());
    values
}

fn write(path: &Path, header: &Header, values: &[u8], piece: usize) -> Result<Vec<String>, WriteError> {
    let mut created = create_volume(path, header, &WriteOptions::default())?;
    for part in values.chunks(piece) {
        created.sink.write(part)?;
    }
    created.sink.finish()?;
    Ok(created.losses)
}

fn text_of(result: Result<Box<dyn Source>, ReadError>) -> String {
    result.err().unwrap().to_string()
}

#[test]
fn a_stack_is_read_by_pattern_and_by_folder() {
    let folder = tempfile::tempdir().unwrap();
    for (name, first) in [("s9.pgm", 1), ("s10.pgm", 5), ("s11.pgm", 9)] {
        pgm(folder.path(), name, 2, &[first, first + 1, first + 2, first + 3]);
    }
    fs::write(folder.path().join("notes.txt"), "no slice").unwrap();
    for name in ["s%d.pgm", "s*.pgm", "*.pgm", ""] {
        for piece in [1, 3, 4, 7, 12] {
            let mut source = open_volume(folder.path().join(name), None).unwrap();
            assert_eq!((source.header().extent, source.header().metadata.rank()), ([2, 2, 3], 3));
            assert!(all(&mut source, piece).into_iter().eq(1..13));
            source.seek(6).unwrap();
            let mut part = [0; 3];
            source.read(&mut part).unwrap();
            assert_eq!(part, [7, 8, 9]);
        }
    }
    let single = open_volume(folder.path().join("s9.pgm"), None).unwrap();
    assert_eq!((single.header().extent, single.header().metadata.rank()), ([2, 2, 1], 2));
}

#[test]
fn raw_slices_have_one_layout() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("1.bin"), [1, 2]).unwrap();
    fs::write(folder.path().join("2.bin"), [3, 4]).unwrap();
    let layout = RawLayout::new("2x1".parse().unwrap(), ElementType::U8);
    for name in ["", "%d.bin", "*"] {
        let mut source = open_volume(folder.path().join(name), Some(&layout)).unwrap();
        assert_eq!(all(&mut source, 4), [1, 2, 3, 4]);
    }
}

#[test]
fn what_makes_no_stack_is_told_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let open = |name: &str| text_of(open_volume(folder.path().join(name), None));
    assert!(open("").contains("there are no slices"));
    assert!(open("a_*.pgm").contains("there are no slices"));
    pgm(folder.path(), "a_1.pgm", 2, &[1, 2]);
    pgm(folder.path(), "a_2.pgm", 1, &[1, 2]);
    let error = open("a_%d.pgm");
    assert!(error.contains("\"a_2.pgm\" has 1x2 u8, but \"a_1.pgm\" has 2x1 u8"), "{error}");
    pgm(folder.path(), "a_4.pgm", 2, &[1, 2]);
    assert!(open("").contains("\"a_3.pgm\" is missing between \"a_2.pgm\" and \"a_4.pgm\""));
    pgm(folder.path(), "a_04.pgm", 2, &[1, 2]);
    assert!(open("").contains("the same number"));
    fs::write(folder.path().join("b.png"), "x").unwrap();
    assert!(open("").contains("several formats"));
    let error = open_volume(folder.path().join("none/%d.pgm"), None).err().unwrap();
    assert_eq!(error.kind(), Fault::Io);
}

#[test]
fn a_stack_is_written_whole_or_not_at_all() {
    let around = tempfile::tempdir().unwrap();
    let folder = around.path().join("new");
    let header = Header::scalar([2, 1, 3], ElementType::U8, Metadata::default());
    for (piece, name) in [(1, "a_##.pgm"), (2, "b%d.pgm"), (4, "c*.pgm")] {
        assert_eq!(write(&folder.join(name), &header, &[1, 2, 3, 4, 5, 6], piece).unwrap(), [""; 0]);
        let mut source = open_volume(folder.join(name), None).unwrap();
        assert_eq!(all(&mut source, 6), [1, 2, 3, 4, 5, 6]);
    }
    for name in ["a_00.pgm", "b2.pgm", "c0001.pgm"] {
        assert!(folder.join(name).exists());
    }
    let again = write(&folder.join("a_##.pgm"), &header, &[0; 6], 6).unwrap_err().to_string();
    assert!(again.contains("there already (3, as ") && again.contains("a_00.pgm"), "{again}");

    write(&folder.join("d%d.pgm"), &header, &[0; 5], 5).unwrap_err();
    write(&folder.join("d%d.pgm"), &header, &[0; 7], 7).unwrap_err();
    let path = around.path().join("other/%d.pgm");
    write(&path, &header, &[0; 4], 1).unwrap_err();
    let wide = Header { element: ElementType::I16, ..header.clone() };
    let error = write(&path, &wide, &[0; 12], 1).unwrap_err().to_string();
    assert!(error.starts_with(&path.display().to_string()) && error.contains("i16"), "{error}");
    write(&path, &Header { steps: 2, ..header }, &[0; 12], 1).unwrap_err();
    let names = |folder: &Path| fs::read_dir(folder).unwrap().count();
    assert_eq!((names(around.path()), names(&folder)), (1, 9));
}
