//! `cargo xtask matrix`: the kernel on every target of `[package.metadata.matrix]` in its manifest.

use std::path::Path;

use crate::shell::{FAST, Failures, cargo, output};
use crate::workspace::{KERNEL, Workspace, feature_sets};

/// Builds the kernel for each target, with no features, each feature alone, each set, and all. A build, not a check:
/// some errors appear only when code is generated. Without optimizations, which are for the steps that link programs.
pub(crate) fn run() -> Failures {
    let matrix = match Workspace::members().and_then(|workspace| workspace.kernel_matrix()) {
        Ok(matrix) => matrix,
        Err(error) => return vec![error],
    };
    let mut failures = vec![];
    let mut targets = vec![];
    for target in &matrix.targets {
        match require_installed(target) {
            Ok(()) => targets.push(target.as_str()),
            Err(error) => failures.push(error),
        }
    }
    if targets.is_empty() {
        return failures;
    }
    for features in feature_sets(&matrix) {
        // All targets at once keep every core busy; one by one afterwards, only to name those that fail.
        if !build(&targets, &features).is_empty() {
            failures.extend(targets.iter().flat_map(|target| build(&[target], &features)));
        }
    }
    failures
}

fn build(targets: &[&str], features: &[String]) -> Failures {
    let mut arguments = vec!["build", "--quiet", "--keep-going", "--package", KERNEL];
    arguments.extend(FAST);
    arguments.extend(targets.iter().flat_map(|target| ["--target", target]));
    arguments.extend(features.iter().map(String::as_str));
    cargo(&arguments)
}

/// Prints the targets, one a line, for whoever prepares a machine.
pub(crate) fn list_targets() -> Failures {
    match Workspace::members().and_then(|workspace| workspace.kernel_matrix()) {
        Ok(matrix) => {
            matrix.targets.iter().for_each(|target| println!("{target}"));
            vec![]
        }
        Err(error) => vec![error],
    }
}

/// A target is installed when its standard library is there.
fn require_installed(target: &str) -> Result<(), String> {
    let folder = output("rustc", &["--print", "target-libdir", "--target", target])?;
    if Path::new(folder.trim()).is_dir() {
        Ok(())
    } else {
        Err(format!("target {target} is missing; install it with: rustup target add {target}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_target_of_this_machine_is_installed_and_an_unknown_one_is_not() {
        let host = output("rustc", &["--print", "host-tuple"]).unwrap();
        assert_eq!(require_installed(host.trim()), Ok(()));
        assert!(require_installed("no-such-target").is_err());
    }
}
