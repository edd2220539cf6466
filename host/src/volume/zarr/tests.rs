use std::fs;
use std::io::Read;
use std::path::PathBuf;

use serde_json::{Value, json};

use super::*;
use crate::volume::synthetic::{Kind, generate};
use crate::volume::{ByteOrder, ElementType, HeaderLine, Metadata, create, open};

fn values_of(path: &Path) -> Result<(Header, Vec<u8>), ReadError> {
    let mut source = open(path, None)?;
    let header = source.header().clone();
    let mut values = vec![0; header.bytes().unwrap() as usize];
    let parts = values.len() / header.element.bytes() / 3 * header.element.bytes();
    let (first, rest) = values.split_at_mut(parts);
    source.read(first)?;
    source.read(rest)?;
    Ok((header, values))
}

fn write(path: &Path, header: &Header, values: &[u8], options: &WriteOptions) {
    let Created { mut sink, losses } = create(path, header, options).unwrap();
    assert!(losses.is_empty());
    let (first, rest) = values.split_at(values.len() / 16 * 8);
    sink.write(first).unwrap();
    sink.write(rest).unwrap();
    sink.finish().unwrap();
}

fn field(name: &str, value: &str) -> HeaderLine {
    HeaderLine::Field { name: name.to_owned(), value: value.to_owned() }
}

/// Samples of 2 time steps of 3 components that end within chunks.
fn noise(extent: [u64; 3], components: u32, steps: u64, element: ElementType) -> (Header, Vec<u8>) {
    let rows = [extent[0] * u64::from(components), extent[1], extent[2] * steps];
    let volume = generate(Kind::Noise, rows, element, 1);
    let mut metadata = Metadata::plain(3, FileFormat::Nrrd);
    metadata.lines = vec![
        field("space", "left-posterior-superior"),
        field("space directions", "(0.1,0,0) (0,3,4) (0,0,2.50)"),
        field("space origin", "(-1.5,2,1e-3)"),
        HeaderLine::KeyValue { key: "k".into(), value: "a\n\"b\"".into() },
        HeaderLine::Comment(" ü".into()),
    ];
    (Header { extent, components, steps, element, metadata }, volume.samples)
}

fn folder(files: &[(&str, Value)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, json) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, json.to_string()).unwrap();
    }
    folder
}

fn message(path: &Path) -> String {
    match values_of(path) {
        Err(error) => error.to_string(),
        Ok(_) => "no error".to_owned(),
    }
}

/// An array of version 2 with big-endian samples, 2 by 3 chunks of 2 by 2, of which the last is missing.
fn old() -> Value {
    json!({
        "zarr_format": 2, "shape": [3, 5], "chunks": [2, 2], "dtype": ">i2", "compressor": null, "fill_value": -7,
        "order": "C", "filters": null
    })
}

fn write_old_chunks(folder: &Path) {
    for (y, x) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1)] {
        let bytes: Vec<u8> = (0..4_u8).flat_map(|at| [0, 100 * y + 10 * x + at]).collect();
        fs::write(folder.join(format!("{y}.{x}")), bytes).unwrap();
    }
}

#[test]
fn every_type_order_and_form_comes_back() {
    let orders = [ByteOrder::Little, ByteOrder::Big].into_iter().cycle();
    let shapes = [(1, 1), (3, 1), (1, 2), (2, 3)].into_iter().cycle();
    for ((element, order), (components, steps)) in ElementType::ALL.into_iter().zip(orders).zip(shapes) {
        let (mut header, values) = noise([67, 65, 70], components, steps, element);
        for (name, gzip) in [("a.zarr", false), ("a.ome.zarr", true)] {
            let around = tempfile::tempdir().unwrap();
            let path = around.path().join(name);
            write(&path, &header, &values, &WriteOptions { byte_order: Some(order), gzip });
            let (found, again) = values_of(&path).unwrap();
            assert!(again == values, "{element} {name} {components} {steps}");
            let order = if element.bytes() == 1 { ByteOrder::Little } else { order };
            assert_eq!(found.metadata.source.byte_order, order);
            header.metadata.source = found.metadata.source;
            assert_eq!(found, header, "{name}");
            assert_eq!(fs::read_dir(around.path()).unwrap().count(), 1);
        }
    }
}

