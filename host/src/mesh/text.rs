//! Lines and words of text files.

use super::MeshFault;

/// The lines of a file that is text, at least where it matters.
#[derive(Clone, Debug)]
pub(super) struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: usize,
}

/// A line without its end and the blanks around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'a> {
    /// The first is 1.
    pub(super) number: usize,
    pub(super) text: &'a [u8],
}

impl<'a> Lines<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, number: 0 }
    }

    /// Byte at which the next line begins.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// The next line, which must be there.
    pub(super) fn needed(&mut self, within: &'static str) -> Result<Line<'a>, MeshFault> {
        self.next().ok_or(MeshFault::Truncated { within, byte: self.bytes.len() })
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.at += length + 1;
        self.number += 1;
        Some(Line { number: self.number, text: rest[..length].trim_ascii() })
    }
}

impl<'a> Line<'a> {
    /// Words between blanks.
    pub(super) fn words(self) -> impl Iterator<Item = &'a [u8]> + Clone {
        self.text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
    }

    /// The line up to a `#`.
    pub(super) fn without_comment(self) -> Self {
        let end = self.text.iter().position(|&byte| byte == b'#').unwrap_or(self.text.len());
        Self { text: self.text[..end].trim_ascii(), ..self }
    }

    /// The line is at fault.
    pub(super) fn fault(self, expected: &'static str) -> MeshFault {
        MeshFault::line(self.number, self.text, expected)
    }

    /// Three numbers, the first of `words`.
    pub(super) fn point(self, mut words: impl Iterator<Item = &'a [u8]>) -> Result<[f64; 3], MeshFault> {
        let mut next = || words.next().and_then(number).ok_or_else(|| self.fault("three coordinates"));
        Ok([next()?, next()?, next()?])
    }
}

/// A word as a number of any type that Rust can parse.
pub(super) fn number<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}
