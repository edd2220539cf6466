//! Arrays as sinks: chunks are written a slab at a time, into a folder that shows when it is whole.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rayon::prelude::*;
use serde_json::{Value, json};
use zarrs::array::{Array, ArrayBytes, ArrayMetadata};
use zarrs::filesystem::FilesystemStore;

use super::boxes::{Counts, Strides, canonical, copy};
use super::layout::{Role, v3_name};
use super::{lines, ome};
use crate::atomic::AtomicTree;
use crate::volume::element::reorder;
use crate::volume::{ByteOrder, FileFormat, Header, Sink, WriteError, WriteOptions};

/// Bytes of a slab at most, unless it is a single plane.
const SLAB_BYTES: u64 = 1 << 26;

/// A Zarr folder under construction.
pub(super) struct ZarrSink {
    folder: AtomicTree,
    array: Array<FilesystemStore>,
    path: PathBuf,
    header: Header,
    /// What lies along each axis of the array, slowest first.
    roles: Vec<Role>,
    /// Samples of a chunk along z, y, x and component.
    chunk: Counts,
    /// Values that wait for the rest of their slab.
    slab: Vec<u8>,
    /// Time step and first plane of the slab.
    step: u64,
    z: u64,
    written: u64,
}

/// Begins a folder: an image of OME-Zarr if the name ends in `.ome.zarr`, else an array.
pub(super) fn create(path: &Path, header: &Header, options: &WriteOptions) -> Result<ZarrSink, WriteError> {
    let fault = |cause| WriteError::Io { path: path.to_owned(), cause };
    let is_image = path.to_string_lossy().to_ascii_lowercase().ends_with(".ome.zarr");
    refuse_foreign(path)?;
    let folder = AtomicTree::create(path).map_err(fault)?;
    let attributes = if is_image { ome::attributes(header) } else { lines::attributes(&header.metadata) };
    let mut inner = folder.path().to_owned();
    let roles = if is_image { image_roles(header) } else { array_roles(header) };
    let chunk = chunk(header, is_image);
    let mut metadata = metadata(header, options, &roles, chunk);
    if is_image {
        let group = json!({ "zarr_format": 3, "node_type": "group", "attributes": attributes });
        fs::write(inner.join("zarr.json"), format!("{group:#}\n")).map_err(fault)?;
        inner.push("0");
        if let Some(kept) = lines::json_of(&header.metadata, lines::ATTRIBUTES).filter(Value::is_object) {
            metadata["attributes"] = kept;
        }
    } else {
        metadata["attributes"] = Value::Object(attributes);
        if let Some(names) = lines::json_of(&header.metadata, lines::NAMES) {
            let fits = names.as_array().is_some_and(|names| {
                names.len() == roles.len() && names.iter().all(|name| name.is_string() || name.is_null())
            });
            if fits {
                metadata["dimension_names"] = names;
            }
        }
    }
    fs::create_dir_all(&inner).map_err(fault)?;
    fs::write(inner.join("zarr.json"), format!("{metadata:#}\n")).map_err(fault)?;
    let array = opened(&inner, metadata).map_err(|cause| fault(io::Error::other(cause)))?;
    let (path, header) = (path.to_owned(), header.clone());
    Ok(ZarrSink { folder, array, path, header, roles, chunk, slab: Vec::new(), step: 0, z: 0, written: 0 })
}

/// The array in a folder with this metadata.
fn opened(folder: &Path, metadata: Value) -> Result<Array<FilesystemStore>, String> {
    let store = FilesystemStore::new(folder).map_err(|cause| cause.to_string())?;
    let metadata: ArrayMetadata = serde_json::from_value(metadata).map_err(|cause| cause.to_string())?;
    Array::new_with_metadata(Arc::new(store), "/", metadata).map_err(|cause| cause.to_string())
}

/// Axes of an array: only those that there are, time first and components last, so that no sample moves.
fn array_roles(header: &Header) -> Vec<Role> {
    let mut roles = [Role::Z, Role::Y, Role::X][3 - header.rank()..].to_vec();
    if header.steps > 1 {
        roles =
            [vec![Role::Time, Role::Z], roles.into_iter().filter(|role| *role != Role::Z).collect()].concat();
    }
    if header.components > 1 {
        roles.push(Role::Component);
    }
    roles
}

