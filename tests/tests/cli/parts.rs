//! Options of size: threads, bricks, levels, regions.

use std::fmt::Write;

use serde_json::{Value, json};

use crate::files::{noise, nrrd, smooth_u16, split_nrrd};
use crate::run::Folder;

const WAVELETS: [&str; 6] = ["haar", "quadratic", "duchaineau", "linear", "cubic", "quintic"];

#[test]
fn the_bytes_do_not_depend_on_threads() {
    let folder = Folder::new();
    let samples = smooth_u16([40, 33, 21]);
    folder.write("in.raw", &samples);
    for options in ["", "--wavelet cubic --levels 2"] {
        for threads in 1..=3 {
            let layout = "--extent 40x33x21 --type u16 --brick 8";
            folder
                .run(&format!("compress in.raw {threads}.wlift {layout} --threads {threads} {options}"))
                .silent();
            folder.run(&format!("decompress 1.wlift {threads}.raw --threads {threads}")).silent();
            assert_eq!(folder.read(format!("{threads}.wlift")), folder.read("1.wlift"));
            assert_eq!(folder.read(format!("{threads}.raw")), samples);
            folder.run(&format!("verify 1.wlift --threads {threads}")).ok();
        }
    }
}

#[test]
fn bricks_may_have_any_sides() {
    let folder = Folder::new();
    let samples = noise(12 * 9 * 7, 1);
    folder.write("in.raw", &samples);
    let cases =
        [("5", [5, 5, 5], 12), ("1x9x4", [1, 9, 4], 24), ("4294967295", [12, 9, 7], 1), ("1", [1; 3], 756)];
    for (brick, sides, count) in cases {
        folder.run(&format!("compress in.raw a.wlift --extent 12x9x7 --type i8 --brick {brick}")).silent();
        folder.run("decompress a.wlift out.raw").silent();
        assert_eq!(folder.read("out.raw"), samples, "{brick}");
        let info = folder.run("info a.wlift --json").json();
        assert_eq!((&info["brick"], &info["bricks"]), (&json!(sides), &json!(count)));
    }
}

#[test]
fn wavelets_and_levels_are_those_asked_for() {
    let folder = Folder::new();
    let samples = smooth_u16([30, 20, 10]);
    folder.write("in.raw", &samples);
    for wavelet in WAVELETS {
        for levels in ["auto", "1", "3"] {
            let options = format!("--extent 30x20x10 --type u16 --wavelet {wavelet} --levels {levels}");
            folder.run(&format!("compress in.raw a.wlift {options}")).silent();
            folder.run("decompress a.wlift out.raw").silent();
            assert_eq!(folder.read("out.raw"), samples, "{options}");
            let info = folder.run("info a.wlift --json").json();
            let expected = levels.parse().unwrap_or(5);
            assert_eq!((&info["wavelet"], &info["levels"]), (&json!(wavelet), &json!(expected)));
        }
    }
    for options in ["--wavelet none", "--wavelet none --levels 0", "--levels 0"] {
        folder.run(&format!("compress in.raw a.wlift --extent 30x20x10 --type u16 {options}")).silent();
        let info = folder.run("info a.wlift --json").json();
        assert_eq!((&info["wavelet"], &info["levels"]), (&json!("none"), &json!(0)), "{options}");
        folder.run("decompress a.wlift out.raw").silent();
        assert_eq!(folder.read("out.raw"), samples);
    }
}

/// A value that no wavelet rounds in two levels along three axes: their gains are 1, 1/2, 1/4 and 2/3.
const EXACT: u32 = 3_u32.pow(6) * 4_u32.pow(6);

