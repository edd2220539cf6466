//! `cargo xtask test`.

use crate::shell::{FAST, Failures, cargo};
use crate::workspace::{KERNEL, Matrix, Workspace, feature_sets};

const ALL: &str = "--all-features";

/// `cargo test` for each package, so that no package leans on features that another one switches on; the
/// kernel as it comes and with all features, and what it refuses without some, which is little work for much that is
/// compiled and so not optimized. Everything runs, whatever failed before.
pub(crate) fn run() -> Failures {
    let workspace = match Workspace::members() {
        Ok(workspace) => workspace,
        Err(error) => return vec![error],
    };
    let mut failures = vec![];
    for package in &workspace.packages {
        if package.name == KERNEL {
            failures.extend(test(KERNEL, &[]));
            failures.extend(test(KERNEL, &[ALL]));
        } else {
            failures.extend(test(&package.name, &[]));
        }
    }
    match workspace.kernel_matrix() {
        Ok(matrix) => {
            let sets = feature_sets(&Matrix { features: vec![], ..matrix });
            for features in sets.iter().filter(|set| !set.iter().any(|word| word == ALL)) {
                let features: Vec<&str> = features.iter().map(String::as_str).collect();
                failures.extend(test(KERNEL, &[&["--test", "features"], FAST, &features[..]].concat()));
            }
        }
        Err(error) => failures.push(error),
    }
    failures
}

fn test(package: &str, features: &[&str]) -> Failures {
    cargo(&[&["test", "--no-fail-fast", "--package", package], features].concat())
}
