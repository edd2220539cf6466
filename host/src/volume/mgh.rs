//! FreeSurfer's volumes (`.mgh`, and `.mgz` in gzip): a header of 284 bytes, big-endian, then samples; read only.
//!
//! Source: *FsTutorial/MghFormat* (the FreeSurfer wiki). Axes are x, y, z and frames, fastest first. What stands behind
//! the samples (times of the scan, tags) is passed over.

use std::io::{self, Read};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use super::format::{Format, has_extension};
use super::input::Input;
use super::stored::{Encoding, GZIP, Place, Stored};
use super::{
    Axis, ByteOrder, Created, ElementType, ExtentError, FileFormat, Geometry, Header, Metadata, Origin,
    ReadError, Source, Space, WriteError, WriteOptions,
};

/// Bytes before the samples.
const BYTES: usize = 284;

/// The only version there is.
const VERSION: i32 = 1;

/// What keeps a file of FreeSurfer from being read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MghError {
    /// The file ends before its header does.
    #[error("the file ends within its header")]
    Truncated,
    /// Another version, or another format.
    #[error("its header says version {found}, where there is only 1")]
    Version {
        /// What it says.
        found: i32,
    },
    /// Samples of a type that is not read.
    #[error("samples of type {code} are not read, only 0, 1, 3, 4 and 10")]
    Type {
        /// The type.
        code: i32,
    },
    /// Axes that make no data set.
    #[error("its header says {found} samples along x, y, z and frames: {cause}")]
    Extent {
        /// What it says.
        found: String,
        /// What is wrong with it.
        cause: ExtentError,
    },
}

/// The format of the Massachusetts General Hospital, which is read only.
pub(super) struct Mgh;

impl Format for Mgh {
    fn format(&self) -> FileFormat {
        FileFormat::Mgh
    }

    fn has_name(&self, path: &Path) -> bool {
        has_extension(path, &["mgh", "mgz", "mgh.gz"])
    }

    fn open_input(&self, mut input: Input) -> Result<Box<dyn Source>, ReadError> {
        let path = input.path().to_owned();
        let encoding = if input.starts_with(GZIP)? { Encoding::Gzip } else { Encoding::Raw };
        let mut bytes = [0; BYTES];
        let (read, mut input) = match encoding {
            Encoding::Raw => (input.read_exact(&mut bytes), input),
            _ => {
                let mut decoder = MultiGzDecoder::new(input);
                (decoder.read_exact(&mut bytes), decoder.into_inner())
            }
        };
        let fault =
            |cause| ReadError::Format { path: path.clone(), format: FileFormat::Mgh, cause: Box::new(cause) };
        read.map_err(|cause| match cause.kind() {
            io::ErrorKind::UnexpectedEof => fault(MghError::Truncated),
            _ if cause.raw_os_error().is_none() => ReadError::Gzip { path: path.clone(), cause },
            _ => ReadError::Io { path: path.clone(), cause },
        })?;
        let header = header(&bytes).map_err(fault)?;
        input.seek(0)?;
        let place = Place { encoding, byte_order: ByteOrder::Big, skip: BYTES as u64, is_open_ended: true };
        Ok(Box::new(Stored::new(input, header, place)?))
    }

    fn create(&self, path: &Path, _: &Header, _: &WriteOptions) -> Result<Created, WriteError> {
        let what =
            "what wavelift writes, they are only read: write .nii.gz, which FreeSurfer reads".to_owned();
        Err(WriteError::CannotHold { path: path.to_owned(), format: FileFormat::Mgh, what })
    }
}

/// `N` bytes from `place` on.
fn at<const N: usize>(bytes: &[u8; BYTES], place: usize) -> [u8; N] {
    std::array::from_fn(|byte| bytes[place + byte])
}

fn header(bytes: &[u8; BYTES]) -> Result<Header, MghError> {
    let integer = |place| i32::from_be_bytes(at(bytes, place));
    if integer(0) != VERSION {
        return Err(MghError::Version { found: integer(0) });
    }
    let element = match integer(20) {
        0 => ElementType::U8,
        1 => ElementType::I32,
        3 => ElementType::F32,
        4 => ElementType::I16,
        10 => ElementType::U16,
        code => return Err(MghError::Type { code }),
    };
    let found = [4, 8, 12, 16].map(integer);
    // A count below zero is as impossible as zero.
    let counts = found.map(|count| u64::try_from(count).unwrap_or(0));
    let mut metadata = Metadata::plain(3, FileFormat::Mgh);
    metadata.source = Origin { format: FileFormat::Mgh, byte_order: ByteOrder::Big, fortran_order: false };
    let rank = if counts[3] == 1 { 3 } else { 4 };
    if rank > 3 {
        metadata.axes.push(Axis::Time(counts[3]));
    }
    metadata.set_geometry(&geometry(bytes, counts));
    metadata.set_field("space units", "\"mm\" \"mm\" \"mm\"");
    Header::of_axes(&counts[..rank], element, metadata)
        .map_err(|cause| MghError::Extent { found: found.map(|count| count.to_string()).join(" x "), cause })
}

