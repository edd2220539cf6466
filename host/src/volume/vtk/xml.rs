//! XML files: markup that describes arrays, and samples in its text or behind it.
//!
//! Source: *VTK File Formats* (Kitware), part "XML File Formats"; class `vtkXMLDataParser` for what stands before the
//! samples: the number of their bytes, or a table of compressed blocks.

use std::io::{self, BufRead, Read, Write};
use std::path::Path;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::VtkError;
use super::array::{Array, Attribute, attribute_of, choose, name_of, without_own};
use super::blocks::{Blocks, Compressor, Words};
use super::body::{Body, Plain, VtkSource, damaged};
use super::bytes::Bytes;
use super::grid::{Grid, joined};
use super::parts::{Parts, Store};
use super::sink::{VtkSink, word_bytes};
use super::text::Text;
use crate::atomic::AtomicFile;
use crate::volume::error::excerpt;
use crate::volume::input::Input;
use crate::volume::joined::beside;
use crate::volume::pieces::PieceSource;
use crate::volume::stored::{Encoding, Place, Stored};
use crate::volume::{
    Axis, ByteOrder, Created, ElementType, FileFormat, Header, Metadata, Origin, ReadError, Source,
    WriteError, WriteOptions, losses,
};

/// Longest tag, and longest text between tags beside samples, that is read.
const TAG_BYTES: u64 = 1 << 20;

/// Where the samples of an array are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Values {
    /// Decimal numbers from this byte of the file on.
    Text(u64),
    /// Base64 from this byte of the file on.
    Base64(u64),
    /// So many bytes, or characters, behind the start of the appended data.
    Appended(u64),
}

/// How the arrays of a file lie in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    words: Words,
    compressor: Option<Compressor>,
    /// First byte of the appended data, and whether they are in base64.
    appended: Option<(u64, bool)>,
}

/// A tag of a piece, and what is in it.
#[derive(Default)]
struct Piece {
    /// First index and points along each axis; all, if it does not say so. A piece may be empty.
    extent: Option<([i64; 3], [u64; 3])>,
    /// The file that it lies in, if it is another.
    source: Option<String>,
    arrays: Vec<Array<Values>>,
}

/// All that the markup says.
struct Document {
    layout: Layout,
    grid: Option<Grid>,
    /// Arrays that are in no piece: those that every file of a list has.
    arrays: Vec<Array<Values>>,
    pieces: Vec<Piece>,
    /// Whose arrays follow, and the names of those that are active.
    section: Option<Section>,
}

struct Section {
    of_cells: bool,
    active: Vec<(Attribute, String)>,
}

/// Markup that is read a tag at a time; samples in its text are passed over.
struct Markup {
    reader: Reader<io::Take<Input>>,
}

/// Opens a file at the array of that name, or the one that is active.
pub(super) fn open(input: Input, wanted: Option<&str>) -> Result<Box<dyn Source>, ReadError> {
    Ok(open_image(input, wanted, false)?.0)
}

/// Opens a file that has a part of an image, at the array of that name; and the points that it has.
pub(super) fn open_part(path: &Path, name: &str) -> Result<(Box<dyn Source>, Grid), ReadError> {
    open_image(Input::open(path)?, Some(name), true)
}

