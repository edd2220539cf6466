//! What can be wrong with a file of HDF5 or NetCDF.

/// Why a file of HDF5 or NetCDF cannot be read. Texts from files are quoted and shortened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Hdf5Error {
    /// Bytes that no such file begins with.
    #[error("it is neither HDF5 nor NetCDF (HDF4, and .mat before MATLAB's -v7.3, are not read)")]
    NoSuchFormat,
    /// A pipe.
    #[error("it is read from many places, and cannot come through a pipe: store it first")]
    Pipe,
    /// No variables of numbers.
    #[error("it holds no variable of integers or floats of 8 to 64 bits with an axis")]
    NoNumbers,
    /// Chunks in a coding that is not read.
    #[error("{0}: store it with gzip, such as with `h5repack -f GZIP=4`")]
    Filter(String),
    /// Several variables with as many axes.
    #[error("it holds {names}: give one as FILE#NAME")]
    Variables {
        /// Variables of numbers.
        names: String,
    },
    /// A variable that is not there, or holds no numbers.
    #[error("there is no variable {asked} of integers or floats of 8 to 64 bits: it holds {names}")]
    NoVariable {
        /// The variable asked for.
        asked: String,
        /// Variables of numbers.
        names: String,
    },
    /// An axis of no samples, or more samples than can be counted.
    #[error("its variable {name}: {cause}")]
    Extent {
        /// The variable.
        name: String,
        /// What is wrong with its axes.
        cause: crate::volume::ExtentError,
    },
    /// What `netcdf-reader` does not read.
    #[error("{0}")]
    Reader(String),
}