#[test]
fn slices_and_lines_keep_their_axes() {
    for (extent, rank) in [([5, 4, 1], 2), ([5, 4, 1], 3), ([7, 1, 1], 1)] {
        let volume = generate(Kind::Noise, extent, ElementType::U16, 1);
        let metadata = Metadata::plain(rank, FileFormat::Zarr);
        let header = Header::scalar(extent, ElementType::U16, metadata);
        for name in ["a.zarr", "a.ome.zarr"] {
            let around = tempfile::tempdir().unwrap();
            let path = around.path().join(name);
            write(&path, &header, &volume.samples, &WriteOptions::default());
            let (found, values) = values_of(&path).unwrap();
            assert_eq!(values, volume.samples);
            assert_eq!(found.rank(), usize::from(rank).max(if name == "a.zarr" { 1 } else { 2 }));
        }
    }
}

#[test]
fn arrays_of_version_2_are_read_with_missing_chunks() {
    let folder = folder(&[(".zarray", old()), (".zattrs", json!({ "a": [1, 0.1] }))]);
    write_old_chunks(folder.path());
    let (header, values) = values_of(folder.path()).unwrap();
    let values: Vec<i16> = values.as_chunks().0.iter().map(|bytes| i16::from_le_bytes(*bytes)).collect();
    assert_eq!((header.extent, header.rank()), ([5, 3, 1], 2));
    assert_eq!(values, [0, 1, 10, 11, 20, 2, 3, 12, 13, 22, 100, 101, 110, 111, -7]);
    assert_eq!(header.metadata.source.byte_order, ByteOrder::Big);
    assert_eq!(header.metadata.key_value("zarr.attributes"), Some("{\"a\":[1,0.1]}"));
    let around = tempfile::tempdir().unwrap();
    let path = around.path().join("b.zarr");
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    write(&path, &header, &bytes, &WriteOptions::default());
    assert_eq!(values_of(&path).unwrap(), (header, bytes));
    let written: Value = serde_json::from_slice(&fs::read(path.join("zarr.json")).unwrap()).unwrap();
    assert_eq!(written["attributes"], json!({ "a": [1, 0.1] }));
    assert_eq!(written["dimension_names"], json!(["y", "x"]));
}

fn image() -> Value {
    let level = |path: &str, scale: f64| {
        json!({ "path": path, "coordinateTransformations": [
            { "type": "scale", "scale": [1.0, 3.0, 0.5 * scale, 0.25 * scale] },
            { "type": "translation", "translation": [0.0, 1.0, 2.0, 3.0] }
        ] })
    };
    json!({ "creator": "x", "multiscales": [{
        "version": "0.4", "name": "cells", "type": "gaussian",
        "axes": [
            { "name": "c", "type": "channel" },
            { "name": "z", "type": "space", "unit": "micrometer" },
            { "name": "y", "type": "space", "unit": "micrometer" },
            { "name": "x", "type": "space", "unit": "parsec" }
        ],
        "datasets": [level("0", 1.0), level("s/1", 2.0)],
        "coordinateTransformations": [{ "type": "scale", "scale": [1.0, 1.0, 1.0, 2.0] }]
    }], "omero": { "channels": [{ "label": "DAPI" }] } })
}

