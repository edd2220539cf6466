//! Names of many files by one: a folder, or a pattern with a place for a number.

use std::cmp::Ordering;
use std::fs;
use std::path::{Path, PathBuf};

use super::SlicesError;
use crate::volume::{FileFormat, ReadError};

/// What stands for a number in the name of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Place {
    /// `%d`, `%04d` or `####`: so many digits at least, with zeros in front.
    Number { digits: usize },
    /// `*`: any text.
    Any,
}

/// Files of one folder whose names differ in a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::volume) struct Pattern {
    folder: PathBuf,
    before: String,
    place: Place,
    after: String,
}

impl Pattern {
    /// The pattern that the last part of a path is, unless it is none or there is a file of that very name.
    pub(in crate::volume) fn of_path(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let (at, length, place) = place_in(name)?;
        if path.exists() {
            return None;
        }
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Some(Self { folder, before: name[..at].to_owned(), place, after: name[at + length..].to_owned() })
    }

    /// The folder of the files.
    pub(in crate::volume) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Name of file `index` of `count`, counted from 0.
    pub(in crate::volume) fn name(&self, index: u64, count: u64) -> String {
        let digits = match self.place {
            Place::Number { digits } => digits,
            Place::Any => count.saturating_sub(1).to_string().len().max(4),
        };
        format!("{}{index:0digits$}{}", self.before, self.after)
    }

    /// Whether a name is one of the pattern's.
    fn matches(&self, name: &str) -> bool {
        let Some(middle) = name.strip_prefix(self.before.as_str()) else { return false };
        match self.place {
            Place::Any => ends_like(middle, &self.after),
            Place::Number { digits } => middle.strip_suffix(self.after.as_str()).is_some_and(|number| {
                let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
                is_number && (number.len() == digits || number.len() > digits && !number.starts_with('0'))
            }),
        }
    }

    /// Every file of a folder.
    pub(in crate::volume) fn any_in(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), before: String::new(), place: Place::Any, after: String::new() }
    }

    /// The files of such names that are there, in the order of their names, whatever is missing.
    ///
    /// # Errors
    /// [`ReadError::Io`]: the folder cannot be read.
    pub(in crate::volume) fn all(&self, path: &Path) -> Result<Vec<PathBuf>, ReadError> {
        let mut names = names_in(&self.folder, path)?;
        names.retain(|name| self.matches(name) && (!name.starts_with('.') || self.before.starts_with('.')));
        names.sort();
        Ok(paths(&self.folder, names))
    }

    /// How many files of such names are there, and one of them.
    pub(in crate::volume) fn found(&self) -> Option<(usize, PathBuf)> {
        let names = names_in(&self.folder, &self.folder).ok()?;
        let names: Vec<String> = names.into_iter().filter(|name| self.matches(name)).collect();
        Some((names.len(), self.folder.join(names.iter().min()?)))
    }

    /// The files that are there, in the order of their numbers.
    ///
    /// # Errors
    /// [`SlicesError`]: there is none, a number is missing, or two are the same.
    pub(in crate::volume) fn files(&self, path: &Path) -> Result<Vec<PathBuf>, ReadError> {
        let is_hidden = self.before.starts_with('.');
        let names = names_in(&self.folder, path)?;
        let names =
            names.into_iter().filter(|name| self.matches(name) && (is_hidden || !name.starts_with('.')));
        let is_consecutive = matches!(self.place, Place::Number { .. });
        Ok(paths(&self.folder, ordered(names.collect(), is_consecutive).map_err(|cause| cause.of(path))?))
    }
}

/// The files of a folder that `format_of` knows, in the order of their numbers.
///
/// # Errors
/// [`SlicesError`]: as [`Pattern::files`], or the files are of several formats.
pub(super) fn files_in(
    folder: &Path,
    format_of: &dyn Fn(&Path) -> Option<FileFormat>,
) -> Result<Vec<PathBuf>, ReadError> {
    let names = names_in(folder, folder)?.into_iter().filter(|name| !name.starts_with('.'));
    let known = names.filter_map(|name| format_of(&folder.join(&name)).map(|format| (name, format)));
    let known: Vec<(String, FileFormat)> = known.collect();
    let fault = |cause: SlicesError| cause.of(folder);
    if let Some((first, format)) = known.first()
        && let Some((other, _)) = known.iter().find(|(_, other)| other != format)
    {
        return Err(fault(SlicesError::Mixed { one: first.clone(), other: other.clone() }));
    }
    let names = known.into_iter().map(|(name, _)| name).collect();
    Ok(paths(folder, ordered(names, false).map_err(fault)?))
}

