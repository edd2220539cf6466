//! What the axes of an NRRD file are: its `kinds` and `space directions` say it, or their number and order do.

use crate::volume::Axis;
use crate::volume::axis::guessed;
use crate::volume::entries::entries;

/// What a header says of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Said {
    Space,
    Time,
    /// Values that make up one sample, wherever the axis stands.
    Component,
    /// Samples that belong together and lie beside each other in no space: components if this axis is faster than
    /// those of space, time steps if it is slower.
    List,
    Nothing,
}

/// Axes of a file with `sizes`, fastest first.
///
/// An axis with a direction lies in space, and one of kind `domain` or `space`; `time` is time; `list`, `stub`,
/// `scalar` and axes with the direction `none` hold components before the axes of space and time steps behind
/// them; the axes of all other kinds (vectors, colours, tensors) hold components wherever they stand. Of more than
/// three axes of space, those from the fourth on are time.
///
/// Where nothing is said of any axis, they are [`guessed`].
pub(super) fn axes_of(sizes: &[u64], kinds: Option<&str>, directions: Option<&str>) -> Option<Vec<Axis>> {
    let said = said_of(sizes.len(), kinds, directions);
    let first_of_space = said.iter().position(|said| *said == Said::Space);
    let Some(first) = first_of_space else {
        return guessed(sizes);
    };
    let mut space = Axis::SPACE.into_iter();
    let axis = |(index, (&said, &size)): (usize, (&Said, &u64))| match said {
        Said::Space => Some(space.next().unwrap_or(Axis::Time(size))),
        Said::Time => Some(Axis::Time(size)),
        Said::List | Said::Nothing if index > first => Some(Axis::Time(size)),
        Said::Component | Said::List | Said::Nothing => Some(Axis::Component(u32::try_from(size).ok()?)),
    };
    said.iter().zip(sizes).enumerate().map(axis).collect()
}

/// What is said of each axis. Of axes of which nothing is said beside others of space, three are enough for space.
fn said_of(rank: usize, kinds: Option<&str>, directions: Option<&str>) -> Vec<Said> {
    let words = |text: Option<&str>| -> Vec<String> {
        let words: Vec<String> = text.map_or(Vec::new(), |text| {
            entries(text).into_iter().map(|range| text[range].to_owned()).collect()
        });
        if words.len() == rank { words } else { vec![String::new(); rank] }
    };
    let said: Vec<Said> = words(kinds)
        .iter()
        .zip(words(directions))
        .map(|(kind, direction)| said_by(kind, &direction))
        .collect();
    let is_silent = |said: &Said| *said == Said::Nothing;
    if rank <= 3 && said.iter().all(|said| matches!(said, Said::Space | Said::Nothing)) {
        return vec![Said::Space; rank];
    }
    let of_space = said.iter().filter(|said| **said == Said::Space).count();
    let silent = said.iter().filter(|said| is_silent(said)).count();
    // Kinds that are given for the other axes only, such as `vector ??? ??? ???`.
    if silent + of_space <= 3 && silent < rank {
        return said.into_iter().map(|said| if is_silent(&said) { Said::Space } else { said }).collect();
    }
    said
}

fn said_by(kind: &str, direction: &str) -> Said {
    let has_direction = direction.starts_with('(');
    match kind.to_ascii_lowercase().as_str() {
        "time" => Said::Time,
        "domain" | "space" if direction.eq_ignore_ascii_case("none") => Said::List,
        _ if has_direction => Said::Space,
        "domain" | "space" => Said::Space,
        "list" | "stub" | "scalar" => Said::List,
        "" | "none" | "???" if direction.is_empty() => Said::Nothing,
        "" | "none" | "???" => Said::List,
        _ => Said::Component,
    }
}