#[test]
fn images_are_known_by_their_group_and_their_levels() {
    let array = |shape: [u64; 4]| {
        json!({ "zarr_format": 2, "shape": shape, "chunks": [1, 2, 2, 2], "dtype": "|u1", "compressor": null,
                "fill_value": 9, "order": "C", "filters": null, "dimension_separator": "/" })
    };
    let around = folder(&[
        ("i/.zgroup", json!({ "zarr_format": 2 })),
        ("i/.zattrs", image()),
        ("i/0/.zarray", array([2, 1, 4, 6])),
        ("i/s/1/.zarray", array([2, 1, 2, 3])),
    ]);
    let path = around.path().join("i");
    fs::create_dir_all(path.join("0/1/0/0")).unwrap();
    fs::write(path.join("0/1/0/0/0"), [1, 2, 3, 4, 0, 0, 0, 0]).unwrap();
    let (header, values) = values_of(&path).unwrap();
    assert_eq!((header.extent, header.components, header.steps), ([6, 4, 1], 2, 1));
    assert_eq!(values[..6], [9, 1, 9, 2, 9, 9]);
    assert_eq!(values[12..16], [9, 3, 9, 4]);
    let lines = &header.metadata.lines;
    assert_eq!(lines[0], field("space dimension", "3"));
    assert_eq!(lines[1], field("space directions", "(0.5,0,0) (0,0.5,0) (0,0,3)"));
    assert_eq!(lines[2], field("space origin", "(6,2,1)"));
    assert_eq!(lines[3], field("space units", "\"parsec\" \"um\" \"um\""));
    assert_eq!(lines[4], field("content", "cells"));

    let (level, _) = values_of(&path.join("s/1")).unwrap();
    assert_eq!((level.extent, level.components), ([3, 2, 1], 2));
    assert_eq!(level.metadata.spacing(), Some([1.0, 1.0, 3.0]));

    let written = around.path().join("b.ome.zarr");
    write(&written, &header, &values, &WriteOptions::default());
    let (found, again) = values_of(&written).unwrap();
    assert_eq!((again, &found.metadata.lines[..5]), (values.clone(), &lines[..5]));
    let group: Value = serde_json::from_slice(&fs::read(written.join("zarr.json")).unwrap()).unwrap();
    let attributes = &group["attributes"];
    assert_eq!(attributes["creator"], "x");
    assert_eq!(attributes["ome"]["omero"], image()["omero"]);
    assert_eq!(attributes["ome"]["version"], "0.5");
    let multiscales = &attributes["ome"]["multiscales"][0];
    assert_eq!(multiscales["axes"], image()["multiscales"][0]["axes"]);
    assert_eq!((&multiscales["type"], &multiscales["version"]), (&json!("gaussian"), &Value::Null));
    assert_eq!(attributes.get("nrrd"), None);
    // Written once more, the image is the same.
    write(&written, &found, &values, &WriteOptions::default());
    assert_eq!(values_of(&written).unwrap().0, found);
}

#[test]
fn groups_say_what_is_in_them() {
    let around = folder(&[("g/.zgroup", json!({})), ("g/a/.zarray", old())]);
    let group = around.path().join("g");
    assert_eq!(values_of(&group).unwrap().0.extent, [5, 3, 1]);
    fs::create_dir(group.join("b")).unwrap();
    fs::write(group.join("b/.zarray"), old().to_string()).unwrap();
    assert!(message(&group).ends_with("name one of the arrays in it, \"a\", \"b\""), "{}", message(&group));
    assert!(message(&around.path().join("no.zarr")).contains("No such file"));
    fs::create_dir(around.path().join("empty.zarr")).unwrap();
    assert!(message(&around.path().join("empty.zarr")).contains("neither zarr.json nor"));
    let mut inside = image();
    inside["multiscales"][0]["datasets"][0]["path"] = json!("../g/a");
    fs::write(group.join(".zattrs"), inside.to_string()).unwrap();
    assert!(message(&group).contains("group without a picture"));
}

#[test]
fn only_zarr_folders_are_replaced() {
    let around = tempfile::tempdir().unwrap();
    let path = around.path().join("a.zarr");
    let (header, values) = noise([5, 4, 3], 1, 1, ElementType::U8);
    fs::create_dir(&path).unwrap();
    fs::write(path.join("notes.txt"), "mine").unwrap();
    let refused = || create(&path, &header, &WriteOptions::default()).unwrap_err().to_string();
    assert!(refused().contains("a folder with other things in it"), "{}", refused());
    fs::write(path.join(".zgroup"), "{}").unwrap();
    assert!(refused().contains("a folder with notes.txt in it"), "{}", refused());
    assert_eq!(fs::read(path.join("notes.txt")).unwrap(), b"mine");
    fs::remove_file(path.join("notes.txt")).unwrap();
    for _ in 0..2 {
        write(&path, &header, &values, &WriteOptions::default());
        assert!(!path.join(".zgroup").exists());
        assert_eq!(values_of(&path).unwrap().1, values);
    }
    let Created { mut sink, .. } = create(&path, &header, &WriteOptions::default()).unwrap();
    sink.write(&[0; 12]).unwrap();
    assert!(matches!(sink.finish(), Err(WriteError::SampleBytes { expected: 60, found: 12, .. })));
    assert_eq!(values_of(&path).unwrap().1, values);
    assert_eq!(fs::read_dir(around.path()).unwrap().count(), 1);
    fs::write(around.path().join("file.zarr"), "").unwrap();
    assert!(create(around.path().join("file.zarr"), &header, &WriteOptions::default()).is_err());
}