#[test]
fn a_level_is_a_coarser_volume_of_the_same_scale() {
    let folder = Folder::new();
    let value = EXACT.to_le_bytes();
    let mut lines =
        vec!["NRRD0004", "type: uint32", "dimension: 3", "sizes: 20 13 6", "endian: little", "encoding: raw"];
    lines.push("spacings: 0.5 1 3");
    folder.write("in.nrrd", nrrd(&lines, &value.repeat(20 * 13 * 6)));
    for wavelet in WAVELETS {
        folder.run(&format!("compress in.nrrd a.wlift --wavelet {wavelet} --brick 8")).silent();
        for (level, sizes, spacings, samples) in [(1, "10 7 3", "1 2 6", 210), (2, "5 4 2", "2 4 12", 40)] {
            folder.run(&format!("decompress a.wlift out.nrrd --level {level}")).silent();
            let file = folder.read("out.nrrd");
            let (header, stored) = split_nrrd(&file);
            assert!(header.contains(&format!("sizes: {sizes}").as_str()), "{header:?}");
            assert!(header.contains(&format!("spacings: {spacings}").as_str()), "{header:?}");
            assert!(stored == value.repeat(samples), "{wavelet}, level {level}");
        }
    }
}

#[test]
fn slices_and_lines_have_levels() {
    let folder = Folder::new();
    for (extent, samples, coarse) in [("21x10", 210, 6 * 3), ("21", 21, 6)] {
        folder.write("in.raw", [77_u8, 0].repeat(samples));
        folder
            .run(&format!("compress in.raw a.wlift --extent {extent} --type i16 --wavelet linear"))
            .silent();
        folder.run("decompress a.wlift out.raw --level 2").silent();
        assert_eq!(folder.read("out.raw"), [77_u8, 0].repeat(coarse), "{extent}");
    }
}

/// The samples of a box, x fastest.
fn crop(
    samples: &[u8],
    [nx, ny]: [usize; 2],
    bytes: usize,
    [x, y, z]: [std::ops::Range<usize>; 3],
) -> Vec<u8> {
    let mut cropped = Vec::new();
    for z in z {
        for y in y.clone() {
            let row = nx * (y + ny * z);
            cropped.extend(&samples[(row + x.start) * bytes..(row + x.end) * bytes]);
        }
    }
    cropped
}

#[test]
fn a_region_is_cut_out_of_the_volume() {
    let folder = Folder::new();
    for (kind, bytes, wavelet) in [("u16", 2, "quadratic"), ("f64", 8, "none"), ("i8", 1, "auto")] {
        let samples = noise(20 * 13 * 6 * bytes, 3);
        folder.write("in.raw", &samples);
        let options = format!("--extent 20x13x6 --type {kind} --wavelet {wavelet} --brick 8x5x4");
        folder.run(&format!("compress in.raw a.wlift {options}")).silent();
        let regions = [[0..20, 0..13, 0..6], [7..9, 4..6, 3..5], [19..20, 12..13, 5..6], [0..1, 0..13, 2..3]];
        for region in regions {
            let text = region.iter().fold(String::new(), |mut text, range| {
                let _ = write!(text, ",{}:{}", range.start, range.end);
                text
            });
            folder.run(&format!("decompress a.wlift out.raw --region {}", &text[1..])).silent();
            assert_eq!(folder.read("out.raw"), crop(&samples, [20, 13], bytes, region), "{kind} {text}");
        }
    }
}

#[test]
fn axes_that_a_region_leaves_out_are_taken_whole() {
    let folder = Folder::new();
    let samples = noise(20 * 13 * 6, 4);
    folder.write("in.raw", &samples);
    folder.run("compress in.raw a.wlift --extent 20x13x6 --type u8 --brick 8").silent();
    for (text, region) in [("7:9", [7..9, 0..13, 0..6]), ("7:9,4:6", [7..9, 4..6, 0..6])] {
        folder.run(&format!("decompress a.wlift out.raw --region {text}")).silent();
        assert_eq!(folder.read("out.raw"), crop(&samples, [20, 13], 1, region), "{text}");
    }
    folder.run("compress in.raw a.wlift --extent 40x39 --type u8").silent();
    folder.run("decompress a.wlift out.raw --region 3:5,38:39").silent();
    assert_eq!(folder.read("out.raw"), samples[38 * 40 + 3..38 * 40 + 5]);
}

