//! Legacy files: lines of text, and big-endian samples or decimal numbers between them.
//!
//! Source: *VTK File Formats* (Kitware), part "Simple Legacy Formats"; class `vtkDataReader` for what later versions
//! added (names with `%20` for a blank, `METADATA`, `vtktypeint64`, texts in fields).

use std::io::{self, BufRead, Read, Write};
use std::path::Path;

use super::VtkError;
use super::array::{Array, Attribute, attribute_of, choose, name_of, without_own};
use super::body::{VtkSource, damaged};
use super::grid::{Grid, joined};
use super::sink::VtkSink;
use super::text::{Text, skip_words};
use crate::atomic::AtomicFile;
use crate::volume::error::excerpt;
use crate::volume::input::Input;
use crate::volume::stored::{Encoding, Place, Stored};
use crate::volume::{
    Axis, ByteOrder, Created, ElementType, FileFormat, Found, Header, HeaderLine, Metadata, Origin,
    ReadError, Source, WriteError, WriteOptions, losses,
};

/// First characters of every file; a version follows.
pub(super) const MAGIC: &str = "# vtk DataFile Version";

/// Longest line that is read; VTK's own readers stop at 256 characters.
const LINE_BYTES: u64 = 1 << 16;

/// Key of the pair that keeps the title.
const TITLE: &str = "vtk.title";

/// Title that VTK writes where none is given.
const NO_TITLE: &str = "vtk output";

/// Where the values of an array are.
#[derive(Clone, Copy, Debug)]
struct Values {
    start: u64,
    /// Decimal colours stand for parts of 255.
    is_color: bool,
}

/// A file whose header is being read.
struct Reader {
    input: Input,
    is_text: bool,
    grid: Grid,
    arrays: Vec<Array<Values>>,
    /// Whose values follow; fields before any belong to none.
    section: Option<Section>,
}

#[derive(Clone, Copy)]
struct Section {
    of_cells: bool,
    count: u64,
}

/// Opens a file at the array of that name, or the one that is active.
pub(super) fn open(input: Input, wanted: Option<&str>) -> Result<Box<dyn Source>, ReadError> {
    let mut reader =
        Reader { input, is_text: false, grid: Grid::plain([0; 3]), arrays: Vec::new(), section: None };
    let title = reader.begin()?;
    while let Some(line) = reader.line()? {
        reader.keyword(&line)?;
    }
    reader.source(wanted, title)
}

impl Reader {
    fn fault(&self, cause: VtkError) -> ReadError {
        ReadError::Format {
            path: self.input.path().to_owned(),
            format: FileFormat::VtkLegacy,
            cause: Box::new(cause),
        }
    }

    /// The next line, without blanks around it. Text that is not UTF-8 is taken as Latin-1.
    fn any_line(&mut self) -> Result<Option<String>, ReadError> {
        let mut line = Vec::new();
        let read = self.input.by_ref().take(LINE_BYTES).read_until(b'\n', &mut line);
        match read.map_err(|cause| self.input.io(cause))? as u64 {
            0 => Ok(None),
            LINE_BYTES if !line.ends_with(b"\n") => Err(self.fault(VtkError::TooLong { limit: LINE_BYTES })),
            _ => Ok(Some(match str::from_utf8(&line) {
                Ok(line) => line.trim().to_owned(),
                Err(_) => line.into_iter().map(char::from).collect::<String>().trim().to_owned(),
            })),
        }
    }

