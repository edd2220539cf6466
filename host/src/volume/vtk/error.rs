//! What can be wrong with a VTK file.

/// Why a VTK file cannot be read. Texts from the file are quoted and shortened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtkError {
    /// The first line of a legacy file is another.
    #[error("it does not begin with `# vtk DataFile Version`")]
    Magic,
    /// A line of a legacy file that has no place there.
    #[error("the line {text} is not understood here: {expected} was expected")]
    Line {
        /// The line.
        text: String,
        /// What can stand there.
        expected: &'static str,
    },
    /// Markup that is no XML.
    #[error("it is no proper XML: {0}")]
    Xml(String),
    /// A data set without a regular grid.
    #[error("its data are {found}, no image on a regular grid: resample them to ImageData with VTK first")]
    Kind {
        /// The kind as the file says it.
        found: String,
    },
    /// A line or a tag that is longer than any sensible one.
    #[error("a line or tag of its header is longer than {limit} bytes")]
    TooLong {
        /// Bytes that are read at most.
        limit: u64,
    },
    /// Something that has to be there and is not.
    #[error("{what} is missing")]
    Missing {
        /// What it is.
        what: &'static str,
    },
    /// A value that makes no sense.
    #[error("{what} is {value}, which is not {expected}")]
    Value {
        /// What has the value.
        what: &'static str,
        /// The value.
        value: String,
        /// What it should be.
        expected: &'static str,
    },
    /// More samples than 64 bits count.
    #[error("its extent has more samples than 64 bits can count the bytes of")]
    TooLarge,
    /// A piece that is not within the whole.
    #[error("one of its pieces lies outside of the whole")]
    Outside,
    /// A sample that is in no piece.
    #[error("none of its pieces has the sample at {}, {}, {}", place[0], place[1], place[2])]
    Hole {
        /// Place of the sample, counted from 0 along x, y, z.
        place: [u64; 3],
    },
    /// A file that is not the part of an image that it is listed as.
    #[error("it has not the points or the array that {list} lists it with")]
    OtherPiece {
        /// File that lists it.
        list: String,
    },
    /// A pipe.
    #[error("its image lies in several pieces, and cannot come through a pipe: store it first")]
    Pipe,
    /// No data at all.
    #[error("it has no arrays of point data or cell data")]
    NoArrays,
    /// An array that is not there.
    #[error("it has no array {name}; there are: {names}")]
    NoSuchArray {
        /// The one that was asked for.
        name: String,
        /// Those that are there.
        names: String,
    },
    /// An array of something else than numbers.
    #[error("the array {name} holds values of type {found}, not integers or floats of 8 to 64 bits")]
    Element {
        /// Name of the array.
        name: String,
        /// Type of its values in the file's words.
        found: String,
    },
    /// A compressor that is not known.
    #[error(
        "its data are compressed with {found}: vtkZLibDataCompressor and vtkLZ4DataCompressor are read, so write it again \
         with one of these"
    )]
    Compressor {
        /// Name as the file has it.
        found: String,
    },
    /// A table of compressed blocks that does not fit the array.
    #[error("the table of its compressed blocks does not fit {expected} bytes of samples")]
    Blocks {
        /// Bytes of samples.
        expected: u64,
    },
    /// An array of another length.
    #[error("an array has {found} bytes where its extent and type need {expected}")]
    Bytes {
        /// Bytes according to extent and type.
        expected: u64,
        /// Bytes according to the word before the samples.
        found: u64,
    },
    /// Samples that cannot be made out.
    #[error("its samples are damaged or cut short: {0}")]
    Samples(std::io::Error),
}
