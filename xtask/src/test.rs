//! `cargo xtask test`.

use crate::shell::{Failures, cargo};
use crate::workspace::{KERNEL, Workspace};

/// `cargo test` for each package, so that no package leans on features that another one switches on; the
/// kernel with no features and with all. Everything runs, whatever failed before.
pub(crate) fn run() -> Failures {
    let workspace = match Workspace::members() {
        Ok(workspace) => workspace,
        Err(error) => return vec![error],
    };
    let mut failures = vec![];
    for package in &workspace.packages {
        if package.name == KERNEL {
            failures.extend(test(KERNEL, &["--no-default-features"]));
            failures.extend(test(KERNEL, &["--all-features"]));
        } else {
            failures.extend(test(&package.name, &[]));
        }
    }
    failures
}

fn test(package: &str, features: &[&str]) -> Failures {
    cargo(&[&["test", "--no-fail-fast", "--package", package], features].concat())
}
