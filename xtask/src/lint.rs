//! `cargo xtask lint`.

use crate::shell::{Failures, cargo};
use crate::workspace::{KERNEL, Workspace, feature_sets};

/// Clippy on all targets: the workspace together, each package alone, and the kernel with each set of
/// features. Alone and together differ, because cargo unifies the features of what it builds at once.
pub(crate) fn run() -> Failures {
    let workspace = match Workspace::members() {
        Ok(workspace) => workspace,
        Err(error) => return vec![error],
    };
    let mut failures = clippy(&["--workspace"]);
    for package in workspace.packages.iter().filter(|package| package.name != KERNEL) {
        failures.extend(clippy(&["--package", &package.name]));
    }
    match workspace.kernel_matrix() {
        Ok(matrix) => {
            for features in feature_sets(&matrix) {
                let mut arguments = vec!["--package", KERNEL];
                arguments.extend(features.iter().map(String::as_str));
                failures.extend(clippy(&arguments));
            }
        }
        Err(error) => failures.push(error),
    }
    failures
}

/// Lints the selected packages alone: what they depend on in the workspace has a run of its own.
fn clippy(selection: &[&str]) -> Failures {
    let arguments =
        [&["clippy", "--quiet", "--no-deps", "--all-targets"], selection, &["--", "-D", "warnings"]].concat();
    cargo(&arguments)
}
