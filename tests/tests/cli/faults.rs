//! Faults: exit code, a message that names file and fault, and nothing left behind.

use std::ops::Range;

use serde_json::{Value, json};
use wavelift_host::codec::{Content, Scanner};

use crate::files::{nrrd, smooth_u16};
use crate::run::Folder;

/// A folder with a volume of 9x7x5 `u16` in some formats, whole and compressed, and with what is none.
fn folder() -> Folder {
    let folder = Folder::new();
    let samples = smooth_u16([9, 7, 5]);
    folder.write("in.raw", &samples);
    let lines =
        ["NRRD0004", "type: uint16", "dimension: 3", "sizes: 9 7 5", "endian: little", "encoding: raw"];
    folder.write("in.nrrd", nrrd(&lines, &samples));
    folder.write("short.nrrd", nrrd(&lines, &samples[1..]));
    folder.write(
        "colour.nrrd",
        nrrd(&["NRRD0004", "type: uint8", "dimension: 4", "sizes: 3 1 1 1", "encoding: raw"], b"rgb"),
    );
    folder.write("ends.nrrd", "NRRD0004\ntype: uint8\n");
    folder.write("wrong.npy", "no array");
    folder.write("float.raw", [0; 4 * 9]);
    folder.write("empty", "");
    folder.write("text.wlift", "no container");
    folder.run("compress in.nrrd a.wlift --wavelet linear --levels 2 --brick 8").silent();
    folder.run("compress float.raw float.wlift --extent 9 --type f32").silent();
    std::fs::create_dir(folder.path("dir")).unwrap();
    folder
}

/// Where the bricks of a compressed file are.
fn bricks(file: &[u8]) -> Vec<Range<usize>> {
    let found = Scanner::new(&file).map(|found| found.unwrap());
    let bricks = found.filter(|found| matches!(found.content, Some(Content::Brick { .. })));
    bricks.map(|brick| brick.bytes.start as usize..brick.bytes.end as usize).collect()
}

/// Runs each command twice, once without a file `OUT` and once with an old one: both must fail in the same way and
/// change nothing.
fn refuse(folder: &Folder, cases: &[(&str, i32, &[&str])]) {
    for (command, code, parts) in cases {
        for old in [false, true] {
            if old {
                folder.write("OUT", "old");
            }
            let before = folder.everything();
            folder.run(command).fails(*code, parts);
            assert!(folder.everything() == before, "{command}: something changed");
        }
        std::fs::remove_file(folder.path("OUT")).unwrap();
    }
}

#[test]
fn wrong_words_are_told() {
    refuse(
        &folder(),
        &[
            ("compress in.raw OUT --type u16 --extent 9;7;5", 2, &["9;7;5", "--extent"]),
            ("compress in.raw OUT --type u16 --extent 9x7x", 2, &["9x7x", "--extent"]),
            ("compress in.raw OUT --type u16 --extent 9x-7x5", 2, &["-7", "--extent"]),
            ("compress in.raw OUT --type u16 --extent 9x0x5", 2, &["axis y", "--extent"]),
            ("compress in.raw OUT --type u16 --extent 9x7x5x1", 2, &["4 axes", "--extent"]),
            ("compress in.raw OUT --type u16 --extent 9.5", 2, &["9.5", "--extent"]),
            ("compress in.raw OUT --type u16 --extent 99999999999x99999999999", 2, &["--extent", "64 bits"]),
            ("compress in.raw OUT --type ushort --extent 9x7x5", 2, &["ushort", "--type", "u16, i16"]),
            (
                "compress in.raw OUT --type u16 --extent 9x7x5 --byte-order middle",
                2,
                &["middle", "little, big"],
            ),
            ("compress in.raw OUT --type u16 --extent 9x7x5 --wavelet cubik", 2, &["cubik", "'cubic'"]),
            ("compress in.raw OUT --type u16 --extent 9x7x5 --wavelet Cubic", 2, &["Cubic", "--wavelet"]),
            ("compress in.raw OUT --type u16 --extent 9x7x5 --levels many", 2, &["many", "--levels"]),
            ("compress in.raw OUT --type u16 --extent 9x7x5 --levels 32", 2, &["32", "--levels"]),
            ("compress in.raw OUT --type u16 --extent 9x7x5 --brick 0", 2, &["--brick"]),
            ("compress in.raw OUT --type u16 --extent 9x7x5 --brick 8x", 2, &["8x", "--brick"]),
            (
                "compress in.raw OUT --type u16 --extent 9x7x5 --threads 0",
                2,
                &["'0'", "--threads", "give a number of threads from 1"],
            ),
            ("compress in.raw OUT --type u16 --extent 9x7x5 --compress", 2, &["--compress"]),
            ("compress in.nrrd", 2, &["<OUTPUT>"]),
            ("decompress a.wlift OUT --region 0:9,0:7:0:5", 2, &["0:9,0:7:0:5", "--region"]),
            ("decompress a.wlift OUT --region 3:3,0:7,0:5", 2, &["3:3", "--region"]),
            ("decompress a.wlift OUT --level -1", 2, &["-1"]),
            ("transform in.nrrd OUT --levels 1", 2, &["--wavelet"]),
            ("transform in.nrrd OUT --levels 1 --wavelet none", 2, &["none", "--wavelet"]),
            ("shrink in.nrrd OUT", 2, &["shrink"]),
        ],
    );
}

