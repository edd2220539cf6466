//! `cargo xtask tidy`: what no compiler checks. The rules are data, in `xtask/tidy.toml`.

mod format;
mod licences;
mod names;
mod source;
mod text;

use std::path::Path;

use serde::Deserialize;

use crate::shell::{Failures, output};
use crate::workspace::Workspace;

const RULES: &str = "xtask/tidy.toml";

/// A text file of the repository.
struct File {
    /// From the root, with `/` between folders.
    path: String,
    text: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rules {
    max_code_lines: usize,
    test_files: Vec<String>,
    forbidden_file_names: Vec<String>,
    forbidden: Vec<text::Forbidden>,
    names: names::Names,
}

/// Runs every check over every file that is tracked or would be.
pub(crate) fn run() -> Failures {
    check().unwrap_or_else(|error| vec![error])
}

fn check() -> Result<Failures, String> {
    let rules: Rules = read_toml(RULES)?;
    let files = text_files()?;
    let mut failures = text::check(&rules, &files);
    failures.extend(names::check(&rules.names, &files));
    failures.extend(format::check_header_hash(&files));
    failures.extend(format::check_error_variants(&files));
    failures.extend(licences::check(&Workspace::with_dependencies()?)?);
    println!("{} text files read", files.len());
    Ok(failures)
}

/// Inputs of the fuzz targets: bytes, though some happen to be text.
const CORPUS: &str = "tests/fuzz/corpus/";

/// All text files that git tracks or would track. A file that is listed but gone is being removed.
fn text_files() -> Result<Vec<File>, String> {
    // The owner of a checkout on a build machine is often somebody else; reading it is still safe.
    let arguments =
        ["-c", "safe.directory=*", "ls-files", "-z", "--cached", "--others", "--exclude-standard"];
    let listing = output("git", &arguments)?;
    let mut files = vec![];
    for path in listing.split_terminator('\0').filter(|path| Path::new(path).is_file()) {
        if path.starts_with(CORPUS) {
            continue;
        }
        let bytes = std::fs::read(path).map_err(|error| format!("{path}: {error}"))?;
        if let Ok(text) = String::from_utf8(bytes) {
            files.push(File { path: path.to_owned(), text });
        }
    }
    Ok(files)
}

fn read_toml<T: serde::de::DeserializeOwned>(path: &str) -> Result<T, String> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
    toml::from_str(&text).map_err(|error| format!("{path}: {error}"))
}

/// Whether a path begins with one of `beginnings`.
fn begins_with_any(path: &str, beginnings: &[String]) -> bool {
    beginnings.iter().any(|beginning| path.starts_with(beginning.as_str()))
}
