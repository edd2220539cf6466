//! Shape, chunks, samples and axes of an array, as its metadata say.
//!
//! Sources: *Zarr core specification*, versions 2 and 3; *OME-Zarr specification* for the types of axes; the
//! attribute `_ARRAY_DIMENSIONS` is xarray's.

use serde_json::{Map, Value};

use super::ZarrError;
use crate::volume::error::excerpt;
use crate::volume::{ByteOrder, ElementType};

/// Most bytes of a chunk, or of a row of samples. Both must be in memory as a whole.
pub(super) const LARGEST_BYTES: u64 = 1 << 30;

/// Bytes of a chunk that may stand beside few samples; more are taken only of an array that has as many.
const SPARE_BYTES: u64 = 1 << 26;

/// Most bytes of the index of a shard.
pub(super) const INDEX_BYTES: u64 = 1 << 26;

/// What lies along an axis of an array: its place in the order time, z, y, x, component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Role {
    Time,
    Z,
    Y,
    X,
    Component,
}

/// An array, understood.
#[derive(Debug)]
pub(super) struct Layout {
    /// Samples along each axis of the array, slowest first.
    pub(super) shape: Vec<u64>,
    /// Samples of a chunk that is decoded as a whole, along each axis.
    pub(super) chunk: Vec<u64>,
    /// What lies along each axis.
    pub(super) roles: Vec<Role>,
    /// Type of a value; of floats of 16 bits, that of their bits.
    pub(super) element: ElementType,
    pub(super) is_half: bool,
    pub(super) byte_order: ByteOrder,
    /// Names of the axes where the array gives others than those of the roles.
    pub(super) names: Option<Value>,
    pub(super) attributes: Map<String, Value>,
}

impl Layout {
    /// Understands the metadata of an array, and the axes that its image names.
    pub(super) fn new(
        metadata: &Map<String, Value>,
        image: Option<&Map<String, Value>>,
    ) -> Result<Self, ZarrError> {
        let is_v2 = metadata.get("zarr_format").and_then(Value::as_u64) == Some(2);
        let shape = numbers(metadata.get("shape"), "shape")?;
        let (outer, inner) = chunks(metadata, is_v2)?;
        let (element, is_half, byte_order) = samples(metadata, is_v2)?;
        if outer.len() != shape.len() || inner.len() != shape.len() {
            return Err(ZarrError::Metadata { what: "shape of chunks" });
        }
        let total = product(&shape).and_then(|count| count.checked_mul(element.bytes() as u64));
        if total.is_none_or(|bytes| bytes == 0) {
            return Err(ZarrError::Extent { shape: excerpt(&format!("{shape:?}")) });
        }
        within(
            "a chunk",
            product(&inner).map(|count| count.saturating_mul(element.bytes() as u64)),
            LARGEST_BYTES.min(total.unwrap_or(0).saturating_mul(2).max(SPARE_BYTES)),
        )?;
        let pieces: Vec<u64> =
            outer.iter().zip(&inner).map(|(outer, inner)| outer.div_ceil(*inner)).collect();
        within("the index of a shard", product(&pieces).map(|count| count.saturating_mul(16)), INDEX_BYTES)?;
        let attributes = metadata.get("attributes").and_then(Value::as_object).cloned().unwrap_or_default();
        let names = metadata.get("dimension_names").or_else(|| attributes.get("_ARRAY_DIMENSIONS"));
        let named = image.and_then(|image| ome_roles(image, shape.len())).or_else(|| roles_named(names?));
        let roles = match named.filter(|roles| roles.len() == shape.len()) {
            Some(roles) => roles,
            None => roles_of_rank(&shape)?,
        };
        let names = names
            .filter(|_| names.and_then(roles_named).is_none() && metadata.contains_key("dimension_names"));
        let names = names.cloned();
        Ok(Self { shape, chunk: inner, roles, element, is_half, byte_order, names, attributes })
    }

    /// Samples along the axis of that role, 1 where there is none.
    pub(super) fn count(&self, role: Role) -> u64 {
        self.axis(role).map_or(1, |axis| self.shape[axis])
    }