#[test]
fn every_place_can_be_gone_to() {
    let around = tempfile::tempdir().unwrap();
    let path = around.path().join("a.ome.zarr");
    let (header, values) = noise([30, 20, 70], 2, 3, ElementType::U16);
    write(&path, &header, &values, &WriteOptions::default());
    let mut source = open(&path, None).unwrap();
    assert!(source.is_random());
    for position in [0, 504_000 - 2, 168_000, 336_000 - 4, 100_000, 400_000] {
        source.seek(position).unwrap();
        let mut found = vec![0; 5000.min(values.len() - position as usize)];
        source.read(&mut found).unwrap();
        assert!(found == values[position as usize..][..found.len()], "{position}");
    }
    source.seek(504_000).unwrap();
    assert!(matches!(source.read(&mut [0; 2]), Err(ReadError::BeyondEnd { .. })));
}

#[test]
fn faults_are_named() {
    let around = tempfile::tempdir().unwrap();
    let path = around.path().join("a.zarr");
    let (header, values) = noise([5, 4, 3], 1, 1, ElementType::F32);
    write(&path, &header, &values, &WriteOptions { byte_order: None, gzip: true });
    let file = path.join("zarr.json");
    let good: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    let with = |pointer: &str, value: Value| {
        let mut bad = good.clone();
        *bad.pointer_mut(pointer).unwrap() = value;
        fs::write(&file, bad.to_string()).unwrap();
        message(&path)
    };
    assert!(with("/node_type", json!("table")).contains("no proper node_type"));
    assert!(with("/data_type", json!("complex64")).contains("samples are of type \"\\\"complex64\\\"\""));
    assert!(with("/shape", json!([0, 4, 5])).contains("an axis of zero samples"));
    assert!(with("/shape", json!([1_u64 << 40, 1_u64 << 40, 5])).contains("64 bits"));
    assert!(with("/shape", json!([3, 4])).contains("no proper shape of chunks"));
    assert!(with("/shape", json!([1, 1, 1_u64 << 40])).contains("a row of samples has"));
    assert!(with("/chunk_grid/configuration/chunk_shape", json!([1, 1 << 30, 5])).contains("a chunk has"));
    assert!(with("/chunk_grid/name", json!("odd")).contains("no proper regular chunk_grid"));
    assert!(with("/codecs/1/name", json!("odd")).contains("odd"));
    let shard =
        json!([{ "name": "sharding_indexed", "configuration": { "chunk_shape": [1, 1, 1], "codecs": [] } }]);
    with("/codecs", shard.clone());
    let mut sharded = good.clone();
    sharded["codecs"] = shard;
    sharded["chunk_grid"]["configuration"]["chunk_shape"] = json!([1000, 1000, 1000]);
    fs::write(&file, sharded.to_string()).unwrap();
    assert!(message(&path).contains("the index of a shard"), "{}", message(&path));
    let rank = with("/shape", json!([1, 1, 1, 1, 1, 1]));
    assert!(rank.contains("shape of chunks"), "{rank}");
    fs::write(&file, good.to_string()).unwrap();
    let chunk = path.join("c/0/0/0");
    let mut bytes = fs::read(&chunk).unwrap();
    bytes[20] ^= 1;
    fs::write(&chunk, bytes).unwrap();
    assert_ne!(message(&path), "no error");
}

/// Every file of a folder, with its bytes.
fn files_of(path: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let (mut folders, mut files) = (vec![path.to_owned()], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => folders.push(path),
                false => files.push((path.clone(), fs::read(path).unwrap())),
            }
        }
    }
    files
}

/// The array of that path with its chunks in shards, whose index is checked.
fn shard(path: &Path, chunk: &[u8]) {
    let file = path.join("zarr.json");
    let mut json: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    let index = json!([{ "name": "bytes", "configuration": { "endian": "little" } }]);
    json["codecs"] = json!([{ "name": "sharding_indexed", "configuration": {
        "chunk_shape": [3, 4, 5], "codecs": json["codecs"], "index_codecs": index, "index_location": "end" } }]);
    fs::write(&file, json.to_string()).unwrap();
    let table = [0_u64, chunk.len() as u64].map(u64::to_le_bytes).concat();
    fs::write(path.join("c/0/0/0"), [chunk, &table].concat()).unwrap();
}

