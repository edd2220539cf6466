//! `cargo xtask fmt`.

use crate::shell::{Failures, cargo};

/// Checks the formatting of every package, or formats when `fix` is set.
pub(crate) fn run(fix: bool) -> Failures {
    if fix { cargo(&["fmt", "--all"]) } else { cargo(&["fmt", "--all", "--check"]) }
}
