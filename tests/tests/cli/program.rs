//! The program under test.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::LazyLock;

use serde_json::{Value, json};

/// Path of the program, as Cargo builds it for the tests of its package: it builds none for those of this one.
pub(crate) fn path() -> &'static Path {
    static PROGRAM: LazyLock<PathBuf> = LazyLock::new(build);
    &PROGRAM
}

fn build() -> PathBuf {
    let output = Command::new(env!("CARGO"))
        // A program that is built alone has other features than one for tests, and would be compiled once more.
        .args(["test", "--quiet", "--no-run", "--package", "wavelift-host", "--test", "examples"])
        .args(["--message-format", "json-render-diagnostics"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .stderr(Stdio::inherit())
        .output()
        .expect("Cargo runs the tests, so it is there");
    assert!(output.status.success(), "the program cannot be built");
    let messages = String::from_utf8(output.stdout).expect("messages are UTF-8");
    let program = messages.lines().find_map(|line| {
        let message: Value = serde_json::from_str(line).expect("a message is JSON");
        let is_program = message["target"]["kind"] == json!(["bin"]) && message["profile"]["test"] == false;
        message["executable"].as_str().filter(|_| is_program).map(PathBuf::from)
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