fn open_image(
    input: Input,
    wanted: Option<&str>,
    is_part: bool,
) -> Result<(Box<dyn Source>, Grid), ReadError> {
    let path = input.path().to_owned();
    let fault =
        |cause| ReadError::Format { path: path.clone(), format: FileFormat::VtkXml, cause: Box::new(cause) };
    let mut markup = Markup { reader: Reader::from_reader(input.take(TAG_BYTES)) };
    let document = Document::read(&mut markup).map_err(fault)?;
    let input = markup.reader.into_inner().into_inner();
    let mut grid = document.grid(is_part).map_err(fault)?;
    let (array, mut lines) = choose(document.arrays(), wanted).map_err(fault)?;
    let element = array
        .element
        .clone()
        .map_err(|found| fault(VtkError::Element { name: excerpt(&array.name), found: excerpt(&found) }))?;
    grid.of_cells = array.of_cells;
    lines.extend(grid.lines());
    let layout = document.layout;
    let byte_order = layout.byte_order(array.data, element);
    let source = Origin { format: FileFormat::VtkXml, byte_order, fortran_order: false };
    let metadata = Metadata { axes: Axis::SPACE.to_vec(), source, lines };
    let header = Header { extent: grid.samples(), components: array.components, steps: 1, element, metadata };
    grid.count().and_then(|_| header.bytes()).ok_or_else(|| fault(VtkError::TooLarge))?;
    if document.is_whole(&grid) {
        return Ok((layout.open(input, array.data, header)?, grid));
    }
    if input.left().is_none() {
        return Err(fault(VtkError::Pipe));
    }
    let pieces = document.stores(&array, &path).map_err(fault)?;
    let parts = Parts::new(&path, (header, grid.clone(), array.name), layout, pieces).map_err(fault)?;
    Ok((Box::new(PieceSource::new(parts)), grid))
}

impl Layout {
    /// Order of the bytes of an array.
    const fn byte_order(&self, values: Values, element: ElementType) -> ByteOrder {
        match values {
            Values::Text(_) => ByteOrder::Little,
            _ if element.bytes() == 1 => ByteOrder::Little,
            _ => self.words.byte_order,
        }
    }

    /// The samples of an array of `header`, which 64 bits count the bytes of.
    pub(super) fn open(
        &self,
        input: Input,
        values: Values,
        header: Header,
    ) -> Result<Box<dyn Source>, ReadError> {
        let (path, element, total) = (input.path().to_owned(), header.element, header.bytes().unwrap_or(0));
        let fault = |cause| ReadError::Format {
            path: path.clone(),
            format: FileFormat::VtkXml,
            cause: Box::new(cause),
        };
        let byte_order = self.byte_order(values, element);
        let (start, is_base64) = match values {
            Values::Text(start) => {
                let body = Box::new(Text::new(input, start, element, false)?);
                return Ok(Box::new(VtkSource { header, body, byte_order, path, at: 0 }));
            }
            Values::Base64(start) => (start, true),
            Values::Appended(offset) => {
                let (start, is_base64) =
                    self.appended.ok_or_else(|| fault(VtkError::Missing { what: "the tag AppendedData" }))?;
                (start.saturating_add(offset), is_base64)
            }
        };
        let mut bytes = Bytes::new(input, start, is_base64)?;
        let body: Box<dyn Body> = if let Some(compressor) = self.compressor {
            Box::new(Blocks::new(bytes, (self.words, compressor), total)?)
        } else {
            let found = self.words.read(&mut bytes).map_err(|cause| damaged(&path, cause))?;
            if found != total {
                return Err(fault(VtkError::Bytes { expected: total, found }));
            }
            if !is_base64 {
                let place = Place { encoding: Encoding::Raw, byte_order, skip: 0, is_open_ended: true };
                return Ok(Box::new(Stored::new(bytes.into_input(), header, place)?));
            }
            Box::new(Plain { bytes, head: self.words.bytes() })
        };
        Ok(Box::new(VtkSource { header, body, byte_order, path, at: 0 }))
    }
}

impl Markup {
    /// First byte of the file behind what was read.
    fn position(&self) -> u64 {
        self.reader.get_ref().get_ref().position()
    }

    /// The next tag or text, in `buffer`.
    fn event<'b>(&mut self, buffer: &'b mut Vec<u8>) -> Result<Event<'b>, VtkError> {
        buffer.clear();
        self.reader.get_mut().set_limit(TAG_BYTES);
        let event = self.reader.read_event_into(buffer);
        match event {
            Ok(Event::Eof) | Err(_) if self.reader.get_ref().limit() == 0 => {
                Err(VtkError::TooLong { limit: TAG_BYTES })
            }
            Ok(event) => Ok(event),
            Err(cause) => Err(VtkError::Xml(cause.to_string())),
        }
    }

    /// Passes over bytes up to one; whether there is one. It is not consumed.
    fn skip_to(&mut self, wanted: u8) -> Result<bool, VtkError> {
        self.reader.get_mut().set_limit(u64::MAX);
        let mut stream = self.reader.stream();
        loop {
            let bytes = stream.fill_buf().map_err(|cause| VtkError::Xml(cause.to_string()))?;
            let end = bytes.iter().position(|&byte| byte == wanted);
            let (count, is_last) = (end.unwrap_or(bytes.len()), bytes.is_empty());
            stream.consume(count);
            if end.is_some() || is_last {
                return Ok(end.is_some());
            }
        }
    }
}

