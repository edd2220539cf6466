//! `cargo xtask miri`: what has `unsafe` code, its own or that of a crate, in an interpreter that checks every access.
//!
//! No part of `cargo xtask ci`, as it takes many minutes, and a nightly toolchain.

use crate::capi::CAPI;
use crate::shell::{Failures, output, run_with};

/// Cargo of the toolchain that has Miri.
const NIGHTLY: [&str; 4] = ["run", "nightly", "cargo", "miri"];

/// The C library as C calls it, and the kernel's unit tests.
const TESTS: [[&str; 4]; 2] =
    [["--package", CAPI, "--test", "calls"], ["--package", "wavelift-kernel", "--lib", "--no-fail-fast"]];

/// Tests of properties try a few cases, and may ask the machine for a seed.
const ENVIRONMENT: [(&str, &str); 2] = [("PROPTEST_CASES", "4"), ("MIRIFLAGS", "-Zmiri-disable-isolation")];

pub(crate) fn run() -> Failures {
    if let Err(error) = output("rustup", &[&NIGHTLY[..], &["--version"]].concat()) {
        return vec![format!("{error}; Miri comes with: rustup toolchain install nightly --component miri")];
    }
    let test =
        |tests: &[&str; 4]| run_with("rustup", &[&NIGHTLY[..], &["test"], &tests[..]].concat(), &ENVIRONMENT);
    TESTS.iter().flat_map(test).collect()
}
