//! Failures: what the user is told, and the exit code.

use std::fmt::Display;
use std::io::{self, ErrorKind};
use std::path::Path;
use std::process::ExitCode;

use wavelift_host::codec::{CompressError, ContainerError};
use wavelift_host::volume::{CopyError, Fault, FileFormat, ReadError, WriteError, in_words};

use super::output::say;

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

    /// A failure of a compressed file.
    pub(crate) fn of_container(path: &Path, error: &ContainerError) -> Self {
        let error = error.cause();
        match error {
            ContainerError::Io(cause) if cause.kind() == ErrorKind::NotSeekable => Self::at(
                path,
                Fault::Io,
                "a compressed file is read from its end, so it cannot come through a pipe: store it first",
            ),
            ContainerError::Io(cause) => {
                Self::at(path, Fault::Io, format_args!("cannot read: {}", in_words(cause)))
            }
            ContainerError::NotAContainer if FileFormat::of_path(path) != FileFormat::Raw => Self::at(
                path,
                error.kind(),
                format_args!(
                    "{error}: `wavelift compress` makes one of it, `wavelift convert` and `preview` read it"
                ),
            ),
            damage if damage.is_damage() => {
                Self::at(path, error.kind(), format_args!("{error}: `wavelift repair` saves what is whole"))
            }
            _ => Self::at(path, error.kind(), error),
        }
    }

    /// A failure of the system to write a file.
    pub(crate) fn cannot_write(path: &Path, cause: &io::Error) -> Self {
        Self::at(path, Fault::Io, format_args!("cannot write: {}", in_words(cause)))
    }

    /// Tells the user on standard error and returns the exit code.
    pub(crate) fn report(&self) -> ExitCode {
        say(format_args!("wavelift: {}", self.message));
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
        let advice = match error {
            ReadError::NoLayout { .. } => ", with --extent XxYxZ and --type T",
            ReadError::NotScalar { .. } => ": `wavelift compress` and `wavelift convert` take all of them",
            _ => "",
        };
        Self::new(error.kind(), format_args!("{error}{advice}"))
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        Self::new(error.kind(), error)
    }
}

impl From<CompressError> for Failure {
    fn from(error: CompressError) -> Self {
        match error {
            CompressError::Read(error) => error.into(),
            CompressError::Container(ContainerError::Open { path, cause }) => {
                Self::of_container(&path, &cause)
            }
            other => Self::new(other.kind(), other),
        }
    }
}

impl From<CopyError> for Failure {
    fn from(error: CopyError) -> Self {
        match error {
            CopyError::Read(error) => error.into(),
            other => Self::new(other.kind(), other),
        }
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
        assert!(missing.message.ends_with("give its layout, with --extent XxYxZ and --type T"));
    }
}
