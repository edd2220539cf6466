//! Lines about axes, for a slice and for a stack of slices.

use crate::volume::{Axis, Metadata};

/// Metadata of a stack of slices that each have these: a third axis, of which nothing is known.
pub(super) fn stacked(slice: &Metadata) -> Metadata {
    let mut axes: Vec<Axis> = slice.axes.iter().copied().filter(|axis| !axis.is_space()).collect();
    let first = slice.axes.iter().position(|axis| axis.is_space()).unwrap_or(axes.len());
    axes.splice(first..first, Axis::SPACE);
    Metadata { lines: slice.lines_for(&axes), axes, ..slice.clone() }
}

/// Metadata of a slice of a stack that has these, and whether something was said of the third axis.
pub(super) fn sliced(stack: &Metadata) -> (Metadata, bool) {
    let axes: Vec<Axis> = stack.axes.iter().copied().filter(|axis| !axis.is_like(Axis::Z)).collect();
    let slice = Metadata { lines: stack.lines_for(&axes), axes, ..stack.clone() };
    let has_third = slice.lines_for(&stack.axes) != stack.lines;
    (slice, has_third)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{FileFormat, HeaderLine};

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