impl Document {
    /// Reads tags up to the appended data, or all if there are none.
    fn read(markup: &mut Markup) -> Result<Self, VtkError> {
        let words = Words { byte_order: ByteOrder::Little, is_wide: false };
        let mut document = Self {
            layout: Layout { words, compressor: None, appended: None },
            grid: None,
            arrays: Vec::new(),
            pieces: Vec::new(),
            section: None,
        };
        let mut is_known = false;
        let mut buffer = Vec::new();
        while document.layout.appended.is_none() {
            let (tag, is_empty) = match markup.event(&mut buffer)? {
                Event::Start(tag) => (tag.into_owned(), false),
                Event::Empty(tag) => (tag.into_owned(), true),
                Event::End(tag) => {
                    if is_section(tag.name().as_ref()) {
                        document.section = None;
                    }
                    continue;
                }
                Event::Eof => break,
                _ => continue,
            };
            is_known |= tag.name().as_ref() == "VTKFile";
            if !is_known {
                return Err(VtkError::Missing { what: "the tag VTKFile" });
            }
            document.tag(&tag, is_empty, markup)?;
        }
        Ok(document)
    }

    /// The points of the whole, or, of a file that has a part, of its only piece.
    fn grid(&self, is_part: bool) -> Result<Grid, VtkError> {
        let mut grid = self.grid.clone().ok_or(VtkError::Missing { what: "the tag ImageData" })?;
        if let ([Piece { extent: Some(extent), .. }], true) = (&self.pieces[..], is_part) {
            (grid.start, grid.points) = *extent;
        }
        Ok(grid)
    }

    /// The arrays to choose from.
    fn arrays(&self) -> Vec<Array<Values>> {
        let first = self.pieces.first().map(|piece| piece.arrays.clone());
        if self.arrays.is_empty() { first.unwrap_or_default() } else { self.arrays.clone() }
    }

    /// Whether the image lies in one piece, in this file.
    fn is_whole(&self, grid: &Grid) -> bool {
        match &self.pieces[..] {
            [] => true,
            [Piece { extent, source: None, .. }] => {
                extent.is_none_or(|extent| extent == (grid.start, grid.points))
            }
            _ => false,
        }
    }

    /// The points of each piece, and where an array has its samples.
    fn stores(self, array: &Array<Values>, path: &Path) -> Result<Vec<(Grid, Store)>, VtkError> {
        let whole = self.grid.as_ref().map(|grid| (grid.start, grid.points));
        let store = |piece: Piece| {
            let (start, points) = piece.extent.or(whole)?;
            let grid = Grid { start, of_cells: array.of_cells, ..Grid::plain(points) };
            let found = piece.arrays.iter().find(|other| other.is_like(array));
            let here = found.map(|found| Store::Here(found.data));
            Some((grid, piece.source.map(|file| Store::File(beside(path, &file))).or(here)?))
        };
        let missing = || VtkError::Missing { what: "the array of one of its pieces" };
        let is_empty = |piece: &Piece| piece.extent.is_some_and(|(_, points)| points.contains(&0));
        let pieces = self.pieces.into_iter().filter(|piece| !is_empty(piece));
        pieces.map(|piece| store(piece).ok_or_else(missing)).collect()
    }

