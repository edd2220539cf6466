//! Every chore of the project: `cargo xtask help`.
//!
//! The chores depend on no package of the workspace, so that they build, and say what is wrong, while one
//! of the packages does not compile. What needs the kernel (`vectors`, `bench`) is a program of the
//! `conformance` package, started from here.

mod bench;
mod browser;
mod budget;
mod capi;
mod ci;
mod device;
mod doc;
mod fmt;
mod fuzz;
mod interop;
mod lint;
mod matrix;
mod miri;
mod shell;
mod size;
mod table;
mod test;
mod tidy;
mod vectors;
mod workspace;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", about = "Every chore of the project", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// All checks in order; failures are listed at the end, with the time of each step
    Ci,
    /// Names, lengths, licences, placement of dependencies, the recorded hash of the header
    Tidy,
    /// Check the formatting of every package
    Fmt {
        /// Format instead of checking
        #[arg(long)]
        fix: bool,
    },
    /// Clippy on all targets: each package alone, all together, the kernel with each feature set
    Lint,
    /// cargo test for each package, the kernel with no features and with all
    Test,
    /// Build the kernel for every target of its table, with no features, each alone, and all
    Matrix {
        /// Print the targets, one a line, and build nothing
        #[arg(long)]
        list_targets: bool,
    },
    /// Run firmware in QEMU: golden vectors, files for the host, instructions and stack
    Device,
    /// Link parts of the kernel alone and compare their flash with xtask/budgets.toml
    Size {
        /// Measure everything on the target, and print it as the table of kernel/README.md
        #[arg(long)]
        table: bool,
    },
    /// rustdoc of every package; warnings are errors
    Doc,
    /// Golden data: check | add ID… | replace ID --because WHY
    Vectors {
        /// Passed on; `cargo xtask vectors --help` explains them
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// The C library, and its example here, with sanitizers, and on an emulated Cortex-M4F
    Capi,
    /// The decoder in WebAssembly: its size, and a page in Node and headless Chromium
    Browser,
    /// Files of other programs and for them: tests/interop, with Python packages installed below target
    Interop,
    /// The C library's calls and the kernel's unit tests in Miri, which checks every access to memory
    Miri,
    /// Fuzz targets of tests/fuzz, each from its committed corpus
    Fuzz(fuzz::Options),
    /// Size, speed and memory, with rival codecs where Python has them
    Bench(bench::Options),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if let Err(error) = std::env::set_current_dir(workspace::root()) {
        eprintln!("cannot enter {}: {error}", workspace::root().display());
        return ExitCode::FAILURE;
    }
    let failures = match arguments.command {
        Command::Ci => return ci::run(),
        Command::Tidy => tidy::run(),
        Command::Fmt { fix } => fmt::run(fix),
        Command::Lint => lint::run(),
        Command::Test => test::run(),
        Command::Matrix { list_targets: true } => matrix::list_targets(),
        Command::Matrix { list_targets: false } => matrix::run(),
        Command::Device => device::run(),
        Command::Size { table: false } => size::run(),
        Command::Size { table: true } => table::run(),
        Command::Doc => doc::run(),
        Command::Vectors { arguments } => vectors::run(&arguments),
        Command::Capi => capi::run(),
        Command::Browser => browser::run(),
        Command::Interop => interop::run(),
        Command::Miri => miri::run(),
        Command::Fuzz(options) => fuzz::run(&options),
        Command::Bench(options) => bench::run(&options),
    };
    for failure in &failures {
        eprintln!("failed: {failure}");
    }
    if failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
