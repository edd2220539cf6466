//! Fields with one entry per axis: `spacings: 1 1 2`, `space directions: none (1,0,0) (0,1,0)`, `labels: "x" "y"`.

use std::ops::Range;

use super::Axis;
use super::metadata::is_same_name;

/// Fields with one entry per axis, and what stands there for an axis of which nothing is known.
const PER_AXIS: [(&str, &str); 10] = [
    ("spacings", "nan"),
    ("space directions", "none"),
    ("kinds", "none"),
    ("units", "\"\""),
    ("labels", "\"\""),
    ("centers", "none"),
    ("centerings", "none"),
    ("thicknesses", "nan"),
    ("axis mins", "nan"),
    ("axis maxs", "nan"),
];

/// What fills the place of an unknown axis in this field; `None` if the field has no entries per axis.
///
/// Time behind all other axes is a `list`, as other programs read it.
pub(super) fn filler(name: &str, axis: Axis, is_last: bool) -> Option<&'static str> {
    let (found, filler) = PER_AXIS.into_iter().find(|(known, _)| is_same_name(known, name))?;
    Some(match axis {
        _ if found != "kinds" => filler,
        Axis::X | Axis::Y | Axis::Z => "domain",
        Axis::Component(_) => "vector",
        Axis::Time(_) if is_last => "list",
        Axis::Time(_) => "time",
    })
}

/// Where the entries of a value are: texts in quotes, vectors in parentheses, or words.
pub(super) fn entries(value: &str) -> Vec<Range<usize>> {
    let mut entries = Vec::new();
    let mut at = 0;
    while let Some(blanks) = value[at..].find(|letter: char| !letter.is_ascii_whitespace()) {
        let start = at + blanks;
        let rest = &value[start..];
        let length = match rest.as_bytes()[0] {
            b'(' => rest.find(')').map(|end| end + 1),
            b'"' => end_of_quoted(rest),
            _ => rest.find(|letter: char| letter.is_ascii_whitespace() || letter == '('),
        };
        at = start + length.unwrap_or(rest.len());
        entries.push(start..at);
    }
    entries
}

/// Bytes up to and with the closing quote; a backslash takes the next byte's meaning.
fn end_of_quoted(text: &str) -> Option<usize> {
    let mut is_escaped = false;
    let inner = text.bytes().enumerate().skip(1);
    let mut closing = inner.filter(|(_, byte)| {
        let closes = *byte == b'"' && !is_escaped;
        is_escaped = *byte == b'\\' && !is_escaped;
        closes
    });
    closing.next().map(|(at, _)| at + 1)
}

/// The value of a field whose entries are for the axes `from`, with entries for the axes `to` instead.
///
/// An axis that is not in `from` gets a filler. `None` where nothing has to change: the axes are the same, the field
/// has no entries per axis, or not as many as axes.
pub(super) fn rearranged(name: &str, value: &str, from: &[Axis], to: &[Axis]) -> Option<String> {
    filler(name, Axis::X, false)?;
    let entries = entries(value);
    if from == to || entries.len() != from.len() {
        return None;
    }
    let mut is_taken = vec![false; from.len()];
    let words = to.iter().enumerate().map(|(place, axis)| {
        let found = (0..from.len()).find(|&index| !is_taken[index] && from[index].is_like(*axis));
        match found {
            Some(index) => {
                is_taken[index] = true;
                &value[entries[index].clone()]
            }
            None => filler(name, *axis, place + 1 == to.len()).unwrap_or_default(),
        }
    });
    Some(words.collect::<Vec<_>>().join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(value: &str) -> Vec<&str> {
        entries(value).into_iter().map(|range| &value[range]).collect()
    }

    #[test]
    fn entries_are_words_vectors_and_quoted_texts() {
        assert_eq!(words(" 1  nan 2.5"), ["1", "nan", "2.5"]);
        assert_eq!(
            words("none (1, 0,0)(0,1,0) none(0,0,1"),
            ["none", "(1, 0,0)", "(0,1,0)", "none", "(0,0,1"]
        );
        assert_eq!(
            words(r#""a b" "\"" "" "c\\" "open"#),
            [r#""a b""#, r#""\"""#, r#""""#, r#""c\\""#, r#""open"#]
        );
        assert_eq!(words("é ü(1)"), ["é", "ü", "(1)"]);
        assert!(words(" \t").is_empty());
    }

    #[test]
    fn entries_move_with_their_axes() {
        let volume = Axis::SPACE;
        let colours = [Axis::Component(3), Axis::X, Axis::Y, Axis::Z, Axis::Time(7)];
        let moved = |name, value| rearranged(name, value, &volume, &colours);
        assert_eq!(moved("Spacings", "1 2  3").unwrap(), "nan 1 2 3 nan");
        let directions = moved("space directions", "(1,0,0) (0,1,0) (0, 0,1)");
        assert_eq!(directions.unwrap(), "none (1,0,0) (0,1,0) (0, 0,1) none");
        assert_eq!(moved("kinds", "space space space").unwrap(), "vector space space space list");
        assert_eq!(moved("labels", "\"a\" \"b c\" \"\"").unwrap(), "\"\" \"a\" \"b c\" \"\" \"\"");
        assert_eq!(moved("kinds", "space space"), None);
        assert_eq!(moved("content", "one two three"), None);
        assert_eq!(rearranged("kinds", "a b c", &volume, &volume), None);
        let back = rearranged(
            "units",
            "\"\" \"mm\" \"mm\" \"um\" \"s\"",
            &colours,
            &[Axis::Time(2), Axis::Y, Axis::Z],
        );
        assert_eq!(back.unwrap(), "\"s\" \"mm\" \"um\"");
    }
}
