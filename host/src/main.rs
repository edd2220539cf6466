//! The `wavelift` program; all it does is in the library, and here are its words.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run()
}
