//! `cargo xtask doc`.

use crate::shell::{Failures, cargo_with};
use crate::workspace::KERNEL;

/// rustdoc of every package, and of the kernel with all its features; a warning is an error.
pub(crate) fn run() -> Failures {
    let deny = [("RUSTDOCFLAGS", "-D warnings")];
    let mut failures = cargo_with(&["doc", "--quiet", "--no-deps", "--workspace"], &deny);
    failures
        .extend(cargo_with(&["doc", "--quiet", "--no-deps", "--package", KERNEL, "--all-features"], &deny));
    failures
}
