//! What goes to standard output, and to files that are no volumes.

use std::fmt;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::path::Path;

use wavelift_host::atomic::AtomicFile;
use wavelift_host::volume::Fault;

use super::exit::Failure;

/// Writes `text` to standard output. A reader that has gone away, such as `head`, is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(cause) if cause.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::new(Fault::Io, format_args!("cannot write to standard output: {cause}")))
        }
        _ => Ok(()),
    }
}

/// Writes a JSON document to standard output, indented.
pub(crate) fn print_json(document: &serde_json::Value) -> Result<(), Failure> {
    print(&format!("{document:#}\n"))
}

/// Tells a person at a terminal what was done; says nothing in a pipe.
pub(crate) fn tell(what: fmt::Arguments<'_>) {
    if io::stderr().is_terminal() {
        eprintln!("{what}");
    }
}

/// Writes a file of text that appears whole or not at all.
pub(crate) fn write_file(path: &Path, text: &str) -> Result<(), Failure> {
    write_atomically(path, |file| file.write_all(text.as_bytes()).map_err(|cause| cannot_write(path, &cause)))
}

/// Writes a file with `fill`; it appears whole or, if that fails, not at all.
pub(crate) fn write_atomically<T>(
    path: &Path,
    fill: impl FnOnce(&mut AtomicFile) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let mut file = AtomicFile::create(path).map_err(|cause| cannot_write(path, &cause))?;
    let filled = fill(&mut file)?;
    file.commit().map_err(|cause| cannot_write(path, &cause))?;
    Ok(filled)
}

fn cannot_write(path: &Path, cause: &io::Error) -> Failure {
    Failure::at(path, Fault::Io, format_args!("cannot write: {cause}"))
}
