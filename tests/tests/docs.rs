//! The READMEs hold: each command in them runs, each file that they name is there.

#![cfg(unix)]

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use conformance::inputs::random;
use tempfile::TempDir;

#[path = "cli/program.rs"]
mod program;

/// The repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Blocks of a Markdown text between fences: the word behind the opening one, and the lines.
fn fenced(text: &str) -> Vec<(&str, Vec<&str>)> {
    let mut blocks = vec![];
    let mut open = None;
    for line in text.lines() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(language), None) => open = Some((language, vec![])),
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (None, Some((_, lines))) => lines.push(line),
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a fence is not closed");
    blocks
}

/// The commands of the `sh` blocks that run the program, without the comments behind them.
fn commands(text: &str) -> Vec<&str> {
    let lines =
        fenced(text).into_iter().filter(|(language, _)| *language == "sh").flat_map(|(_, lines)| lines);
    let commands = lines.map(|line| line.split(" #").next().unwrap_or(line).trim_end());
    commands.filter(|command| command.starts_with("wavelift ")).collect()
}

/// Samples of `bytes` bytes of a field: noise of 12 bits, or 8, smoothed three times along each axis. Its fine structure
/// is what a transform is good for.
fn field(extent: [usize; 3], bytes: usize) -> Vec<u8> {
    let samples = extent.iter().product::<usize>();
    let mut values: Vec<u64> = (0..samples as u64).map(|index| random(1, index) >> 48).collect();
    for stride in [1, extent[0], extent[0] * extent[1]].repeat(3) {
        let at = |index: usize| values[index % samples];
        values = (0..samples).map(|i| (at(i) + 2 * at(i + stride) + at(i + 2 * stride)) / 4).collect();
    }
    let shift = if bytes == 1 { 8 } else { 4 };
    values.into_iter().flat_map(|value| (value >> shift).to_le_bytes().into_iter().take(bytes)).collect()
}

/// Samples of 16 bits of a scan: a body, which is an ellipsoid of [`field`], in empty air, which no transform should touch.
fn scan(extent: [usize; 3]) -> Vec<u8> {
    let [x, y, _] = extent;
    let mut samples = field(extent, 2);
    for (index, sample) in samples.as_chunks_mut::<2>().0.iter_mut().enumerate() {
        let place = [index % x, index / x % y, index / x / y];
        let distance: f64 =
            (0..3).map(|axis| (2.4 * place[axis] as f64 / extent[axis] as f64 - 1.2).powi(2)).sum();
        if distance > 1.0 {
            *sample = [0; 2];
        }
    }
    samples
}

/// `64x64x93`, cut to 64 samples an axis if there are more than a million.
fn cut_extent(text: &str) -> [usize; 3] {
    let mut axes: Vec<usize> = text.split('x').map(|axis| axis.parse().expect("a number")).collect();
    if axes.iter().product::<usize>() > 1 << 20 {
        axes.iter_mut().for_each(|axis| *axis = (*axis).min(64));
    }
    axes.resize(3, 1);
    [axes[0], axes[1], axes[2]]
}

/// A command with its extent cut, so that it takes no time.
fn cut(command: &str) -> String {
    let mut words: Vec<String> = command.split(' ').map(str::to_owned).collect();
    if let Some(extent) = words.iter().position(|word| word == "--extent").map(|option| option + 1) {
        words[extent] = cut_extent(&words[extent]).map(|axis| axis.to_string()).join("x");
    }
    words.join(" ")
}

/// What follows an option in a command.
fn option<'a>(command: &'a str, name: &str) -> Option<&'a str> {
    command.split_whitespace().skip_while(|word| *word != name).nth(1)
}

/// Makes the file that a command reads, if neither an earlier command nor this function made it.
fn provide(folder: &Path, command: &str, extent: [usize; 3]) {
    // `surface` has commands of its own.
    let place = if command.contains(" surface ") { 3 } else { 2 };
    let Some(name) = command.split_whitespace().nth(place).filter(|word| !word.starts_with('-')) else {
        return;
    };
    if folder.join(name).exists() {
        return;
    }
    let [x, y, z] = extent;
    let bytes = match Path::new(name).extension().and_then(OsStr::to_str) {
        Some("raw") => {
            let extent = option(command, "--extent").expect("a raw file has an extent");
            let bytes =
                option(command, "--type").map_or(4, |name| name[1..].parse::<usize>().expect("bits") / 8);
            field(cut_extent(extent), bytes)
        }
        Some("nrrd") => {
            let header =
                "NRRD0004\ntype: uint16\ndimension: 3\nendian: little\nencoding: raw\nspacings: 1 1 2\n";
            [format!("{header}sizes: {x} {y} {z}\n\n").as_bytes(), &scan(extent)].concat()
        }
        Some("npy") => {
            let header = format!("{{'descr': '<u2', 'fortran_order': False, 'shape': ({z}, {y}, {x}), }}");
            [b"\x93NUMPY\x01\x00\x76\x00", format!("{header:<117}\n").as_bytes(), &field(extent, 2)].concat()
        }
        Some("wlift") => {
            fs::write(folder.join("source.raw"), field(extent, 2)).expect("the folder takes files");
            run(folder, &format!("wavelift compress source.raw {name} --extent {x}x{y}x{z} --type u16"));
            return;
        }
        other => panic!("{command}: no file of type {other:?} can be made"),
    };
    fs::write(folder.join(name), bytes).expect("the folder takes files");
}

