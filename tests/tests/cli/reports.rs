//! What the program says: text for people, JSON for scripts, and nothing where nobody asked.

use serde_json::{Value, json};

use crate::files::{noise, nrrd, smooth_u16};
use crate::run::Folder;

/// A folder with a volume, `in.nrrd`, and the same compressed, `a.wlift`.
fn compressed() -> Folder {
    let folder = Folder::new();
    let mut lines =
        vec!["NRRD0004", "type: uint16", "dimension: 3", "sizes: 20 13 6", "endian: little", "encoding: raw"];
    lines.extend(["spacings: 0.5 1 3", "content: a hill", "# measured twice", "operator:=J. Doe"]);
    folder.write("in.nrrd", nrrd(&lines, &smooth_u16([20, 13, 6])));
    folder.run("compress in.nrrd a.wlift --wavelet cubic --brick 8").silent();
    folder
}

#[test]
fn compress_reports_sizes_and_choices() {
    let folder = compressed();
    let document = folder.run("compress in.nrrd b.wlift --wavelet cubic --brick 8 --json").json();
    let bytes = folder.read("b.wlift").len();
    assert_eq!(folder.read("a.wlift").len(), bytes);
    assert_eq!(document["extent"], json!([20, 13, 6]));
    assert_eq!((&document["input"], &document["output"]), (&json!("in.nrrd"), &json!("b.wlift")));
    assert_eq!(document["type"], "u16");
    assert!((document["bits_per_sample"].as_f64().unwrap() - 8.0 * bytes as f64 / 1560.0).abs() < 1e-9);
    assert_eq!((&document["bytes"], &document["sample_bytes"]), (&json!(bytes), &json!(3120)));
    assert_eq!((&document["wavelet"], &document["levels"]), (&json!("cubic"), &json!(3)));
    assert_eq!(document["effort"], "default");
    let info = folder.run("info b.wlift --json").json();
    for (name, value) in document.as_object().unwrap() {
        assert!(["input", "output"].contains(&name.as_str()) || info[name] == *value, "{name}: {info}");
    }
}

#[test]
fn a_file_without_a_transform_is_told_as_such() {
    let folder = Folder::new();
    let samples: Vec<u8> = noise(8 * 8 * 8, 1).into_iter().map(|byte| byte / 86 * 100).collect();
    folder.write("in.raw", samples);
    let options = "--extent 8x8x8 --type u8 --wavelet none --json";
    let document = folder.run(&format!("compress in.raw a.wlift {options}")).json();
    assert_eq!((&document["wavelet"], &document["packed_values"]), (&json!("none"), &json!(3)));
    let info = folder.run("info a.wlift").ok();
    let levels = "levels    0 to 3 can be read, but whole bricks are decoded for each: `compress --wavelet linear` \
                  makes quick ones";
    for line in ["wavelet   none (no transform)", levels, "packed    3 values"] {
        assert!(info.stdout().lines().any(|found| found == line), "{line}: {}", info.stdout());
    }
    folder.write("floats.raw", [0; 32]);
    folder.run("compress floats.raw a.wlift --extent 8 --type f32").silent();
    let info = folder.run("info a.wlift").ok();
    assert!(info.stdout().contains("\nlevels    0, full resolution only\n"), "{}", info.stdout());
}

#[test]
fn decompress_reports_what_was_written() {
    let folder = compressed();
    let document = folder.run("decompress a.wlift out.nrrd --level 1 --json").json();
    assert_eq!(document["extent"], json!([10, 7, 3]));
    assert_eq!((&document["type"], &document["format"]), (&json!("u16"), &json!("NRRD")));
    assert_eq!(document["sample_bytes"], 420);
    assert_eq!(document["not_kept"], json!([]));
}

#[test]
fn info_tells_all_that_the_file_says() {
    let folder = compressed();
    let text = folder.run("info a.wlift").ok();
    let expected = [
        "effort    default\n",
        "20 x 13 x 6",
        "u16",
        "cubic",
        "3 levels",
        "6 of 8 x 8 x 6",
        "NRRD",
        "little",
        "spacings: 0.5 1 3",
        "a hill",
        "levels    0 to 3 can be read",
        "          # measured twice\n",
        "J. Doe",
        "bits a sample",
    ];
    for part in expected {
        assert!(text.stdout().contains(part), "{part}: {}", text.stdout());
    }
    assert_eq!(text.stderr(), "");
    let document = folder.run("info a.wlift --json").json();
    let expected: [(&str, Value); 10] = [
        ("extent", json!([20, 13, 6])),
        ("type", json!("u16")),
        ("wavelet", json!("cubic")),
        ("levels", json!(3)),
        ("brick", json!([8, 8, 6])),
        ("bricks", json!(6)),
        ("bytes", json!(folder.read("a.wlift").len())),
        ("sample_bytes", json!(3120)),
        ("spacing", json!([0.5, 1.0, 3.0])),
        ("name", json!("a hill")),
    ];
    for (field, value) in expected {
        assert_eq!(document[field], value, "{field}: {document}");
    }
    assert_eq!(document["source"]["format"], "NRRD");
    let header = json!([
        { "field": "spacings", "value": "0.5 1 3" },
        { "field": "content", "value": "a hill" },
        { "comment": " measured twice" },
        { "key": "operator", "value": "J. Doe" },
    ]);
    assert_eq!(document["header"], header);
}

