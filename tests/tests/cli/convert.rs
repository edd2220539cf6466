//! Volumes go from format to format and keep their bits.

use serde_json::json;

use crate::files::{TYPES, noise, npy, nrrd, smooth_u16, split_nrrd, swapped};
use crate::run::Folder;

#[test]
fn every_type_comes_back_through_every_format() {
    let folder = Folder::new();
    for (kind, seed) in TYPES.iter().zip(0..) {
        let samples = noise(315 * kind.bytes, seed);
        folder.write("in.raw", &samples);
        let layout = format!("--extent 9x7x5 --type {}", kind.name);
        folder.run(&format!("convert in.raw a.nrrd --gzip {layout}")).silent();
        folder.run("convert a.nrrd b.nhdr").silent();
        folder.run("convert b.nhdr c.npy").silent();
        let order = if kind.bytes == 1 { "|" } else { "<" };
        assert_eq!(folder.read("c.npy"), npy(&format!("{order}{}", kind.npy), false, "(5, 7, 9)", &samples));
        folder.run("convert c.npy d.raw").silent();
        assert_eq!(folder.read("d.raw"), samples, "{layout}");
    }
}

#[test]
fn byte_orders_are_those_asked_for() {
    let folder = Folder::new();
    let samples = smooth_u16([9, 7, 5]);
    folder.write("big.raw", swapped(&samples, 2));
    folder.run("convert big.raw big.nrrd --extent 9x7x5 --type u16 --byte-order big").silent();
    let file = folder.read("big.nrrd");
    let (header, stored) = split_nrrd(&file);
    assert!(header.contains(&"endian: big") && stored == swapped(&samples, 2), "{header:?}");
    folder.run("convert big.nrrd little.raw --output-byte-order little").silent();
    assert_eq!(folder.read("little.raw"), samples);
}

#[cfg(unix)]
#[test]
fn a_volume_of_several_pieces_comes_through_a_pipe() {
    let folder = Folder::new();
    let samples = noise(9_000_000, 5);
    folder.write("in.raw", &samples);
    let layout = "--extent 3000x1000x3 --type u8";
    folder.shell(&format!("cat in.raw | wavelift convert /dev/stdin a.nrrd --gzip {layout}")).silent();
    folder.shell("cat a.nrrd | wavelift convert /dev/stdin b.npy").silent();
    folder.shell("wavelift convert b.npy /dev/stdout | cat >out.raw").silent();
    assert!(folder.read("out.raw") == samples);
}

#[test]
fn what_a_format_cannot_hold_is_told() {
    let folder = Folder::new();
    let lines = ["NRRD0004", "type: uint8", "dimension: 1", "sizes: 3", "encoding: raw", "spacings: 2"];
    folder.write("in.nrrd", nrrd(&[&lines[..], &["# c", "k:=v"]].concat(), &[1, 2, 3]));
    let outcome = folder.run("convert in.nrrd out.npy").ok();
    let lost = "wavelift: out.npy: .npy has no place for spacings, 1 comment, 1 key/value pair\n";
    assert_eq!(outcome.stderr(), lost);
    let document = folder.run("convert in.nrrd out.npy --json").json();
    let expected = json!({
        "input": "in.nrrd",
        "output": "out.npy",
        "format": ".npy",
        "extent": [3, 1, 1],
        "components": 1,
        "steps": 1,
        "type": "u8",
        "sample_bytes": 3,
        "not_kept": ["spacings", "1 comment", "1 key/value pair"],
    });
    assert_eq!(document, expected);
    folder.run("convert out.npy /dev/stdout --json").fails(2, &["--json and OUTPUT"]);
    folder.run("convert in.nrrd out.raw --gzip").fails(2, &["out.raw", "gzip"]);
}

#[test]
fn compressed_files_and_the_input_itself_are_refused() {
    let folder = Folder::new();
    folder.write("in.raw", [7; 8]);
    let layout = "--extent 8 --type u8";
    folder.run(&format!("compress in.raw a.wlift {layout}")).silent();
    std::fs::copy(folder.path("a.wlift"), folder.path("a.data")).unwrap();
    let before = folder.everything();
    for name in ["a.wlift", "a.data"] {
        let told = format!("{name}: wavelift files are read by `wavelift decompress`");
        folder.run(&format!("convert {name} out.raw")).fails(2, &[&told]);
    }
    let told = "b.WLIFT: wavelift files are written by `wavelift compress`";
    folder.run(&format!("convert in.raw b.WLIFT {layout}")).fails(2, &[told]);
    folder.run(&format!("convert in.raw in.raw {layout}")).fails(2, &["in.raw", "is the input as well"]);
    folder.run("convert in.raw out.npy").fails(2, &["in.raw", "--extent"]);
    folder.run(&format!("convert none.raw out.npy {layout}")).fails(4, &["none.raw", "cannot read"]);
    assert!(folder.everything() == before);
}

#[test]
fn the_samples_of_the_input_are_not_overwritten() {
    let folder = Folder::new();
    let samples = smooth_u16([9, 7, 5]);
    folder.write("in.raw", &samples);
    folder.run("convert in.raw a.nhdr --extent 9x7x5 --type u16").silent();
    folder.run("convert in.raw b.mhd --extent 9x7x5 --type u16").silent();
    folder.run("convert a.nhdr s_%02d.png").ok();
    let before = folder.everything();
    for (line, file) in [
        ("convert a.nhdr a.raw", "a.raw"),
        ("convert a.nhdr ./a.raw --output-byte-order big", "a.raw"),
        ("convert a.nhdr a.mhd", "a.raw"),
        ("convert b.mhd b.raw", "b.raw"),
        ("compress a.nhdr a.raw", "a.raw"),
        ("preview a.nhdr a.raw", "a.raw"),
        ("transform a.nhdr a.raw --wavelet haar --levels 1", "a.raw"),
        ("convert s_%02d.png s_01.png", "s_01.png"),
        ("convert s_*.png s_03.png", "s_03.png"),
        ("compress s_%02d.png s_04.png", "s_04.png"),
    ] {
        folder.run(line).fails(2, &["would overwrite", file]);
    }
    folder.run("compress a.nhdr a.nhdr").fails(2, &["is the input as well"]);
    folder.run("convert s_%02d.png s_%02d.png").fails(2, &["there already"]);
    // Nor is anything written under the name of a format that it is not.
    folder.run("compress a.nhdr new.nrrd").fails(2, &["new.nrrd: is named", "NRRD"]);
    folder.run("convert a.nhdr new.wlift").fails(2, &["new.wlift", "`wavelift compress`"]);
    assert!(folder.everything() == before);
    folder.run("convert a.nhdr c.zarr").ok();
    folder.run("convert c.zarr c.zarr").fails(2, &["would overwrite"]);
    folder.run("convert c.zarr c.zarr/zarr.json").fails(2, &["would overwrite"]);
    folder.run("convert c.zarr d.nrrd").ok();
}

#[test]
fn a_file_cut_short_leaves_the_old_output() {
    let folder = Folder::new();
    folder.write("whole.raw", noise(9_000_000, 5));
    folder.run("convert whole.raw a.nrrd --gzip --extent 3000x3000 --type u8").silent();
    let mut bytes = folder.read("a.nrrd");
    bytes.truncate(bytes.len() - 1000);
    folder.write("a.nrrd", bytes);
    folder.write("out.npy", "old");
    let before = folder.everything();
    folder.run("convert a.nrrd out.npy").fails(3, &["a.nrrd"]);
    assert!(folder.everything() == before);
}
