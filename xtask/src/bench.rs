//! `cargo xtask bench`: the kernel's speed, and in the same run that of rival codecs where Python has them.

use std::process::{Command, Stdio};

use crate::shell::{Failures, cargo, output};

/// Runs `tests/benches/speed.rs`, then `xtask/rivals.py` on the same data.
pub(crate) fn run() -> Failures {
    let failures = cargo(&["bench", "--quiet", "--package", "conformance", "--bench", "speed"]);
    if !failures.is_empty() {
        return failures;
    }
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    if output(&python, &["-c", "import imagecodecs, numpy"]).is_err() {
        println!("\nNo rivals measured: {python} has no imagecodecs. To have them in the table:");
        println!("    python3 -m venv target/venv && target/venv/bin/pip install imagecodecs");
        println!("    PYTHON=target/venv/bin/python cargo xtask bench");
        return vec![];
    }
    match Command::new(&python).arg("xtask/rivals.py").stdin(Stdio::null()).status() {
        Ok(status) if status.success() => vec![],
        Ok(status) => vec![format!("xtask/rivals.py: {status}")],
        Err(error) => vec![format!("{python}: {error}")],
    }
}
