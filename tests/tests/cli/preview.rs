//! Pictures show the samples at their place.

use std::fs::File;
use std::io::BufReader;

use serde_json::json;

use crate::files::{noise, smooth_u16};
use crate::run::Folder;

/// Size, colors and samples of a PNG file.
fn png(folder: &Folder, name: &str) -> ([u32; 2], png::ColorType, Vec<u8>) {
    let decoder = png::Decoder::new(BufReader::new(File::open(folder.path(name)).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut samples = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut samples).unwrap();
    ([info.width, info.height], info.color_type, samples)
}

#[test]
fn slices_of_volumes_and_of_compressed_files_are_the_same() {
    let folder = Folder::new();
    let samples = noise(30 * 20 * 10, 3);
    folder.write("in.raw", &samples);
    let layout = "--extent 30x20x10 --type u8";
    folder.run(&format!("compress in.raw a.wlift {layout} --brick 8")).silent();
    folder.run("preview a.wlift a.png --slice z=7 --window 0:255").silent();
    folder.run(&format!("preview in.raw b.png {layout} --slice z=7 --window 0:255")).silent();
    let expected = ([30, 20], png::ColorType::Grayscale, samples[7 * 600..8 * 600].to_vec());
    assert!(png(&folder, "a.png") == expected && png(&folder, "b.png") == expected);
    for (view, size) in [("--slice y=3", [30, 10]), ("--slice x", [20, 10]), ("--mip z", [30, 20])] {
        folder.run(&format!("preview a.wlift a.png {view}")).silent();
        folder.run(&format!("preview in.raw b.png {layout} {view}")).silent();
        assert_eq!(folder.read("a.png"), folder.read("b.png"), "{view}");
        assert_eq!(png(&folder, "a.png").0, size, "{view}");
    }
}

#[test]
fn sixteen_bits_and_coarse_levels_are_drawn() {
    let folder = Folder::new();
    let samples = smooth_u16([64, 64, 16]);
    folder.write("in.raw", &samples);
    folder.run("compress in.raw a.wlift --extent 64x64x16 --type u16 --brick 16").silent();
    folder.run("preview a.wlift a.png --slice z=0 --depth 16 --window 0:65535").silent();
    let swapped: Vec<u8> =
        samples[..2 * 64 * 64].chunks(2).flat_map(|sample| [sample[1], sample[0]]).collect();
    assert_eq!(png(&folder, "a.png").2, swapped);
    for (option, level, side) in [("--size 17", 1, 32), ("--size 16", 2, 16), ("--level 2", 2, 16)] {
        let document = folder.run(&format!("preview a.wlift a.png {option} --json")).json();
        assert_eq!(
            (&document["level"], &document["size"]),
            (&json!(level), &json!([side, side])),
            "{option}"
        );
    }
}

#[test]
fn pictures_that_cannot_be_are_refused() {
    let folder = Folder::new();
    folder.write("in.raw", noise(30 * 20 * 10, 3));
    folder.run("compress in.raw a.wlift --extent 30x20x10 --type u8").silent();
    let before = folder.everything();
    for (line, code, told) in [
        ("preview a.wlift out.png --slice z=10", 2, "there is no slice z = 10: the last one is 9"),
        ("preview a.wlift out.png --slice w", 2, "'w' is no axis"),
        ("preview a.wlift out.png --slice z=a", 2, "z=40"),
        ("preview a.wlift out.png --window 2:1", 2, "LOW:HIGH"),
        ("preview a.wlift out.png --percentiles 0:101", 2, "LOW:HIGH"),
        ("preview a.wlift out.png --depth 12", 2, "8 or 16"),
        ("preview a.wlift out.png --step 1", 2, "there is no time step 1"),
        ("preview a.wlift out.png --component 1", 2, "there is no component 1"),
        ("preview a.wlift out.png --level 9", 2, "level 9 is not in this file"),
        ("preview a.wlift out.png --extent 4", 2, "needs no --extent"),
        ("preview a.wlift a.wlift", 2, "is the input as well"),
        ("preview a.wlift none/out.png", 4, "none does not exist"),
        ("preview in.raw out.png", 2, "--extent"),
        ("preview in.raw out.png --extent 30x20x10 --type u8 --level 1", 2, "has no levels"),
        ("preview none.wlift out.png", 4, "none.wlift"),
    ] {
        folder.run(line).fails(code, &[told]);
    }
    assert!(folder.everything() == before);
}
