//! Samples as arrays of Rust: slices, and the arrays of the crate [`ndarray`].
//!
//! An array of a volume has the shape `[z, y, x]` in C order: x varies fastest, as in the file and as NumPy shows it. One
//! of time steps and components has the shape `[step, z, y, x, component]`.

use std::borrow::Cow;
use std::num::NonZeroUsize;

use bytemuck::{cast_slice, cast_slice_mut};
use ndarray::{Array3, Array5, ArrayView3, ArrayView5, ArrayViewMut3, Axis};

use crate::codec::{CompressError, CompressOptions, Container, ContainerError, Part, compress_stream};
use crate::progress::{Progress, ignore};
use crate::volume::sample::each_f64;
use crate::volume::{ElementType, Fault, FileFormat, Geometry, Header, InMemory, Metadata, Sample, Volume};

/// Why samples cannot be in an array.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ArrayError {
    /// An array of another type than the samples.
    #[error("the samples are {found}, not {asked}: read them as that type, and convert them")]
    WrongType {
        /// Type of the array.
        asked: ElementType,
        /// Type of the samples.
        found: ElementType,
    },
    /// An array of another shape than the samples.
    #[error("an array of shape {found:?} does not hold samples of shape {expected:?}")]
    WrongShape {
        /// Shape of the samples.
        expected: Vec<usize>,
        /// Shape of the array.
        found: Vec<usize>,
    },
    /// An array without values.
    #[error("an array without values: there is nothing to compress or to write")]
    Empty,
    /// The samples could not be read.
    #[error(transparent)]
    Container(#[from] ContainerError),
}

impl ArrayError {
    /// Whose fault it is.
    pub fn kind(&self) -> Fault {
        match self {
            Self::WrongType { .. } | Self::WrongShape { .. } | Self::Empty => Fault::Usage,
            Self::Container(error) => error.kind(),
        }
    }
}

/// # Arrays
impl Container {
    /// Reads the only volume, all of it, into an array of the shape `[z, y, x]`, on all cores.
    ///
    /// # Errors
    /// As [`Container::read_array`].
    pub fn to_array<T: Sample>(&self) -> Result<Array3<T>, ArrayError> {
        self.read_array(&Part::default(), None, &ignore)
    }

    /// Reads one volume of single values, or a part of it, into an array of the shape `[z, y, x]`, on `threads` threads
    /// (`None`: one per core); bricks outside it are not touched.
    ///
    /// # Errors
    /// [`ArrayError`]: another type, a part that is not there or no single volume, a damaged brick.
    pub fn read_array<T: Sample>(
        &self,
        part: &Part,
        threads: Option<NonZeroUsize>,
        progress: Progress<'_>,
    ) -> Result<Array3<T>, ArrayError> {
        let header = self.typed_header::<T>(part)?;
        let shape = volume_shape(&header)?;
        let values = self.read_vec(&header, part, threads, progress)?;
        Array3::from_shape_vec(shape, values).map_err(|_| wrong_shape(&shape, &[]))
    }

    /// As [`Container::read_array`], whatever the type, as numbers in double precision: exact but for integers beyond
    /// 2^53. A slope or intercept that a file gave of its values is not applied.
    ///
    /// # Errors
    /// As [`Container::read_array`], but for another type.
    ///
    /// Cost: the samples are in memory twice, as they are and as numbers.
    pub fn read_numbers(
        &self,
        part: &Part,
        threads: Option<NonZeroUsize>,
        progress: Progress<'_>,
    ) -> Result<Array3<f64>, ArrayError> {
        self.read(part, threads, progress)?.to_numbers()
    }

    /// Reads any part into an array of the shape `[step, z, y, x, component]`.
    ///
    /// # Errors
    /// As [`Container::read_array`], but for several steps and components.
    pub fn read_array5<T: Sample>(
        &self,
        part: &Part,
        threads: Option<NonZeroUsize>,
        progress: Progress<'_>,
    ) -> Result<Array5<T>, ArrayError> {
        let header = self.typed_header::<T>(part)?;
        let shape = shape(&header);
        let values = self.read_vec(&header, part, threads, progress)?;
        Array5::from_shape_vec(shape, values).map_err(|_| wrong_shape(&shape, &[]))
    }

    /// Reads a part into an array of its shape `[z, y, x]`, which may be a view of a larger one.
    ///
    /// # Errors
    /// As [`Container::read_array`], and [`ArrayError::WrongShape`]. The array may be written in part then.
    ///
    /// Cost: a copy of the samples if the array does not lie in one piece, in C order.
    pub fn read_into_array<T: Sample>(
        &self,
        part: &Part,
        mut out: ArrayViewMut3<'_, T>,
        threads: Option<NonZeroUsize>,
        progress: Progress<'_>,
    ) -> Result<(), ArrayError> {
        let header = self.typed_header::<T>(part)?;
        let shape = volume_shape(&header)?;
        if out.shape() != shape {
            return Err(wrong_shape(&shape, out.shape()));
        }
        match out.as_slice_mut() {
            Some(out) => self.read_into_slice(part, out, threads, progress),
            None => {
                out.assign(&self.read_array(part, threads, progress)?);
                Ok(())
            }
        }
    }