    /// The next line with something on it.
    fn line(&mut self) -> Result<Option<String>, ReadError> {
        while let Some(line) = self.any_line()? {
            if !line.is_empty() {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }

    fn required(&mut self, what: &'static str) -> Result<String, ReadError> {
        self.line()?.ok_or_else(|| self.fault(VtkError::Missing { what }))
    }

    /// Reads the first four lines; the title.
    fn begin(&mut self) -> Result<String, ReadError> {
        if !self.any_line()?.is_some_and(|line| line.starts_with(MAGIC)) {
            return Err(self.fault(VtkError::Magic));
        }
        let title = self.any_line()?.unwrap_or_default();
        let kind = self.required("the line BINARY or ASCII")?;
        self.is_text = match kind.to_ascii_uppercase().as_str() {
            "BINARY" => false,
            "ASCII" => true,
            _ => return Err(self.unexpected(&kind, "BINARY or ASCII")),
        };
        let line = self.required("the line DATASET")?;
        let words: Vec<String> = line.split_whitespace().map(str::to_ascii_uppercase).collect();
        match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            ["DATASET", "STRUCTURED_POINTS"] => Ok(title),
            ["DATASET", other] => Err(self.fault(VtkError::Kind { found: excerpt(other) })),
            _ => Err(self.unexpected(&line, "DATASET STRUCTURED_POINTS")),
        }
    }

    fn unexpected(&self, line: &str, expected: &'static str) -> ReadError {
        self.fault(VtkError::Line { text: excerpt(line), expected })
    }

    /// Understands a line that begins something, and passes over the values that follow it.
    fn keyword(&mut self, line: &str) -> Result<(), ReadError> {
        let words: Vec<&str> = line.split_whitespace().collect();
        match (words[0].to_ascii_uppercase().as_str(), &words[1..]) {
            ("DIMENSIONS", of) => self.grid.points = self.three(line, of)?,
            ("SPACING" | "ASPECT_RATIO", of) => self.grid.spacing = self.three(line, of)?,
            ("ORIGIN", of) => self.grid.origin = self.three(line, of)?,
            ("POINT_DATA", [count]) => self.begin_section(false, count)?,
            ("CELL_DATA", [count]) => self.begin_section(true, count)?,
            ("FIELD", [_, count]) => self.field(count)?,
            ("METADATA", _) => while self.any_line()?.is_some_and(|line| !line.is_empty()) {},
            ("LOOKUP_TABLE", [_, count]) => {
                let count = self.number(line, count)?;
                let (element, components) = if self.is_text { ("float", 4) } else { ("unsigned_char", 4) };
                self.skip(element, count, components)?;
            }
            (keyword, [name, rest @ ..]) => self.attribute(line, keyword, name, rest)?,
            _ => return Err(self.unexpected(line, "a keyword of STRUCTURED_POINTS")),
        }
        Ok(())
    }

    /// Understands the line of an attribute: its name, its type, and how many components it has.
    fn attribute(&mut self, line: &str, keyword: &str, name: &str, rest: &[&str]) -> Result<(), ReadError> {
        let (attribute, element, components) = match (keyword, rest) {
            ("SCALARS", [element]) => (Attribute::Scalars, *element, 1),
            ("SCALARS", [element, count]) => (Attribute::Scalars, *element, self.number(line, count)?),
            ("COLOR_SCALARS", [count]) => (Attribute::Scalars, "unsigned_char", self.number(line, count)?),
            ("VECTORS", [element]) => (Attribute::Vectors, *element, 3),
            ("NORMALS", [element]) => (Attribute::Normals, *element, 3),
            ("TENSORS", [element]) => (Attribute::Tensors, *element, 9),
            ("TENSORS6", [element]) => (Attribute::Field, *element, 6),
            ("TEXTURE_COORDINATES", [count, element]) => {
                (Attribute::TextureCoordinates, *element, self.number(line, count)?)
            }
            ("GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS", [element]) => (Attribute::Field, *element, 1),
            _ => return Err(self.unexpected(line, "a keyword of STRUCTURED_POINTS")),
        };
        if keyword == "SCALARS" {
            let table = self.required("the line LOOKUP_TABLE")?;
            if !table.to_ascii_uppercase().starts_with("LOOKUP_TABLE") {
                return Err(self.unexpected(&table, "LOOKUP_TABLE"));
            }
        }
        let Some(section) = self.section else {
            return Err(self.unexpected(line, "POINT_DATA or CELL_DATA before any array"));
        };
        let is_color = keyword == "COLOR_SCALARS" && self.is_text;
        let array = self.array(name, element, components, attribute, is_color)?;
        self.skip(if is_color { "float" } else { element }, section.count, components)?;
        self.arrays.push(array);
        Ok(())
    }

    /// An array whose values begin here.
    fn array(
        &self,
        name: &str,
        element: &str,
        components: u64,
        attribute: Attribute,
        is_color: bool,
    ) -> Result<Array<Values>, ReadError> {
        let found = u32::try_from(components).ok().filter(|&found| found > 0);
        let components = found.ok_or_else(|| {
            let (what, value) = ("the number of components", components.to_string());
            self.fault(VtkError::Value { what, value, expected: "from 1 to 4294967295" })
        })?;
        Ok(Array {
            name: decoded(name),
            element: element_named(element).ok_or_else(|| element.to_owned()),
            components,
            of_cells: self.section.is_some_and(|section| section.of_cells),
            attribute,
            data: Values { start: self.input.position(), is_color },
        })
    }

    /// Reads the arrays of a field, as many as its line says.
    fn field(&mut self, count: &str) -> Result<(), ReadError> {
        for _ in 0..self.number("FIELD", count)? {
            let mut line = self.required("an array of a FIELD")?;
            if line == "METADATA" {
                self.keyword("METADATA")?;
                line = self.required("an array of a FIELD")?;
            }
            let [name, components, tuples, element] = line.split_whitespace().collect::<Vec<_>>()[..] else {
                return Err(self.unexpected(&line, "name, components, tuples and type of an array"));
            };
            let (components, tuples) = (self.number(&line, components)?, self.number(&line, tuples)?);
            let belongs = self.section.is_some_and(|section| section.count == tuples) && components > 0;
            if belongs {
                let array = self.array(name, element, components, Attribute::Field, false)?;
                self.arrays.push(array);
            }
            self.skip(element, tuples, components)?;
        }
        Ok(())
    }

    fn begin_section(&mut self, of_cells: bool, count: &str) -> Result<(), ReadError> {
        let count = self.number("the number of values", count)?;
        self.grid.of_cells = of_cells;
        let expected = self.grid.count().ok_or_else(|| self.fault(VtkError::TooLarge))?;
        if count != expected {
            let what = if of_cells { "the number after CELL_DATA" } else { "the number after POINT_DATA" };
            let expected = "the one that DIMENSIONS before it gives";
            return Err(self.fault(VtkError::Value { what, value: count.to_string(), expected }));
        }
        self.section = Some(Section { of_cells, count });
        Ok(())
    }

    /// Passes over the values of an array.
    fn skip(&mut self, element: &str, tuples: u64, components: u64) -> Result<(), ReadError> {
        let count = tuples.checked_mul(components).ok_or_else(|| self.fault(VtkError::TooLarge))?;
        if element.eq_ignore_ascii_case("string") {
            return (0..count).try_for_each(|_| self.skip_string());
        }
        if self.is_text {
            return skip_words(&mut self.input, count).map_err(|cause| self.samples(cause));
        }
        let bytes = match (element_named(element), element) {
            (Some(known), _) => count.checked_mul(known.bytes() as u64),
            (None, "bit") => Some(count.div_ceil(8)),
            (None, _) => {
                let what = "the type of an array";
                let expected = "a type of VTK";
                return Err(self.fault(VtkError::Value { what, value: excerpt(element), expected }));
            }
        };
        let bytes = bytes.ok_or_else(|| self.fault(VtkError::TooLarge))?;
        self.skip_bytes(bytes)
    }

    fn skip_bytes(&mut self, bytes: u64) -> Result<(), ReadError> {
        if let Some(left) = self.input.left().filter(|&left| left < bytes) {
            let (path, found) = (self.input.path().to_owned(), Found::Exactly(left));
            return Err(ReadError::SampleBytes { path, expected: bytes, found });
        }
        self.input.seek(self.input.position().saturating_add(bytes))
    }

    /// Passes over one text: a line, or bytes behind their number, whose first two bits say how wide it is.
    fn skip_string(&mut self) -> Result<(), ReadError> {
        if self.is_text {
            let line = self.any_line()?;
            return line.map(drop).ok_or_else(|| self.fault(VtkError::Missing { what: "a text of a FIELD" }));
        }
        let mut word = [0; 8];
        self.input.read_exact(&mut word[..1]).map_err(|cause| self.samples(cause))?;
        let width = [8, 4, 2, 1][usize::from(word[0] >> 6)];
        word[0] &= 0x3f;
        self.input.read_exact(&mut word[1..width]).map_err(|cause| self.samples(cause))?;
        self.skip_bytes(u64::from_be_bytes(word) >> (64 - 8 * width))
    }

    fn samples(&self, cause: io::Error) -> ReadError {
        match damaged(self.input.path(), cause) {
            ReadError::Format { path, cause, .. } => {
                ReadError::Format { path, format: FileFormat::VtkLegacy, cause }
            }
            other => other,
        }
    }

    fn number(&self, line: &str, text: &str) -> Result<u64, ReadError> {
        text.parse().map_err(|_| self.unexpected(&format!("{line} {text}"), "a whole number from 0 up"))
    }

    fn three<T: std::str::FromStr>(&self, line: &str, words: &[&str]) -> Result<[T; 3], ReadError> {
        let numbers: Option<Vec<T>> = words.iter().map(|word| word.parse().ok()).collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        numbers.ok_or_else(|| self.unexpected(line, "three numbers"))
    }

    /// The data set that is asked for.
    fn source(mut self, wanted: Option<&str>, title: String) -> Result<Box<dyn Source>, ReadError> {
        let arrays = std::mem::take(&mut self.arrays);
        let (array, named) = choose(arrays, wanted).map_err(|cause| self.fault(cause))?;
        let element = array.element.map_err(|found| {
            self.fault(VtkError::Element { name: excerpt(&array.name), found: excerpt(&found) })
        })?;
        self.grid.of_cells = array.of_cells;
        let byte_order =
            if self.is_text || element.bytes() == 1 { ByteOrder::Little } else { ByteOrder::Big };
        let source = Origin { format: FileFormat::VtkLegacy, byte_order, fortran_order: false };
        let mut lines = [named, self.grid.lines()].concat();
        if !title.is_empty() && title != NO_TITLE {
            lines.push(HeaderLine::KeyValue { key: TITLE.to_owned(), value: title });
        }
        let metadata = Metadata { axes: Axis::SPACE.to_vec(), source, lines };
        let (extent, components) = (self.grid.samples(), array.components);
        let header = Header { extent, components, steps: 1, element, metadata };
        let Values { start, is_color } = array.data;
        if self.is_text {
            let path = self.input.path().to_owned();
            let body = Box::new(Text::new(self.input, start, element, is_color)?);
            return Ok(Box::new(VtkSource { header, body, byte_order, path, at: 0 }));
        }
        self.input.seek(start)?;
        let place = Place { encoding: Encoding::Raw, byte_order, skip: 0, is_open_ended: true };
        Ok(Box::new(Stored::new(self.input, header, place)?))
    }
}

/// Begins a file of binary samples.
pub(super) fn create(
    path: &Path,
    header: &Header,
    options: &WriteOptions,
    name: Option<&str>,
) -> Result<Created, WriteError> {
    let fault = |cause| WriteError::Io { path: path.to_owned(), cause };
    if options.byte_order == Some(ByteOrder::Little) && header.element.bytes() > 1 {
        let what = "little-endian samples: leave the order of bytes out, or write .vti".to_owned();
        return Err(WriteError::CannotHold { path: path.to_owned(), format: FileFormat::VtkLegacy, what });
    }
    let grid = Grid::of(header);
    let metadata = &header.metadata;
    let is_own = |line: &HeaderLine| match line {
        HeaderLine::KeyValue { key, .. } => key == TITLE || Grid::has_line(line),
        _ => Grid::has_line(line),
    };
    let mut lost = losses(&without_own(metadata, is_own));
    if !grid.is_upright() {
        lost.insert(
            0,
            "space directions (only the distances of samples are kept; .vti keeps all)".to_owned(),
        );
    }
    let mut file = AtomicFile::create(path).map_err(fault)?;
    let text = head(header, &grid, name.unwrap_or(name_of(metadata)));
    file.write_all(text.as_bytes()).map_err(fault)?;
    let sink = VtkSink::new(file, path, header, ByteOrder::Big, "\n");
    Ok(Created { sink: Box::new(sink), losses: lost })
}

/// All lines before the samples.
fn head(header: &Header, grid: &Grid, name: &str) -> String {
    let title = header.metadata.key_value(TITLE).unwrap_or(NO_TITLE);
    let title: String =
        title.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).take(255).collect();
    let (spacing, origin) = (joined(&grid.spacing, " "), joined(&grid.first_point(), " "));
    let section = if grid.of_cells { "CELL_DATA" } else { "POINT_DATA" };
    let count: u64 = header.extent.iter().product();
    let (name, element, components) = (encoded(name), type_name(header.element), header.components);
    let attribute = match attribute_of(&header.metadata, components) {
        Attribute::Scalars => format!("SCALARS {name} {element} {components}\nLOOKUP_TABLE default"),
        Attribute::Vectors => format!("VECTORS {name} {element}"),
        Attribute::Normals => format!("NORMALS {name} {element}"),
        Attribute::Tensors => format!("TENSORS {name} {element}"),
        Attribute::TextureCoordinates => format!("TEXTURE_COORDINATES {name} {components} {element}"),
        Attribute::Field => format!("FIELD FieldData 1\n{name} {components} {count} {element}"),
    };
    format!(
        "{MAGIC} 3.0\n{title}\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS {}\nSPACING {spacing}\n\
         ORIGIN {origin}\n{section} {count}\n{attribute}\n",
        joined(&grid.points, " ")
    )
}