#[test]
fn verify_tells_what_was_checked_and_what_differs() {
    let folder = compressed();
    let checked = folder.run("verify a.wlift").ok();
    assert!(checked.stdout().starts_with("a.wlift: 6 bricks"), "{}", checked.stdout());
    let compared = folder.run("verify a.wlift in.nrrd").ok();
    assert!(compared.stdout().contains("equal to in.nrrd"), "{}", compared.stdout());
    let document = folder.run("verify a.wlift in.nrrd --json").json();
    assert_eq!((&document["original"], &document["whole"]), (&json!("in.nrrd"), &json!(true)));
    assert_eq!((&document["damaged"], &document["difference"]), (&json!([]), &Value::Null));
    assert_eq!(folder.run("verify a.wlift --json").json()["bricks"], 6);

    let mut changed = smooth_u16([20, 13, 6]);
    changed[2 * (7 + 20 * (4 + 13 * 2))] ^= 1;
    folder.write("other.raw", changed);
    let layout = "--extent 20x13x6 --type u16";
    folder.run(&format!("verify a.wlift other.raw {layout}")).fails(3, &["other.raw", "(7, 4, 2)"]);
    let document = folder.run("verify a.wlift other.raw --json").fails_with_json(3, "(7, 4, 2)");
    assert_eq!(document["whole"], true);
    assert!(document["difference"].as_str().unwrap().contains("(7, 4, 2)"), "{document}");
    let other = "--extent 13x20x6 --type u16";
    folder.run(&format!("verify a.wlift other.raw {other}")).fails(3, &["other.raw", "13x20x6", "20x13x6"]);
    folder.run("verify a.wlift other.raw --extent 20x13x6 --type i16").fails(3, &["other.raw", "i16", "u16"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_person_at_a_terminal_is_told_what_was_done() {
    let folder = compressed();
    if !folder.shell("script -qec true /dev/null").stderr().is_empty() {
        println!("skipped: there is no `script` to make a terminal");
        return;
    }
    let commands = [
        ("compress in.nrrd b.wlift", "20x13x6 u16, 3120 bytes -> b.wlift: "),
        ("decompress a.wlift out.npy", "out.npy: 20x13x6 u16, 3120 bytes of samples, .npy"),
        (
            "transform in.nrrd c.raw --wavelet haar --levels 2",
            "c.raw: 20x13x6 coefficients, 2 levels of haar",
        ),
        (
            "transform c.raw s.raw --wavelet haar --levels 2 --inverse --extent 20x13x6",
            "s.raw: 20x13x6 samples",
        ),
    ];
    for (command, told) in commands {
        let outcome = folder.shell(&format!("script -qec 'wavelift {command}' /dev/null")).ok();
        assert!(outcome.stdout().contains(told), "{told}: {}", outcome.stdout());
    }
}

#[test]
fn tables_are_text_json_and_a_picture() {
    let folder = compressed();
    let text = folder.run("tables in.nrrd --levels 2 --svg tables.svg").ok();
    for part in ["in.nrrd", "20x13x6", "psi_H", "quintic", "none", "Smallest stream"] {
        assert!(text.stdout().contains(part), "{part}: {}", text.stdout());
    }
    let picture = String::from_utf8(folder.read("tables.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.trim_end().ends_with("</svg>"));
    assert!(picture.contains("quadratic"));

    let document = folder.run("tables in.nrrd --json").json();
    let table = &document["tables"][0];
    assert_eq!((&table["extent"], &table["raw_bytes"]), (&json!([20, 13, 6]), &json!(3120)));
    let rows = table["rows"].as_array().unwrap();
    let names: Vec<_> = rows.iter().map(|row| row["wavelet"].as_str().unwrap()).collect();
    assert_eq!(names, ["haar", "quadratic", "duchaineau", "linear", "cubic", "quintic", "none"]);
    assert!(rows.iter().all(|row| row["stream_bytes"].as_u64().is_some_and(|bytes| bytes > 0)));
}

#[test]
fn the_built_in_tables_are_those_of_the_dissertation() {
    let folder = Folder::new();
    let text = folder.run("tables").ok();
    for part in ["512x512", "64x64x64", "Table 3.5", "Table 3.6"] {
        assert!(text.stdout().contains(part), "{part}: {}", text.stdout());
    }
    let document = folder.run("tables --json").json();
    let references =
        document["tables"].as_array().unwrap().iter().map(|table| table["reference"].as_str().unwrap());
    assert_eq!(references.collect::<Vec<_>>(), ["Table 3.5", "Table 3.6"]);
}

#[test]
fn help_and_version_are_at_hand() {
    let folder = Folder::new();
    assert_eq!(folder.run("--version").ok().stdout(), concat!("wavelift ", env!("CARGO_PKG_VERSION"), "\n"));
    let help = folder.run("--help").ok();
    assert!(help.stdout().contains("Exit codes: 0"));
    for command in ["compress", "decompress", "info", "verify", "tables", "transform"] {
        assert!(help.stdout().contains(command));
        let help = folder.run(&format!("{command} --help")).ok();
        assert!(help.stdout().contains("Examples:") && help.stderr().is_empty(), "{command}");
    }
}

#[test]
fn efforts_are_told_and_read_alike() {
    let folder = compressed();
    for effort in ["light", "fast", "default", "dense"] {
        folder.run(&format!("compress in.nrrd {effort}.wlift --effort {effort}")).silent();
        assert_eq!(folder.run(&format!("info {effort}.wlift --json")).json()["effort"], effort);
        folder.run(&format!("verify {effort}.wlift in.nrrd")).ok();
    }
    folder.run("compress in.nrrd b.wlift --effort slow").fails(2, &["slow", "light, fast, default, dense"]);
}
