//! Arrays as sources: samples come a slab of chunks at a time.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use zarrs::array::{Array, ArrayBytes, ArraySubset, CodecOptions};

use super::bounded::bound_codecs;
use super::boxes::{canonical, copy};
use super::layout::{INDEX_BYTES, LARGEST_BYTES, Layout, Role};
use super::node::{self, Place, multiscales};
use super::store::Within;
use super::{ZarrError, lines, ome};
use crate::volume::element::reorder;
use crate::volume::guarded::guarded;
use crate::volume::half::Widened;
use crate::volume::pieces::{PieceSource, Pieces};
use crate::volume::{ByteOrder, FileFormat, Header, Metadata, Origin, ReadError, Source};

/// Bytes of samples that are decoded at a time, if chunks are no larger.
const PIECE_BYTES: u64 = 1 << 24;

/// Bytes of samples that are decoded at a time at most, unless a single row has more, or less is asked for.
const MOST_PIECE_BYTES: u64 = 1 << 27;

/// Chunks that are decoded at once at most.
const MOST_THREADS: u64 = 256;

/// An array of a Zarr folder.
pub(super) struct ZarrArray {
    array: Array<Within>,
    layout: Layout,
    header: Header,
    path: PathBuf,
    /// The array's own, in `path` where that is an image.
    folder: PathBuf,
    /// Bytes that may be held at a time: those of a piece, and of chunks while they are decoded.
    most: u64,
}

/// Planes and rows of one time step.
#[derive(Debug)]
struct Slab {
    step: u64,
    z: [u64; 2],
    y: [u64; 2],
}

/// Opens the array that a path means.
pub(super) fn open(path: &Path) -> Result<Box<dyn Source>, ReadError> {
    let fault =
        |cause| ReadError::Format { path: path.to_owned(), format: FileFormat::Zarr, cause: Box::new(cause) };
    std::fs::read_dir(path).map_err(|cause| ReadError::Io { path: path.to_owned(), cause })?;
    let Place { folder, metadata, image } = node::find(path).map_err(fault)?;
    let axes = image.as_ref().and_then(|(attributes, _)| multiscales(attributes));
    let layout = Layout::new(&metadata, axes).map_err(fault)?;
    let header = header(&layout, image).map_err(fault)?;
    let row = u64::from(header.components).saturating_mul(header.element.bytes() as u64);
    let row = row.saturating_mul(header.extent[0]);
    if row > LARGEST_BYTES {
        return Err(fault(ZarrError::TooLarge {
            what: "a row of samples",
            bytes: row,
            limit: LARGEST_BYTES,
        }));
    }
    bound_codecs();
    // A chunk may be longer than its samples where these cannot be compressed; a shard as a whole is read for a piece.
    let most = 2 * layout.chunk_bytes().max(MOST_PIECE_BYTES) + INDEX_BYTES;
    let array = guarded(|| {
        let store = Within::new(&folder, most).map_err(|cause| cause.to_string())?;
        Array::open(Arc::new(store), "/").map_err(|cause| cause.to_string())
    });
    let array = array.map_err(|cause| fault(ZarrError::Zarrs(cause)))?;
    if array.shape() != layout.shape {
        return Err(fault(ZarrError::Metadata { what: "shape" }));
    }
    let is_half = layout.is_half;
    let source = Box::new(PieceSource::new(ZarrArray {
        array,
        layout,
        header,
        path: path.to_owned(),
        folder,
        most: 3 * MOST_PIECE_BYTES,
    }));
    Ok(if is_half { Box::new(Widened::new(source)) } else { source })
}

fn header(
    layout: &Layout,
    image: Option<(serde_json::Map<String, serde_json::Value>, usize)>,
) -> Result<Header, ZarrError> {
    let components = layout.count(Role::Component);
    let components = u32::try_from(components).map_err(|_| ZarrError::TooLarge {
        what: "a sample",
        bytes: components,
        limit: u32::MAX.into(),
    })?;
    let extent = [Role::X, Role::Y, Role::Z].map(|role| layout.count(role));
    let rank = layout.roles.iter().filter(|role| matches!(role, Role::X | Role::Y | Role::Z)).count().max(1);
    let mut metadata = Metadata::plain(rank as u8, FileFormat::Zarr);
    metadata.source =
        Origin { format: FileFormat::Zarr, byte_order: layout.byte_order, fortran_order: false };
    let mut header =
        Header { extent, components, steps: layout.count(Role::Time), element: layout.element, metadata };
    let mut own = lines::of_attributes(layout.attributes.clone(), layout.names.as_ref());
    if let Some((attributes, level)) = image {
        own.retain(|line| !lines::is_pair(line, lines::NAMES));
        if ome::tells_time(&attributes, level) && header.steps > 1 {
            header.metadata.axes = ome::in_order(&header);
        }
        own.splice(0..0, ome::lines(&attributes, level, &header));
    }
    header.metadata.lines = own;
    Ok(header)
}

