//! Failures: what the user is told, and the exit code.

use std::fmt::Display;
use std::path::Path;
use std::process::ExitCode;

use wavelift_host::volume::{Fault, ReadError, WriteError};

/// Why a command gave up.
#[derive(Debug)]
pub(crate) struct Failure {
    fault: Fault,
    /// File, fault, and what to do.
    message: String,
}

impl Failure {
    /// A failure whose message is complete.
    pub(crate) fn new(fault: Fault, message: impl Display) -> Self {
        Self { fault, message: message.to_string() }
    }

    /// A failure with a file; the message is completed to `FILE: message`.
    pub(crate) fn at(path: &Path, fault: Fault, message: impl Display) -> Self {
        Self::new(fault, format_args!("{}: {message}", path.display()))
    }

    /// Tells the user on standard error and returns the exit code.
    pub(crate) fn report(&self) -> ExitCode {
        eprintln!("wavelift: {}", self.message);
        ExitCode::from(self.code())
    }

    const fn code(&self) -> u8 {
        match self.fault {
            Fault::Usage => 2,
            Fault::Data => 3,
            Fault::Io => 4,
        }
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        Self::new(error.kind(), error)
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        Self::new(error.kind(), error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_the_file_and_codes_the_fault() {
        let path = Path::new("field.raw");
        for (fault, code) in [(Fault::Usage, 2), (Fault::Data, 3), (Fault::Io, 4)] {
            let failure = Failure::at(path, fault, "no samples: give some");
            assert_eq!((failure.code(), &failure.message[..]), (code, "field.raw: no samples: give some"));
        }
        let missing = Failure::from(ReadError::NoLayout { path: path.to_owned() });
        assert_eq!(missing.code(), 2);
        assert!(missing.message.starts_with("field.raw: "));
    }
}
