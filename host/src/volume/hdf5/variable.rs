//! Which variable of a file is meant, and what it says of itself.

use netcdf_reader::{NcAttrValue, NcAttribute, NcGroup, NcType, NcVariable};

use super::Hdf5Error;
use crate::volume::axis::guessed;
use crate::volume::error::excerpt;
use crate::volume::{ElementType, ExtentError, FileFormat, Header, HeaderLine, Metadata, Origin};

/// Names that a message has at most.
const MOST_NAMES: usize = 16;

/// Groups within groups that are looked into.
const MOST_DEPTH: usize = 64;

/// What the keys of attributes begin with.
const PREFIX: &str = "hdf5.";

/// A variable of numbers.
#[derive(Debug)]
pub(super) struct Variable<'a> {
    /// Its name behind those of the groups that it is in.
    pub(super) path: String,
    pub(super) element: ElementType,
    /// Samples along each axis, slowest first.
    pub(super) shape: Vec<u64>,
    pub(super) content: &'a NcVariable,
}

/// The variable of that name, or the only one of those with the most axes.
pub(super) fn find<'a>(root: &'a NcGroup, wanted: Option<&str>) -> Result<Variable<'a>, Hdf5Error> {
    let mut all = Vec::new();
    collect(root, "", 0, &mut all);
    let names = names(&all);
    if let Some(wanted) = wanted {
        let found = all.into_iter().find(|variable| variable.path == wanted.trim_matches('/'));
        return found.ok_or_else(|| Hdf5Error::NoVariable { asked: excerpt(wanted), names });
    }
    let rank = |variable: &Variable<'_>| variable.shape.iter().filter(|count| **count > 1).count();
    let most = all.iter().map(rank).max();
    let mut largest = all.into_iter().filter(|variable| Some(rank(variable)) == most);
    match (largest.next(), largest.next()) {
        (Some(found), None) => Ok(found),
        (None, _) => Err(Hdf5Error::NoNumbers),
        _ => Err(Hdf5Error::Variables { names }),
    }
}

fn collect<'a>(group: &'a NcGroup, path: &str, depth: usize, all: &mut Vec<Variable<'a>>) {
    let within = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}/{name}") };
    for content in &group.variables {
        let (shape, path) = (content.shape(), within(content.name()));
        if let Some(element) = element_of(content.dtype()).filter(|_| !shape.is_empty()) {
            all.push(Variable { path, element, shape, content });
        }
    }
    if depth < MOST_DEPTH {
        group.groups.iter().for_each(|inner| collect(inner, &within(&inner.name), depth + 1, all));
    }
}

const fn element_of(kind: &NcType) -> Option<ElementType> {
    Some(match kind {
        NcType::Byte => ElementType::I8,
        NcType::UByte => ElementType::U8,
        NcType::Short => ElementType::I16,
        NcType::UShort => ElementType::U16,
        NcType::Int => ElementType::I32,
        NcType::UInt => ElementType::U32,
        NcType::Int64 => ElementType::I64,
        NcType::UInt64 => ElementType::U64,
        NcType::Float => ElementType::F32,
        NcType::Double => ElementType::F64,
        _ => return None,
    })
}

fn names(all: &[Variable<'_>]) -> String {
    let mut names: Vec<String> =
        all.iter().take(MOST_NAMES).map(|variable| excerpt(&variable.path)).collect();
    if all.len() > MOST_NAMES {
        names.push(format!("{} more", all.len() - MOST_NAMES));
    }
    match &names[..] {
        [] => "no variable of numbers".to_owned(),
        [name] => format!("the variable {name}"),
        _ => format!("the variables {}", names.join(", ")),
    }
}

impl Variable<'_> {
    /// What the file says of the samples.
    pub(super) fn header(&self) -> Result<Header, Hdf5Error> {
        let fault = |cause| Hdf5Error::Extent { name: excerpt(&self.path), cause };
        let counts: Vec<u64> = self.shape.iter().rev().copied().collect();
        let axes = guessed(&counts).ok_or_else(|| fault(ExtentError::TooLarge))?;
        let source = Origin { format: FileFormat::Hdf5, ..Metadata::plain(1, FileFormat::Hdf5).source };
        let metadata = Metadata { axes, source, lines: self.lines() };
        Header::of_axes(&counts, self.element, metadata).map_err(fault)
    }

    /// Its name, its unit, and all attributes that are texts or numbers.
    fn lines(&self) -> Vec<HeaderLine> {
        let field = |name: &str, value: String| HeaderLine::Field { name: name.to_owned(), value };
        let mut lines = vec![field("content", self.path.clone())];
        let unit = self.content.attribute("units").and_then(|unit| text_of(&unit.value));
        lines.extend(unit.map(|unit| field("sample units", unit)));
        let kept = self.content.attributes().iter().filter(|attribute| attribute.name != "units");
        lines.extend(kept.filter_map(pair));
        lines
    }
}

fn pair(attribute: &NcAttribute) -> Option<HeaderLine> {
    let value = text_of(&attribute.value)?;
    Some(HeaderLine::KeyValue { key: format!("{PREFIX}{}", attribute.name), value })
}

/// A text, or numbers with spaces between them.
pub(super) fn text_of(value: &NcAttrValue) -> Option<String> {
    fn words<T: ToString>(values: &[T]) -> String {
        values.iter().map(T::to_string).collect::<Vec<_>>().join(" ")
    }
    Some(match value {
        NcAttrValue::Chars(text) => text.trim_end_matches('\0').to_owned(),
        NcAttrValue::Strings(texts) => texts.join("\n"),
        NcAttrValue::Bytes(values) => words(values),
        NcAttrValue::UBytes(values) => words(values),
        NcAttrValue::Shorts(values) => words(values),
        NcAttrValue::UShorts(values) => words(values),
        NcAttrValue::Ints(values) => words(values),
        NcAttrValue::UInts(values) => words(values),
        NcAttrValue::Int64s(values) => words(values),
        NcAttrValue::UInt64s(values) => words(values),
        NcAttrValue::Floats(values) => words(values),
        NcAttrValue::Doubles(values) => words(values),
        NcAttrValue::UserDefined { .. } => return None,
    })
}
