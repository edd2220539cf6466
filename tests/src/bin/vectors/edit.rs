//! Setting single values of `vectors/MANIFEST.toml`, all else of the text left as it is written.

use std::path::PathBuf;

use conformance::vectors::folder;

/// The text of the manifest, by lines.
pub(crate) struct Manuscript {
    lines: Vec<String>,
}

impl Manuscript {
    pub(crate) fn read() -> Result<Self, String> {
        let text =
            std::fs::read_to_string(path()).map_err(|error| format!("{}: {error}", path().display()))?;
        Ok(Self::new(&text))
    }

    fn new(text: &str) -> Self {
        Self { lines: text.lines().map(str::to_owned).collect() }
    }

    /// Writes beside the manifest and renames, so that an interrupted run leaves a whole one.
    pub(crate) fn write(&self) -> Result<(), String> {
        let new = path().with_extension("toml.new");
        let written = std::fs::write(&new, self.text()).and_then(|()| std::fs::rename(&new, path()));
        written.map_err(|error| format!("{}: {error}", path().display()))
    }

    fn text(&self) -> String {
        self.lines.iter().flat_map(|line| [line.as_str(), "\n"]).collect()
    }

    /// Sets `key` of the vector `id` to a value in TOML: in its line, or in a new one below `file`.
    pub(crate) fn set(&mut self, id: &str, key: &str, value: &str) -> Result<(), String> {
        let line = format!("{key} = {value}");
        let start =
            self.entry(id).ok_or_else(|| format!("vectors/MANIFEST.toml has no line id = \"{id}\""))?;
        let end = self.position(start + 1, |line| line.starts_with("[[")).unwrap_or(self.lines.len());
        let prefix = format!("{key} = ");
        match self.position(start, |line| line.starts_with(&prefix)).filter(|at| *at < end) {
            Some(at) => self.lines[at] = line,
            None => {
                let file = self.position(start, |line| line.starts_with("file = ")).filter(|at| *at < end);
                let file = file.ok_or_else(|| format!("the entry of {id} has no line file = …"))?;
                self.lines.insert(file + 1, line);
            }
        }
        Ok(())
    }

    /// The line `[[vector]]` of the entry with that id.
    fn entry(&self, id: &str) -> Option<usize> {
        let wanted = format!("id = \"{id}\"");
        let pairs = self.lines.iter().zip(self.lines.iter().skip(1));
        pairs
            .enumerate()
            .find(|(_, (head, first))| *head == "[[vector]]" && **first == wanted)
            .map(|(at, _)| at)
    }

    fn position(&self, start: usize, matches: impl Fn(&str) -> bool) -> Option<usize> {
        let found = self.lines.iter().skip(start).position(|line| matches(line))?;
        Some(start + found)
    }
}

fn path() -> PathBuf {
    folder().join("MANIFEST.toml")
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# Top\n\n[[vector]]\nid = \"a\"\nfile = \"v2/a\"\nsince = 1\n\n\
                        [[vector]]\nid = \"b\"\nfile = \"v2/b\" # here\nsince = 1\n";

    #[test]
    fn a_value_is_set_where_it_stands_or_below_the_file() {
        let mut manuscript = Manuscript::new(TEXT);
        manuscript.set("b", "since", "2").unwrap();
        manuscript.set("b", "bytes", "30").unwrap();
        let expected = TEXT.replace("# here\nsince = 1", "# here\nbytes = 30\nsince = 2");
        assert_eq!(manuscript.text(), expected);
        manuscript.set("b", "bytes", "31").unwrap();
        assert_eq!(manuscript.text(), expected.replace("30", "31"));
    }

    #[test]
    fn an_unknown_vector_is_an_error() {
        assert!(Manuscript::new(TEXT).set("c", "since", "2").is_err());
    }
}
