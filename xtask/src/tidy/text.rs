//! Lengths, names and last lines of files, and text that must not stand in them.

use serde::Deserialize;

use super::source::{code_lines, split_tests};
use super::{File, RULES, Rules, begins_with_any};

/// A text, the paths in which it is forbidden, and why.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Forbidden {
    text: String,
    #[serde(default)]
    within: Vec<String>,
    #[serde(default)]
    allowed: Vec<String>,
    #[serde(default)]
    code: bool,
    why: String,
}

pub(super) fn check(rules: &Rules, files: &[File]) -> Vec<String> {
    files.iter().flat_map(|file| check_file(rules, file)).collect()
}

fn check_file(rules: &Rules, file: &File) -> Vec<String> {
    let File { path, text } = file;
    let mut failures = vec![];
    let name = path.rsplit('/').next().unwrap_or(path);
    if rules.forbidden_file_names.iter().any(|forbidden| forbidden == name) {
        failures.push(format!("{path}: a file is named after what is in it"));
    }
    let is_codestream = name.ends_with(".wlc");
    if !is_codestream && !text.is_empty() && !text.ends_with('\n') {
        failures.push(format!("{path}: the last line has no end"));
    }
    if name.ends_with(".rs") && !is_test_file(rules, path) {
        let lines = code_lines(split_tests(text).0).count();
        if lines > rules.max_code_lines {
            failures.push(format!("{path}: {lines} lines of code, {} at most", rules.max_code_lines));
        }
    }
    // Lists of rules and of resolved packages quote words; they do not use them.
    if path != RULES && name != "Cargo.lock" {
        failures.extend(rules.forbidden.iter().flat_map(|rule| find_forbidden(rule, file)));
    }
    failures
}

fn is_test_file(rules: &Rules, path: &str) -> bool {
    rules.test_files.iter().any(|part| {
        if part.starts_with('/') { path.contains(part.as_str()) } else { path.starts_with(part.as_str()) }
    })
}

fn find_forbidden(rule: &Forbidden, file: &File) -> Vec<String> {
    let File { path, text } = file;
    let applies = rule.within.is_empty() || begins_with_any(path, &rule.within);
    if !applies || begins_with_any(path, &rule.allowed) {
        return vec![];
    }
    let hits = text.lines().enumerate().filter(|(_, line)| {
        let comment = rule.code && line.trim_start().starts_with("//");
        !comment && contains_word(line, &rule.text)
    });
    hits.map(|(index, _)| format!("{path}:{}: {}: {}", index + 1, rule.text, rule.why)).collect()
}

/// Whether `line` contains `text` and neither end of it continues a word.
pub(super) fn contains_word(line: &str, text: &str) -> bool {
    let is_word = |letter: char| letter.is_alphanumeric() || letter == '_';
    let ends_in_word = text.ends_with(is_word);
    line.match_indices(text).any(|(start, _)| {
        let before = line[..start].chars().next_back();
        let after = line[start + text.len()..].chars().next();
        let continues = before.is_some_and(is_word) || (ends_in_word && after.is_some_and(is_word));
        !continues
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rule(text: &str) -> Forbidden {
        let within = vec!["a/".to_owned()];
        Forbidden {
            text: text.to_owned(),
            within,
            allowed: vec!["a/b.rs".to_owned()],
            code: true,
            why: "w".into(),
        }
    }

    fn hits(path: &str, text: &str) -> Vec<String> {
        find_forbidden(&rule("word"), &File { path: path.to_owned(), text: text.to_owned() })
    }

    #[test]
    fn a_word_is_found_whole() {
        assert!(contains_word("(word)", "word"));
        assert!(contains_word("a sword, a word", "word"));
        assert!(!contains_word("words, sword, word_count", "word"));
        assert!(contains_word("\"../../x/y", "../x"));
        assert!(!contains_word("net/a/b", "/a/"));
        assert!(contains_word("fixed::types", "fixed::"));
    }

    #[test]
    fn a_rule_holds_where_it_says() {
        assert_eq!(hits("a/c.rs", "one\nword\n"), ["a/c.rs:2: word: w"]);
        assert_eq!(hits("a/c.rs", "// word\n"), [""; 0]);
        assert_eq!(hits("a/b.rs", "word\n"), [""; 0]);
        assert_eq!(hits("c.rs", "word\n"), [""; 0]);
    }
}