    /// Bytes of a chunk that is decoded as a whole.
    pub(super) fn chunk_bytes(&self) -> u64 {
        product(&self.chunk).unwrap_or(u64::MAX).saturating_mul(self.element.bytes() as u64)
    }

    /// The axis of that role.
    pub(super) fn axis(&self, role: Role) -> Option<usize> {
        self.roles.iter().position(|found| *found == role)
    }
}

fn within(what: &'static str, bytes: Option<u64>, limit: u64) -> Result<(), ZarrError> {
    let bytes = bytes.unwrap_or(u64::MAX);
    if bytes > limit { Err(ZarrError::TooLarge { what, bytes, limit }) } else { Ok(()) }
}

fn product(counts: &[u64]) -> Option<u64> {
    counts.iter().try_fold(1_u64, |product, &count| product.checked_mul(count))
}

fn numbers(list: Option<&Value>, what: &'static str) -> Result<Vec<u64>, ZarrError> {
    let numbers = list.and_then(Value::as_array).map(|list| list.iter().map(Value::as_u64).collect());
    numbers.flatten().ok_or(ZarrError::Metadata { what })
}

/// Shape of chunks, and of the inner chunks of shards.
fn chunks(metadata: &Map<String, Value>, is_v2: bool) -> Result<(Vec<u64>, Vec<u64>), ZarrError> {
    const WHAT: &str = "shape of chunks";
    let positive = |list: Option<&Value>| {
        let list = numbers(list, WHAT)?;
        if list.contains(&0) { Err(ZarrError::Metadata { what: WHAT }) } else { Ok(list) }
    };
    if is_v2 {
        let chunks = positive(metadata.get("chunks"))?;
        return Ok((chunks.clone(), chunks));
    }
    let grid = metadata.get("chunk_grid").and_then(Value::as_object);
    if grid.and_then(|grid| grid.get("name")?.as_str()) != Some("regular") {
        return Err(ZarrError::Metadata { what: "regular chunk_grid" });
    }
    let outer = positive(grid.and_then(|grid| grid.get("configuration")?.get("chunk_shape")))?;
    let mut inner = outer.clone();
    let mut codecs = metadata.get("codecs");
    while let Some(shard) = codecs.and_then(|codecs| codec(codecs, "sharding_indexed")) {
        inner = positive(shard.get("chunk_shape"))?;
        codecs = shard.get("codecs");
    }
    Ok((outer, inner))
}

/// Configuration of the codec of that name.
fn codec<'a>(codecs: &'a Value, name: &str) -> Option<&'a Value> {
    let found =
        codecs.as_array()?.iter().find(|codec| codec.get("name").and_then(Value::as_str) == Some(name));
    found?.get("configuration")
}

/// Type of a value, whether it is the bits of a float of 16, and the order of its bytes. Truth values are bytes.
fn samples(metadata: &Map<String, Value>, is_v2: bool) -> Result<(ElementType, bool, ByteOrder), ZarrError> {
    let name = metadata
        .get(if is_v2 { "dtype" } else { "data_type" })
        .ok_or(ZarrError::Metadata { what: "data type" })?;
    let unknown = || ZarrError::Element { found: excerpt(&name.to_string()) };
    let text = name.as_str().ok_or_else(unknown)?;
    let kind = if is_v2 { text.trim_start_matches(['<', '>', '|']) } else { text };
    let name_of = |element: &ElementType| if is_v2 { v2_name(*element) } else { v3_name(*element) };
    let is_half = kind == if is_v2 { "f2" } else { "float16" };
    let element = match kind {
        "f2" | "float16" if is_half => ElementType::U16,
        "b1" | "bool" => ElementType::U8,
        kind => ElementType::ALL.into_iter().find(|element| name_of(element) == kind).ok_or_else(unknown)?,
    };
    let is_big = match is_v2 {
        true => text.starts_with('>'),
        false => metadata.get("codecs").is_some_and(is_big_endian),
    };
    let byte_order = if is_big && element.bytes() > 1 { ByteOrder::Big } else { ByteOrder::Little };
    Ok((element, is_half, byte_order))
}