/// Name written for a type: one that both VTK and readers of the first versions know, where there is one.
const fn type_name(element: ElementType) -> &'static str {
    match element {
        ElementType::U8 => "unsigned_char",
        ElementType::I8 => "char",
        ElementType::U16 => "unsigned_short",
        ElementType::I16 => "short",
        ElementType::U32 => "unsigned_int",
        ElementType::I32 => "int",
        ElementType::U64 => "vtktypeuint64",
        ElementType::I64 => "vtktypeint64",
        ElementType::F32 => "float",
        ElementType::F64 => "double",
    }
}

/// A type by its name in any case; `long` has 64 bits, as on all systems but Windows.
fn element_named(name: &str) -> Option<ElementType> {
    Some(match name.to_ascii_lowercase().as_str() {
        "unsigned_char" => ElementType::U8,
        "char" | "signed_char" => ElementType::I8,
        "unsigned_short" => ElementType::U16,
        "short" => ElementType::I16,
        "unsigned_int" => ElementType::U32,
        "int" | "vtkidtype" => ElementType::I32,
        "unsigned_long" | "unsigned_long_long" | "vtktypeuint64" => ElementType::U64,
        "long" | "long_long" | "vtktypeint64" => ElementType::I64,
        "float" => ElementType::F32,
        "double" => ElementType::F64,
        _ => return None,
    })
}

/// A name without blanks: other characters than those between `!` and `~`, and `"` and `%`, as `%` and two digits.
fn encoded(name: &str) -> String {
    let letters = name.bytes().map(|byte| match byte {
        b'"' | b'%' | 0..=b' ' | 0x7f.. => format!("%{byte:02X}"),
        _ => char::from(byte).to_string(),
    });
    letters.collect()
}

/// The name that [`encoded`] was made from.
fn decoded(name: &str) -> String {
    let mut bytes = Vec::with_capacity(name.len());
    let mut rest = name.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let digits = after.get(..2).and_then(|digits| str::from_utf8(digits).ok());
        let byte = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok()).filter(|_| first == b'%');
        bytes.push(byte.unwrap_or(first));
        rest = if byte.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
