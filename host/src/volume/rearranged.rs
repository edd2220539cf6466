//! Values whose axes have another order in the file than in a [`Header`]: colours as planes, time fastest.

use std::fs::File;
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};

use super::input::Input;
use super::stored::{Encoding, Place, Stored};
use super::{Axis, ByteOrder, Header, PIECE_BYTES, ReadError, Sink, Source, WriteError};

/// One axis on the way from values in their wanted order to values in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Stride {
    count: u64,
    /// Values in the file from one to the next.
    step: u64,
}

/// For each axis in the wanted order, its number in the file: components first, then x, y, z, then time. Axes of one
/// kind stay in the order of the file.
fn canonical(axes: &[Axis]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..axes.len()).collect();
    order.sort_by_key(|&index| axes[index].place());
    order
}

/// Whether a file of these axes has its values in the order of [`Header`]; axes of one value can stand anywhere.
fn is_canonical(axes: &[Axis]) -> bool {
    let counts = axes.iter().filter(|axis| !matches!(axis, Axis::Component(1) | Axis::Time(1)));
    counts.is_sorted_by_key(|axis| axis.place())
}

/// The values of `inner`, the file at `path`, in the order of [`Header`], where the file has them in that of `axes`.
///
/// # Errors
/// [`ReadError`]: compressed samples that have to be rearranged, and are damaged.
pub(super) fn ordered<S: Source + 'static>(
    inner: S,
    path: &Path,
    axes: &[Axis],
) -> Result<Box<dyn Source>, ReadError> {
    let inner = Box::new(inner);
    Ok(if is_canonical(axes) { inner } else { Box::new(Rearranged::new(inner, path, axes)?) })
}

/// A sink of values in the order of [`Header`] into `inner`, the sink of the file at `path`, in the order of `axes`.
///
/// # Errors
/// [`WriteError`], when no temporary file can be made.
pub(super) fn ordered_sink<S: Sink + 'static>(
    inner: S,
    path: &Path,
    header: &Header,
    axes: &[Axis],
) -> Result<Box<dyn Sink>, WriteError> {
    let inner = Box::new(inner);
    Ok(if is_canonical(axes) { inner } else { Box::new(RearrangedSink::new(inner, path, header, axes)?) })
}

/// Strides in the order of `order` through a file whose axes have `counts` values, with neighbours joined where one
/// goes on as the other ends.
fn strides(counts: &[u64], order: &[usize]) -> Vec<Stride> {
    let mut step = 1;
    let of_file: Vec<Stride> = counts
        .iter()
        .map(|&count| {
            let stride = Stride { count, step };
            step *= count;
            stride
        })
        .collect();
    let mut joined: Vec<Stride> = Vec::new();
    for stride in order.iter().map(|&index| of_file[index]).filter(|stride| stride.count > 1) {
        match joined.last_mut() {
            Some(last) if last.count * last.step == stride.step => last.count *= stride.count,
            _ => joined.push(stride),
        }
    }
    joined
}

/// A source of values that lie in another order in the file.
///
/// Memory: a piece. Cost: every run of values along the axis that lies closest together is one read; where that is
/// an axis whose values have others between them, those are read as well and passed over.
struct Rearranged {
    inner: Box<dyn Source>,
    /// Those of the source that was opened, which may have been copied.
    files: Vec<PathBuf>,
    strides: Vec<Stride>,
    /// Axis along which runs are read.
    along: usize,
    /// Values that the axes before it make.
    block: u64,
    /// The next value.
    at: u64,
    span: Vec<u8>,
}

impl Rearranged {
    /// Values of `inner` in the order of its header, where the file has the axes of its metadata. Samples that are
    /// compressed come out of a temporary file.
    fn new(inner: Box<dyn Source>, path: &Path, axes: &[Axis]) -> Result<Self, ReadError> {
        let counts: Vec<u64> = axes.iter().map(|axis| inner.header().count(*axis)).collect();
        let files = inner.files();
        let inner = if inner.is_random() { inner } else { Box::new(unpacked(inner, path)?) };
        Ok(Self { files, ..Self::with_order(inner, &counts, &canonical(axes)) })
    }

