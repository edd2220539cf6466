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
    let program = messages.lines().find_map(|line| {
        let message: Value = serde_json::from_str(line).expect("a message is JSON");
        message["executable"].as_str().map(PathBuf::from)
    });
    program.expect("Cargo tells where the program is")
}

/// A shell that will run `line` and finds the program as `wavelift`.
#[cfg(unix)]
pub(crate) fn shell(line: &str) -> Command {
    let own = path().parent().expect("a program lies in a folder").to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::env::join_paths([own].into_iter().chain(std::env::split_paths(&path)));
    let mut shell = Command::new("sh");
    shell.args(["-c", line]).env("PATH", folders.expect("folders that a path can hold"));
    shell
}
