//! `cargo xtask lint`.

use crate::budget::{self, Budgets, Image, WORKSPACE};
use crate::fuzz;
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
    failures.extend(firmware());
    failures.extend(fuzz_targets());
    failures
}

/// The firmware of each board, the images of each profile, and what runs here: a workspace of its own.
fn firmware() -> Failures {
    let Budgets { images, runs } = match budget::read() {
        Ok(budgets) => budgets,
        Err(error) => return vec![error],
    };
    let lint = |target: &str, selection: &[&str], features: &[String]| {
        let features = features.join(",");
        let arguments =
            [&["--manifest-path", WORKSPACE, "--target", target, "--features", &features], selection];
        clippy_of("--bins", &arguments.concat())
    };
    let mut failures =
        clippy_of("--all-targets", &["--manifest-path", WORKSPACE, "-p", "fixture", "-p", "runner"]);
    failures.extend(runs.iter().flat_map(|run| lint(&run.target, &["--package", "firmware"], &run.features)));
    let image =
        |image: &Image| lint(&image.target, &["--package", "image", "--bin", &image.binary], &image.features);
    failures.extend(images.iter().flat_map(image));
    failures
}

/// The fuzz targets of the kernel, another workspace; that of the container would check all of the host again.
fn fuzz_targets() -> Failures {
    clippy_of("--bins", &["--manifest-path", fuzz::WORKSPACE])
}

/// Lints the selected packages alone: what they depend on in the workspace has a run of its own.
fn clippy(selection: &[&str]) -> Failures {
    clippy_of("--all-targets", selection)
}

/// The same of some kinds of targets.
fn clippy_of(targets: &str, selection: &[&str]) -> Failures {
    let arguments = [&["clippy", "--quiet", "--no-deps", targets], selection, &["--", "-D", "warnings"]];
    cargo(&arguments.concat())
}
