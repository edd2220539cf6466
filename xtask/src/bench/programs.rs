//! The programs that measure: `tests/benches/speed`, the same under a counter of instructions, and `xtask/rivals.py`.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use super::record::{Coding, Instructions, Row};
use super::volumes::Listed;
use crate::shell::{cargo_program, output};

/// Volumes whose coding is counted in instructions: built in, and small, for counting is slow.
const COUNTED: [&str; 2] = ["rt_brick64", "rt_slice512"];

/// `tests/benches/speed`, built.
pub(super) struct Speed {
    program: String,
}

impl Speed {
    /// Builds the program as `cargo bench` does.
    pub(super) fn build() -> Result<Self, String> {
        let bench = ["bench", "--quiet", "--package", "conformance", "--bench", "speed", "--no-run"];
        let arguments = [bench.as_slice(), &["--message-format=json"]].concat();
        let messages = output(&cargo_program(), &arguments)?;
        let program = messages.lines().find_map(executable);
        Ok(Self { program: program.ok_or("cargo built no bench program")? })
    }

    /// The rows that one of its commands prints.
    pub(super) fn rows(&self, arguments: &[&str]) -> Result<Vec<Row>, String> {
        rows(&self.program, arguments)
    }

    /// Instructions per sample of every way that wavelift coded the small built-in volumes in, with valgrind.
    pub(super) fn instructions(
        &self,
        volumes: &[Listed],
        coding: &[Coding],
    ) -> Result<Vec<Instructions>, String> {
        let mut counts = vec![];
        for volume in volumes.iter().filter(|volume| COUNTED.contains(&volume.name.as_str())) {
            let list = write_list(std::slice::from_ref(volume), "counted.json")?;
            let ways = coding.iter().filter(|row| row.is_ours() && row.volume == volume.name);
            for way in ways {
                let count = |times: [&str; 2]| {
                    self.count(&[["repeat", &list, &way.codec].as_slice(), &times].concat())
                };
                // What one more of each costs, so that the start of the program counts for nothing.
                let once = count(["1", "1"])?;
                let per_sample = |twice: u64| twice.saturating_sub(once) as f64 / volume.samples() as f64;
                counts.push(Instructions {
                    volume: volume.name.clone(),
                    codec: way.codec.clone(),
                    encode: per_sample(count(["2", "1"])?),
                    decode: per_sample(count(["1", "2"])?),
                });
            }
        }
        Ok(counts)
    }

    /// Instructions of a run, which valgrind tells on standard error.
    fn count(&self, arguments: &[&str]) -> Result<u64, String> {
        let callgrind = ["--tool=callgrind", "--callgrind-out-file=/dev/null", &self.program];
        let run = Command::new("valgrind").args(callgrind).args(arguments).stdin(Stdio::null()).output();
        let run = run.map_err(|error| format!("valgrind: {error}"))?;
        let said = String::from_utf8_lossy(&run.stderr);
        let count = said.lines().find_map(|line| line.split_once("Collected :")?.1.trim().parse().ok());
        count.ok_or_else(|| format!("valgrind {}: {}", arguments.join(" "), said.trim()))
    }
}

/// The bench program that a message of cargo names, if it names one.
fn executable(message: &str) -> Option<String> {
    let message: serde_json::Value = serde_json::from_str(message).ok()?;
    let is_bench = message["target"]["kind"][0] == "bench";
    is_bench.then(|| message["executable"].as_str().map(str::to_owned))?
}

/// The rows of the rival codecs, or why there are none.
pub(super) fn rivals(list: &str, quick: bool) -> Result<Vec<Row>, String> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    if output(&python, &["-c", "import imagecodecs, numpy"]).is_err() {
        return Err(format!(
            "{python} has no imagecodecs. To have them beside wavelift:\n\
             \x20   python3 -m venv target/venv && target/venv/bin/pip install imagecodecs imageio-ffmpeg\n\
             \x20   PYTHON=target/venv/bin/python cargo xtask bench"
        ));
    }
    let quick = if quick { ["--quick"].as_slice() } else { &[] };
    rows(&python, &[&["xtask/rivals.py", list], quick].concat())
}

/// Writes the list of volumes that the programs read, and returns its path.
pub(super) fn write_list(volumes: &[Listed], name: &str) -> Result<String, String> {
    let folder = Path::new("target/bench");
    let path = folder.join(name).display().to_string();
    let text = serde_json::to_string_pretty(volumes).map_err(|error| error.to_string())?;
    let written = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&path, text));
    written.map(|()| path.clone()).map_err(|error| format!("{path}: {error}"))
}

/// Runs a program and reads a row from every line, telling of each as it comes.
fn rows(program: &str, arguments: &[&str]) -> Result<Vec<Row>, String> {
    let line = format!("{program} {}", arguments.join(" "));
    let failed = |error: String| format!("{line}: {error}");
    let mut command = Command::new(program);
    let child = command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).spawn();
    let mut child = child.map_err(|error| failed(error.to_string()))?;
    let mut rows = vec![];
    if let Some(printed) = child.stdout.take() {
        for line in BufReader::new(printed).lines() {
            let line = line.map_err(|error| failed(error.to_string()))?;
            let row = serde_json::from_str(&line).map_err(|error| failed(format!("{error} in {line}")))?;
            tell(&row);
            rows.push(row);
        }
    }
    let status = child.wait().map_err(|error| failed(error.to_string()))?;
    if status.success() { Ok(rows) } else { Err(failed(status.to_string())) }
}

fn tell(row: &Row) {
    match row {
        Row::Coding(row) => {
            eprintln!("{:<20} {:<12} {:<20} {:>10} bytes", row.volume, row.task, row.codec, row.bytes)
        }
        Row::Refused(row) => eprintln!("{:<20} {} refuses: {}", row.volume, row.codec, row.why),
        Row::Lifting(row) => eprintln!("lifting, {}", row.wavelet),
        Row::Memory(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn executables_are_found_among_other_messages() {
        let message =
            |kind: &str| format!(r#"{{ "target": {{ "kind": ["{kind}"] }}, "executable": "a/speed-1" }}"#);
        assert_eq!(executable(&message("bench")).as_deref(), Some("a/speed-1"));
        assert_eq!(executable(&message("bin")), None);
        assert_eq!(executable(r#"{"reason":"build-finished"}"#), None);
    }

    #[test]
    fn a_program_that_is_missing_or_prints_no_row_is_named() {
        assert!(rows("no-such-program", &[]).err().unwrap().starts_with("no-such-program"));
        assert!(rows("rustc", &["--version"]).err().unwrap().starts_with("rustc --version"));
    }
}