/// Names of the files in a folder; those that are not UTF-8 are none of ours.
fn names_in(folder: &Path, path: &Path) -> Result<Vec<String>, ReadError> {
    let place = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let list = || {
        let mut names = Vec::new();
        for entry in fs::read_dir(place)? {
            let entry = entry?;
            if !entry.path().is_dir() {
                names.extend(entry.file_name().into_string());
            }
        }
        Ok(names)
    };
    list().map_err(|cause| ReadError::Io { path: path.to_owned(), cause })
}

fn paths(folder: &Path, names: Vec<String>) -> Vec<PathBuf> {
    names.into_iter().map(|name| folder.join(name)).collect()
}

/// Where the place for a number is in a name: its first byte, its bytes, and what it is.
fn place_in(name: &str) -> Option<(usize, usize, Place)> {
    for (at, byte) in name.bytes().enumerate() {
        let rest = &name.as_bytes()[at..];
        match byte {
            b'*' => return Some((at, 1, Place::Any)),
            b'#' => {
                // One alone is a common letter in names.
                let digits = rest.iter().take_while(|byte| **byte == b'#').count();
                if digits > 1 {
                    return Some((at, digits, Place::Number { digits }));
                }
            }
            b'%' => {
                let width = rest[1..].iter().take_while(|byte| byte.is_ascii_digit()).count();
                if rest.get(1 + width) == Some(&b'd') && width <= 2 {
                    let digits = name[at + 1..][..width].parse().unwrap_or(1);
                    return Some((at, width + 2, Place::Number { digits }));
                }
            }
            _ => {}
        }
    }
    None
}

/// Whether a text ends in `pattern`, in which each `*` stands for any text, after any text.
fn ends_like(text: &str, pattern: &str) -> bool {
    let mut rest = text;
    let mut parts = pattern.split('*').peekable();
    while let Some(part) = parts.next() {
        if parts.peek().is_none() {
            return rest.ends_with(part);
        }
        match rest.find(part) {
            Some(at) => rest = &rest[at + part.len()..],
            None => return false,
        }
    }
    true
}

/// A name as texts and numbers in turn, a text first.
fn runs(name: &str) -> Vec<&str> {
    let mut runs = Vec::new();
    let mut rest = name;
    for is_number in [false, true].into_iter().cycle() {
        if rest.is_empty() {
            break;
        }
        let end = rest.find(|letter: char| letter.is_ascii_digit() != is_number).unwrap_or(rest.len());
        runs.push(&rest[..end]);
        rest = &rest[end..];
    }
    runs
}

/// Order of names in which numbers count as numbers, however long; zeros in front of them do not count.
fn natural(one: &str, other: &str) -> Ordering {
    let (one, other) = (runs(one), runs(other));
    for (place, (one, other)) in one.iter().zip(&other).enumerate() {
        let order = if place % 2 == 0 {
            one.cmp(other)
        } else {
            let [one, other] = [one, other].map(|number| number.trim_start_matches('0'));
            one.len().cmp(&other.len()).then(one.cmp(other))
        };
        if order != Ordering::Equal {
            return order;
        }
    }
    one.len().cmp(&other.len())
}

/// Names in their order, with neither a gap nor the same number twice.
///
/// A gap is told where the names differ in one number alone: its steps must then be the same, or 1 if the numbers
/// are to be consecutive.
fn ordered(mut names: Vec<String>, is_consecutive: bool) -> Result<Vec<String>, SlicesError> {
    names.sort_by(|one, other| natural(one, other).then(one.cmp(other)));
    let Some(first) = names.first() else { return Err(SlicesError::NoFiles) };
    let first_runs = runs(first);
    let mut varying = None;
    for pair in names.windows(2) {
        if natural(&pair[0], &pair[1]) == Ordering::Equal {
            return Err(SlicesError::Twice { one: pair[0].clone(), other: pair[1].clone() });
        }
    }
    for name in &names[1..] {
        let runs = runs(name);
        if runs.len() != first_runs.len() {
            return Ok(names);
        }
        let mut places = (0..runs.len()).filter(|place| runs[*place] != first_runs[*place]);
        match (places.next(), places.next()) {
            (Some(place), None) if place % 2 == 1 && varying.is_none_or(|found| found == place) => {
                varying = Some(place);
            }
            _ => return Ok(names),
        }
    }
    match varying {
        Some(place) => without_gap(names, place, is_consecutive),
        None => Ok(names),
    }
}