#[test]
fn contradictions_are_told() {
    refuse(
        &folder(),
        &[
            (
                "compress in.nrrd OUT --wavelet none --levels 3",
                2,
                &["wavelift: wavelet none", "3", "contradict"],
            ),
            (
                "compress in.nrrd OUT --wavelet cubic --levels 0",
                2,
                &["wavelift: wavelet cubic", "0", "contradict"],
            ),
            ("compress in.nrrd OUT --levels 5", 2, &["wavelift: bricks of 9x7x5", "at most 4 levels"]),
            ("compress in.nrrd OUT --levels 3 --brick 4", 2, &["at most 2", "levels"]),
            ("compress in.raw OUT --extent 9x7x5", 2, &["--extent", "--type"]),
            ("compress in.raw OUT --type u16", 2, &["--type", "--extent"]),
            ("compress in.nrrd OUT --byte-order big", 2, &["--byte-order"]),
            ("decompress a.wlift OUT --level 3", 2, &["a.wlift", "level 3", "2"]),
            ("decompress float.wlift OUT --level 1", 2, &["float.wlift", "level 1", "full resolution only"]),
            ("decompress a.wlift OUT --region 0:10,0:7,0:5", 2, &["a.wlift", "0:10,0:7,0:5", "9x7x5"]),
            ("decompress a.wlift OUT --region 1:2,1:2,1:2 --level 1", 2, &["a.wlift", "1:2,1:2,1:2"]),
            ("decompress a.wlift OUT --gzip", 2, &["OUT", "gzip"]),
            ("decompress a.wlift a.wlift", 2, &["a.wlift", "input"]),
            ("decompress a.wlift ./dir/../a.wlift", 2, &["a.wlift", "input"]),
            ("compress a.wlift OUT", 2, &["a.wlift: is a wavelift file already: decompress it first"]),
            ("compress a.wlift OUT --extent 9 --type u8", 2, &["a.wlift: is a wavelift file already"]),
            ("transform a.wlift OUT --wavelet haar --levels 1", 2, &["a.wlift: is a wavelift file already"]),
            ("tables a.wlift", 2, &["a.wlift: is a wavelift file already"]),
            ("compress in.nrrd in.nrrd", 2, &["in.nrrd", "input"]),
            ("transform in.nrrd in.nrrd --wavelet haar --levels 1", 2, &["in.nrrd", "input"]),
            ("tables in.nrrd --svg in.nrrd", 2, &["in.nrrd", "input"]),
            ("tables in.nrrd --levels 5", 2, &["in.nrrd", "at most 4"]),
            ("tables --extent 9x7x5 --type u16", 2, &["--extent"]),
            ("tables float.raw --extent 9 --type f32", 2, &["float.raw", "f32"]),
            ("verify a.wlift --extent 9x7x5 --type u16", 2, &["ORIGINAL"]),
            ("verify a.wlift --byte-order big", 2, &["ORIGINAL"]),
            ("transform in.nrrd OUT --wavelet haar --levels 5", 2, &["in.nrrd", "5", "at most 4"]),
            ("transform in.nrrd OUT --wavelet haar --levels 1 --inverse", 2, &["in.nrrd", "i32", "u16"]),
            (
                "transform float.raw OUT --wavelet haar --levels 1 --extent 9 --type f64",
                2,
                &["float.raw", "36"],
            ),
        ],
    );
}

