//! The program in a folder of its own, and what came of it.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

use crate::program;

/// A folder that the program works in and that goes away with this value.
pub(crate) struct Folder(TempDir);

impl Folder {
    /// An empty one.
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    /// Path of a file in it.
    pub(crate) fn path(&self, name: impl AsRef<OsStr>) -> PathBuf {
        self.0.path().join(name.as_ref())
    }

    /// Writes a file.
    pub(crate) fn write(&self, name: impl AsRef<OsStr>, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).expect("the folder takes files");
    }

    /// Reads a file.
    pub(crate) fn read(&self, name: impl AsRef<OsStr>) -> Vec<u8> {
        let name = name.as_ref();
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{}: {error}", name.display()))
    }

    /// Every file in it, hidden ones too, with its bytes; `None` for a folder.
    pub(crate) fn everything(&self) -> BTreeMap<String, Option<Vec<u8>>> {
        let entries = fs::read_dir(self.0.path()).expect("the folder is there");
        let names = entries.map(|entry| entry.expect("the folder can be listed").file_name());
        names.map(|name| (name.to_string_lossy().into_owned(), fs::read(self.path(name)).ok())).collect()
    }

    /// The program with the words of a line as its arguments, in a pipe and without input.
    pub(crate) fn run(&self, line: &str) -> Outcome {
        self.run_words(&line.split_whitespace().map(OsStr::new).collect::<Vec<_>>())
    }

    /// As [`run`](Self::run), with arguments that may hold anything.
    pub(crate) fn run_words(&self, words: &[&OsStr]) -> Outcome {
        Outcome::of(self.inside(&mut Command::new(program::path())).args(words))
    }

    /// Runs a line of the shell, which finds the program as `wavelift`.
    #[cfg(unix)]
    pub(crate) fn shell(&self, line: &str) -> Outcome {
        Outcome::of(self.inside(&mut program::shell(line)))
    }

    /// The program, to be run with other arguments.
    #[cfg(unix)]
    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(program::path());
        self.inside(&mut command);
        command
    }

    /// Sets this folder as the place where a command runs, without input.
    fn inside<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        command.current_dir(self.0.path()).stdin(Stdio::null())
    }
}

/// How a run ended, and what it said.
pub(crate) struct Outcome {
    command: String,
    output: Output,
}

impl Outcome {
    fn of(command: &mut Command) -> Self {
        let output = command.output().expect("the program starts");
        Self { command: format!("{command:?}"), output }
    }

    /// What it wrote to standard output.
    pub(crate) fn stdout(&self) -> &str {
        str::from_utf8(&self.output.stdout).expect("standard output is UTF-8")
    }

    /// What it wrote to standard error.
    pub(crate) fn stderr(&self) -> &str {
        str::from_utf8(&self.output.stderr).expect("standard error is UTF-8")
    }

    fn told(&self) -> String {
        let Output { status, stdout, stderr } = &self.output;
        let [stdout, stderr] = [stdout, stderr].map(|bytes| String::from_utf8_lossy(bytes));
        format!("{}\n{status}\n{stdout}\n{stderr}", self.command)
    }

    /// Ended well.
    pub(crate) fn ok(self) -> Self {
        assert!(self.output.status.success(), "{}", self.told());
        self
    }

    /// Ended well without a word.
    pub(crate) fn silent(self) {
        let quiet = self.output.stdout.is_empty() && self.output.stderr.is_empty();
        assert!(self.output.status.success() && quiet, "{}", self.told());
    }

    /// Ended well, with one JSON document on standard output and nothing else.
    pub(crate) fn json(self) -> Value {
        assert!(self.output.status.success() && self.output.stderr.is_empty(), "{}", self.told());
        serde_json::from_str(self.stdout()).unwrap_or_else(|error| panic!("{error}: {}", self.told()))
    }

    /// Failed with that exit code and a message, with one JSON document on standard output.
    pub(crate) fn fails_with_json(&self, code: i32, part: &str) -> Value {
        let message = self.stderr();
        assert!(
            self.output.status.code() == Some(code) && message.starts_with("wavelift: "),
            "{}",
            self.told()
        );
        assert!(message.contains(part), "{part} expected: {}", self.told());
        serde_json::from_str(self.stdout()).unwrap_or_else(|error| panic!("{error}: {}", self.told()))
    }

    /// Failed with that exit code and a message that holds all of `parts`, and said nothing to standard output.
    pub(crate) fn fails(&self, code: i32, parts: &[&str]) {
        let message = self.stderr();
        let begins = message.starts_with("wavelift: ") || message.starts_with("error: ");
        let told = begins && message.ends_with('\n') && parts.iter().all(|part| message.contains(part));
        assert!(self.output.status.code() == Some(code), "code {code} expected: {}", self.told());
        assert!(told && self.output.stdout.is_empty(), "{parts:?} expected: {}", self.told());
        assert!(!message.contains("os error") && !message.contains(".wavelift-"), "{}", self.told());
        assert!(!message.contains("panicked") && !message.contains("Error {"), "{}", self.told());
    }
}
