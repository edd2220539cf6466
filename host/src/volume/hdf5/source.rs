//! Variables as sources: samples come a slab of chunks at a time.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use bytemuck::cast_slice;
use hdf5_reader::storage::DynStorage;
use hdf5_reader::{FileStorage, Hdf5File};
use netcdf_reader::{
    NcFile, NcFormat, NcMetadataMode, NcOpenOptions, NcReadable, NcSliceInfo, NcSliceInfoElem,
};

use super::variable::{self, Variable};
use super::{Hdf5Error, filters, places};
use crate::volume::guarded::guarded;
use crate::volume::input::Input;
use crate::volume::pieces::{PieceSource, Pieces};
use crate::volume::stored::DEFLATE_EXPANSION;
use crate::volume::{ElementType, FileFormat, Header, ReadError, Sample, Source};

/// Bytes of samples that are read at a time, if chunks are no larger.
const PIECE_BYTES: u64 = 1 << 24;

/// Bytes of samples that are read at a time at most, unless a single row has more, or less is asked for.
const MOST_PIECE_BYTES: u64 = 1 << 27;

/// Bytes of samples that are read at a time at least.
const LEAST_PIECE_BYTES: u64 = 1 << 12;

/// Bytes of chunks that are kept for the next piece.
const CACHE_BYTES: usize = 1 << 26;

/// Most bytes of a chunk, which must be in memory as a whole, and of what is read at a time.
const LARGEST_BYTES: u64 = 1 << 30;

/// A variable of a file.
pub(super) struct Hdf5Variable {
    file: NcFile,
    /// Of the variable.
    name: String,
    /// Samples along each axis, slowest first, and those of a chunk.
    shape: Vec<u64>,
    chunk: Vec<u64>,
    header: Header,
    path: PathBuf,
    /// Bytes that a piece may have.
    most: u64,
}

/// Opens the variable that is meant.
pub(super) fn open(input: &Input, name: Option<&str>) -> Result<Box<dyn Source>, ReadError> {
    let path = input.path();
    let fault =
        |cause| ReadError::Format { path: path.to_owned(), format: FileFormat::Hdf5, cause: Box::new(cause) };
    if input.left().is_none() {
        return Err(fault(Hdf5Error::Pipe));
    }
    let source = guarded(|| Ok(read(path, name))).map_err(Hdf5Error::Reader).and_then(|source| source);
    Ok(Box::new(PieceSource::new(source.map_err(fault)?)))
}

/// The only variable of a file, of which so many bytes are read at a time at most.
#[cfg(test)]
pub(super) fn open_within(path: &Path, most: u64) -> Result<PieceSource<Hdf5Variable>, Hdf5Error> {
    Ok(PieceSource::new(Hdf5Variable { most, ..read(path, None)? }))
}

fn read(path: &Path, name: Option<&str>) -> Result<Hdf5Variable, Hdf5Error> {
    let storage: DynStorage = Arc::new(FileStorage::open(path).map_err(reader)?);
    // A chunk cannot be more than Deflate makes of the file.
    let most_chunk = storage.len().saturating_mul(DEFLATE_EXPANSION).clamp(CACHE_BYTES as u64, LARGEST_BYTES);
    let options = NcOpenOptions {
        chunk_cache_bytes: CACHE_BYTES,
        // Other programs describe axes in their own ways, or not at all.
        metadata_mode: NcMetadataMode::Lossy,
        max_chunk_bytes: most_chunk as usize,
        filter_registry: Some(filters::registry(most_chunk as usize)),
        max_read_bytes: LARGEST_BYTES as usize,
        ..NcOpenOptions::default()
    };
    let file =
        NcFile::from_storage_with_options(Arc::clone(&storage), options).map_err(|cause| match cause {
            netcdf_reader::Error::InvalidMagic => Hdf5Error::NoSuchFormat,
            other => reader(other),
        })?;
    let found = variable::find(file.root_group().map_err(reader)?, name)?;
    let mut header = found.header()?;
    places::describe(&file, &found, &mut header);
    let Variable { path: name, shape, .. } = found;
    let is_classic = matches!(file.format(), NcFormat::Classic | NcFormat::Offset64 | NcFormat::Cdf5);
    let chunk = if is_classic { None } else { chunk(storage, &name)? };
    let chunk = chunk.filter(|chunk| chunk.len() == shape.len()).unwrap_or_else(|| vec![1; shape.len()]);
    let path = path.to_owned();
    Ok(Hdf5Variable { file, name, shape, chunk, header, path, most: MOST_PIECE_BYTES })
}