#[test]
fn files_that_do_not_fit_are_told() {
    refuse(
        &folder(),
        &[
            ("compress in.raw OUT", 2, &["in.raw", "--extent", "--type"]),
            ("compress in.raw OUT --extent 9x7x5 --type u8", 2, &["in.raw", "315", "630", "u16"]),
            ("compress in.raw OUT --extent 9x7x6 --type u16", 2, &["in.raw", "756", "630"]),
            ("compress in.raw OUT --extent 400000000x4000000000 --type u8", 2, &["in.raw", "630"]),
            ("compress empty OUT --extent 1 --type u8", 3, &["empty: the file is empty"]),
            ("compress empty OUT", 3, &["empty: the file is empty"]),
            ("compress short.nrrd OUT", 3, &["short.nrrd", "630", "629"]),
            ("tables colour.nrrd", 2, &["colour.nrrd", "3 components"]),
            ("compress ends.nrrd OUT", 3, &["ends.nrrd", "header"]),
            ("compress wrong.npy OUT", 3, &["wrong.npy"]),
            ("decompress in.raw OUT", 3, &["in.raw", "not a wavelift file"]),
            ("decompress empty OUT", 3, &["empty", "not a wavelift file"]),
            ("decompress text.wlift OUT", 3, &["text.wlift", "not a wavelift file"]),
            ("info in.nrrd", 3, &["in.nrrd", "not a wavelift file"]),
            ("verify empty", 3, &["empty", "not a wavelift file"]),
            ("verify a.wlift wrong.npy", 3, &["wrong.npy"]),
            ("verify a.wlift float.raw", 3, &["float.raw: has 36 bytes", "9x7x5 of u16, 630 bytes"]),
        ],
    );
}

#[test]
fn what_the_system_refuses_is_told() {
    refuse(
        &folder(),
        &[
            ("compress missing.raw OUT --extent 1 --type u8", 4, &["missing.raw", "cannot read"]),
            ("compress missing.nrrd OUT", 4, &["missing.nrrd", "cannot read"]),
            ("compress dir OUT", 3, &["dir: there are no slices"]),
            ("compress dir OUT --extent 1 --type u8", 3, &["dir: there are no slices"]),
            ("decompress missing.wlift OUT", 4, &["missing.wlift", "cannot read"]),
            ("decompress dir OUT", 4, &["dir: cannot read: is a directory"]),
            ("info missing.wlift", 4, &["missing.wlift", "cannot read"]),
            ("info dir", 4, &["dir: cannot read: is a directory"]),
            ("verify missing.wlift", 4, &["missing.wlift", "cannot read"]),
            ("verify a.wlift missing.nrrd", 4, &["missing.nrrd", "cannot read"]),
            ("tables missing.nrrd", 4, &["missing.nrrd", "cannot read"]),
            ("transform missing.nrrd OUT --wavelet haar --levels 1", 4, &["missing.nrrd", "cannot read"]),
            ("compress in.nrrd dir", 4, &["dir: cannot write: is a directory"]),
            (
                "compress in.nrrd missing/OUT",
                4,
                &["missing/OUT: cannot write: the folder missing does not exist"],
            ),
            ("compress in.nrrd in.raw/OUT", 4, &["in.raw/OUT", "cannot write"]),
            ("decompress a.wlift dir", 4, &["dir: cannot write: is a directory"]),
            ("decompress a.wlift missing/OUT", 4, &["missing/OUT", "the folder missing does not exist"]),
            ("decompress a.wlift missing/OUT.nhdr", 4, &["missing/", "cannot write"]),
            ("tables in.nrrd --svg missing/OUT", 4, &["missing/OUT", "the folder missing does not exist"]),
            ("transform in.nrrd missing/OUT --wavelet haar --levels 1", 4, &["missing/OUT", "cannot write"]),
        ],
    );
}

