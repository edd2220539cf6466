//! What is whole of a damaged file is saved, and what is lost is named.

use serde_json::json;

use crate::files::noise;
use crate::run::Folder;

/// A folder with a file of eight bricks.
fn prepared() -> Folder {
    let folder = Folder::new();
    folder.write("in.raw", noise(32 * 32 * 32, 3));
    folder.run("compress in.raw a.wlift --extent 32x32x32 --type u8 --brick 16 --effort fast").silent();
    folder
}

#[test]
fn a_whole_file_is_saved_whole() {
    let folder = prepared();
    let outcome = folder.run("repair a.wlift b.wlift").ok();
    assert_eq!((outcome.stdout(), outcome.stderr()), ("b.wlift: all 8 bricks saved\n", ""));
    assert_eq!(folder.read("b.wlift"), folder.read("a.wlift"));
}

#[test]
fn a_damaged_brick_is_lost_and_the_others_are_not() {
    let folder = prepared();
    let mut bytes = folder.read("a.wlift");
    let middle = bytes.len() * 3 / 16;
    bytes[middle..][..9].fill(0);
    folder.write("bad.wlift", &bytes);
    folder.write("old.wlift", "old");
    for name in ["new.wlift", "old.wlift"] {
        let lost = ["brick 1 (samples 16:32,0:16,0:16)", "1 of 8 bricks are lost"];
        folder.run(&format!("repair bad.wlift {name}")).fails(3, &lost);
        folder.run(&format!("info {name}")).ok();
        folder.run(&format!("verify {name}")).fails(3, &["brick 1 (samples 16:32,0:16,0:16)", "lost"]);
        folder.run(&format!("decompress {name} part.raw --region 0:32,16:32")).silent();
        let whole = folder.read("in.raw");
        let part: Vec<u8> = whole.chunks(32 * 32).flat_map(|plane| &plane[16 * 32..]).copied().collect();
        assert_eq!(folder.read("part.raw"), part);
    }
    let document = folder.run("repair bad.wlift c.wlift --json").fails_with_json(3, "1 of 8 bricks are lost");
    let lost = json!([{ "step": 0, "brick": 1, "component": 0, "region": "16:32,0:16,0:16" }]);
    assert_eq!(
        (&document["lost"], &document["bricks"], &document["lost_metadata"]),
        (&lost, &json!(8), &json!(false))
    );
}

#[test]
fn a_single_wrong_byte_is_put_right() {
    let folder = prepared();
    let whole = folder.read("a.wlift");
    // In the head, a brick, and the footer.
    for byte in [15, whole.len() / 2, whole.len() - 2] {
        let mut bytes = whole.clone();
        bytes[byte] ^= 1;
        folder.write("bad.wlift", &bytes);
        folder.run("verify bad.wlift").fails(3, &["bad.wlift"]);
        let outcome = folder.run("repair bad.wlift good.wlift").ok();
        assert_eq!(outcome.stdout(), "good.wlift: all 8 bricks saved\n");
        assert!(folder.read("good.wlift") == whole, "byte {byte}");
        folder.run("decompress bad.wlift out.raw --salvage").ok();
        assert!(folder.read("out.raw") == folder.read("in.raw"), "byte {byte}");
    }
    let mut bytes = whole;
    bytes[15] ^= 1;
    folder.write("bad.wlift", &bytes);
    let told = folder.run("repair bad.wlift good.wlift");
    assert!(told.stderr().contains("bad.wlift: byte 15 was wrong, and is put right"), "{}", told.stderr());
}

#[test]
fn what_is_left_is_decompressed_and_the_rest_filled() {
    let folder = prepared();
    let mut bytes = folder.read("a.wlift");
    let middle = bytes.len() * 3 / 16;
    bytes[middle..][..9].fill(0);
    folder.write("bad.wlift", &bytes);
    folder.run("decompress bad.wlift out.raw").fails(3, &["brick 1 (samples 16:32,0:16,0:16)", "--salvage"]);
    let lost = ["lost: brick 1 (samples 16:32,0:16,0:16)", "1 of the bricks asked for are lost, and filled"];
    folder.run("decompress bad.wlift out.raw --salvage --fill 7").fails(3, &lost);
    let mut expected = folder.read("in.raw");
    for plane in expected.chunks_mut(32 * 32).take(16) {
        plane.chunks_mut(32).take(16).for_each(|row| row[16..].fill(7));
    }
    assert!(folder.read("out.raw") == expected);
    // Where nothing is missing, all is well.
    folder.run("decompress bad.wlift part.raw --salvage --region 0:16").ok();
    folder.run("decompress a.wlift same.raw --salvage").silent();
    assert!(folder.read("same.raw") == folder.read("in.raw"));
    // Cut short, and the index gone.
    folder.write("cut.wlift", &bytes[..bytes.len() * 9 / 16]);
    let line = "decompress cut.wlift out.raw --salvage --json";
    let document = folder.run(line).fails_with_json(3, "5 of the bricks asked for are lost");
    assert_eq!(document["lost"][0]["region"], json!("16:32,0:16,0:16"));
    assert_eq!((document["lost"].as_array().unwrap().len(), &document["mended"]), (5, &json!([])));
    folder.run("decompress a.wlift out.raw --fill 7").fails(2, &["--salvage"]);
    folder.run("decompress bad.wlift out.raw --salvage --fill 256").fails(2, &["'256' is no value of u8"]);
}

#[test]
fn a_file_without_its_end_is_saved() {
    let folder = prepared();
    let bytes = folder.read("a.wlift");
    folder.write("cut.wlift", &bytes[..bytes.len() * 9 / 16]);
    folder.run("info cut.wlift").fails(3, &["truncated"]);
    folder.run("repair cut.wlift saved.wlift").fails(3, &["4 of 8 bricks are lost"]);
    folder.run("decompress saved.wlift half.raw --region 0:32,0:32,0:16").silent();
    assert_eq!(folder.read("half.raw"), folder.read("in.raw")[..32 * 32 * 16]);
}

#[test]
fn what_cannot_be_repaired_leaves_the_old_output() {
    let folder = prepared();
    folder.write("out.wlift", "old");
    folder.write("noise", noise(1000, 9));
    folder.write("empty", "");
    let before = folder.everything();
    for name in ["noise", "empty", "in.raw"] {
        folder.run(&format!("repair {name} out.wlift")).fails(3, &[name, "nothing in it says"]);
    }
    folder.run("repair none.wlift out.wlift").fails(4, &["none.wlift", "cannot read"]);
    folder.run("repair a.wlift a.wlift").fails(2, &["is the input as well"]);
    folder.run("repair a.wlift /dev/stdout --json").fails(2, &["--json and OUTPUT"]);
    assert!(folder.everything() == before);
}
