//! Every format and type goes in and comes out as the same bytes, headers included.

use std::ffi::OsStr;
use std::io::{Read, Write};

use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use serde_json::json;

use crate::files::{TYPES, noise, npy, nrrd, smooth_u16, split_nrrd, swapped};
use crate::run::Folder;

/// Extents of a line, a slice and a brick, with their samples.
const EXTENTS: [(&str, usize); 3] = [("50", 50), ("13x9", 117), ("9x7x5", 315)];

#[test]
fn raw_files_of_every_type_and_byte_order_come_back() {
    let folder = Folder::new();
    for (kind, seed) in TYPES.iter().zip(0..) {
        for (extent, samples) in EXTENTS {
            let original = noise(samples * kind.bytes, seed);
            folder.write("in.raw", &original);
            for order in ["little", "big"] {
                let layout = format!("--extent {extent} --type {} --byte-order {order}", kind.name);
                folder.run(&format!("compress in.raw a.wlift {layout}")).silent();
                folder.run("decompress a.wlift out.raw").silent();
                assert_eq!(folder.read("out.raw"), original, "{layout}");
                folder.run("verify a.wlift in.raw").ok();
                folder.run(&format!("verify a.wlift in.raw {layout}")).ok();
                let other = if order == "big" { "little" } else { "big" };
                folder.run(&format!("decompress a.wlift out.raw --byte-order {other}")).silent();
                assert_eq!(folder.read("out.raw"), swapped(&original, kind.bytes), "{layout}");
            }
        }
    }
}

#[test]
fn numpy_files_of_every_type_and_order_come_back() {
    let shapes = [("(50,)", "(50,)"), ("(9, 13)", "(13, 9)"), ("(5, 7, 9)", "(9, 7, 5)")];
    let folder = Folder::new();
    for (kind, seed) in TYPES.iter().zip(0..) {
        let orders: &[&str] = if kind.bytes == 1 { &["|"] } else { &["<", ">"] };
        for ((_, samples), (c_shape, fortran_shape)) in EXTENTS.into_iter().zip(shapes) {
            for order in orders {
                for (fortran, shape) in [(false, c_shape), (true, fortran_shape)] {
                    let descr = format!("{order}{}", kind.npy);
                    let original = npy(&descr, fortran, shape, &noise(samples * kind.bytes, seed));
                    folder.write("in.npy", &original);
                    folder.run("compress in.npy a.wlift").silent();
                    folder.run("decompress a.wlift out.npy").silent();
                    assert_eq!(folder.read("out.npy"), original, "{descr} {shape} {fortran}");
                }
            }
        }
    }
}

/// Lines of a header that a volume keeps, with samples that are spaced.
const SPACED: [&str; 9] = [
    "# made by an instrument",
    "#no blank after the sign",
    "spacings: 3.20 0.5e0 1",
    "content: head, quarter: \"of\" a scan",
    "units: \"mm\" \"mm\" \"s\"",
    "labels: \"x\" \"y\" \"depth; or z\"",
    "kinds: domain domain domain",
    "patient:=Doe: Jane = 7",
    "note:=two\\nlines and a \\\\ backslash",
];

/// The same with samples that lie in space.
const ORIENTED: [&str; 5] = [
    "space: left-posterior-superior",
    "space directions: (3.2000000000000002,0,0) (0,3.2,0) (0,0,1.5e0)",
    "space origin: (-100.5,-1e2,12.250)",
    "measurement frame: (1,0,0) (0,1,0) (0,0,1)",
    "Größe:=5 µm",
];

