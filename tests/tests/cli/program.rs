//! The program under test.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::LazyLock;

use serde_json::Value;

/// Path of the program, built with the profile of the tests. It belongs to another package, whose programs Cargo
/// does not build for the tests of this one.
pub(crate) fn path() -> &'static Path {
    static PROGRAM: LazyLock<PathBuf> = LazyLock::new(build);
    &PROGRAM
}

fn build() -> PathBuf {
    let output = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--profile", "test", "--package", "wavelift-host", "--bin", "wavelift"])
        .args(["--message-format", "json-render-diagnostics"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .stderr(Stdio::inherit())
        .output()
        .expect("Cargo runs the tests, so it is there");
    assert!(output.status.success(), "the program cannot be built");
    let messages = String::from_utf8(output.stdout).expect("messages are UTF-8");
    let programs = messages.lines().filter_map(|line| {
        let message: Value = serde_json::from_str(line).expect("a message is JSON");
        message["executable"].as_str().map(PathBuf::from)
    });
    programs.last().expect("Cargo tells where the program is")
}