/// Axes of an image in their prescribed order.
fn image_roles(header: &Header) -> Vec<Role> {
    let (has_time, has_channel, rank) = ome::shape_of(header);
    let mut roles = [Role::Z, Role::Y, Role::X][3 - rank..].to_vec();
    if has_channel {
        roles.insert(0, Role::Component);
    }
    if has_time {
        roles.insert(0, Role::Time);
    }
    roles
}

/// Samples of a chunk along z, y, x and component: 64 a side, or fewer planes and longer sides if slabs of 64 planes
/// are too large; no more than there are. An image has chunks of single channels.
fn chunk(header: &Header, is_image: bool) -> Counts {
    let plane = header.plane_bytes().unwrap_or(u64::MAX);
    let planes =
        [64, 16, 4].into_iter().find(|planes| plane.saturating_mul(*planes) <= SLAB_BYTES).unwrap_or(1);
    let side = [(64, 64), (16, 128), (4, 256), (1, 512)].into_iter().find(|(depth, _)| *depth == planes);
    let side = side.map_or(512, |(_, side)| side);
    let [width, height, depth] = header.extent;
    let components = if is_image { 1 } else { u64::from(header.components) };
    [planes.min(depth), side.min(height), side.min(width), components].map(|count| count as usize)
}

/// Metadata of version 3.
fn metadata(header: &Header, options: &WriteOptions, roles: &[Role], chunk: Counts) -> Value {
    let [width, height, depth] = header.extent;
    let along = |role: &Role| match role {
        Role::Time => (header.steps, 1, "t"),
        Role::Z => (depth, chunk[0], "z"),
        Role::Y => (height, chunk[1], "y"),
        Role::X => (width, chunk[2], "x"),
        Role::Component => (u64::from(header.components), chunk[3], "c"),
    };
    let axes: Vec<_> = roles.iter().map(along).collect();
    let order = options.byte_order.unwrap_or(header.metadata.source.byte_order);
    let bytes = match order {
        _ if header.element.bytes() == 1 => json!({ "name": "bytes" }),
        order => json!({ "name": "bytes", "configuration": { "endian": order.name() } }),
    };
    let gzip = json!({ "name": "gzip", "configuration": { "level": 6 } });
    json!({
        "zarr_format": 3,
        "node_type": "array",
        "shape": axes.iter().map(|axis| axis.0).collect::<Vec<_>>(),
        "data_type": v3_name(header.element),
        "chunk_grid": {
            "name": "regular",
            "configuration": { "chunk_shape": axes.iter().map(|axis| axis.1).collect::<Vec<_>>() }
        },
        "chunk_key_encoding": { "name": "default", "configuration": { "separator": "/" } },
        "fill_value": if header.element.is_float() { json!(0.0) } else { json!(0) },
        "codecs": if options.gzip { json!([bytes, gzip]) } else { json!([bytes]) },
        "dimension_names": axes.iter().map(|axis| axis.2).collect::<Vec<_>>(),
    })
}

/// An old folder is replaced only if all that is in it belongs to Zarr.
fn refuse_foreign(path: &Path) -> Result<(), WriteError> {
    if !path.is_dir() {
        return Ok(());
    }
    let refuse = |found: &Path| {
        let what = format!(
            "a folder with {} in it, which is no part of a Zarr array: move it away first",
            found.display()
        );
        WriteError::CannotHold { path: path.to_owned(), format: FileFormat::Zarr, what }
    };
    if !super::node::is_node(path) {
        return Err(refuse(Path::new("other things")));
    }
    match foreign(path) {
        Ok(None) => Ok(()),
        Ok(Some(found)) => Err(refuse(found.strip_prefix(path).unwrap_or(&found))),
        Err(cause) => Err(WriteError::Io { path: path.to_owned(), cause }),
    }
}

/// A file that neither holds metadata nor a chunk, or a folder that is neither part of chunks nor an array or group.
fn foreign(path: &Path) -> io::Result<Option<PathBuf>> {
    let mut folders = vec![path.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let (inner, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
            let is_chunk = name == "c"
                || name.split('.').all(|part| {
                    let digits = part.trim_start_matches('c');
                    !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
                });
            let is_metadata =
                ["zarr.json", ".zarray", ".zattrs", ".zgroup", ".zmetadata"].contains(&name.as_str());
            match entry.file_type()?.is_dir() {
                true if is_chunk || super::node::is_node(&inner) => folders.push(inner),
                false if is_chunk || is_metadata => {}
                _ => return Ok(Some(inner)),
            }
        }
    }
    Ok(None)
}

