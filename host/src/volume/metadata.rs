//! What a file says about its samples beside their extent and type.

use serde::{Deserialize, Serialize};

use super::entries::{entries, filler, rearranged};
use super::geometry::vector_text;
use super::{Axis, ByteOrder, FileFormat};

/// All that a file says about a data set beside extent and type, kept so that it can be written again.
///
/// The words are those of NRRD, the richest of the formats; its lines are kept as they stand. Numbers are read
/// out of them when asked for ([`spacing`](Self::spacing), …), so no digit changes between two files.
///
/// Fields with one entry per axis (`spacings`, `space directions`, `kinds`, `labels`, …) have entries for
/// [`axes`](Self::axes), in their order: where a file has axes of components or time between or beside those of space,
/// so has the field. What is asked for here ([`spacing`](Self::spacing), [`directions`](Self::directions), …) is about
/// x, y and z alone, wherever they stand. A format without such axes may list x, y and z alone although samples have
/// components; writing fills in the others.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Metadata {
    /// Axes of the file, fastest first. Those of space, one to three, are in the order x, y, z: a slice comes back as
    /// a slice.
    pub axes: Vec<Axis>,
    /// How the samples lay in the file.
    pub source: Origin,
    /// Lines of the header in their order, without those that extent, type and encoding determine.
    pub lines: Vec<HeaderLine>,
}

/// How samples lay in the file they came from, so that by default they are written the same way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Format of the file.
    pub format: FileFormat,
    /// Order of the bytes of a sample. Little for samples of one byte.
    pub byte_order: ByteOrder,
    /// Whether the file named its axes x first and said so (NumPy's `fortran_order`).
    pub fortran_order: bool,
}

/// One line of an NRRD header.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum HeaderLine {
    /// `# text`; the text is kept with the space before it.
    Comment(String),
    /// `name: value`.
    Field {
        /// As it stands in the file, in whatever case and spacing.
        name: String,
        /// As it stands in the file, without the blanks around it.
        value: String,
    },
    /// `key:=value`, with escapes resolved: a newline is a newline here.
    KeyValue {
        /// Any text.
        key: String,
        /// Any text.
        value: String,
    },
}

/// Of three axes, as a raw file: nothing is said.
impl Default for Metadata {
    fn default() -> Self {
        Self::plain(3, FileFormat::Raw)
    }
}

impl Metadata {
    /// Metadata of a file of one to three axes that says nothing: little-endian, no lines.
    pub fn plain(rank: u8, format: FileFormat) -> Self {
        let source = Origin { format, byte_order: ByteOrder::Little, fortran_order: false };
        let axes = Axis::SPACE[..usize::from(rank).clamp(1, 3)].to_vec();
        Self { axes, source, lines: Vec::new() }
    }

    /// Number of axes of space in the file, 1 to 3.
    pub fn rank(&self) -> usize {
        self.axes.iter().filter(|axis| axis.is_space()).count().clamp(1, 3)
    }

    /// Number of axes of space, 1 to 3, of a volume of `extent`: those of the source, and more if z or y need them.
    pub(super) fn rank_of(&self, extent: [u64; 3]) -> usize {
        let needed = extent.iter().rposition(|&axis| axis > 1).map_or(1, |axis| axis + 1);
        needed.max(self.rank())
    }

    /// Value of a field, by a name in any case, with or without its spaces: `space origin` is `SpaceOrigin`.
    pub fn field(&self, name: &str) -> Option<&str> {
        self.lines.iter().find_map(|line| match line {
            HeaderLine::Field { name: found, value } if is_same_name(found, name) => Some(value.as_str()),
            _ => None,
        })
    }

    /// Value of the last pair with this key; keys are compared exactly.
    pub fn key_value(&self, key: &str) -> Option<&str> {
        self.lines.iter().rev().find_map(|line| match line {
            HeaderLine::KeyValue { key: found, value } if found == key => Some(value.as_str()),
            _ => None,
        })
    }

    /// Sets a field, in its place if it is there, else behind all others.
    pub fn set_field(&mut self, name: &str, value: &str) {
        let found = self.lines.iter_mut().find_map(|line| match line {
            HeaderLine::Field { name: found, value } if is_same_name(found, name) => Some(value),
            _ => None,
        });
        match found {
            Some(old) => value.clone_into(old),
            None => self.lines.push(HeaderLine::Field { name: name.to_owned(), value: value.to_owned() }),
        }
    }