/// Samples of a chunk, where a variable has chunks.
fn chunk(storage: DynStorage, name: &str) -> Result<Option<Vec<u64>>, Hdf5Error> {
    let file = Hdf5File::from_storage(storage).map_err(reader)?;
    let chunk = file.dataset(name).map_err(reader)?.chunks();
    Ok(chunk.map(|chunk| chunk.into_iter().map(u64::from).collect()))
}

fn reader(cause: impl Into<netcdf_reader::Error>) -> Hdf5Error {
    match cause.into() {
        netcdf_reader::Error::InvalidMagic => Hdf5Error::NoSuchFormat,
        netcdf_reader::Error::Hdf5(cause @ hdf5_reader::error::Error::UnsupportedFilter(_)) => {
            Hdf5Error::Filter(cause.to_string())
        }
        netcdf_reader::Error::Hdf5(cause) => Hdf5Error::Reader(cause.to_string()),
        other => Hdf5Error::Reader(other.to_string()),
    }
}

impl Hdf5Variable {
    /// The box that the value at a byte lies in, as a range along each axis: one place along the slowest axes, some along
    /// the next, all along the others. And the byte that it begins at.
    fn slab(&self, position: u64) -> (Vec<[u64; 2]>, u64) {
        let mut step = self.header.bytes().unwrap_or(0);
        let (mut start, mut is_whole) = (0, false);
        let range = |(&count, &chunk): (&u64, &u64)| {
            step /= count;
            if is_whole {
                return [0, count];
            }
            is_whole = step <= self.most;
            let layer = chunk.clamp(1, count);
            let places = match (PIECE_BYTES.min(self.most) / step, self.most / step) {
                (_, 0) => 1,
                (few, _) if few >= layer => few / layer * layer,
                (_, most) if most >= layer => layer,
                (few, _) => few.max(1),
            };
            let at = (position - start) / step;
            let first = at / places * places;
            start += first * step;
            [first, (first + places).min(count)]
        };
        let ranges = self.shape.iter().zip(&self.chunk).map(range).collect();
        (ranges, start)
    }

    /// Values of a box as little-endian bytes.
    fn values(&self, selection: &NcSliceInfo) -> netcdf_reader::Result<Vec<u8>> {
        match self.header.element {
            ElementType::U8 => self.values_of::<u8>(selection),
            ElementType::I8 => self.values_of::<i8>(selection),
            ElementType::U16 => self.values_of::<u16>(selection),
            ElementType::I16 => self.values_of::<i16>(selection),
            ElementType::U32 => self.values_of::<u32>(selection),
            ElementType::I32 => self.values_of::<i32>(selection),
            ElementType::U64 => self.values_of::<u64>(selection),
            ElementType::I64 => self.values_of::<i64>(selection),
            ElementType::F32 => self.values_of::<f32>(selection),
            ElementType::F64 => self.values_of::<f64>(selection),
        }
    }

    fn values_of<T: NcReadable + Sample>(&self, selection: &NcSliceInfo) -> netcdf_reader::Result<Vec<u8>> {
        let found = self.file.read_variable_slice::<T>(&self.name, selection)?;
        let values: Vec<T> = found.into_iter().map(T::of_little).collect();
        Ok(cast_slice(&values).to_vec())
    }
}

impl Pieces for Hdf5Variable {
    fn header(&self) -> &Header {
        &self.header
    }

    fn path(&self) -> &Path {
        &self.path
    }

    fn piece(&mut self, position: u64) -> Result<(Vec<u8>, u64), ReadError> {
        let (ranges, start) = self.slab(position);
        let ranges = ranges.into_iter().map(|[start, end]| NcSliceInfoElem::Slice { start, end, step: 1 });
        let selection = NcSliceInfo { selections: ranges.collect() };
        let found = guarded(|| Ok(self.values(&selection))).map_err(Hdf5Error::Reader);
        let found = found.and_then(|found| found.map_err(reader)).map_err(|cause| ReadError::Format {
            path: self.path.clone(),
            format: FileFormat::Hdf5,
            cause: Box::new(cause),
        })?;
        Ok((found, start))
    }

    fn hold_at_most(&mut self, bytes: u64) -> u64 {
        // A piece is there twice while it is read, beside the chunks that are kept.
        self.most = (bytes.saturating_sub(CACHE_BYTES as u64) / 2).clamp(LEAST_PIECE_BYTES, MOST_PIECE_BYTES);
        2 * self.most + CACHE_BYTES as u64
    }
}