/// The value of `kinds` that makes a reader find these axes.
///
/// Time behind all others is a `list`: ITK takes `time` for one more axis of space, and then misses its direction.
pub(super) fn kinds_of(axes: &[Axis]) -> String {
    let kind = |(index, axis): (usize, &Axis)| match axis {
        Axis::Component(_) => "vector",
        Axis::Time(_) if index + 1 == axes.len() => "list",
        Axis::Time(_) => "time",
        Axis::X | Axis::Y | Axis::Z => "domain",
    };
    axes.iter().enumerate().map(kind).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use Axis::{Component, Time, X, Y, Z};

    use super::*;

    fn found(sizes: &[u64], kinds: &str, directions: &str) -> Vec<Axis> {
        let given = |text| Some(text).filter(|text: &&str| !text.is_empty());
        axes_of(sizes, given(kinds), given(directions)).unwrap()
    }

    #[test]
    fn kinds_and_directions_say_what_axes_are() {
        let volume = "(1,0,0) (0,1,0) (0,0,1)";
        assert_eq!(found(&[4, 5, 6], "domain domain domain", ""), [X, Y, Z]);
        assert_eq!(found(&[4, 5, 6], "space space none", volume), [X, Y, Z]);
        assert_eq!(found(&[3, 5, 6], "RGB-color domain domain", ""), [Component(3), X, Y]);
        assert_eq!(found(&[4, 5, 6], "domain domain time", ""), [X, Y, Time(6)]);
        let colours = "none (1,0,0) (0,1,0) (0,0,1)";
        assert_eq!(found(&[3, 5, 6, 7], "RGB-color domain domain domain", colours), [Component(3), X, Y, Z]);
        assert_eq!(found(&[60, 5, 6, 7], "list domain domain domain", ""), [Component(60), X, Y, Z]);
        assert_eq!(found(&[60, 5, 6, 7], "", colours), [Component(60), X, Y, Z]);
        assert_eq!(found(&[5, 6, 7, 60], "domain domain domain list", ""), [X, Y, Z, Time(60)]);
        assert_eq!(
            found(&[5, 6, 7, 60], "space space space domain", "(1,0,0) (0,1,0) (0,0,1) none"),
            [X, Y, Z, Time(60)]
        );
        assert_eq!(found(&[5, 6, 7, 3], "domain domain domain 3-vector", ""), [X, Y, Z, Component(3)]);
        assert_eq!(found(&[9, 5, 6, 7], "time domain domain domain", ""), [Time(9), X, Y, Z]);
        assert_eq!(found(&[5, 6, 7, 8], "domain domain domain domain", ""), [X, Y, Z, Time(8)]);
        assert_eq!(found(&[5, 6, 7, 8], "vector ??? ??? ???", ""), [Component(5), X, Y, Z]);
        assert_eq!(
            found(&[3, 3, 5, 6, 7], "covariant-vector vector domain domain domain", ""),
            [Component(3), Component(3), X, Y, Z]
        );
    }

    #[test]
    fn without_a_word_the_number_of_axes_says_what_they_are() {
        assert_eq!(found(&[3], "", ""), [X]);
        assert_eq!(found(&[3, 4, 5], "", ""), [X, Y, Z]);
        assert_eq!(found(&[3, 4, 5], "none none", "(1)"), [X, Y, Z]);
        assert_eq!(found(&[4, 5, 6, 7], "", ""), [Component(4), X, Y, Z]);
        assert_eq!(found(&[5, 5, 6, 7], "", ""), [X, Y, Z, Time(7)]);
        assert_eq!(found(&[5, 5, 6, 7, 8, 2], "", ""), [Component(5), X, Y, Z, Time(8), Time(2)]);
        assert_eq!(found(&[5, 6], "list list", ""), [X, Y]);
        assert_eq!(axes_of(&[1 << 40, 5], Some("vector domain"), None), None);
    }

    #[test]
    fn written_kinds_are_read_as_they_are_meant() {
        for axes in [
            vec![X, Y],
            vec![Component(9), X, Y, Z],
            vec![Time(2), Z, Component(3), Y, X]
                .into_iter()
                .filter(|axis| !axis.is_space())
                .chain([X, Y])
                .collect(),
            vec![X, Y, Z, Time(3), Component(2), Time(2)],
        ] {
            let sizes: Vec<u64> = axes
                .iter()
                .map(|axis| match axis {
                    Component(count) => u64::from(*count),
                    Time(count) => *count,
                    _ => 5,
                })
                .collect();
            assert_eq!(axes_of(&sizes, Some(&kinds_of(&axes)), None), Some(axes));
        }
    }
}