    /// Removes a field.
    pub fn remove_field(&mut self, name: &str) {
        self.lines.retain(
            |line| !matches!(line, HeaderLine::Field { name: found, .. } if is_same_name(found, name)),
        );
    }

    /// Sets the pair with this key, in the place of the last such pair if there is one, else behind all others.
    pub fn set_key_value(&mut self, key: &str, value: &str) {
        let found = self.lines.iter_mut().rev().find_map(|line| match line {
            HeaderLine::KeyValue { key: found, value } if found == key => Some(value),
            _ => None,
        });
        match found {
            Some(old) => value.clone_into(old),
            None => self.lines.push(HeaderLine::KeyValue { key: key.to_owned(), value: value.to_owned() }),
        }
    }

    /// The lines with entries for the axes of another file: those of the same axes, fillers such as `none` for others.
    pub(super) fn lines_for(&self, axes: &[Axis]) -> Vec<HeaderLine> {
        let moved = |line: &HeaderLine| match line {
            HeaderLine::Field { name, value } => {
                let value = rearranged(name, value, &self.axes, axes).unwrap_or_else(|| value.clone());
                HeaderLine::Field { name: name.clone(), value }
            }
            other => other.clone(),
        };
        self.lines.iter().map(moved).collect()
    }

    /// The entries of a field for x, y and z, each with the number of its axis; `None` if the field is missing or has
    /// not as many entries as there are axes.
    pub(super) fn space_entries(&self, name: &str) -> Option<Vec<(usize, &str)>> {
        let value = self.field(name)?;
        let entries = entries(value);
        let axes = self.axes.iter().zip(&entries);
        let of_space = axes.filter_map(|(axis, entry)| Some((axis.space()?, &value[entry.clone()])));
        (entries.len() == self.axes.len()).then(|| of_space.collect())
    }

    /// The entry of a field for the first axis like this one: of components or of time, however many, or x, y or z.
    pub fn axis_entry(&self, name: &str, axis: Axis) -> Option<&str> {
        let value = self.field(name)?;
        let entries = entries(value);
        let index = self.axes.iter().position(|found| found.is_like(axis))?;
        (entries.len() == self.axes.len()).then(|| &value[entries[index].clone()])
    }

    /// Sets the entry of a field for the axes like this one. Others keep theirs, or get a filler such as `none`.
    pub fn set_axis_entry(&mut self, name: &str, axis: Axis, entry: &str) {
        let words: Vec<String> = self
            .axes
            .iter()
            .map(|found| match found.is_like(axis) {
                true => entry.to_owned(),
                false => self
                    .axis_entry(name, *found)
                    .or_else(|| filler(name, *found, self.axes.last() == Some(found)))
                    .unwrap_or("none")
                    .to_owned(),
            })
            .collect();
        self.set_field(name, &words.join(" "));
    }

    /// Time from one step to the next, in the units that `units` names for this axis; `None` if the file has no axis
    /// of time, or says nothing of it.
    pub fn time_step(&self) -> Option<f64> {
        number(self.axis_entry("spacings", Axis::Time(0))?)
    }

    /// What the volume is, in the file's words (`content`).
    pub fn name(&self) -> Option<&str> {
        self.field("content")
    }

    /// Distance between samples along x, y and z, in the file's units.
    ///
    /// From `spacings`, else the lengths of `space directions`; 1 for axes that the file does not have. `None`
    /// unless x, y and z have a positive, finite one wherever the file has them.
    pub fn spacing(&self) -> Option<[f64; 3]> {
        let given = self.space_entries("spacings").and_then(|entries| {
            entries.into_iter().map(|(_, entry)| number(entry)).collect::<Option<Vec<f64>>>()
        });
        let given = given.or_else(|| {
            let lengths = self.directions()?.into_iter();
            Some(lengths.map(|axis| axis.iter().map(|part| part * part).sum::<f64>().sqrt()).collect())
        })?;
        let valid = !given.is_empty() && given.iter().all(|step| *step > 0.0);
        valid.then(|| std::array::from_fn(|axis| given.get(axis).copied().unwrap_or(1.0)))
    }

    /// Steps in space from one sample to the next along each of x, y and z that the file has (`space directions`).
    ///
    /// `None` if the field is missing, or any of these has no direction (`none`).
    pub fn directions(&self) -> Option<Vec<Vec<f64>>> {
        let entries = self.space_entries("space directions")?;
        entries.into_iter().map(|(_, entry)| vector(entry)).collect()
    }

    /// Position in space of the first sample (`space origin`).
    pub fn origin(&self) -> Option<Vec<f64>> {
        vector(self.field("space origin")?)
    }

