//! Running other programs, and what a chore hands back.

use std::process::{Command, Stdio};

/// One line for each thing that is wrong; empty when the chore passed.
pub(crate) type Failures = Vec<String>;

/// What has cargo compile as fast as it can, for programs that run for a moment or not at all.
pub(crate) const FAST: &[&str] =
    &["--config", "profile.dev.opt-level=0", "--config", "profile.dev.debug=false"];

/// Runs `cargo` with `arguments`, its output shown as it comes. A failure names the whole command.
pub(crate) fn cargo(arguments: &[&str]) -> Failures {
    cargo_with(arguments, &[])
}

/// As [`cargo`], with environment variables set for that run.
pub(crate) fn cargo_with(arguments: &[&str], environment: &[(&str, &str)]) -> Failures {
    start("cargo", Command::new(cargo_program()), arguments, environment)
}

/// As [`cargo_with`], for any program.
pub(crate) fn run_with(program: &str, arguments: &[&str], environment: &[(&str, &str)]) -> Failures {
    start(program, Command::new(program), arguments, environment)
}

fn start(name: &str, mut command: Command, arguments: &[&str], environment: &[(&str, &str)]) -> Failures {
    let line = format!("{name} {}", arguments.join(" "));
    eprintln!("$ {line}");
    match command.args(arguments).envs(environment.iter().copied()).stdin(Stdio::null()).status() {
        Ok(status) if status.success() => vec![],
        Ok(status) => vec![format!("{line} ({status})")],
        Err(error) => vec![format!("{line}: {error}")],
    }
}

/// Standard output of a program that is expected to succeed, or what it said on standard error.
pub(crate) fn output(program: &str, arguments: &[&str]) -> Result<String, String> {
    let line = format!("{program} {}", arguments.join(" "));
    let output = Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("{line}: {error}"))?;
    if !output.status.success() {
        return Err(format!("{line}: {}", String::from_utf8_lossy(&output.stderr).trim()));
    }
    String::from_utf8(output.stdout).map_err(|_| format!("{line}: output is not UTF-8"))
}

/// The cargo that started this program, so that a toolchain chosen on the command line stays chosen.
pub(crate) fn cargo_program() -> String {
    std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned())
}
