//! `cargo xtask fmt`.

use crate::budget::WORKSPACE;
use crate::fuzz;
use crate::shell::{Failures, cargo};

/// Checks the formatting of every package, those of workspaces of their own too, or formats when `fix` is set.
pub(crate) fn run(fix: bool) -> Failures {
    let workspaces = ["Cargo.toml", WORKSPACE, fuzz::WORKSPACE];
    let check: &[&str] = if fix { &[] } else { &["--check"] };
    let format = |workspace| cargo(&[&["fmt", "--all", "--manifest-path", workspace], check].concat());
    workspaces.into_iter().flat_map(format).collect()
}