    fn tag(&mut self, tag: &BytesStart<'_>, is_empty: bool, markup: &mut Markup) -> Result<(), VtkError> {
        match tag.name().as_ref() {
            "VTKFile" => self.file(tag)?,
            "ImageData" | "PImageData" => self.grid = Some(grid(tag)?),
            "Piece" => self.piece(tag)?,
            name if is_section(name) && !is_empty => self.section = section(tag)?,
            "DataArray" | "Array" | "PDataArray" => self.array(tag, is_empty, markup)?,
            "AppendedData" => {
                let is_base64 = match required(tag, "encoding", "the encoding of AppendedData")?.as_str() {
                    "raw" => false,
                    "base64" => true,
                    other => return Err(value("the encoding of AppendedData", other, "raw or base64")),
                };
                if !markup.skip_to(b'_')? {
                    return Err(VtkError::Missing { what: "the mark _ before the appended data" });
                }
                self.layout.appended = Some((markup.position() + 1, is_base64));
            }
            _ => {}
        }
        Ok(())
    }

    fn file(&mut self, tag: &BytesStart<'_>) -> Result<(), VtkError> {
        let kind = required(tag, "type", "the type of VTKFile")?;
        if !matches!(kind.as_str(), "ImageData" | "PImageData") {
            return Err(VtkError::Kind { found: excerpt(&kind) });
        }
        self.layout.words.byte_order = match attribute(tag, "byte_order")?.as_deref() {
            None | Some("LittleEndian") => ByteOrder::Little,
            Some("BigEndian") => ByteOrder::Big,
            Some(other) => return Err(value("byte_order", other, "LittleEndian or BigEndian")),
        };
        self.layout.words.is_wide = match attribute(tag, "header_type")?.as_deref() {
            None | Some("UInt32") => false,
            Some("UInt64") => true,
            Some(other) => return Err(value("header_type", other, "UInt32 or UInt64")),
        };
        self.layout.compressor = match attribute(tag, "compressor")?.as_deref() {
            None | Some("") => None,
            Some(name) => match Compressor::named(name) {
                None => return Err(VtkError::Compressor { found: excerpt(name) }),
                known => known,
            },
        };
        Ok(())
    }

    fn piece(&mut self, tag: &BytesStart<'_>) -> Result<(), VtkError> {
        let text = attribute(tag, "Extent")?;
        let extent = text.as_deref().map(ends).transpose()?;
        self.pieces.push(Piece { extent, source: attribute(tag, "Source")?, arrays: Vec::new() });
        Ok(())
    }

    fn array(&mut self, tag: &BytesStart<'_>, is_empty: bool, markup: &mut Markup) -> Result<(), VtkError> {
        let format = attribute(tag, "format")?.unwrap_or_else(|| "ascii".to_owned());
        let start = markup.position();
        let data = match format.as_str() {
            "ascii" => Values::Text(start),
            "binary" => Values::Base64(start),
            "appended" => Values::Appended(number(tag, "offset", "the offset of an array")?.unwrap_or(0)),
            other => return Err(value("the format of an array", other, "ascii, binary or appended")),
        };
        if !is_empty && !matches!(data, Values::Appended(_)) {
            markup.skip_to(b'<')?;
        }
        let Some(section) = &self.section else { return Ok(()) };
        let components = number(tag, "NumberOfComponents", "NumberOfComponents")?.unwrap_or(1);
        let found = u32::try_from(components).ok().filter(|&found| found > 0);
        let components = found
            .ok_or_else(|| value("NumberOfComponents", &components.to_string(), "from 1 to 4294967295"))?;
        let name = attribute(tag, "Name")?.unwrap_or_default();
        let kind = required(tag, "type", "the type of an array")?;
        let marked = section.active.iter().find(|(_, active)| *active == name);
        let arrays = match self.pieces.last_mut() {
            Some(piece) if tag.name().as_ref() != "PDataArray" => &mut piece.arrays,
            _ => &mut self.arrays,
        };
        arrays.push(Array {
            element: element_named(&kind).ok_or(kind),
            components,
            of_cells: section.of_cells,
            attribute: marked.map_or(Attribute::Field, |(attribute, _)| *attribute),
            name,
            data,
        });
        Ok(())
    }
}

