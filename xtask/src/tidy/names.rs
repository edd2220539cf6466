//! Words that public names do not use, because the project has another word for the thing.

use serde::Deserialize;

use super::source::{code_lines, split_tests};
use super::{File, begins_with_any};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Names {
    within: Vec<String>,
    words: Vec<String>,
}

pub(super) fn check(rules: &Names, files: &[File]) -> Vec<String> {
    let mut failures = vec![];
    for file in
        files.iter().filter(|file| file.path.ends_with(".rs") && begins_with_any(&file.path, &rules.within))
    {
        for name in code_lines(split_tests(&file.text).0).filter_map(public_name) {
            let words = words(name);
            if let Some(word) = rules.words.iter().find(|word| words.contains(word)) {
                failures.push(format!("{}: public name {name}: the project does not say {word}", file.path));
            }
        }
    }
    failures
}

/// The name that a line makes public, if it does.
fn public_name(line: &str) -> Option<&str> {
    let rest = line.trim_start().strip_prefix("pub ")?;
    let mut words = rest.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
    let kinds = ["fn", "struct", "enum", "trait", "type", "mod", "static"];
    let first = words.next()?;
    if kinds.contains(&first) {
        return words.next();
    }
    match (first, words.next()?) {
        ("const", "fn") => words.next(),
        ("const", name) => Some(name),
        ("use", _) => None,
        (field, _) => Some(field),
    }
}

/// The words of `snake_case`, `CamelCase` and `UPPER_CASE` names, in lower case.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut after_lower = false;
    for letter in name.chars() {
        if letter == '_' || (letter.is_uppercase() && after_lower) {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut().filter(|_| letter != '_') {
            word.extend(letter.to_lowercase());
        }
        after_lower = letter.is_lowercase();
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn public_names_are_found() {
        assert_eq!(public_name("pub const fn scratch_len(&self)"), Some("scratch_len"));
        assert_eq!(public_name("    pub struct Plan {"), Some("Plan"));
        assert_eq!(public_name("    pub axis: u8,"), Some("axis"));
        assert_eq!(public_name("pub const NEW: Self"), Some("NEW"));
        assert_eq!(public_name("pub use embedded_io;"), None);
        assert_eq!(public_name("pub(crate) fn f()"), None);
        assert_eq!(public_name("fn f()"), None);
    }

    #[test]
    fn names_fall_into_words() {
        assert_eq!(words("max_encoded_len"), ["max", "encoded", "len"]);
        assert_eq!(words("SampleType"), ["sample", "type"]);
        assert_eq!(words("MAX_LEVELS"), ["max", "levels"]);
    }
}
