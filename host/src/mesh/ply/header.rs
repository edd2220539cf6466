//! The lines before the elements.

use super::values::Scalar;
use crate::mesh::MeshFault;
use crate::mesh::text::{Line, Lines, number};

/// How the elements are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    Little,
    Big,
}

impl Encoding {
    const ALL: [Self; 3] = [Self::Text, Self::Little, Self::Big];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Text => "ascii",
            Self::Little => "binary_little_endian",
            Self::Big => "binary_big_endian",
        }
    }
}

/// A number of each element, or a list of them.
#[derive(Clone, Debug)]
pub(super) struct Property {
    name: String,
    /// Type of the number, or of those in the list.
    pub(super) scalar: Scalar,
    /// Type of the length of the list.
    pub(super) list: Option<Scalar>,
}

impl Property {
    pub(super) fn is_scalar(&self, name: &str) -> bool {
        self.name == name && self.list.is_none()
    }

    pub(super) fn is_list(&self, name: &str) -> bool {
        self.name == name && self.list.is_some()
    }
}

/// Things of one kind.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

/// What the file says of itself.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Byte at which the elements begin.
    pub(super) end: usize,
    /// Lines up to there.
    pub(super) lines: usize,
}

impl Header {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, MeshFault> {
        let mut lines = Lines::new(bytes);
        let first = lines.needed("header")?;
        if first.text != b"ply" {
            return Err(first.fault("ply"));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            let line = lines.needed("header")?;
            let mut words = line.words();
            match words.next() {
                Some(b"format") => {
                    let name = words.next().unwrap_or_default();
                    encoding = Encoding::ALL.into_iter().find(|known| known.name().as_bytes() == name);
                }
                Some(b"element") => elements.push(element(line, words)?),
                Some(b"property") => {
                    let element = elements.last_mut().ok_or_else(|| line.fault("an element first"))?;
                    element.properties.push(property(line, words)?);
                }
                Some(b"comment" | b"obj_info") | None => {}
                Some(b"end_header") => {
                    let encoding = encoding.ok_or_else(|| {
                        line.fault("format ascii, binary_little_endian or binary_big_endian before it")
                    })?;
                    return Ok(Self { encoding, elements, end: lines.at(), lines: line.number });
                }
                Some(_) => return Err(line.fault("format, element, property, comment or end_header")),
            }
        }
    }
}

fn element<'a>(line: Line, mut words: impl Iterator<Item = &'a [u8]>) -> Result<Element, MeshFault> {
    let name = words.next().map(text);
    let count = words.next().and_then(number);
    name.zip(count)
        .map(|(name, count)| Element { name, count, properties: Vec::new() })
        .ok_or_else(|| line.fault("a name and a number of elements"))
}

fn property<'a>(line: Line, words: impl Iterator<Item = &'a [u8]>) -> Result<Property, MeshFault> {
    let words: Vec<&[u8]> = words.collect();
    let property = match words[..] {
        [b"list", count, scalar, name] => Scalar::named(count)
            .zip(Scalar::named(scalar))
            .map(|(count, scalar)| Property { name: text(name), scalar, list: Some(count) }),
        [scalar, name] => {
            Scalar::named(scalar).map(|scalar| Property { name: text(name), scalar, list: None })
        }
        _ => None,
    };
    property.ok_or_else(|| line.fault("a type that PLY knows, or a list of two, and a name"))
}

fn text(word: &[u8]) -> String {
    String::from_utf8_lossy(word).into_owned()
}