/// Checks that number `place` of the names has steps that are all the same.
fn without_gap(names: Vec<String>, place: usize, is_consecutive: bool) -> Result<Vec<String>, SlicesError> {
    let numbers: Option<Vec<u64>> = names.iter().map(|name| runs(name)[place].parse().ok()).collect();
    let Some(numbers) = numbers else { return Ok(names) };
    let smallest = numbers.windows(2).map(|pair| pair[1] - pair[0]).min().unwrap_or(1);
    let step = if is_consecutive { 1 } else { smallest };
    let Some(at) = numbers.windows(2).position(|pair| pair[1] - pair[0] != step) else { return Ok(names) };
    let mut missing: Vec<String> = runs(&names[at]).into_iter().map(str::to_owned).collect();
    let digits = missing[place].len();
    missing[place] = format!("{:0digits$}", numbers[at] + step);
    Err(SlicesError::Gap {
        missing: missing.concat(),
        before: names[at].clone(),
        after: names[at + 1].clone(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(name: &str) -> Option<Pattern> {
        Pattern::of_path(&Path::new("no such folder").join(name))
    }

    fn order(names: &[&str], is_consecutive: bool) -> Result<Vec<String>, String> {
        let names = names.iter().map(|name| name.to_string()).collect();
        ordered(names, is_consecutive).map_err(|error| error.to_string())
    }

    #[test]
    fn patterns_make_and_match_names() {
        for (text, made, yes, no) in [
            (
                "a_%04d.png",
                "a_0007.png",
                &["a_0007.png", "a_12345.png"][..],
                &["a_7.png", "a_012345.png", "b_0007.png"][..],
            ),
            ("a%d.png", "a7.png", &["a7.png", "a10.png"], &["a07.png", "a.png", "a7x.png"]),
            ("##.tif", "07.tif", &["07.tif", "100.tif"], &["7.tif", "007.tif"]),
            ("z*.pgm", "z0007.pgm", &["z1.pgm", "z.pgm", "zebra.pgm"], &["1.pgm", "z1.ppm"]),
            ("*_c*_.pgm", "0007_c*_.pgm", &["1_c2_.pgm", "_c_c_.pgm"], &["1_c2.pgm", "c2_.pgm"]),
        ] {
            let pattern = pattern(text).unwrap();
            assert_eq!(pattern.name(7, 12), made);
            yes.iter().for_each(|name| assert!(pattern.matches(name), "{text} {name}"));
            no.iter().for_each(|name| assert!(!pattern.matches(name), "{text} {name}"));
        }
        assert_eq!(pattern("a*").unwrap().name(7, 123_456), "a000007");
        for text in ["a.png", "50%.png", "%s", "%123d", "no #3.png"] {
            assert_eq!(pattern(text), None, "{text}");
        }
    }

    #[test]
    fn names_are_in_the_order_of_their_numbers() {
        assert_eq!(order(&["a10", "a9", "a11"], false).unwrap(), ["a9", "a10", "a11"]);
        assert_eq!(order(&["x2_10", "x10_9", "x2_9"], false).unwrap(), ["x2_9", "x2_10", "x10_9"]);
        assert_eq!(order(&["5", "15", "10"], false).unwrap(), ["5", "10", "15"]);
        assert_eq!(order(&["b", "a", "c7"], false).unwrap(), ["a", "b", "c7"]);
        let long = "99999999999999999999999999999998";
        assert_eq!(order(&["99999999999999999999999999999999", long], false).unwrap()[0], long);
    }

    #[test]
    fn gaps_and_numbers_that_come_twice_are_told_by_name() {
        assert!(order(&[], true).unwrap_err().contains("no slices"));
        let gap = order(&["a_08.png", "a_11.png", "a_09.png"], false).unwrap_err();
        assert!(gap.contains("\"a_10.png\" is missing"), "{gap}");
        let gap = order(&["5.png", "10.png"], true).unwrap_err();
        assert!(gap.contains("\"6.png\" is missing"), "{gap}");
        let twice = order(&["a1.png", "a2.png", "a01.png"], false).unwrap_err();
        assert!(twice.contains("\"a01.png\"") && twice.contains("\"a1.png\""), "{twice}");
    }
}