#[test]
fn a_region_of_a_level_is_cut_out_of_the_level() {
    let folder = Folder::new();
    folder.write("in.raw", smooth_u16([20, 13, 6]));
    folder.run("compress in.raw a.wlift --extent 20x13x6 --type u16 --wavelet cubic --brick 8").silent();
    folder.run("decompress a.wlift level.raw --level 1").silent();
    folder.run("decompress a.wlift part.raw --level 1 --region 3:20,4:13,1:5").silent();
    assert_eq!(folder.read("part.raw"), crop(&folder.read("level.raw"), [10, 7], 2, [2..10, 2..7, 1..3]));
}

#[test]
fn a_region_keeps_its_place_in_space() {
    let folder = Folder::new();
    let mut lines =
        vec!["NRRD0004", "type: uint16", "dimension: 3", "sizes: 20 13 6", "endian: little", "encoding: raw"];
    lines.extend([
        "spacings: 2.00 5e-1 3",
        "space dimension: 3",
        "space directions: (2,0,0) (0,0.5,0) (0,0,-3)",
        "space origin: (10,20,30)",
    ]);
    folder.write("in.nrrd", nrrd(&lines, &smooth_u16([20, 13, 6])));
    folder.run("compress in.nrrd a.wlift --wavelet linear").silent();
    folder.run("decompress a.wlift out.nrrd --region 4:12,2:4,1:6 --level 1").silent();
    let file = folder.read("out.nrrd");
    let (header, _) = split_nrrd(&file);
    for line in ["sizes: 4 1 2", "space directions: (4,0,0) (0,1,0) (0,0,-6)", "space origin: (18,21,24)"] {
        assert!(header.contains(&line), "{line}: {header:?}");
    }
    folder.run("decompress a.wlift out.nrrd --region 4:12,2:4,1:6").silent();
    let file = folder.read("out.nrrd");
    let (header, _) = split_nrrd(&file);
    for line in ["spacings: 2.00 5e-1 3", "space directions: (2,0,0) (0,0.5,0) (0,0,-3)"] {
        assert!(header.contains(&line), "{line}: {header:?}");
    }
}

#[test]
fn time_steps_are_appended_and_read_one_by_one() {
    let folder = Folder::new();
    let layout = "--extent 20x13x6 --type u16";
    let (first, second) = (noise(2 * 20 * 13 * 6, 1), noise(2 * 20 * 13 * 6, 2));
    folder.write("first.raw", &first);
    folder.write("second.raw", &second);
    folder.run(&format!("compress first.raw a.wlift --brick 8 {layout}")).silent();
    folder.run(&format!("append a.wlift second.raw --brick 8 --time 0.5 {layout}")).silent();
    let info = folder.run("info a.wlift --json").json();
    let steps = info["steps"].as_array().unwrap();
    assert_eq!((steps.len(), &info["bricks"]), (2, &json!(12)));
    assert_eq!((&steps[1]["name"], &steps[1]["time"]), (&json!("second"), &json!(0.5)));
    assert_eq!((&steps[0]["name"], &steps[0]["brick"]), (&Value::Null, &json!([8, 8, 6])));
    folder.run("decompress a.wlift out.raw").silent();
    assert_eq!(folder.read("out.raw"), [first.clone(), second.clone()].concat());
    for (step, expected) in [(0, first), (1, second)] {
        folder.run(&format!("decompress a.wlift out.raw --step {step}")).silent();
        assert_eq!(folder.read("out.raw"), expected);
        folder.run(&format!("decompress a.wlift out.raw --step {step} --memory 1K")).silent();
        assert_eq!(folder.read("out.raw"), expected);
    }
    folder.run("verify a.wlift").ok();
    folder.run("decompress a.wlift out.raw --step 2").fails(2, &["time step 2", "has 2"]);
    folder.run("decompress a.wlift out.raw --component 1").fails(2, &["component 1"]);
    folder.write("small.raw", noise(2 * 20 * 13 * 5, 1));
    let before = folder.read("a.wlift");
    let small = "append a.wlift small.raw --extent 20x13x5 --type u16";
    folder.run(small).fails(2, &["20x13x6", "20x13x5"]);
    assert_eq!(folder.read("a.wlift"), before);
}