impl ZarrArray {
    /// Bytes of a row of samples, of a plane, of a time step.
    fn sizes(&self) -> [u64; 3] {
        let [width, height, depth] = self.header.extent;
        let row = width * u64::from(self.header.components) * self.header.element.bytes() as u64;
        [row, row * height, row * height * depth]
    }

    /// The slab that the value at a byte lies in: some rows of chunks as a whole, or planes or rows of one.
    fn slab(&self, position: u64) -> Slab {
        let [row, plane, step] = self.sizes();
        let [_, height, depth] = self.header.extent;
        let (at, within) = (position / step, position % step);
        let (z, y) = (within / plane, within % plane / row);
        // A piece is there twice while its axes change places.
        let most = (self.most / 3).min(MOST_PIECE_BYTES);
        if plane > most {
            let rows = (most / row).max(1);
            let first = y / rows * rows;
            return Slab { step: at, z: [z, z + 1], y: [first, (first + rows).min(height)] };
        }
        let chunk = self.layout.axis(Role::Z).map_or(1, |axis| self.layout.chunk[axis]).min(depth);
        let (base, planes) = match chunk * plane {
            bytes if bytes > most => (z / chunk * chunk, most / plane),
            bytes => (0, chunk * (PIECE_BYTES.min(most) / bytes).max(1)),
        };
        let first = base + (z - base) / planes * planes;
        let end = if base > 0 || planes < chunk { base + chunk } else { depth };
        Slab { step: at, z: [first, (first + planes).min(end).min(depth)], y: [0, height] }
    }

    /// The values of a slab, and the byte that it begins at.
    fn decode(&self, Slab { step, z, y }: Slab) -> Result<(Vec<u8>, u64), ReadError> {
        let [row, plane, step_bytes] = self.sizes();
        let components = u64::from(self.header.components);
        let range = |role| match role {
            Role::Time => step..step + 1,
            Role::Z => z[0]..z[1],
            Role::Y => y[0]..y[1],
            Role::X => 0..self.header.extent[0],
            Role::Component => 0..components,
        };
        let ranges: Vec<_> = self.layout.roles.iter().map(|role| range(*role)).collect();
        let subset = ArraySubset::new_with_ranges(&ranges);
        let threads = (self.most / 3 / self.layout.chunk_bytes().max(1)).clamp(1, MOST_THREADS) as usize;
        let options = CodecOptions::default();
        let options = options.with_concurrent_target(options.concurrent_target().min(threads));
        let found = guarded(|| {
            let found: ArrayBytes<'static> =
                self.array.retrieve_array_subset_opt(&subset, &options).map_err(|cause| cause.to_string())?;
            Ok(found.into_fixed().map_err(|cause| cause.to_string())?.into_owned())
        });
        let mut found = found.map_err(|cause| self.fault(cause))?;
        if cfg!(target_endian = "big") {
            reorder(&mut found, self.header.element, ByteOrder::Big);
        }
        let counts =
            [z[1] - z[0], y[1] - y[0], self.header.extent[0], components].map(|count| count as usize);
        let lengths: Vec<usize> = ranges.iter().map(|range| (range.end - range.start) as usize).collect();
        let strides = [Role::Z, Role::Y, Role::X, Role::Component].map(|role| self.stride(role, &lengths));
        let start = step * step_bytes + z[0] * plane + y[0] * row;
        if self.layout.roles.is_sorted() {
            return Ok((found, start));
        }
        let mut piece = vec![0; found.len()];
        copy((&found, strides), (&mut piece, canonical(counts)), counts, self.header.element.bytes());
        Ok((piece, start))
    }

    /// Samples from one to the next along an axis of a box with these lengths along the array's axes.
    fn stride(&self, role: Role, lengths: &[usize]) -> usize {
        self.layout.axis(role).map_or(1, |axis| lengths[axis + 1..].iter().product())
    }

    fn fault(&self, cause: String) -> ReadError {
        let cause = Box::new(ZarrError::Zarrs(cause));
        ReadError::Format { path: self.path.clone(), format: FileFormat::Zarr, cause }
    }
}

impl Pieces for ZarrArray {
    fn header(&self) -> &Header {
        &self.header
    }

    fn path(&self) -> &Path {
        &self.path
    }

    fn piece(&mut self, position: u64) -> Result<(Vec<u8>, u64), ReadError> {
        self.decode(self.slab(position))
    }

    fn hold_at_most(&mut self, bytes: u64) -> u64 {
        self.most = bytes.min(3 * MOST_PIECE_BYTES);
        self.most
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.path.clone(), self.folder.clone()]
    }
}