    /// Metadata of a part of the volume: every `step`-th sample along x, y and z, from sample `start` on.
    ///
    /// `spacings` and `space directions` of these axes grow by `step`, `space origin` moves to the first sample of the
    /// part. Left out are `axis mins` and `axis maxs`, and an origin that no directions tell how to move. For all
    /// samples from the first, nothing changes.
    #[must_use]
    pub fn of_part(&self, start: [u64; 3], step: u64) -> Self {
        let mut part = self.clone();
        if start == [0; 3] && step == 1 {
            return part;
        }
        part.lines.retain_mut(|line| {
            let HeaderLine::Field { name, value } = line else { return true };
            let is = |wanted| is_same_name(name, wanted);
            if step > 1 && (is("spacings") || is("space directions")) {
                *value = self.scaled(value, step);
            } else if is("space origin") && start != [0; 3] {
                let Some(moved) = self.origin_of_part(start) else { return false };
                *value = moved;
            }
            !is("axis mins") && !is("axis maxs")
        });
        part
    }

    fn origin_of_part(&self, start: [u64; 3]) -> Option<String> {
        let mut origin = self.origin()?;
        for (steps, direction) in start.into_iter().zip(self.directions()?) {
            for (position, part) in origin.iter_mut().zip(direction) {
                *position += steps as f64 * part;
            }
        }
        Some(vector_text(&origin))
    }

    /// Multiplies the entries of x, y and z; everything between them stays.
    fn scaled(&self, value: &str, factor: u64) -> String {
        let mut out = String::with_capacity(value.len());
        let mut end = 0;
        for (index, entry) in entries(value).into_iter().enumerate() {
            out.push_str(&value[end..entry.start]);
            end = entry.end;
            match self.axes.get(index) {
                Some(axis) if !axis.is_space() => out.push_str(&value[entry]),
                _ => out.push_str(&scaled(&value[entry], factor)),
            }
        }
        out + &value[end..]
    }
}

/// Multiplies a number or those of a vector; everything between them stays.
fn scaled(text: &str, factor: u64) -> String {
    let parts = text.split_inclusive(['(', ')', ',', ' ', '\t']).map(|part| {
        let word = part.trim_end_matches(['(', ')', ',', ' ', '\t']);
        let value = number(word).map(|value| (value * factor as f64).to_string());
        value.unwrap_or_else(|| word.to_owned()) + &part[word.len()..]
    });
    parts.collect()
}

/// Whether two names of NRRD fields are the same: neither case nor spaces count.
pub(super) fn is_same_name(one: &str, other: &str) -> bool {
    letters(one).eq(letters(other))
}

