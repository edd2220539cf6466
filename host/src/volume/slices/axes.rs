//! Lines about axes, for a slice and for a stack of slices.

use crate::volume::metadata::is_same_name;
use crate::volume::{HeaderLine, Metadata};

/// Fields of NRRD with an entry for each axis, and what stands for an axis of which nothing is known.
const PER_AXIS: [(&str, &str); 8] = [
    ("spacings", "nan"),
    ("thicknesses", "nan"),
    ("axis mins", "nan"),
    ("axis maxs", "nan"),
    ("centers", "???"),
    ("kinds", "???"),
    ("labels", "\"\""),
    ("units", "\"\""),
];

/// Metadata of a stack of slices that each have these: a third axis, of which nothing is known.
pub(super) fn stacked(slice: &Metadata) -> Metadata {
    let mut stack = slice.clone();
    for line in &mut stack.lines {
        let HeaderLine::Field { name, value } = line else { continue };
        let unknown = PER_AXIS.into_iter().chain([("space directions", "none")]);
        let Some((_, unknown)) = unknown.into_iter().find(|(field, _)| is_same_name(field, name)) else {
            continue;
        };
        for _ in entries(value).len()..3 {
            *value = format!("{value} {unknown}");
        }
    }
    stack.rank = 3;
    stack
}

/// Metadata of a slice of a stack that has these, and whether something was said of the third axis.
pub(super) fn sliced(stack: &Metadata) -> (Metadata, bool) {
    let mut slice = stack.clone();
    let mut has_third = false;
    for line in &mut slice.lines {
        let HeaderLine::Field { name, value } = line else { continue };
        let known = PER_AXIS.into_iter().chain([("space directions", "none")]);
        let Some((_, unknown)) = known.into_iter().find(|(field, _)| is_same_name(field, name)) else {
            continue;
        };
        let found = entries(value);
        if let [x, y, third, ..] = found[..] {
            has_third |= third != unknown;
            *value = format!("{x} {y}");
        }
    }
    slice.rank = slice.rank.min(2);
    (slice, has_third)
}

/// Parts of a value between blanks, of which those in quotes and brackets are none.
fn entries(value: &str) -> Vec<&str> {
    let mut depth = 0_u32;
    let mut is_quoted = false;
    let parts = value.split(move |letter: char| {
        match letter {
            '"' => is_quoted = !is_quoted,
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        letter.is_whitespace() && !is_quoted && depth == 0
    });
    parts.filter(|part| !part.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::FileFormat;

    fn with(rank: u8, lines: &[(&str, &str)]) -> Metadata {
        let lines = lines
            .iter()
            .map(|(name, value)| HeaderLine::Field { name: name.to_string(), value: value.to_string() });
        Metadata { lines: lines.collect(), ..Metadata::plain(rank, FileFormat::Png) }
    }

    #[test]
    fn a_third_axis_comes_and_goes() {
        let slice = with(
            2,
            &[
                ("Spacings", "0.5 2"),
                ("units", "\"mm\" \"a b\""),
                ("space directions", "(1,0, 0) (0,1,0)"),
                ("content", "a b c"),
            ],
        );
        let stack = with(
            3,
            &[
                ("Spacings", "0.5 2 nan"),
                ("units", "\"mm\" \"a b\" \"\""),
                ("space directions", "(1,0, 0) (0,1,0) none"),
                ("content", "a b c"),
            ],
        );
        assert_eq!(stacked(&slice), stack);
        assert_eq!(sliced(&stack), (slice, false));
        assert!(sliced(&with(3, &[("spacings", "1 1 3")])).1);
    }
}