    fn with_order(inner: Box<dyn Source>, counts: &[u64], order: &[usize]) -> Self {
        let strides = strides(counts, order);
        let is_dense = |stride: &Stride| stride.count >= stride.step;
        let closest = |stride: &Stride| stride.step == 1;
        let along =
            strides.iter().position(is_dense).or_else(|| strides.iter().position(closest)).unwrap_or(0);
        let block = strides[..along].iter().map(|stride| stride.count).product();
        Self { inner, files: Vec::new(), strides, along, block, at: 0, span: Vec::new() }
    }

    /// Place in the file of value `index` of the wanted order, and how far it is along the axis of runs.
    fn place(&self, mut index: u64) -> (u64, u64) {
        let (mut place, mut along) = (0, 0);
        for (axis, stride) in self.strides.iter().enumerate() {
            let at = index % stride.count;
            index /= stride.count;
            place += at * stride.step;
            if axis == self.along {
                along = at;
            }
        }
        (place, along)
    }

    /// Reads the run from `place` on, of every `step`-th value of the file, into every `spread`-th value of `out`.
    fn read_run(&mut self, place: u64, step: u64, spread: usize, out: &mut [u8]) -> Result<(), ReadError> {
        let bytes = self.inner.header().element.bytes();
        let count = (out.len() / bytes).div_ceil(spread);
        let step = step as usize;
        self.inner.seek(place * bytes as u64)?;
        if step == 1 && spread == 1 {
            return self.inner.read(out);
        }
        self.span.resize(((count - 1) * step + 1) * bytes, 0);
        self.inner.read(&mut self.span)?;
        let from = self.span.chunks(step * bytes);
        for (from, to) in from.zip(out.chunks_mut(spread * bytes)) {
            to[..bytes].copy_from_slice(&from[..bytes]);
        }
        Ok(())
    }

    /// Reads a whole number of runs, or single values where `out` begins or ends between them; how many it read.
    fn read_some(&mut self, out: &mut [u8]) -> Result<usize, ReadError> {
        let bytes = self.inner.header().element.bytes();
        let left = (out.len() / bytes) as u64;
        let (_, along) = self.place(self.at);
        let Some(&stride) = self.strides.get(self.along) else {
            self.read_run(0, 1, 1, &mut out[..bytes])?;
            return Ok(1);
        };
        let most = (PIECE_BYTES / (stride.step * bytes as u64)).max(1);
        let count = (stride.count - along).min(left / self.block).min(most);
        if !self.at.is_multiple_of(self.block) || count == 0 {
            let (place, _) = self.place(self.at);
            self.read_run(place, 1, 1, &mut out[..bytes])?;
            return Ok(1);
        }
        let block = self.block as usize;
        let out = &mut out[..count as usize * block * bytes];
        for first in 0..block {
            let (place, _) = self.place(self.at + first as u64);
            let to = &mut out[first * bytes..];
            self.read_run(place, stride.step, block, to)?;
        }
        Ok(count as usize * block)
    }
}

impl Source for Rearranged {
    fn header(&self) -> &Header {
        self.inner.header()
    }

    fn files(&self) -> Vec<PathBuf> {
        self.files.clone()
    }

    fn read(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        let bytes = self.header().element.bytes();
        let mut filled = 0;
        while filled < out.len() {
            let count = self.read_some(&mut out[filled..])?;
            self.at += count as u64;
            filled += count * bytes;
        }
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.at = position / self.header().element.bytes() as u64;
        Ok(())
    }

    fn is_random(&self) -> bool {
        true
    }
}

