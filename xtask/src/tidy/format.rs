//! The format's promises: the header's document moves with its code, and each error is met by a test.

use std::fmt::Write;

use super::File;
use super::source::split_tests;
use super::text::contains_word;

const HEADER: &str = "kernel/src/codestream/header.rs";
const DOCUMENT: &str = "kernel/docs/codestream.md";
const ERRORS: &str = "kernel/src/error.rs";
const VECTORS: &str = "vectors/MANIFEST.toml";

fn find<'a>(files: &'a [File], path: &str) -> Result<&'a str, String> {
    files
        .iter()
        .find(|file| file.path == path)
        .map(|file| file.text.as_str())
        .ok_or_else(|| format!("{path}: missing"))
}

/// The document of the codestream records the hash of the code of its header, so that whoever changes the
/// code reads the document again.
pub(super) fn check_header_hash(files: &[File]) -> Vec<String> {
    header_hash(files).err().into_iter().collect()
}

fn header_hash(files: &[File]) -> Result<(), String> {
    let line = hash_line(find(files, HEADER)?);
    if find(files, DOCUMENT)?.lines().any(|candidate| candidate.trim() == line) {
        return Ok(());
    }
    Err(format!(
        "{DOCUMENT} does not record {HEADER} as it is; when both say the same, it has the line\n    {line}"
    ))
}

fn hash_line(source: &str) -> String {
    let normal = source.replace("\r\n", "\n");
    let digest = hmac_sha256::Hash::hash(normal.as_bytes()).iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    });
    format!("<!-- header.rs sha256: {digest} -->")
}

/// Every variant of every enum of the kernel's errors is named in a test, or expected by a golden vector.
pub(super) fn check_error_variants(files: &[File]) -> Vec<String> {
    let source = match find(files, ERRORS) {
        Ok(source) => split_tests(source).0,
        Err(error) => return vec![error],
    };
    let tests: Vec<&str> = files.iter().filter_map(test_text).collect();
    let vectors = find(files, VECTORS).unwrap_or_default();
    let unnamed = variants(source).into_iter().filter(|(owner, variant)| {
        let full = format!("{owner}::{variant}");
        let expected = vectors.lines().any(|line| line.contains("error = ") && contains_word(line, variant));
        !expected && !tests.iter().any(|text| contains_word(text, &full))
    });
    unnamed.map(|(owner, variant)| format!("{ERRORS}: no test names {owner}::{variant}")).collect()
}

/// The part of a file that is tests.
fn test_text(file: &File) -> Option<&str> {
    let path = &file.path;
    if !path.ends_with(".rs") {
        return None;
    }
    let whole =
        path.starts_with("tests/") || path.starts_with("kernel/tests/") || path.ends_with("/tests.rs");
    match (whole, path.starts_with("kernel/src/")) {
        (true, _) => Some(&file.text),
        (false, true) => Some(split_tests(&file.text).1),
        (false, false) => None,
    }
}

/// Pairs (enum, variant) of a file formatted by rustfmt.
fn variants(source: &str) -> Vec<(&str, &str)> {
    let mut owner = None;
    let mut found = vec![];
    for line in source.lines() {
        if let Some(rest) = line.strip_prefix("pub enum ") {
            owner = rest.split([' ', '<', '{']).next();
        } else if line == "}" {
            owner = None;
        } else if let (Some(owner), Some(variant)) = (owner, variant(line)) {
            found.push((owner, variant));
        }
    }
    found
}

fn variant(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("    ")?;
    let name = rest.split(|letter: char| !letter.is_alphanumeric()).next()?;
    name.starts_with(|letter: char| letter.is_ascii_uppercase()).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(path: &str, text: &str) -> File {
        File { path: path.to_owned(), text: text.to_owned() }
    }

    #[test]
    fn the_hash_does_not_depend_on_line_ends() {
        assert_eq!(hash_line("a\r\nb\n"), hash_line("a\nb\n"));
        let empty =
            "<!-- header.rs sha256: e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855 -->";
        assert_eq!(hash_line(""), empty);
    }

    #[test]
    fn the_document_must_have_the_hash_of_the_header() {
        let header = file(HEADER, "const VERSION: u8 = 1;\n");
        let line = hash_line(&header.text);
        let files = [header, file(DOCUMENT, &format!("# Codestream\n\n{line}\n"))];
        assert_eq!(check_header_hash(&files), [""; 0]);
        let stale = [file(HEADER, "const VERSION: u8 = 2;\n"), file(DOCUMENT, &files[1].text)];
        assert_eq!(check_header_hash(&stale).len(), 1);
    }

    #[test]
    fn a_variant_that_no_test_names_is_reported() {
        let source = "pub enum PlanError {\n    /// Text.\n    ZeroExtent {\n        axis: u8,\n    },\n    TooLarge,\n}\n";
        assert_eq!(variants(source), [("PlanError", "ZeroExtent"), ("PlanError", "TooLarge")]);
        let files = [
            file(ERRORS, source),
            file("tests/tests/limits.rs", "PlanError::ZeroExtent { axis: 0 }"),
            file("kernel/src/extent.rs", "PlanError::TooLarge\n#[cfg(test)]\nmod tests {\n}\n"),
        ];
        let expected = format!("{ERRORS}: no test names PlanError::TooLarge");
        assert_eq!(check_error_variants(&files), [expected]);
    }
}
