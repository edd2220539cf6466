//! A file of the host, as a writer of `embedded_io`.

use core::ffi::CStr;

use embedded_io::{ErrorKind, ErrorType, Write};
use semihosting::fs;
use semihosting::io::Write as _;

/// A file that is being written.
pub(crate) struct File(fs::File);

impl File {
    /// A new one, or an old one emptied.
    pub(crate) fn create(name: &CStr) -> Result<Self, ErrorKind> {
        fs::File::create(name).map(Self).map_err(|_| ErrorKind::NotFound)
    }
}

impl ErrorType for File {
    type Error = ErrorKind;
}

impl Write for File {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        self.0.write(bytes).map_err(|_| ErrorKind::Other)
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}