#[cfg(unix)]
#[test]
fn a_folder_that_takes_no_files_is_told() {
    use std::fs::{Permissions, set_permissions};
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    set_permissions(folder.path("dir"), Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(folder.path("dir/probe"), "").is_ok() {
        println!("skipped: this user may write to every folder");
        return;
    }
    refuse(
        &folder,
        &[
            ("compress in.nrrd dir/new.wlift", 4, &["dir/new.wlift", "cannot write", "denied"]),
            ("decompress a.wlift dir/new.nrrd", 4, &["dir/new.nrrd", "cannot write", "denied"]),
        ],
    );
}

#[test]
fn a_detached_header_replaces_no_strange_samples() {
    let folder = folder();
    folder.write("scan.raw", "of another scan");
    let before = folder.everything();
    folder.run("decompress a.wlift scan.nhdr").fails(2, &["scan.nhdr", "scan.raw"]);
    assert!(folder.everything() == before);
}

#[test]
fn a_container_cut_anywhere_is_refused() {
    let folder = folder();
    let whole = folder.read("a.wlift");
    for length in 0..whole.len() {
        folder.write("cut.wlift", &whole[..length]);
        let commands: &[&str] = match length % 16 {
            0 => &["info cut.wlift", "verify cut.wlift", "decompress cut.wlift OUT --level 2"],
            _ => &["decompress cut.wlift OUT"],
        };
        for command in commands {
            folder.run(command).fails(3, &["cut.wlift"]);
        }
    }
    assert!(!folder.everything().contains_key("OUT"));
    folder.write("cut.wlift", [&whole[..], &[0]].concat());
    refuse(
        &folder,
        &[("decompress cut.wlift OUT", 3, &["cut.wlift"]), ("info cut.wlift", 3, &["cut.wlift"])],
    );
}

#[test]
fn every_damaged_byte_is_found() {
    let folder = folder();
    let whole = folder.read("a.wlift");
    let bricks = bricks(&whole).last().unwrap().clone();
    for at in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 1 << (at % 8);
        folder.write("damaged.wlift", &damaged);
        folder.run("verify damaged.wlift").fails(3, &["damaged.wlift"]);
        if at % 16 == 0 {
            folder.run("verify damaged.wlift in.nrrd").fails(3, &["damaged.wlift"]);
            // Statistics, which follow the bricks, are not looked at to read samples.
            if at < bricks.end {
                folder.run("decompress damaged.wlift OUT").fails(3, &["damaged.wlift"]);
            }
        }
    }
    let before = folder.everything();
    assert!(!before.contains_key("OUT"));
    let hidden = before.keys().filter(|name| name.starts_with('.'));
    assert_eq!(hidden.count(), 0);
}

#[test]
fn a_damaged_brick_is_named_and_the_others_are_readable() {
    let folder = folder();
    let mut damaged = folder.read("a.wlift");
    let first = bricks(&damaged)[0].end - 1;
    damaged[first] ^= 1;
    folder.write("damaged.wlift", &damaged);
    for command in ["verify damaged.wlift", "verify damaged.wlift in.nrrd"] {
        folder.run(command).fails(3, &["brick 0", "0:8,0:7,0:5", "1 of 2 bricks"]);
    }
    folder.run("decompress damaged.wlift OUT").fails(3, &["brick 0", "0:8,0:7,0:5"]);
    folder.run("decompress damaged.wlift part.raw --region 8:9,0:7,0:5").silent();
    folder.run("decompress a.wlift whole.raw --region 8:9,0:7,0:5").silent();
    assert_eq!(folder.read("part.raw"), folder.read("whole.raw"));
}

#[test]
fn every_damaged_brick_is_named_in_json_too() {
    let folder = folder();
    let mut file = folder.read("a.wlift");
    let footer = file.len() - 12;
    for brick in bricks(&file) {
        file[brick.end - 1] ^= 1;
    }
    folder.write("damaged.wlift", &file);
    for command in ["verify damaged.wlift --json", "verify damaged.wlift in.nrrd --json"] {
        let document = folder.run(command).fails_with_json(3, "2 of 2 bricks");
        let damaged = document["damaged"].as_array().unwrap();
        assert_eq!((&document["whole"], &document["bricks"]), (&json!(false), &json!(2)));
        assert!(
            damaged
                .iter()
                .zip(["brick 0", "brick 1"])
                .all(|(message, brick)| { message.as_str().unwrap().contains(brick) })
        );
    }
    folder.write("cut.wlift", &file[..footer]);
    let document = folder.run("verify cut.wlift --json").fails_with_json(3, "cut.wlift: truncated");
    assert_eq!((&document["whole"], &document["bricks"]), (&json!(false), &Value::Null));
    assert_eq!(document["damaged"].as_array().map(Vec::len), Some(1));
}

#[test]
fn other_versions_are_told() {
    let folder = folder();
    let mut other = folder.read("a.wlift");
    for (version, told) in [(2, "never released"), (4, "a newer wavelift")] {
        other[8] = version;
        folder.write("other.wlift", &other);
        let number = format!("version {version}");
        folder.run("info other.wlift").fails(3, &["other.wlift", &number, told]);
    }
}
