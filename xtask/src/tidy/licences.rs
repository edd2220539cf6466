//! Licences of all dependencies against `xtask/licences.toml`.

use serde::Deserialize;

use super::read_toml;
use crate::workspace::Workspace;

const LIST: &str = "xtask/licences.toml";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Licences {
    allow: Vec<String>,
}

pub(super) fn check(workspace: &Workspace) -> Result<Vec<String>, String> {
    let licences: Licences = read_toml(LIST)?;
    let refused = workspace.packages.iter().filter_map(|package| {
        let licence = package.license.as_deref().unwrap_or_default();
        let fault = match is_met(licence, &licences.allow) {
            Some(true) => return None,
            Some(false) => "not met by the list",
            None => "not an SPDX expression",
        };
        Some(format!("{} {}: licence `{licence}`: {fault} in {LIST}", package.name, package.version))
    });
    Ok(refused.collect())
}

/// Whether an SPDX expression can be met with the allowed licences; `None` if it is not one.
/// AND binds more tightly than OR; the old separator `/` means OR.
fn is_met(expression: &str, allowed: &[String]) -> Option<bool> {
    let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let mut words = spaced.split_whitespace().peekable();
    let met = any(&mut words, allowed)?;
    words.next().is_none().then_some(met)
}

type Words<'a> = std::iter::Peekable<std::str::SplitWhitespace<'a>>;

fn any(words: &mut Words, allowed: &[String]) -> Option<bool> {
    let mut met = all(words, allowed)?;
    while words.next_if_eq(&"OR").is_some() {
        met |= all(words, allowed)?;
    }
    Some(met)
}

fn all(words: &mut Words, allowed: &[String]) -> Option<bool> {
    let mut met = one(words, allowed)?;
    while words.next_if_eq(&"AND").is_some() {
        met &= one(words, allowed)?;
    }
    Some(met)
}

fn one(words: &mut Words, allowed: &[String]) -> Option<bool> {
    match words.next()? {
        "(" => {
            let met = any(words, allowed)?;
            (words.next()? == ")").then_some(met)
        }
        ")" | "AND" | "OR" | "WITH" => None,
        name if words.next_if_eq(&"WITH").is_some() => {
            Some(allowed.contains(&format!("{name} WITH {}", words.next()?)))
        }
        name => Some(allowed.iter().any(|licence| licence == name)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn met(expression: &str) -> Option<bool> {
        is_met(expression, &["MIT", "Zlib", "Apache-2.0 WITH LLVM-exception"].map(String::from))
    }

    #[test]
    fn expressions_are_evaluated() {
        assert_eq!(met("MIT"), Some(true));
        assert_eq!(met("GPL-3.0-only"), Some(false));
        assert_eq!(met("GPL-3.0-only OR MIT"), Some(true));
        assert_eq!(met("GPL-3.0-only AND MIT OR Zlib"), Some(true));
        assert_eq!(met("(GPL-3.0-only OR MIT) AND Zlib"), Some(true));
        assert_eq!(met("(MIT OR Zlib) AND ISC"), Some(false));
        assert_eq!(met("Apache-2.0 WITH LLVM-exception"), Some(true));
        assert_eq!(met("Apache-2.0"), Some(false));
        assert_eq!(met("MIT/Apache-2.0"), Some(true));
    }

    #[test]
    fn what_is_no_expression_is_told_apart() {
        assert_eq!(met(""), None);
        assert_eq!(met("MIT OR"), None);
        assert_eq!(met("(MIT"), None);
        assert_eq!(met("MIT Zlib"), None);
    }
}