/// The same values in a temporary file, little-endian and uncompressed.
fn unpacked(mut packed: Box<dyn Source>, path: &Path) -> Result<Stored, ReadError> {
    let fault = |cause| ReadError::Io { path: path.to_owned(), cause };
    let header = packed.header().clone();
    let mut file = tempfile::tempfile().map_err(fault)?;
    let mut left = header.bytes().unwrap_or(u64::MAX);
    let mut piece = Vec::new();
    while left > 0 {
        piece.resize(left.min(PIECE_BYTES) as usize, 0);
        packed.read(&mut piece)?;
        file.write_all(&piece).map_err(fault)?;
        left -= piece.len() as u64;
    }
    plain(file, path, header)
}

/// Little-endian values from the beginning of a file.
fn plain(mut file: File, path: &Path, header: Header) -> Result<Stored, ReadError> {
    file.rewind().map_err(|cause| ReadError::Io { path: path.to_owned(), cause })?;
    let place =
        Place { encoding: Encoding::Raw, byte_order: ByteOrder::Little, skip: 0, is_open_ended: false };
    Stored::new(Input::of_file(file, path)?, header, place)
}

/// A sink of values that are to lie in another order in the file. They wait in a temporary file beside it.
struct RearrangedSink {
    inner: Box<dyn Sink>,
    waiting: File,
    path: PathBuf,
    header: Header,
    axes: Vec<Axis>,
}

impl RearrangedSink {
    /// Values of `header` go to `inner`, the sink of the file at `path`, in the order of `axes`.
    fn new(inner: Box<dyn Sink>, path: &Path, header: &Header, axes: &[Axis]) -> Result<Self, WriteError> {
        let folder = path.parent().filter(|folder| folder.is_dir()).unwrap_or(Path::new("."));
        let waiting = tempfile::tempfile_in(folder).or_else(|_| tempfile::tempfile());
        let waiting = waiting.map_err(|cause| WriteError::Io { path: path.to_owned(), cause })?;
        Ok(Self { inner, waiting, path: path.to_owned(), header: header.clone(), axes: axes.to_vec() })
    }
}

impl Sink for RearrangedSink {
    fn write(&mut self, values: &[u8]) -> Result<(), WriteError> {
        self.waiting.write_all(values).map_err(|cause| WriteError::Io { path: self.path.clone(), cause })
    }