#[test]
fn hostile_folders_return() {
    let around = tempfile::tempdir().unwrap();
    let names = ["a.zarr", "a.ome.zarr", "s.zarr", "v.zarr"];
    let [array, image, sharded, v2] = names.map(|name| around.path().join(name));
    let (header, values) = noise([5, 4, 3], 1, 1, ElementType::I16);
    for path in [&array, &image, &sharded] {
        write(path, &header, &values, &WriteOptions { byte_order: None, gzip: true });
    }
    shard(&sharded, &fs::read(sharded.join("c/0/0/0")).unwrap());
    assert_eq!(values_of(&sharded).unwrap().1, values);
    fs::create_dir(&v2).unwrap();
    fs::write(v2.join(".zarray"), old().to_string()).unwrap();
    write_old_chunks(&v2);
    for path in [&array, &image, &sharded, &v2] {
        for (file, bytes) in files_of(path) {
            let step = bytes.len() / 100 + 1;
            for at in (0..bytes.len()).step_by(step) {
                let mut changed = bytes.clone();
                for change in [1, 0x10, 0x80] {
                    changed[at] = bytes[at] ^ change;
                    fs::write(&file, &changed).unwrap();
                    let _result = values_of(path);
                }
                changed[at] = b'9';
                changed.insert(at, b'9');
                fs::write(&file, &changed).unwrap();
                let _result = values_of(path);
                fs::write(&file, &bytes[..at]).unwrap();
                let _result = values_of(path);
            }
            fs::write(&file, &bytes).unwrap();
        }
        assert!(values_of(path).is_ok());
    }
}

#[test]
fn chunks_stay_within_their_shape() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.zarr");
    let (header, values) = noise([5, 4, 3], 1, 1, ElementType::I16);
    write(&path, &header, &values, &WriteOptions { byte_order: None, gzip: true });
    let chunk = path.join("c/0/0/0");
    let mut bomb = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::copy(&mut std::io::repeat(0).take(1 << 26), &mut bomb).unwrap();
    let bomb = bomb.finish().unwrap();
    assert!(bomb.len() < 1 << 17);
    fs::write(&chunk, &bomb).unwrap();
    let told = message(&path);
    assert!(told.contains("a chunk has more bytes than its shape says"), "{told}");
    // A chunk of gigabytes beside a hundred samples.
    let file = path.join("zarr.json");
    let mut json: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    json["chunk_grid"]["configuration"]["chunk_shape"] = json!([1024, 512, 512]);
    fs::write(&file, json.to_string()).unwrap();
    let told = message(&path);
    assert!(told.contains("a chunk has 536870912 bytes"), "{told}");
}

#[test]
fn shards_stay_within_their_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.zarr");
    let (header, values) = noise([5, 4, 3], 1, 1, ElementType::I16);
    for gzip in [false, true] {
        write(&path, &header, &values, &WriteOptions { byte_order: None, gzip });
        let file = path.join("c/0/0/0");
        let chunk = fs::read(&file).unwrap();
        shard(&path, &chunk);
        assert_eq!(values_of(&path).unwrap().1, values);
        let len = chunk.len() as u64;
        // From a byte too many to what no machine has, at places within the file and behind it.
        let lengths = [len + 17, 1 << 32, 1 << 46, 1 << 62, u64::MAX - 1];
        for (offset, length) in [0, 1, len, 1 << 46, u64::MAX - 1]
            .into_iter()
            .flat_map(|offset| lengths.map(|length| (offset, length)))
            .chain([(len + 16, len), (u64::MAX - len + 1, len)])
        {
            let table = [offset, length].map(u64::to_le_bytes).concat();
            fs::write(&file, [&chunk[..], &table].concat()).unwrap();
            assert_ne!(message(&path), "no error", "{offset} {length}");
        }
    }
}

#[test]
fn pieces_are_as_small_as_asked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.zarr");
    let (header, values) = noise([50, 40, 30], 1, 1, ElementType::I16);
    write(&path, &header, &values, &WriteOptions::default());
    for most in [1, 1000, 30_000, 300_000] {
        let mut source = crate::volume::open(&path, None).unwrap();
        assert_eq!(source.hold_at_most(most), most);
        let mut found = vec![0; values.len()];
        source.read(&mut found).unwrap();
        assert!(found == values, "{most}");
    }
}
