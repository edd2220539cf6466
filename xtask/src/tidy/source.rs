//! A Rust file, split into its code and the tests at its foot.

/// The code before, and the tests from, the first `#[cfg(test)]` that opens an inline module.
/// Without one, all is code.
pub(super) fn split_tests(source: &str) -> (&str, &str) {
    let mut start = 0;
    while let Some(found) = source.get(start..).and_then(|rest| rest.find("#[cfg(test)]")) {
        let attribute = start + found;
        let after = source[attribute..].lines().skip(1).find(|line| !line.trim_start().starts_with("#["));
        if after.is_some_and(|line| line.trim_start().starts_with("mod ") && line.ends_with('{')) {
            return source.split_at(attribute);
        }
        start = attribute + 1;
    }
    (source, "")
}

/// Lines that are neither blank nor a comment.
pub(super) fn code_lines(source: &str) -> impl Iterator<Item = &str> {
    source.lines().filter(|line| !line.trim().is_empty() && !line.trim_start().starts_with("//"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_are_split_off_at_the_inline_module() {
        let source = "#[cfg(test)]\nuse a;\nfn f() {}\n#[cfg(test)]\n#[rustfmt::skip]\nmod tests {\n}\n";
        let (code, tests) = split_tests(source);
        assert_eq!(code, "#[cfg(test)]\nuse a;\nfn f() {}\n");
        assert!(tests.starts_with("#[cfg(test)]\n#[rustfmt"));
        assert_eq!(split_tests("#[cfg(test)]\nmod tests;\n").1, "");
    }

    #[test]
    fn blank_lines_and_comments_are_not_code() {
        let lines: Vec<&str> = code_lines("//! a\n\nfn f() { // b\n    // c\n}\n").collect();
        assert_eq!(lines, ["fn f() { // b", "}"]);
    }
}