#[test]
fn nrrd_headers_come_back_line_by_line() {
    let folder = Folder::new();
    let samples = smooth_u16([9, 7, 5]);
    for kept in [&SPACED[..], &ORIENTED[..]] {
        let mut lines = vec!["NRRD0005", "type: uint16", "dimension: 3", "sizes: 9 7 5", "endian: little"];
        lines.push("encoding: raw");
        let made = lines.len();
        lines.extend(kept);
        folder.write("in.nrrd", nrrd(&lines, &samples));
        folder.run("compress in.nrrd a.wlift").silent();
        folder.run("decompress a.wlift out.nrrd").silent();
        let out = folder.read("out.nrrd");
        let (header, back) = split_nrrd(&out);
        assert_eq!(header[1..made], lines[1..made]);
        assert_eq!((&header[made..], back), (kept, &samples[..]));
        folder.run("compress out.nrrd b.wlift").silent();
        folder.run("decompress b.wlift again.nrrd").silent();
        assert_eq!(folder.read("again.nrrd"), out);
    }
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn gunzip(bytes: &[u8]) -> Vec<u8> {
    let mut samples = Vec::new();
    GzDecoder::new(bytes).read_to_end(&mut samples).unwrap();
    samples
}

#[test]
fn nrrd_files_attached_detached_and_gzipped_come_back() {
    let folder = Folder::new();
    for (kind, seed) in TYPES.iter().zip(0..) {
        let stored = noise(315 * kind.bytes, seed);
        for (encoding, endian) in [("raw", "little"), ("gzip", "big")] {
            let (kind_line, endian_line) = (format!("type: {}", kind.nrrd), format!("endian: {endian}"));
            let encoding_line = format!("encoding: {encoding}");
            let lines =
                ["NRRD0004", &kind_line, "dimension: 3", "sizes: 9 7 5", &encoding_line, &endian_line];
            let data = if encoding == "gzip" { gzip(&stored) } else { stored.clone() };
            folder.write("in.nrrd", nrrd(&lines, &data));
            folder.write("in.data", &data);
            folder.write("in.nhdr", nrrd(&[&lines[..], &["data file: in.data"]].concat(), &[]));
            folder.run("compress in.nrrd a.wlift").silent();
            folder.run("compress in.nhdr b.wlift").silent();
            assert_eq!(folder.read("a.wlift"), folder.read("b.wlift"));
            folder.run("decompress a.wlift out.raw").silent();
            assert_eq!(folder.read("out.raw"), stored, "{lines:?}");

            folder.run("decompress a.wlift out.nrrd --gzip").silent();
            let out = folder.read("out.nrrd");
            let (header, packed) = split_nrrd(&out);
            assert!(header.contains(&"encoding: gzip"), "{header:?}");
            assert_eq!(gunzip(packed), stored);
            folder.run("decompress a.wlift apart.nhdr").silent();
            assert_eq!(folder.read("apart.raw"), stored);
            folder.run("decompress a.wlift packed.nhdr --gzip").silent();
            assert_eq!(gunzip(&folder.read("packed.raw.gz")), stored);
            for name in ["out.nrrd", "apart.nhdr", "packed.nhdr"] {
                folder.run(&format!("verify a.wlift {name}")).ok();
            }
        }
    }
}

#[test]
fn axes_keep_their_meaning_from_format_to_format() {
    let folder = Folder::new();
    let samples = smooth_u16([5, 4, 3]);
    folder.write("a.raw", &samples);
    folder.write("c.npy", npy("<u2", false, "(3, 4, 5)", &samples));
    folder.write("fortran.npy", npy("<u2", true, "(5, 4, 3)", &samples));
    for (name, layout) in [("a.raw", "--extent 5x4x3 --type u16"), ("c.npy", ""), ("fortran.npy", "")] {
        folder.run(&format!("compress {name} a.wlift {layout}")).silent();
        folder.run("decompress a.wlift a.nrrd").silent();
        let file = folder.read("a.nrrd");
        let (header, stored) = split_nrrd(&file);
        assert!(header.contains(&"sizes: 5 4 3"), "{name}: {header:?}");
        assert_eq!(stored, samples);
    }
    folder.run("compress a.raw a.wlift --extent 5x4x3 --type u16").silent();
    folder.run("decompress a.wlift out.npy").silent();
    assert_eq!(folder.read("out.npy"), npy("<u2", false, "(3, 4, 5)", &samples));
}

#[test]
fn formats_are_known_by_their_first_bytes_too() {
    let folder = Folder::new();
    let samples = smooth_u16([9, 7, 5]);
    folder.write("array.data", npy("<u2", false, "(5, 7, 9)", &samples));
    let lines =
        ["NRRD0001", "type: ushort", "dimension: 3", "sizes: 9 7 5", "endian: little", "encoding: raw"];
    folder.write("volume.data", nrrd(&lines, &samples));
    for name in ["array.data", "volume.data"] {
        folder.run(&format!("compress {name} a.wlift")).silent();
        folder.run("decompress a.wlift out.raw").silent();
        assert_eq!(folder.read("out.raw"), samples, "{name}");
    }
}

#[test]
fn what_a_format_cannot_hold_is_named() {
    let folder = Folder::new();
    let lines = [
        "NRRD0004",
        "type: uint8",
        "dimension: 1",
        "sizes: 3",
        "encoding: raw",
        "spacings: 2",
        "# c",
        "k:=v",
    ];
    folder.write("in.nrrd", nrrd(&lines, &[1, 2, 3]));
    folder.run("compress in.nrrd a.wlift").silent();
    let outcome = folder.run("decompress a.wlift out.npy").ok();
    let expected = "wavelift: out.npy: .npy has no place for spacings, 1 comment, 1 key/value pair\n";
    assert_eq!(outcome.stderr(), expected);
    let document = folder.run("decompress a.wlift out.npy --json").json();
    assert_eq!(document["not_kept"], json!(["spacings", "1 comment", "1 key/value pair"]));
}

#[test]
fn files_may_have_any_name() {
    let folder = Folder::new();
    folder.write("Größe in µm.raw", [1, 2, 3, 4]);
    let [original, packed, back] = ["Größe in µm.raw", "容积 1.wlift", "zurück -- x.raw"].map(OsStr::new);
    let layout = ["--extent", "2x2", "--type", "u8"].map(OsStr::new);
    folder.run_words(&[&[OsStr::new("compress"), original, packed], &layout[..]].concat()).silent();
    folder.run_words(&[OsStr::new("decompress"), packed, back]).silent();
    assert_eq!(folder.read(back), [1, 2, 3, 4]);
}

#[cfg(target_os = "linux")]
#[test]
fn file_names_need_not_be_text() {
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new();
    let [packed, back] = [&b"\xff\xfe.wlift"[..], b"\xff.raw"].map(OsStr::from_bytes);
    folder.write("in.raw", [1, 2, 3, 4]);
    let words = ["compress", "in.raw", "--extent", "4", "--type", "u8"].map(OsStr::new);
    folder.run_words(&[&words[..], &[packed]].concat()).silent();
    folder.run_words(&[OsStr::new("decompress"), packed, back]).silent();
    assert_eq!(folder.read(back), [1, 2, 3, 4]);
    folder.run_words(&[OsStr::new("info"), back]).fails(3, &[".raw: not a wavelift file"]);
}

#[test]
fn a_damaged_index_of_a_shard_is_told_in_one_line() {
    let folder = Folder::new();
    folder.write("in.raw", [7; 120]);
    folder.run("convert in.raw a.zarr --extent 5x4x3 --type u16").silent();
    let file = "a.zarr/zarr.json";
    let mut array: serde_json::Value = serde_json::from_slice(&folder.read(file)).unwrap();
    let index = serde_json::json!([{ "name": "bytes", "configuration": { "endian": "little" } }]);
    array["codecs"] = serde_json::json!([{ "name": "sharding_indexed", "configuration": {
        "chunk_shape": [3, 4, 5], "codecs": array["codecs"], "index_codecs": index, "index_location": "end" } }]);
    folder.write(file, array.to_string());
    for [start, length] in [[u64::MAX - 5, 120], [0, u64::MAX - 1], [1 << 40, 1 << 40], [100, 120]] {
        let table = [start, length].map(u64::to_le_bytes).concat();
        folder.write("a.zarr/c/0/0/0", [&[7; 120][..], &table].concat());
        let outcome = folder.run("convert a.zarr out.nrrd");
        let told = outcome.stderr();
        assert!(told.starts_with("wavelift: a.zarr: ") && told.lines().count() == 1, "{told}");
        outcome.fails(3, &["a.zarr"]);
    }
}