fn is_big_endian(codecs: &Value) -> bool {
    let mut codecs = Some(codecs);
    while let Some(shard) = codecs.and_then(|codecs| codec(codecs, "sharding_indexed")) {
        codecs = shard.get("codecs");
    }
    let endian = codecs.and_then(|codecs| codec(codecs, "bytes")?.get("endian")?.as_str());
    endian == Some("big")
}

/// Name of a type in version 3.
pub(super) const fn v3_name(element: ElementType) -> &'static str {
    match element {
        ElementType::U8 => "uint8",
        ElementType::I8 => "int8",
        ElementType::U16 => "uint16",
        ElementType::I16 => "int16",
        ElementType::U32 => "uint32",
        ElementType::I32 => "int32",
        ElementType::U64 => "uint64",
        ElementType::I64 => "int64",
        ElementType::F32 => "float32",
        ElementType::F64 => "float64",
    }
}

const fn v2_name(element: ElementType) -> &'static str {
    match element {
        ElementType::U8 => "u1",
        ElementType::I8 => "i1",
        ElementType::U16 => "u2",
        ElementType::I16 => "i2",
        ElementType::U32 => "u4",
        ElementType::I32 => "i4",
        ElementType::U64 => "u8",
        ElementType::I64 => "i8",
        ElementType::F32 => "f4",
        ElementType::F64 => "f8",
    }
}

/// Roles by the axes of an image: their types, and x last of those of space.
fn ome_roles(image: &Map<String, Value>, rank: usize) -> Option<Vec<Role>> {
    let axes = image.get("axes")?.as_array().filter(|axes| axes.len() == rank)?;
    let text = |axis: &Value, key: &str| axis.get(key).and_then(Value::as_str).map(str::to_owned);
    let names: Vec<String> = axes.iter().map(|axis| text(axis, "name")).collect::<Option<_>>()?;
    if let Some(roles) = distinct(names.iter().map(|name| role_named(name)).collect::<Option<_>>()?) {
        return Some(roles);
    }
    let mut space = [Role::X, Role::Y, Role::Z].into_iter();
    let mut roles = Vec::new();
    for axis in axes.iter().rev() {
        roles.push(match text(axis, "type").as_deref() {
            Some("time") => Role::Time,
            Some("channel") => Role::Component,
            _ => space.next()?,
        });
    }
    roles.reverse();
    distinct(roles)
}

/// Roles by the names of the axes, if all are known.
fn roles_named(names: &Value) -> Option<Vec<Role>> {
    let roles = names.as_array()?.iter().map(|name| role_named(name.as_str()?)).collect::<Option<_>>();
    distinct(roles?)
}

fn role_named(name: &str) -> Option<Role> {
    Some(match name.to_ascii_lowercase().as_str() {
        "t" | "time" => Role::Time,
        "z" => Role::Z,
        "y" => Role::Y,
        "x" => Role::X,
        "c" | "channel" | "component" => Role::Component,
        _ => return None,
    })
}

fn distinct(roles: Vec<Role>) -> Option<Vec<Role>> {
    let mut sorted = roles.clone();
    sorted.sort();
    sorted.dedup();
    (sorted.len() == roles.len()).then_some(roles)
}

/// Roles of axes without names: the order of OME-Zarr, time, channel, z, y, x, without the channel in four axes.
fn roles_of_rank(shape: &[u64]) -> Result<Vec<Role>, ZarrError> {
    use Role::{Component, Time, X, Y, Z};
    match shape.len() {
        1 => Ok(vec![X]),
        2 => Ok(vec![Y, X]),
        3 => Ok(vec![Z, Y, X]),
        4 => Ok(vec![Time, Z, Y, X]),
        5 => Ok(vec![Time, Component, Z, Y, X]),
        _ => Err(ZarrError::Axes { axes: excerpt(&format!("{shape:?}")) }),
    }
}
