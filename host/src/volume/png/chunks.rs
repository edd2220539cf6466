//! Chunks beside the image, and the lines of metadata that they become.

use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;

use super::{BITS, PngError, fault, pair};
use crate::volume::input::Input;
use crate::volume::metadata::is_same_name;
use crate::volume::{HeaderLine, Metadata, ReadError};

/// Prefix of keys of texts; the keyword follows.
const TEXT: &str = "png.text.";

/// Bytes of chunks that are kept at most, and of a compressed text.
const KEPT_BYTES: u32 = 1 << 24;

/// Lengths in metres of the units that NRRD files name.
const METRES: [(&str, f64); 9] = [
    ("m", 1.0),
    ("cm", 1e-2),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("µm", 1e-6),
    ("micron", 1e-6),
    ("nm", 1e-9),
    ("inch", 0.0254),
    ("in", 0.0254),
];

/// A chunk to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Chunk {
    pub(super) name: [u8; 4],
    pub(super) data: Vec<u8>,
}

/// Lines for the chunks of a file, from its first chunk on.
///
/// Texts, whatever way they are stored, and the size of pixels become readable lines, any other ancillary chunk its
/// bytes. Of a picture with a palette, what refers to the palette is left out with it.
pub(super) fn read(input: &mut Input, has_palette: bool) -> Result<Vec<HeaderLine>, ReadError> {
    let mut lines = Vec::new();
    let mut kept = 0_u32;
    loop {
        let mut head = [0; 8];
        // A file that ends early is found out where its samples are read.
        if input.read_exact(&mut head).is_err() {
            return Ok(lines);
        }
        let [a, b, c, d, name @ ..] = head;
        let bytes = u32::from_be_bytes([a, b, c, d]);
        let end = input.position() + u64::from(bytes) + 4;
        let refers_to_palette = has_palette && [b"tRNS", b"bKGD", b"sBIT", b"hIST"].contains(&&name);
        let is_kept = name[0].is_ascii_lowercase() && !refers_to_palette && !is_of_animation(&name);
        if &name == b"IEND" {
            return Ok(lines);
        }
        if is_kept {
            kept = kept.saturating_add(bytes);
            if kept > KEPT_BYTES || input.left().is_some_and(|left| left < u64::from(bytes)) {
                let name = String::from_utf8_lossy(&name).into_owned();
                return Err(fault(input.path(), PngError::Chunk { name, bytes }));
            }
            let mut data = Vec::new();
            input.take(bytes.into()).read_to_end(&mut data).map_err(|cause| input.io(cause))?;
            lines.extend(lines_of(Chunk { name, data }));
        }
        input.seek(end)?;
    }
}

fn is_of_animation(name: &[u8; 4]) -> bool {
    [b"acTL", b"fcTL", b"fdAT"].contains(&name)
}

fn lines_of(chunk: Chunk) -> Vec<HeaderLine> {
    let known = match &chunk.name {
        b"tEXt" | b"zTXt" | b"iTXt" => {
            text(&chunk).map(|(keyword, text)| vec![pair(&format!("{TEXT}{keyword}"), text)])
        }
        b"pHYs" => spacings(&chunk.data),
        _ => None,
    };
    known.unwrap_or_else(|| {
        let name = String::from_utf8_lossy(&chunk.name);
        vec![pair(&format!("png.{name}"), STANDARD.encode(&chunk.data))]
    })
}

/// Keyword and text; `None` if there is more to it, as a language.
fn text(chunk: &Chunk) -> Option<(String, String)> {
    let (keyword, rest) = at_zero(&chunk.data)?;
    let text = match &chunk.name {
        b"tEXt" => latin1(rest),
        b"zTXt" => latin1(&inflate(rest.strip_prefix(&[0])?)?),
        _ => match rest {
            [0, _, 0, 0, text @ ..] => String::from_utf8(text.to_vec()).ok()?,
            [1, 0, 0, 0, text @ ..] => String::from_utf8(inflate(text)?).ok()?,
            _ => return None,
        },
    };
    Some((latin1(keyword), text))
}

fn at_zero(data: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = data.iter().position(|byte| *byte == 0)?;
    Some((&data[..end], &data[end + 1..]))
}

