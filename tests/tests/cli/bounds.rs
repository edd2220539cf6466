//! Error bounds on the command line: kept, told, and refused where they make no sense.

use serde_json::{Value, json};

use crate::files::smooth_u16;
use crate::run::Folder;

/// 24 x 20 x 10 smooth samples, the last a NaN and the one before a fill value.
fn field() -> Vec<f32> {
    let heights = smooth_u16([24, 20, 10]);
    let mut samples: Vec<f32> = heights
        .as_chunks()
        .0
        .iter()
        .enumerate()
        .map(|(i, height)| (f32::from(u16::from_le_bytes(*height)) + 0.3 * (i as f32).sin()) / 777.0)
        .collect();
    samples[4798..].copy_from_slice(&[-1e30, f32::NAN]);
    samples
}

fn bytes(samples: &[f32]) -> Vec<u8> {
    samples.iter().flat_map(|sample| sample.to_le_bytes()).collect()
}

fn samples(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks().0.iter().map(|sample| f32::from_le_bytes(*sample)).collect()
}

/// A folder with the field as `in.raw`, and within 0.001 as `a.wlift`.
fn bounded() -> (Folder, Value) {
    let folder = Folder::new();
    folder.write("in.raw", bytes(&field()));
    let document =
        folder.run("compress in.raw a.wlift --extent 24x20x10 --type f32 --max-error 0.001 --json");
    (folder, document.json())
}

#[test]
fn a_bound_holds_and_is_told() {
    let (folder, document) = bounded();
    assert_eq!((&document["form"], &document["max_error"]), (&json!("scaled"), &json!(0.001)));
    assert_eq!((&document["exceptions"], &document["exact_bricks"]), (&json!(2), &json!(0)));
    assert!(document["bytes"].as_u64().unwrap() < 4800 * 2, "{document}");
    folder.run("decompress a.wlift out.raw").silent();
    let back = samples(&folder.read("out.raw"));
    for (a, b) in field().into_iter().zip(&back).take(4798) {
        assert!((f64::from(a) - f64::from(*b)).abs() <= 0.001, "{a} {b}");
    }
    assert_eq!(bytes(&back[4798..]), bytes(&[-1e30, f32::NAN]));
    let info = folder.run("info a.wlift").ok();
    for part in ["bound     no sample is off by more than 1e-3\n", "2 samples kept", "0 of 1 bricks exact"] {
        assert!(info.stdout().contains(part), "{part}: {}", info.stdout());
    }
    let info = folder.run("info a.wlift --json").json();
    for name in
        ["form", "density", "max_error", "relative_error", "exceptions", "exact_bricks", "step", "slack"]
    {
        assert_eq!(info[name], document[name], "{name}");
    }
}

#[test]
fn verify_checks_the_bound() {
    let (folder, _) = bounded();
    let told = folder.run("verify a.wlift in.raw").ok();
    assert!(
        told.stdout().contains("every sample within 1e-3 of in.raw, the largest error is 9."),
        "{}",
        told.stdout()
    );
    let document = folder.run("verify a.wlift in.raw --json").json();
    assert_eq!((&document["max_error"], &document["difference"]), (&json!(0.001), &Value::Null));
    let largest = document["largest_error"].as_f64().unwrap();
    assert!(largest > 0.0 && largest <= 0.001);
    let mut other = field();
    other[24 * 20 + 3] += 0.01;
    folder.write("other.raw", bytes(&other));
    folder.run("verify a.wlift other.raw").fails(3, &["other.raw", "by more than 1e-3", "(3, 0, 1)"]);
}

#[test]
fn levels_and_regions_of_bounded_floats() {
    let (folder, document) = bounded();
    assert!(document["readable_levels"].as_u64() >= Some(2));
    folder.run("decompress a.wlift coarse.raw --level 2").silent();
    let coarse = samples(&folder.read("coarse.raw"));
    assert_eq!(coarse.len(), 6 * 5 * 3);
    folder.run("decompress a.wlift out.raw").silent();
    folder.run("decompress a.wlift part.raw --region 3:5,2:3,4:5").silent();
    let at = 4 * (3 + 24 * (2 + 20 * 4));
    assert_eq!(folder.read("part.raw"), folder.read("out.raw")[at..at + 8]);
}

#[test]
fn a_relative_bound_is_one_of_the_range() {
    let folder = Folder::new();
    folder.write("in.raw", bytes(&field()[..4798]));
    let document =
        folder.run("compress in.raw a.wlift --extent 4798 --type f32 --relative-error 1e-3 --json").json();
    let (least, most) = field()[..4798].iter().fold((f32::MAX, f32::MIN), |(a, b), &x| (a.min(x), b.max(x)));
    let error = document["max_error"].as_f64().unwrap();
    let expected = 1e-3 * (f64::from(most) - f64::from(least));
    assert!(error <= expected && error > 0.999_999 * expected, "{error} {expected}");
    assert_eq!(document["relative_error"], 1e-3);
    folder.run("verify a.wlift in.raw").ok();
}

#[test]
fn integers_stay_within_whole_numbers() {
    let folder = Folder::new();
    folder.write("in.raw", smooth_u16([24, 20, 10]));
    for (error, wavelet, form, step, slack) in [
        ("0.5", "auto", "exact", Value::Null, Value::Null),
        ("1", "linear", "steps", json!(3), Value::Null),
        ("2.9", "linear", "steps", json!(5), Value::Null),
        ("40.7", "auto", "near", Value::Null, json!(40)),
    ] {
        let options = format!("--extent 24x20x10 --type u16 --max-error {error} --wavelet {wavelet} --json");
        let document = folder.run(&format!("compress in.raw a.wlift {options}")).json();
        let told = [&document["form"], &document["step"], &document["slack"]];
        assert_eq!(told, [&json!(form), &step, &slack]);
        folder.run("verify a.wlift in.raw").ok();
        folder.run("decompress a.wlift out.raw").silent();
        let value = |sample: &[u8; 2]| u16::from_le_bytes(*sample);
        let (before, after) = (folder.read("in.raw"), folder.read("out.raw"));
        let pairs = before.as_chunks().0.iter().zip(after.as_chunks().0);
        let largest = pairs.map(|(a, b)| value(a).abs_diff(value(b))).max().unwrap();
        assert!(f64::from(largest) <= error.parse::<f64>().unwrap());
    }
}

#[test]
fn bounds_that_make_no_sense_are_refused() {
    let folder = Folder::new();
    folder.write("in.raw", bytes(&field()));
    for option in ["--max-error", "--relative-error"] {
        for (value, part) in [
            ("0", "give one above 0"),
            ("-1", "give one above 0"),
            ("NaN", "not a number"),
            ("1e-3x", "not a number"),
            ("inf", "infinite"),
        ] {
            let line = format!("compress in.raw out.wlift --extent 24x20x10 --type f32 {option} {value}");
            folder.run(&line).fails(2, &[option, part]);
        }
    }
    folder
        .run("compress in.raw out.wlift --extent 24x20x10 --type f32 --max-error 1 --relative-error 0.1")
        .fails(2, &["--max-error", "--relative-error"]);
    assert!(!folder.path("out.wlift").exists());
}