    /// Reads any part into a slice: component fastest, then x, y, z, time step.
    ///
    /// # Errors
    /// As [`Container::read_array`], and [`ArrayError::WrongShape`] for a slice of another length. The slice may be
    /// written in part then.
    pub fn read_into_slice<T: Sample>(
        &self,
        part: &Part,
        out: &mut [T],
        threads: Option<NonZeroUsize>,
        progress: Progress<'_>,
    ) -> Result<(), ArrayError> {
        let header = self.typed_header::<T>(part)?;
        let values: usize = shape(&header).into_iter().product();
        if out.len() != values {
            return Err(wrong_shape(&[values], &[out.len()]));
        }
        self.read_into(part, cast_slice_mut(out), threads, progress)?;
        if cfg!(target_endian = "big") {
            out.iter_mut().for_each(|value| *value = T::of_little(*value));
        }
        Ok(())
    }

    fn typed_header<T: Sample>(&self, part: &Part) -> Result<Header, ArrayError> {
        let found = self.head().element;
        if found != T::ELEMENT {
            return Err(ArrayError::WrongType { asked: T::ELEMENT, found });
        }
        Ok(self.header_of(part)?)
    }

    fn read_vec<T: Sample>(
        &self,
        header: &Header,
        part: &Part,
        threads: Option<NonZeroUsize>,
        progress: Progress<'_>,
    ) -> Result<Vec<T>, ArrayError> {
        let bytes = header.bytes().unwrap_or(u64::MAX);
        let too_large = || ContainerError::OutOfMemory { bytes };
        let len = usize::try_from(bytes / size_of::<T>() as u64).map_err(|_| too_large())?;
        Vec::<T>::new().try_reserve_exact(len).map_err(|_| too_large())?;
        let mut values = vec![T::zeroed(); len];
        self.read_into_slice(part, &mut values, threads, progress)?;
        Ok(values)
    }
}

/// `[step, z, y, x, component]`; a container that was opened has as many values as can be counted.
fn shape(header: &Header) -> [usize; 5] {
    let [x, y, z] = header.extent;
    [header.steps, z, y, x, header.components.into()]
        .map(|count| usize::try_from(count).unwrap_or(usize::MAX))
}

/// `[z, y, x]` of one volume of single values.
fn volume_shape(header: &Header) -> Result<[usize; 3], ContainerError> {
    let (steps, components) = (header.steps, header.components);
    match shape(header) {
        [1, z, y, x, 1] => Ok([z, y, x]),
        _ => Err(ContainerError::NotScalar { steps, components }),
    }
}

fn wrong_shape(expected: &[usize], found: &[usize]) -> ArrayError {
    ArrayError::WrongShape { expected: expected.to_vec(), found: found.to_vec() }
}

/// Values of an array or a slice, to be compressed or written to a file: what [`InMemory`] makes a source of.
#[derive(Clone, Debug)]
pub struct Samples<'a> {
    header: Header,
    bytes: Cow<'a, [u8]>,
}

impl<'a> Samples<'a> {
    /// A volume of the shape `[z, y, x]`; an image is one of a single slice, by `insert_axis(Axis(0))`.
    ///
    /// # Errors
    /// [`ArrayError::Empty`].
    ///
    /// Cost: a copy if it does not lie in one piece, in C order.
    pub fn of_array<T: Sample>(array: ArrayView3<'a, T>) -> Result<Self, ArrayError> {
        Self::of_array5(array.insert_axis(Axis(0)).insert_axis(Axis(4)))
    }

    /// Time steps of a volume of several components, of the shape `[step, z, y, x, component]`.
    ///
    /// # Errors
    /// [`ArrayError`]: no values, or more than 2^32 - 1 components.
    ///
    /// Cost: as [`Samples::of_array`].
    pub fn of_array5<T: Sample>(array: ArrayView5<'a, T>) -> Result<Self, ArrayError> {
        let shape = array.dim();
        let (steps, z, y, x, components) = shape;
        let [x, y, z, steps] = [x, y, z, steps].map(|count| count as u64);
        let bytes = match array.to_slice() {
            Some(values) => little_endian(values),
            None => Cow::Owned(little_endian(&array.iter().copied().collect::<Vec<T>>()).into_owned()),
        };
        let metadata = Metadata::plain(3, FileFormat::Npy);
        let mut header = Header::scalar([x, y, z], T::ELEMENT, metadata);
        let few = u32::try_from(components);
        let most = || wrong_shape(&[u32::MAX as usize], &[components]);
        (header.components, header.steps) = (few.map_err(|_| most())?, steps);
        if bytes.is_empty() { Err(ArrayError::Empty) } else { Ok(Self { header, bytes }) }
    }

    /// A volume of `extent` samples along x, y, z, x fastest.
    ///
    /// # Errors
    /// [`ArrayError`]: no values, or another number than the extent says.
    pub fn of_slice<T: Sample>(extent: [u64; 3], values: &'a [T]) -> Result<Self, ArrayError> {
        let header = Header::scalar(extent, T::ELEMENT, Metadata::plain(3, FileFormat::Npy));
        let bytes = little_endian(values);
        if header.bytes() != Some(bytes.len() as u64) {
            let [x, y, z] = extent.map(|count| usize::try_from(count).unwrap_or(usize::MAX));
            return Err(wrong_shape(&[z, y, x], &[values.len()]));
        }
        if bytes.is_empty() { Err(ArrayError::Empty) } else { Ok(Self { header, bytes }) }
    }