fn latin1(bytes: &[u8]) -> String {
    bytes.iter().map(|&byte| char::from(byte)).collect()
}

fn inflate(data: &[u8]) -> Option<Vec<u8>> {
    let mut text = Vec::new();
    ZlibDecoder::new(data).take(KEPT_BYTES.into()).read_to_end(&mut text).ok()?;
    (text.len() < KEPT_BYTES as usize).then_some(text)
}

/// Pixels per metre as distances; `None` if the unit is not known.
fn spacings(data: &[u8]) -> Option<Vec<HeaderLine>> {
    let (&[x, y], [1]) = data.as_chunks::<4>() else { return None };
    let [x, y] = [x, y].map(u32::from_be_bytes);
    let field = |name: &str, value: String| HeaderLine::Field { name: name.to_owned(), value };
    let value = format!("{} {}", 1.0 / f64::from(x), 1.0 / f64::from(y));
    (x > 0 && y > 0).then(|| vec![field("spacings", value), field("units", "\"m\" \"m\"".to_owned())])
}

/// Chunks for what of the metadata they can hold, and the rest of the metadata.
pub(super) fn of(metadata: &Metadata) -> (Vec<Chunk>, Metadata) {
    let mut left = metadata.clone();
    let mut chunks = Vec::new();
    left.lines.retain(|line| {
        let HeaderLine::KeyValue { key, value } = line else { return true };
        let chunk = match (key.strip_prefix(TEXT), key.strip_prefix("png.")) {
            (Some(keyword), _) => text_chunk(keyword, value),
            (None, Some(name)) => raw_chunk(name, value),
            _ => None,
        };
        let is_kept = chunk.is_some();
        chunks.extend(chunk);
        !is_kept && key != BITS
    });
    if let Some(chunk) = size_of_pixels(metadata) {
        chunks.insert(0, chunk);
        left.lines.retain(|line| match line {
            HeaderLine::Field { name, .. } => !is_same_name(name, "spacings") && !is_same_name(name, "units"),
            _ => true,
        });
    }
    (chunks, left)
}

fn raw_chunk(name: &str, value: &str) -> Option<Chunk> {
    let name: [u8; 4] = name.as_bytes().try_into().ok()?;
    let is_name =
        name.iter().all(u8::is_ascii_alphabetic) && name[0].is_ascii_lowercase() && !is_of_animation(&name);
    let data = STANDARD.decode(value).ok()?;
    is_name.then_some(Chunk { name, data })
}

fn text_chunk(keyword: &str, text: &str) -> Option<Chunk> {
    let keyword =
        to_latin1(keyword).filter(|keyword| (1..80).contains(&keyword.len()) && !keyword.contains(&0))?;
    Some(match to_latin1(text).filter(|text| !text.contains(&0)) {
        Some(text) => Chunk { name: *b"tEXt", data: [&keyword[..], &[0], &text].concat() },
        None => Chunk { name: *b"iTXt", data: [&keyword[..], &[0; 5], text.as_bytes()].concat() },
    })
}

fn to_latin1(text: &str) -> Option<Vec<u8>> {
    text.chars().map(|letter| u8::try_from(letter).ok()).collect()
}

/// Distances as whole pixels per metre, where they are.
fn size_of_pixels(metadata: &Metadata) -> Option<Chunk> {
    let spacings: Vec<f64> = metadata
        .field("spacings")?
        .split_whitespace()
        .map(|word| word.parse().ok())
        .collect::<Option<_>>()?;
    let mut units = metadata.field("units")?.split('"').skip(1).step_by(2);
    let mut data = Vec::new();
    for spacing in spacings.first_chunk::<2>()? {
        let unit = units.next()?;
        let (_, metres) = METRES.into_iter().find(|(name, _)| *name == unit)?;
        let per_metre = 1.0 / (spacing * metres);
        let whole = per_metre.round();
        let is_exact =
            (per_metre - whole).abs() <= per_metre * 1e-9 && (1.0..=f64::from(i32::MAX)).contains(&whole);
        data.extend((is_exact.then_some(whole)? as u32).to_be_bytes());
    }
    data.push(1);
    Some(Chunk { name: *b"pHYs", data })
}