fn letters(name: &str) -> impl Iterator<Item = u8> {
    name.bytes().filter(|byte| *byte != b' ').map(|byte| byte.to_ascii_lowercase())
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

/// Reads `(0, 1, 0)`.
fn vector(text: &str) -> Option<Vec<f64>> {
    text.trim().strip_prefix('(')?.strip_suffix(')')?.split(',').map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(lines: &[(&str, &str)]) -> Metadata {
        let mut metadata = Metadata::plain(3, FileFormat::Nrrd);
        metadata.lines = lines
            .iter()
            .map(|(name, value)| HeaderLine::Field { name: name.to_string(), value: value.to_string() })
            .collect();
        metadata
    }

    #[test]
    fn spacing_comes_from_spacings_or_directions() {
        assert_eq!(with(&[("Spacings", "3.2 3.2 1.5e0")]).spacing(), Some([3.2, 3.2, 1.5]));
        let oriented = with(&[
            ("SpaceDirections", "(3,4,0) (0, 2, 0) ( 0,0,-0.5 )"),
            ("space origin", "(-1.5,2,1e3)"),
            ("content", "head"),
        ]);
        assert_eq!(oriented.spacing(), Some([5.0, 2.0, 0.5]));
        assert_eq!(oriented.origin(), Some(vec![-1.5, 2.0, 1000.0]));
        assert_eq!(oriented.directions().unwrap()[2], [0.0, 0.0, -0.5]);
        assert_eq!(oriented.name(), Some("head"));
        let mut slice = with(&[("spacings", "2 3")]);
        slice.axes.pop();
        assert_eq!(slice.spacing(), Some([2.0, 3.0, 1.0]));
    }

    #[test]
    fn what_is_no_spacing_is_none() {
        for text in ["", "1 2", "1 2 3 4", "1 2 nan", "1 2 inf", "1 2 0", "1 2 -1", "1 2 x"] {
            assert_eq!(with(&[("spacings", text)]).spacing(), None, "{text}");
        }
        for text in ["", "none", "(1,0,0) none (0,0,1)", "(1,0,0", "1,0,0", "()", "(1,,0)", "(1,0,0) (0,1,0)"]
        {
            assert_eq!(with(&[("space directions", text)]).spacing(), None, "{text}");
        }
        assert_eq!(Metadata::plain(3, FileFormat::Raw).spacing(), None);
    }

    #[test]
    fn a_part_has_its_own_place_and_spacing() {
        let whole = with(&[
            ("spacings", "0.5 nan  2"),
            ("space directions", "(3.25,0, 0) none (0,0,1e-3)"),
            ("axis mins", "0 0 0"),
            ("content", "4 slices"),
        ]);
        let part = with(&[
            ("spacings", "2 nan  8"),
            ("space directions", "(13,0, 0) none (0,0,0.004)"),
            ("content", "4 slices"),
        ]);
        assert_eq!(whole.of_part([0; 3], 4), part);
        assert_eq!(whole.of_part([0; 3], 1), whole);

        let directions = ("space directions", "(2.00,0,0) (0,0,3e0) (0.5,0,0)");
        let whole = with(&[directions, ("space origin", "(-1,0.25,7)")]);
        assert_eq!(whole.of_part([1, 2, 3], 1), with(&[directions, ("space origin", "(2.5,0.25,13)")]));
        let whole = with(&[("space origin", "(-1,0.25,7)")]);
        assert_eq!(whole.of_part([1, 2, 3], 1), with(&[]));
        assert_eq!(whole.of_part([0, 0, 0], 2), whole);
    }

    #[test]
    fn axes_beside_those_of_space_are_passed_over() {
        let mut metadata = with(&[
            ("spacings", "nan 0.5 0.25 4 2"),
            ("space directions", "none (0.5,0,0)  (0,0.25,0) (0,0,4) none"),
            ("space origin", "(1,2,3)"),
            ("kinds", "RGB-color domain domain domain time"),
        ]);
        metadata.axes = vec![Axis::Component(3), Axis::X, Axis::Y, Axis::Z, Axis::Time(9)];
        assert_eq!(metadata.rank(), 3);
        assert_eq!(metadata.spacing(), Some([0.5, 0.25, 4.0]));
        assert_eq!(metadata.directions().unwrap()[1], [0.0, 0.25, 0.0]);
        let part = metadata.of_part([2, 0, 1], 2);
        assert_eq!(part.field("spacings"), Some("nan 1 0.5 8 2"));
        assert_eq!(part.field("space directions"), Some("none (1,0,0)  (0,0.5,0) (0,0,8) none"));
        assert_eq!(part.origin(), Some(vec![2.0, 2.0, 7.0]));
        metadata.axes.pop();
        assert_eq!((metadata.spacing(), metadata.directions()), (None, None));
        assert_eq!(metadata.lines_for(&metadata.axes), metadata.lines);
    }

    #[test]
    fn fields_and_pairs_are_set_in_their_place() {
        let mut metadata = with(&[("Space Origin", "(1,2,3)"), ("content", "head")]);
        metadata.set_field("space origin", "(0,0,0)");
        metadata.set_field("sample units", "HU");
        metadata.set_key_value("a", "1");
        metadata.set_key_value("a", "2");
        let mut expected = with(&[("Space Origin", "(0,0,0)"), ("content", "head"), ("sample units", "HU")]);
        expected.lines.push(HeaderLine::KeyValue { key: "a".into(), value: "2".into() });
        assert_eq!(metadata, expected);
        metadata.remove_field("CONTENT");
        assert_eq!(metadata.name(), None);
    }

    #[test]
    fn the_last_of_equal_keys_counts() {
        let mut metadata = with(&[]);
        for value in ["1", "2"] {
            metadata.lines.push(HeaderLine::KeyValue { key: "k".into(), value: value.into() });
        }
        assert_eq!(metadata.key_value("k"), Some("2"));
        assert_eq!(metadata.key_value("K"), None);
    }

    #[test]
    fn metadata_survive_postcard() {
        let mut metadata = with(&[("spacings", "1 2 3")]);
        metadata.lines.push(HeaderLine::Comment(" Größe".into()));
        metadata.lines.push(HeaderLine::KeyValue { key: "a".into(), value: "b\nc".into() });
        let bytes = postcard::to_allocvec(&metadata).unwrap();
        assert_eq!(postcard::from_bytes::<Metadata>(&bytes), Ok(metadata));
    }
}
