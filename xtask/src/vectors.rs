//! `cargo xtask vectors`: starts the program `vectors` of the conformance package, which has the recipes.

use crate::shell::{Failures, cargo};

/// Passes `arguments` on; none means `check`. Built as the tests are, so that nothing is compiled twice.
pub(crate) fn run(arguments: &[String]) -> Failures {
    let program =
        ["run", "--quiet", "--profile", "test", "--package", "conformance", "--bin", "vectors", "--"];
    let arguments: Vec<&str> = program.iter().copied().chain(arguments.iter().map(String::as_str)).collect();
    cargo(&arguments)
}