/// Runs a line of the shell; returns what it wrote to standard output.
fn run(folder: &Path, line: &str) -> String {
    let output = program::shell(line).current_dir(folder).output().expect("there is a shell");
    assert!(output.status.success(), "{line}\n{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Runs all commands of a document, one after the other, on volumes of 64x64x93 samples where they say nothing else;
/// returns the folder with what they made.
fn run_all(document: &str) -> TempDir {
    let extent = [64, 64, 93];
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = read(document);
    let commands = commands(&text);
    assert!(commands.len() >= 5, "{document}: {commands:?}");
    for command in commands {
        let command = cut(command);
        provide(folder.path(), &command, extent);
        run(folder.path(), &command);
    }
    folder
}

#[test]
fn the_tour_of_the_project_can_be_taken() {
    let folder = run_all("README.md");
    let info = |name: &str, line: &str| run(folder.path(), &format!("wavelift info {name} | grep {line}"));
    let wavelet = info("head.wlift", "wavelet");
    assert!(wavelet.contains(" none "), "levels were to be read of a file without a transform: {wavelet}");
    let effort = info("ct.wlift", "effort");
    assert!(effort.contains("dense"), "{effort}");
}

#[test]
fn the_examples_of_the_program_run() {
    run_all("host/README.md");
}

#[test]
fn links_lead_to_files() {
    for document in ["README.md", "host/README.md", "kernel/README.md", "vectors/README.md"] {
        let text = read(document);
        let folder = root().join(document).parent().expect("a document lies in a folder").to_owned();
        let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        for target in targets.filter(|target| !target.contains("://") && !target.starts_with('#')) {
            let path = folder.join(target.split('#').next().expect("a part before any sign"));
            assert!(path.exists(), "{document}: {target} is not there");
        }
    }
}

#[test]
fn the_house_has_the_rooms_it_is_said_to_have() {
    let text = read("README.md");
    let houses =
        fenced(&text).into_iter().filter(|(_, lines)| lines.iter().any(|line| line.starts_with("kernel/")));
    let rooms: Vec<&str> = houses.flat_map(|(_, lines)| lines).collect();
    assert!(rooms.len() >= 5, "{rooms:?}");
    for room in rooms {
        let folder = room.split(' ').next().expect("a room has a name");
        let documents = room.split_whitespace().filter(|word| word.ends_with(".md"));
        for path in documents.chain([folder]) {
            assert!(root().join(path).exists(), "{path} is not there");
        }
    }
}

#[test]
fn chores_and_set_up_commands_are_real() {
    let text = read("README.md");
    let lines: BTreeSet<&str> = fenced(&text)
        .into_iter()
        .filter(|(language, _)| *language == "sh")
        .flat_map(|(_, lines)| lines)
        .collect();
    for command in ["cargo run --release --bin wavelift -- tables", "cargo xtask test"] {
        assert!(lines.contains(command), "{command}");
    }
    assert!(read(".cargo/config.toml").contains("xtask = "));
    let installed = lines.iter().find_map(|line| line.strip_prefix("cargo install --path "));
    let package = installed.and_then(|rest| rest.split(' ').next()).expect("a package to install");
    assert!(read(&format!("{package}/Cargo.toml")).contains("name = \"wavelift\""));
}

/// Words that scripts hold on to.
const STABLE: [(&str, &[&str]); 6] = [
    (
        "compress",
        &["--extent", "--type", "--byte-order", "--wavelet", "--levels", "--brick", "--threads", "--json"],
    ),
    ("decompress", &["--level", "--region", "--byte-order", "--gzip", "--threads", "--json"]),
    ("info", &["--json"]),
    ("verify", &["[ORIGINAL]", "--extent", "--type", "--json"]),
    ("tables", &["[INPUT]", "--json", "--svg", "--extent", "--type"]),
    ("transform", &["--wavelet", "--levels", "--inverse", "--extent", "--type"]),
];

#[test]
fn stable_words_are_in_the_help() {
    for (command, words) in STABLE {
        let output =
            Command::new(program::path()).args([command, "--help"]).output().expect("the program starts");
        let help = String::from_utf8(output.stdout).expect("help is text");
        for word in words {
            assert!(help.contains(word), "{command} --help: {word} is missing");
        }
    }
    let help =
        Command::new(program::path()).args(["compress", "--help"]).output().expect("the program starts");
    let help = String::from_utf8(help.stdout).expect("help is text");
    for name in
        ["u8, i8, u16, i16, u32, i32, u64, i64, f32, f64", "little, big", "auto, haar, quadratic", "none"]
    {
        assert!(help.contains(name), "compress --help: {name} is missing");
    }
}