impl ZarrSink {
    /// Planes of the present slab, and its bytes.
    fn slab_size(&self) -> (u64, u64) {
        let planes = (self.chunk[0] as u64).min(self.header.extent[2] - self.z);
        (planes, planes * self.header.plane_bytes().unwrap_or(u64::MAX / self.header.extent[2]))
    }

    /// Writes the chunks of a full slab.
    fn put(&mut self) -> io::Result<()> {
        let (planes, _) = self.slab_size();
        let [width, height, _] = self.header.extent;
        let counts = [planes, height, width, u64::from(self.header.components)].map(|count| count as usize);
        let grid: Counts = std::array::from_fn(|axis| counts[axis].div_ceil(self.chunk[axis]));
        let places = (0..grid[1] * grid[2] * grid[3]).into_par_iter();
        places.try_for_each(|at| {
            let place = [0, at / grid[3] / grid[2], at / grid[3] % grid[2], at % grid[3]];
            self.put_chunk(place, counts)
        })?;
        self.slab.clear();
        self.z += planes;
        if self.z == self.header.extent[2] {
            (self.z, self.step) = (0, self.step + 1);
        }
        Ok(())
    }

    /// Writes the chunk at a place in the grid of chunks of the slab.
    fn put_chunk(&self, place: Counts, counts: Counts) -> io::Result<()> {
        let size = self.header.element.bytes();
        let first: Counts = std::array::from_fn(|axis| place[axis] * self.chunk[axis]);
        let part = std::array::from_fn(|axis| self.chunk[axis].min(counts[axis] - first[axis]));
        let of_slab = canonical(counts);
        let offset: usize = first.iter().zip(of_slab).map(|(first, stride)| first * stride).sum();
        let mut bytes = vec![0; self.chunk.iter().product::<usize>() * size];
        copy((&self.slab[offset * size..], of_slab), (&mut bytes, self.strides()), part, size);
        if cfg!(target_endian = "big") {
            reorder(&mut bytes, self.header.element, ByteOrder::Big);
        }
        let index = |role: &Role| match role {
            Role::Time => self.step,
            Role::Z => self.z / self.chunk[0] as u64,
            Role::Y => place[1] as u64,
            Role::X => place[2] as u64,
            Role::Component => place[3] as u64,
        };
        let indices: Vec<u64> = self.roles.iter().map(index).collect();
        self.array.store_chunk(&indices, ArrayBytes::from(bytes)).map_err(system_error)
    }

    /// Samples from one to the next along z, y, x and component of a chunk.
    fn strides(&self) -> Strides {
        let length = |role: &Role| match role {
            Role::Time => 1,
            Role::Z => self.chunk[0],
            Role::Y => self.chunk[1],
            Role::X => self.chunk[2],
            Role::Component => self.chunk[3],
        };
        [Role::Z, Role::Y, Role::X, Role::Component].map(|role| {
            let axis = self.roles.iter().position(|found| *found == role);
            axis.map_or(1, |axis| self.roles[axis + 1..].iter().map(length).product())
        })
    }

    fn take(&mut self, mut values: &[u8]) -> io::Result<()> {
        while !values.is_empty() && self.step < self.header.steps {
            let (_, bytes) = self.slab_size();
            let missing = bytes as usize - self.slab.len();
            let (now, later) = values.split_at(missing.min(values.len()));
            self.slab.extend_from_slice(now);
            values = later;
            if self.slab.len() as u64 == bytes {
                self.put()?;
            }
        }
        Ok(())
    }
}

/// The system's error behind one of zarrs, if there is one.
fn system_error(cause: zarrs::array::ArrayError) -> io::Error {
    let mut source: Option<&(dyn std::error::Error + 'static)> = Some(&cause);
    while let Some(error) = source {
        if let Some(code) = error.downcast_ref::<io::Error>().and_then(io::Error::raw_os_error) {
            return io::Error::from_raw_os_error(code);
        }
        source = error.source();
    }
    io::Error::other(cause.to_string())
}

impl Sink for ZarrSink {
    fn write(&mut self, values: &[u8]) -> Result<(), WriteError> {
        self.written += values.len() as u64;
        self.take(values).map_err(|cause| WriteError::Io { path: self.path.clone(), cause })
    }

    fn finish(self: Box<Self>) -> Result<(), WriteError> {
        let Self { folder, path, header, written, .. } = *self;
        let expected = header.bytes().unwrap_or(u64::MAX);
        if written != expected {
            return Err(WriteError::SampleBytes { path, expected, found: written });
        }
        folder.commit().map_err(|cause| WriteError::Io { path, cause })
    }
}
