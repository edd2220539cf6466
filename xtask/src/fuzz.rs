//! `cargo xtask fuzz`: builds the targets of `tests/fuzz` with counters at every branch, and runs each for a while.
//!
//! The counters are passes of LLVM that every toolchain has; a sanitizer, which only nightly ones have, would find
//! little in code without `unsafe`. Overflow checks and debug assertions are on.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use clap::Args;

use crate::shell::{Failures, cargo, cargo_program, output};

/// The package, a workspace of its own.
const PACKAGE: &str = "tests/fuzz";

/// Its manifest.
pub(crate) const WORKSPACE: &str = "tests/fuzz/Cargo.toml";

/// Where new inputs and those that fail are kept; git does not see it.
const FOUND: &str = "tests/fuzz/target/found";

/// Each target, and the folders with the inputs that it starts from, beside its own in `tests/fuzz/corpus`.
const TARGETS: [(&str, &[&str]); 5] = [
    ("decode", &["vectors/v2", "vectors/handmade", "vectors/reject"]),
    ("header", &["vectors/v2", "vectors/streams", "vectors/handmade", "vectors/reject"]),
    ("roundtrip", &["vectors/v2"]),
    ("step", &["vectors/v2", "vectors/streams"]),
    ("container", &[]),
];

/// What counts branches and comparisons.
const COUNTERS: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing";

#[derive(Args, Clone)]
pub(crate) struct Options {
    /// decode, header, roundtrip, step or container; all of them without one. `mutate` damages golden streams
    target: Option<String>,
    /// Seconds for each target
    #[arg(long, default_value_t = 12)]
    seconds: u32,
    /// Add the fewest inputs of at most 600 bytes that reach new branches to tests/fuzz/corpus
    #[arg(long)]
    keep: bool,
    /// Streams that `mutate` damages
    #[arg(long, default_value_t = 1_000_000)]
    count: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { target: None, seconds: 12, keep: false, count: 0 }
    }
}

/// Builds all that is asked for, then runs one target after another.
pub(crate) fn run(options: &Options) -> Failures {
    if options.target.as_deref() == Some("mutate") {
        return mutate(options.count);
    }
    let asked = |name: &str| options.target.as_deref().is_none_or(|target| target == name);
    let targets: Vec<_> = TARGETS.into_iter().filter(|(name, _)| asked(name)).collect();
    if targets.is_empty() {
        return vec![format!("no target is called {}", options.target.as_deref().unwrap_or_default())];
    }
    let programs = match build(&targets.iter().map(|(name, _)| *name).collect::<Vec<_>>()) {
        Ok(programs) => programs,
        Err(error) => return vec![error],
    };
    targets.iter().filter_map(|(name, seeds)| fuzz(&programs, name, seeds, options).err()).collect()
}

/// Starts the program `mutate` of the conformance package, built as the tests are.
fn mutate(count: u64) -> Failures {
    let program = ["run", "--quiet", "--profile", "test", "--package", "conformance", "--bin", "mutate"];
    cargo(&[&program[..], &["--", "--count", &count.to_string()]].concat())
}

/// Builds `targets`; returns the folder of their programs.
///
/// The host is named as target, so that build scripts and macros are built without counters.
fn build(targets: &[&str]) -> Result<PathBuf, String> {
    let rustc = output("rustc", &["-vV"])?;
    let host = rustc.lines().find_map(|line| line.strip_prefix("host: ")).ok_or("rustc -vV names no host")?;
    let mut command = Command::new(cargo_program());
    command.args(["build", "--quiet", "--release", "--locked", "--target", host]);
    command.args(["--features", "container"]);
    command.args(targets.iter().flat_map(|target| ["--bin", target]));
    command.env("RUSTFLAGS", COUNTERS).current_dir(PACKAGE);
    status(&mut command)?;
    Ok(Path::new(PACKAGE).join("target").join(host).join("release"))
}

/// Runs one target; what it finds goes to a folder that git does not see.
fn fuzz(programs: &Path, name: &str, seeds: &[&str], options: &Options) -> Result<(), String> {
    let corpus = format!("{PACKAGE}/corpus/{name}");
    let found = format!("{FOUND}/{name}");
    let failing = format!("{FOUND}/{name}-failing/");
    for folder in [&corpus, &found, &failing] {
        std::fs::create_dir_all(folder).map_err(|error| format!("{folder}: {error}"))?;
    }
    let program = programs.join(name);
    let mut command = Command::new(&program);
    command.arg(format!("-max_total_time={}", options.seconds));
    command.args(["-print_final_stats=1", "-verbosity=0", "-timeout=200", "-rss_limit_mb=2048"]);
    command.args(["-max_len=4096", &format!("-artifact_prefix={failing}"), &found, &corpus]).args(seeds);
    status(&mut command).map_err(|error| format!("{error}; the input is the newest file in {failing}"))?;
    if options.keep {
        let mut merge = Command::new(&program);
        status(merge.args(["-set_cover_merge=1", "-max_len=600", "-verbosity=0", &corpus, &found]))?;
    }
    Ok(())
}

/// Runs a command; its output is shown as it comes.
fn status(command: &mut Command) -> Result<(), String> {
    eprintln!("$ {command:?}");
    match command.stdin(Stdio::null()).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{} ({status})", command.get_program().display())),
        Err(error) => Err(format!("{}: {error}", command.get_program().display())),
    }
}