    /// The same with the distances between samples along x, y and z.
    #[must_use]
    pub fn with_spacing(mut self, spacing: [f64; 3]) -> Self {
        self.header.metadata.set_geometry(&Geometry::along_axes(spacing, [0.0; 3]));
        self
    }

    /// The same with all that there is to say beside extent and type, such as what another file said of its samples.
    #[must_use]
    pub fn with_metadata(mut self, metadata: Metadata) -> Self {
        self.header.metadata = metadata;
        self
    }

    /// All but the values.
    pub const fn header(&self) -> &Header {
        &self.header
    }

    /// The bytes of a compressed file of the values: [`compress_stream`] into memory.
    ///
    /// ```
    /// use wavelift_host::array::Samples;
    /// use wavelift_host::codec::{CompressOptions, Container};
    /// use wavelift_host::ndarray::Array3;
    ///
    /// let array = Array3::from_shape_fn((9, 20, 30), |(z, y, x)| (z * y + x) as u16);
    /// let bytes = Samples::of_array(array.view())?.compress(&CompressOptions::default())?;
    /// let back: Array3<u16> = Container::new(Box::new(bytes))?.to_array()?;
    /// assert_eq!(back, array);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`CompressError`]: options that are contradictory.
    pub fn compress(&self, options: &CompressOptions) -> Result<Vec<u8>, CompressError> {
        let mut bytes = Vec::new();
        compress_stream(&mut self.source(), options, &mut bytes, &ignore)?;
        Ok(bytes)
    }

    /// A source of the values, to be compressed or copied.
    ///
    /// # Panics
    /// Never: there are as many values as the header says.
    pub fn source(&self) -> InMemory<'_> {
        InMemory::of(self.header.clone(), &self.bytes).expect("as many values as the header says")
    }

    /// A copy of the values as a volume.
    ///
    /// # Errors
    /// [`ArrayError`]: several steps or components.
    pub fn to_volume(&self) -> Result<Volume, ArrayError> {
        let Header { extent, element, metadata, .. } = self.header.clone();
        volume_shape(&self.header)?;
        Ok(Volume { extent, element, samples: self.bytes.to_vec(), metadata })
    }
}

/// The bytes of values, little-endian.
pub(crate) fn little_endian<T: Sample>(values: &[T]) -> Cow<'_, [u8]> {
    if cfg!(target_endian = "little") {
        Cow::Borrowed(cast_slice(values))
    } else {
        let values: Vec<T> = values.iter().copied().map(T::of_little).collect();
        Cow::Owned(cast_slice(&values).to_vec())
    }
}

/// # Arrays
impl Volume {
    /// A copy of the samples as an array of the shape `[z, y, x]`.
    ///
    /// # Errors
    /// [`ArrayError`]: another type, or samples of another number than the extent says.
    pub fn to_array<T: Sample>(&self) -> Result<Array3<T>, ArrayError> {
        if self.element != T::ELEMENT {
            return Err(ArrayError::WrongType { asked: T::ELEMENT, found: self.element });
        }
        let [x, y, z] = self.extent.map(|count| usize::try_from(count).unwrap_or(usize::MAX));
        let values = self.samples.chunks_exact(size_of::<T>());
        let values: Vec<T> = values.map(|value| T::of_little(bytemuck::pod_read_unaligned(value))).collect();
        let found = values.len();
        Array3::from_shape_vec((z, y, x), values).map_err(|_| wrong_shape(&[z, y, x], &[found]))
    }

    /// The samples, whatever their type, as numbers in double precision, of the shape `[z, y, x]`: exact but for integers
    /// beyond 2^53. A slope or intercept that a file gave of its values is not applied.
    ///
    /// ```
    /// use wavelift_host::volume;
    ///
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("head.nrrd");
    /// # let made = volume::synthetic::generate(volume::synthetic::Kind::Waves, [9, 8, 7], volume::ElementType::I16, 1);
    /// # volume::write(&made, &path, &volume::WriteOptions::default())?;
    /// let numbers = volume::read(&path, None)?.to_numbers()?;
    /// assert_eq!(numbers.dim(), (7, 8, 9));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArrayError::WrongShape`]: samples of another number than the extent says.
    pub fn to_numbers(&self) -> Result<Array3<f64>, ArrayError> {
        let mut numbers = Vec::with_capacity(self.samples.len() / self.element.bytes());
        each_f64(self.element, &self.samples, &mut |number| numbers.push(number));
        let [x, y, z] = self.extent.map(|count| usize::try_from(count).unwrap_or(usize::MAX));
        let found = numbers.len();
        Array3::from_shape_vec((z, y, x), numbers).map_err(|_| wrong_shape(&[z, y, x], &[found]))
    }
}

#[cfg(test)]
mod tests;