fn is_section(name: &str) -> bool {
    matches!(name, "PointData" | "CellData" | "FieldData" | "PPointData" | "PCellData" | "PFieldData")
}

/// What a tag of points or cells says; that of fields says nothing.
fn section(tag: &BytesStart<'_>) -> Result<Option<Section>, VtkError> {
    let of_cells = match tag.name().as_ref() {
        "PointData" | "PPointData" => false,
        "CellData" | "PCellData" => true,
        _ => return Ok(None),
    };
    let mut active = Vec::new();
    for kind in Attribute::ALL {
        if let Some(name) = attribute(tag, kind.name())? {
            active.push((kind, name));
        }
    }
    Ok(Some(Section { of_cells, active }))
}

fn grid(tag: &BytesStart<'_>) -> Result<Grid, VtkError> {
    let (start, points) = extent(&required(tag, "WholeExtent", "WholeExtent")?)?;
    let mut grid = Grid { start, ..Grid::plain(points) };
    if let Some(origin) = numbers(tag, "Origin")? {
        grid.origin = origin;
    }
    if let Some(spacing) = numbers(tag, "Spacing")? {
        grid.spacing = spacing;
    }
    if let Some(direction) = numbers(tag, "Direction")? {
        grid.direction = direction;
    }
    Ok(grid)
}

/// As [`ends`], of at least one point along each axis.
fn extent(text: &str) -> Result<([i64; 3], [u64; 3]), VtkError> {
    let (start, points) = ends(text)?;
    let is_some = points.iter().all(|&count| count > 0);
    is_some
        .then_some((start, points))
        .ok_or_else(|| value("an extent", text, "at least one point along each axis"))
}

/// Reads `0 3 0 2 0 1`: first and last index along each axis; the first and the number of points there, which may be 0.
fn ends(text: &str) -> Result<([i64; 3], [u64; 3]), VtkError> {
    let fault = || value("an extent", text, "first and last index along each of three axes");
    let ends =
        text.split_whitespace().map(str::parse).collect::<Result<Vec<i64>, _>>().map_err(|_| fault())?;
    let [x, x1, y, y1, z, z1] = ends[..] else { return Err(fault()) };
    let count = |first: i64, last: i64| last.checked_sub(first)?.checked_add(1).filter(|&count| count >= 0);
    let count = |first, last| count(first, last).map(i64::unsigned_abs).ok_or_else(fault);
    Ok(([x, y, z], [count(x, x1)?, count(y, y1)?, count(z, z1)?]))
}

fn numbers<const COUNT: usize>(
    tag: &BytesStart<'_>,
    name: &'static str,
) -> Result<Option<[f64; COUNT]>, VtkError> {
    let Some(text) = attribute(tag, name)? else { return Ok(None) };
    let found: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    let found = found.and_then(|found| found.try_into().ok());
    found.map(Some).ok_or_else(|| value(name, &text, "as many numbers as it has to be"))
}

fn number(tag: &BytesStart<'_>, name: &str, what: &'static str) -> Result<Option<u64>, VtkError> {
    let Some(text) = attribute(tag, name)? else { return Ok(None) };
    text.trim().parse().map(Some).map_err(|_| value(what, &text, "a whole number from 0 up"))
}

fn value(what: &'static str, found: &str, expected: &'static str) -> VtkError {
    VtkError::Value { what, value: excerpt(found), expected }
}

fn required(tag: &BytesStart<'_>, name: &str, what: &'static str) -> Result<String, VtkError> {
    attribute(tag, name)?.ok_or(VtkError::Missing { what })
}

fn attribute(tag: &BytesStart<'_>, name: &str) -> Result<Option<String>, VtkError> {
    let found = tag.try_get_attribute(name).map_err(|cause| VtkError::Xml(cause.to_string()))?;
    let Some(found) = found else { return Ok(None) };
    let text = found.normalized_value(quick_xml::XmlVersion::Explicit1_0);
    Ok(Some(text.map_err(|cause| VtkError::Xml(cause.to_string()))?.into_owned()))
}

