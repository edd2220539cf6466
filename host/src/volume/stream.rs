//! Files of volumes as streams: samples come and go a piece at a time, so that no more than a piece is in memory.

use std::path::{Path, PathBuf};

use super::format::Format;
use super::input::Input;
use super::slices::{self, Pattern};
use super::watched::Watched;
use super::{FileFormat, Header, RawLayout, ReadError, Volume, WriteError, WriteOptions, format, raw};

/// A file of a data set that is being read.
///
/// Values come in the order of [`Header`]: component fastest, then x, y, z, time step; little-endian, whatever the
/// file has.
///
/// Whatever can give its values so can be compressed and copied, as here what is computed when it is asked for:
///
/// ```
/// use wavelift_host::codec::{CompressOptions, Container, compress_file};
/// use wavelift_host::progress::ignore;
/// use wavelift_host::volume::{ElementType, Header, Metadata, ReadError, Source};
///
/// struct Squares {
///     header: Header,
///     next: u64,
/// }
///
/// impl Source for Squares {
///     fn header(&self) -> &Header {
///         &self.header
///     }
///
///     fn read(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
///         for value in out.chunks_exact_mut(4) {
///             value.copy_from_slice(&((self.next * self.next) as u32).to_le_bytes());
///             self.next += 1;
///         }
///         Ok(())
///     }
///
///     fn seek(&mut self, position: u64) -> Result<(), ReadError> {
///         self.next = position / 4;
///         Ok(())
///     }
///
///     fn is_random(&self) -> bool {
///         true
///     }
/// }
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("squares.wlift");
/// let header = Header::scalar([16, 8, 4], ElementType::U32, Metadata::default());
/// compress_file(&path, &mut Squares { header, next: 0 }, &CompressOptions::default(), &ignore)?;
/// assert_eq!(Container::open(&path)?.to_array::<u32>()?[[3, 7, 15]], 511 * 511);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Source: Send {
    /// What the file says of its samples.
    fn header(&self) -> &Header;

    /// Fills `out`, whole values, with those that follow. The call that takes the last one also finds out whether the
    /// file ends there.
    ///
    /// # Errors
    /// [`ReadError`]: the file is damaged, has too few values or too many, or cannot be read.
    fn read(&mut self, out: &mut [u8]) -> Result<(), ReadError>;

    /// Goes to the value at byte `position` of all values; 0 begins anew. Every source can go to every place.
    ///
    /// # Errors
    /// [`ReadError`], as for [`Source::read`] of all that lies before.
    fn seek(&mut self, position: u64) -> Result<(), ReadError>;

    /// Whether going to a place costs little; in compressed samples it means to decompress all that lies before.
    fn is_random(&self) -> bool;

    /// Asks for no more than so many bytes of values to be held at a time, where more than a piece or a plane is held:
    /// what has to be decoded as a whole is held as a whole. Returns the bytes that will be held, about.
    fn hold_at_most(&mut self, _bytes: u64) -> u64 {
        0
    }

    /// The files that hold the values, or the folder of an array; none for memory. The last call of [`Source::read`] of
    /// what [`open`] gives also finds out whether one of them has changed.
    fn files(&self) -> Vec<PathBuf> {
        Vec::new()
    }
}

/// A file of a data set that is being written. It appears whole when it is finished, or not at all.
pub trait Sink: Send {
    /// Takes the next values, whole ones, in the order of [`Header`].
    ///
    /// # Errors
    /// [`WriteError`]; nothing has changed at the path then.
    fn write(&mut self, values: &[u8]) -> Result<(), WriteError>;

    /// Puts the file in its place.
    ///
    /// # Errors
    /// [`WriteError`], also where values are missing; nothing has changed at the path then.
    fn finish(self: Box<Self>) -> Result<(), WriteError>;
}

/// A [`Sink`], and what its format has no place for.
pub struct Created {
    /// Where values go.
    pub sink: Box<dyn Sink>,
    /// What is lost: fields by name, `2 comments`, `17 key/value pairs`.
    pub losses: Vec<String>,
}

impl std::fmt::Debug for Created {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Created").field("losses", &self.losses).finish_non_exhaustive()
    }
}