/// Where the samples lie: the header has steps, directions, and the place of the middle; without them they lie as in the
/// format's default, coronal slices of 1 mm about the middle of space.
fn geometry(bytes: &[u8; BYTES], counts: [u64; 4]) -> Geometry {
    let real = |place| f64::from(f32::from_be_bytes(at(bytes, place)));
    let three = |place: usize| [0, 4, 8].map(|more| real(place + more));
    let is_placed = i16::from_be_bytes(at(bytes, 28)) != 0;
    let (spacing, middle, directions) = if is_placed {
        (three(30), three(78), [42, 54, 66].map(three))
    } else {
        ([1.0; 3], [0.0; 3], [[-1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    };
    let mut steps = directions;
    for (step, spacing) in steps.iter_mut().zip(spacing) {
        *step = step.map(|part| part * spacing);
    }
    let from_middle =
        |part: usize| (0..3).map(|axis| steps[axis][part] * counts[axis] as f64 / 2.0).sum::<f64>();
    let origin = [0, 1, 2].map(|part| middle[part] - from_middle(part));
    Geometry { space: Space::RightAnteriorSuperior, directions: steps, origin }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    /// 3 x 2 x 2 samples of `i16`, 1 to 12, in two frames or one, and eight bytes behind them.
    fn file(frames: i32, is_placed: bool) -> Vec<u8> {
        let mut bytes = vec![0; BYTES];
        let mut put = |place: usize, word: [u8; 4]| bytes[place..place + 4].copy_from_slice(&word);
        for (place, number) in
            [(0, 1), (4, 3), (8, 2), (12, if frames == 1 { 2 } else { 1 }), (16, frames), (20, 4)]
        {
            put(place, i32::to_be_bytes(number));
        }
        let reals = [1.0, 2.0, 3.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 5.0, 6.0, 7.0];
        for (number, real) in reals.into_iter().enumerate() {
            put(30 + 4 * number, f32::to_be_bytes(real));
        }
        bytes[29] = is_placed.into();
        bytes.extend((1..=12_i16).flat_map(i16::to_be_bytes));
        bytes.extend([9; 8]);
        bytes
    }

    fn open(bytes: &[u8]) -> Result<(Header, Vec<u8>), ReadError> {
        let mut source = Mgh.open_input(Input::from_bytes(bytes))?;
        let mut values = vec![0; source.header().bytes().unwrap() as usize];
        source.read(&mut values)?;
        Ok((source.header().clone(), values))
    }

    #[test]
    fn samples_and_their_places_are_read() {
        let little: Vec<u8> = (1..=12_i16).flat_map(i16::to_le_bytes).collect();
        let (header, values) = open(&file(1, true)).unwrap();
        assert_eq!((header.extent, header.steps, header.element), ([3, 2, 2], 1, ElementType::I16));
        assert_eq!(values, little);
        let geometry = header.metadata.geometry().unwrap();
        assert_eq!(geometry.directions, [[-1.0, 0.0, 0.0], [0.0, 0.0, -2.0], [0.0, 3.0, 0.0]]);
        assert_eq!((geometry.space, geometry.origin), (Space::RightAnteriorSuperior, [6.5, 3.0, 9.0]));
        let (header, _) = open(&file(1, false)).unwrap();
        assert_eq!(header.metadata.geometry().unwrap().origin, [1.5, -1.0, 1.0]);
        let (header, values) = open(&file(2, true)).unwrap();
        assert_eq!((header.extent, header.steps, values), ([3, 2, 1], 2, little.clone()));
        let mut packed = GzEncoder::new(Vec::new(), Compression::default());
        packed.write_all(&file(1, true)).unwrap();
        assert_eq!(open(&packed.finish().unwrap()).unwrap().1, little);
    }

    #[test]
    fn what_is_wrong_is_told() {
        let whole = file(1, true);
        for length in 0..whole.len() - 8 {
            open(&whole[..length]).unwrap_err();
        }
        for (place, number, said) in
            [(0, 2, "version 2"), (20, 2, "type 2"), (4, 0, "0 x 2 x 2 x 1"), (8, -5, "3 x -5 x 2 x 1")]
        {
            let mut changed = whole.clone();
            changed[place..place + 4].copy_from_slice(&i32::to_be_bytes(number));
            let told = open(&changed).unwrap_err().to_string();
            assert!(told.contains(said), "{told}");
        }
    }
}