/// Begins a file of appended samples, raw or in compressed blocks.
pub(super) fn create(
    path: &Path,
    header: &Header,
    options: &WriteOptions,
    name: Option<&str>,
) -> Result<Created, WriteError> {
    let fault = |cause| WriteError::Io { path: path.to_owned(), cause };
    let byte_order = options.byte_order.unwrap_or(header.metadata.source.byte_order);
    let grid = Grid::of(header);
    let mut file = AtomicFile::create(path).map_err(fault)?;
    let text = head(header, &grid, name.unwrap_or(name_of(&header.metadata)), byte_order, options.gzip);
    file.write_all(text.as_bytes()).map_err(fault)?;
    if !options.gzip {
        let bytes = header.bytes().unwrap_or(u64::MAX);
        file.write_all(&word_bytes(bytes, byte_order)).map_err(fault)?;
    }
    let mut sink = VtkSink::new(file, path, header, byte_order, "\n  </AppendedData>\n</VTKFile>\n");
    if options.gzip {
        sink = sink.in_blocks().map_err(fault)?;
    }
    let lost = losses(&without_own(&header.metadata, Grid::has_line));
    Ok(Created { sink: Box::new(sink), losses: lost })
}

/// All markup before the samples.
fn head(header: &Header, grid: &Grid, name: &str, byte_order: ByteOrder, is_compressed: bool) -> String {
    let order = match byte_order {
        ByteOrder::Little => "LittleEndian",
        ByteOrder::Big => "BigEndian",
    };
    let compressor =
        if is_compressed { format!(" compressor=\"{}\"", Compressor::Zlib.name()) } else { String::new() };
    let ends: [i64; 6] = std::array::from_fn(|at| {
        let (axis, is_last) = (at / 2, at % 2);
        grid.start[axis] + is_last as i64 * (grid.points[axis] as i64 - 1)
    });
    let (extent, origin, spacing) =
        (joined(&ends, " "), joined(&grid.origin, " "), joined(&grid.spacing, " "));
    let direction = joined(&grid.direction, " ");
    let section = if grid.of_cells { "CellData" } else { "PointData" };
    let name = escaped(name);
    let active = match attribute_of(&header.metadata, header.components) {
        Attribute::Field => String::new(),
        attribute => format!(" {}=\"{name}\"", attribute.name()),
    };
    let (element, components) = (type_name(header.element), header.components);
    format!(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"{order}\" header_type=\"UInt64\"{compressor}>\n\
         \x20 <ImageData WholeExtent=\"{extent}\" Origin=\"{origin}\" Spacing=\"{spacing}\" Direction=\"{direction}\">\n\
         \x20   <Piece Extent=\"{extent}\">\n\
         \x20     <{section}{active}>\n\
         \x20       <DataArray type=\"{element}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
         format=\"appended\" offset=\"0\"/>\n\
         \x20     </{section}>\n\
         \x20   </Piece>\n\
         \x20 </ImageData>\n\
         \x20 <AppendedData encoding=\"raw\">\n   _"
    )
}

/// A name as the value of an attribute.
fn escaped(name: &str) -> String {
    let kept = |letter: &char| !letter.is_control() || matches!(letter, '\t' | '\n' | '\r');
    let letters = name.chars().filter(kept).map(|letter| match letter {
        '&' | '<' | '>' | '"' | '\t' | '\n' | '\r' => format!("&#{};", u32::from(letter)),
        _ => letter.to_string(),
    });
    letters.collect()
}

const fn type_name(element: ElementType) -> &'static str {
    match element {
        ElementType::U8 => "UInt8",
        ElementType::I8 => "Int8",
        ElementType::U16 => "UInt16",
        ElementType::I16 => "Int16",
        ElementType::U32 => "UInt32",
        ElementType::I32 => "Int32",
        ElementType::U64 => "UInt64",
        ElementType::I64 => "Int64",
        ElementType::F32 => "Float32",
        ElementType::F64 => "Float64",
    }
}

fn element_named(name: &str) -> Option<ElementType> {
    ElementType::ALL.into_iter().find(|element| type_name(*element) == name)
}