/// Opens a data set of any format. With a layout the file is taken as raw, whatever its name.
///
/// A folder, or a pattern such as `scan_%04d.png` or `scan_*.tif`, stands for files of one slice each.
///
/// # Errors
/// [`ReadError`]: no format that is known, a header that is none, a file of another length than its header says.
///
/// Cost: that of reading the header. A pipe is copied to a temporary file as it is read.
pub fn open(path: impl AsRef<Path>, layout: Option<&RawLayout>) -> Result<Box<dyn Source>, ReadError> {
    let path = path.as_ref();
    let source = match layout.copied() {
        Some(layout) => open_each(path, true, move |file| raw::open(Input::open(file)?, &layout)),
        None => open_by_format(path, None),
    };
    Ok(Box::new(Watched::new(source?)))
}

/// As [`open`] without a layout, but where the file is raw, it is taken to have that one.
///
/// # Errors
/// As [`open`], but for [`ReadError::NoLayout`].
pub fn open_known(path: impl AsRef<Path>, layout: &RawLayout) -> Result<Box<dyn Source>, ReadError> {
    Ok(Box::new(Watched::new(open_by_format(path.as_ref(), Some(layout))?)))
}

fn open_by_format(path: &Path, layout: Option<&RawLayout>) -> Result<Box<dyn Source>, ReadError> {
    if let Some(format) = format::of_path(path).filter(|format| format.takes_folders()) {
        return format.open(path);
    }
    let layout = layout.copied();
    open_each(path, false, move |file| open_file(file, layout.as_ref()))
}

/// Opens a file with `open`, or the stack of files that a path stands for.
fn open_each(
    path: &Path,
    is_any: bool,
    open: impl Fn(&Path) -> Result<Box<dyn Source>, ReadError> + Send + 'static,
) -> Result<Box<dyn Source>, ReadError> {
    match slices::files(path, is_any)? {
        Some(files) => slices::open(path, files, Box::new(open)),
        None => open(path),
    }
}

fn open_file(path: &Path, layout: Option<&RawLayout>) -> Result<Box<dyn Source>, ReadError> {
    if let Some(format) = format::of_path(path) {
        return format.open(path);
    }
    let mut input = Input::open(path)?;
    match (format::of_first_bytes(&mut input)?, layout) {
        (Some(format), _) => format.open_input(input),
        (None, Some(layout)) => raw::open(input, layout),
        (None, None) => Err(ReadError::NoLayout { path: path.to_owned() }),
    }
}

/// Begins a file in the format of the path's extension, raw for an unknown one.
///
/// A pattern such as `scan_%04d.png` or `scans/*.tif` stands for a file for each slice, numbered from 0.
///
/// # Errors
/// [`WriteError`]: the format cannot hold such a data set, or the system refuses. Nothing has changed at the path then.
pub fn create(
    path: impl AsRef<Path>,
    header: &Header,
    options: &WriteOptions,
) -> Result<Created, WriteError> {
    let path = path.as_ref();
    let format: &'static dyn Format = format::of_path(path).unwrap_or(&raw::Raw);
    if format::has_extension(path, &["wlift", "wsurf"]) {
        return Err(WriteError::Compressed { path: path.to_owned() });
    }
    if let Some(what) = format::mistaken(path).filter(|_| format.format() == FileFormat::Raw) {
        return Err(WriteError::Foreign { path: path.to_owned(), what });
    }
    if options.gzip && !format.compresses(path) {
        return Err(WriteError::NoGzip { path: path.to_owned() });
    }
    match Pattern::of_path(path) {
        Some(pattern) if !format.takes_folders() => slices::create(path, pattern, format, header, *options),
        _ => format.create(path, header, options),
    }
}

/// A volume in memory, as a source.
#[derive(Debug)]
pub struct InMemory<'a> {
    header: Header,
    samples: &'a [u8],
    at: usize,
}

impl<'a> InMemory<'a> {
    /// The samples of a volume, as many as its extent and type say; if not, `None`.
    pub fn new(volume: &'a Volume) -> Option<Self> {
        Self::of(volume.header(), &volume.samples)
    }

    /// Values in the order of [`Header`], as many as it says; if not, `None`.
    pub fn of(header: Header, samples: &'a [u8]) -> Option<Self> {
        (header.bytes() == Some(samples.len() as u64)).then_some(Self { header, samples, at: 0 })
    }
}

impl Source for InMemory<'_> {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        let end = self.at.saturating_add(out.len());
        let found =
            self.samples.get(self.at..end).ok_or_else(|| ReadError::BeyondEnd { path: "memory".into() })?;
        out.copy_from_slice(found);
        self.at = end;
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        self.at = usize::try_from(position).unwrap_or(usize::MAX);
        Ok(())
    }

    fn is_random(&self) -> bool {
        true
    }
}