    fn finish(self: Box<Self>) -> Result<(), WriteError> {
        let Self { mut inner, waiting, path, header, axes } = *self;
        let order = canonical(&axes);
        let counts: Vec<u64> = order.iter().map(|&index| header.count(axes[index])).collect();
        let mut back = vec![0; order.len()];
        for (to, &from) in order.iter().enumerate() {
            back[from] = to;
        }
        let mut left = header.bytes().unwrap_or(u64::MAX);
        let lost = |error| match error {
            ReadError::Io { cause, .. } => WriteError::Io { path: path.clone(), cause },
            ReadError::SampleBytes { expected, found: super::Found::Exactly(found), .. } => {
                WriteError::SampleBytes { path: path.clone(), expected, found }
            }
            other => WriteError::Io { path: path.clone(), cause: std::io::Error::other(other) },
        };
        let waiting = Box::new(plain(waiting, &path, header).map_err(lost)?);
        let mut rearranged = Rearranged::with_order(waiting, &counts, &back);
        let mut piece = Vec::new();
        while left > 0 {
            piece.resize(left.min(PIECE_BYTES) as usize, 0);
            rearranged.read(&mut piece).map_err(lost)?;
            inner.write(&piece)?;
            left -= piece.len() as u64;
        }
        inner.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{ElementType, FileFormat, Metadata};

    /// Value of a place, whatever the order: the indices of its axes, as digits.
    fn digits(counts: &[u64], order: &[usize]) -> Vec<u8> {
        let total: u64 = counts.iter().product();
        let value = |mut index: u64| {
            let mut value = 0_u16;
            for &axis in order {
                value += (index % counts[axis]) as u16 * 6_u16.pow(axis as u32);
                index /= counts[axis];
            }
            value.to_le_bytes()
        };
        (0..total).flat_map(value).collect()
    }

    fn header(axes: &[Axis], counts: &[u64]) -> Header {
        let metadata = Metadata { axes: axes.to_vec(), ..Metadata::plain(3, FileFormat::Nrrd) };
        Header::of_axes(counts, ElementType::U16, metadata).unwrap()
    }

    fn orders() -> Vec<Vec<Axis>> {
        use Axis::{Component, Time, X, Y, Z};
        let mut orders = vec![
            vec![X],
            vec![Component(3), X, Y, Z, Time(4)],
            vec![X, Y, Component(5), Z],
            vec![Component(2), X, Component(3), Y, Time(2), Time(3)],
            vec![Time(5), X, Y],
            vec![Z, Y, X],
            vec![Time(2), Component(1), Z, X, Component(4), Y],
        ];
        let all = [Component(2), X, Y, Z, Time(3)];
        orders.extend((0..5).flat_map(|turn| {
            let mut turned = all;
            turned.rotate_left(turn);
            let mut swapped = turned;
            swapped.swap(1, 3);
            [turned.to_vec(), swapped.to_vec()]
        }));
        orders
    }

    #[test]
    fn values_come_in_the_order_of_headers_from_any_order_of_axes() {
        for axes in orders() {
            let counts: Vec<u64> = axes
                .iter()
                .map(|axis| match axis {
                    Axis::Component(count) => u64::from(*count),
                    Axis::Time(count) => *count,
                    axis => [5, 4, 3][axis.space().unwrap()],
                })
                .collect();
            let header = header(&axes, &counts);
            let file = digits(&counts, &(0..axes.len()).collect::<Vec<_>>());
            let expected = digits(&counts, &canonical(&axes));
            assert_eq!(is_canonical(&axes), file == expected, "{axes:?}");
            let place = Place {
                encoding: Encoding::Raw,
                byte_order: ByteOrder::Little,
                skip: 0,
                is_open_ended: false,
            };
            let stored = Stored::new(Input::from_bytes(&file), header.clone(), place).unwrap();
            let mut source = Rearranged::new(Box::new(stored), Path::new("memory"), &axes).unwrap();
            for piece in [2, 6, 26, 1 << 20] {
                source.seek(0).unwrap();
                let mut found = vec![0; expected.len()];
                found.chunks_mut(piece).for_each(|piece| source.read(piece).unwrap());
                assert_eq!(found, expected, "{axes:?} by {piece}");
            }
            let middle = expected.len() / 4 * 2;
            source.seek(middle as u64).unwrap();
            let mut rest = vec![0; expected.len() - middle];
            source.read(&mut rest).unwrap();
            assert_eq!(rest, expected[middle..]);

            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.raw");
            let raw = crate::volume::create(&path, &header, &Default::default()).unwrap().sink;
            let mut sink = Box::new(RearrangedSink::new(raw, &path, &header, &axes).unwrap());
            expected.chunks(26).for_each(|piece| sink.write(piece).unwrap());
            sink.finish().unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), file, "{axes:?}");
        }
    }

    #[test]
    fn axes_are_joined_where_they_go_on() {
        let stride = |count, step| Stride { count, step };
        assert_eq!(strides(&[5, 4, 3, 2], &[3, 0, 1, 2]), [stride(2, 60), stride(60, 1)]);
        assert_eq!(strides(&[5, 4, 3, 2], &[0, 1, 2, 3]), [stride(120, 1)]);
        assert_eq!(strides(&[1, 1], &[1, 0]), []);
    }

    #[test]
    fn a_sink_that_gets_too_little_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.raw");
        let axes = [Axis::X, Axis::Component(3)];
        let header = header(&axes, &[4, 3]);
        let raw = crate::volume::create(&path, &header, &Default::default()).unwrap().sink;
        let mut sink = Box::new(RearrangedSink::new(raw, &path, &header, &axes).unwrap());
        sink.write(&[0; 22]).unwrap();
        let error = sink.finish().unwrap_err();
        assert!(matches!(error, WriteError::SampleBytes { expected: 24, found: 22, .. }), "{error}");
        assert!(!path.exists());
    }
}
