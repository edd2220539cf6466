//! What goes to standard output, and to files that are no volumes.

use std::fmt;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};

use clap::builder::TypedValueParser;
use wavelift_host::atomic::AtomicFile;
use wavelift_host::volume::{Fault, FileFormat, in_words};

use super::exit::Failure;
use super::input::path_or;

/// Writes `text` to standard output. A reader that has gone away, such as `head`, is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(cause) if cause.kind() != ErrorKind::BrokenPipe => Err(Failure::new(
            Fault::Io,
            format_args!("cannot write to standard output: {}", in_words(&cause)),
        )),
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
        say(what);
    }
}

/// Writes a line to standard error. Where that fails nobody can be told, so the exit code has to say it.
pub(crate) fn say(what: fmt::Arguments<'_>) {
    let _ = writeln!(io::stderr(), "{what}");
}

/// Tells what of a volume's metadata the format of a file has no place for.
pub(crate) fn say_losses(output: &Path, losses: &[String]) {
    if !losses.is_empty() {
        let (path, format) = (output.display(), FileFormat::of_path(output).name());
        say(format_args!("wavelift: {path}: {format} has no place for {}", losses.join(", ")));
    }
}

/// Writes a file of text that appears whole or not at all.
pub(crate) fn write_file(path: &Path, text: &str) -> Result<(), Failure> {
    write_atomically(path, |file| {
        file.write_all(text.as_bytes()).map_err(|cause| Failure::cannot_write(path, &cause))
    })
}

/// Writes a file with `fill`; it appears whole or, if that fails, not at all.
pub(crate) fn write_atomically<T>(
    path: &Path,
    fill: impl FnOnce(&mut AtomicFile) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let mut file = AtomicFile::create(path).map_err(|cause| Failure::cannot_write(path, &cause))?;
    let filled = fill(&mut file)?;
    file.commit().map_err(|cause| Failure::cannot_write(path, &cause))?;
    Ok(filled)
}

/// Takes a path; `-` is standard output, and `./-` a file of that name.
pub(crate) fn output_path() -> impl TypedValueParser<Value = PathBuf> {
    path_or("/dev/stdout")
}

/// Names of standard output as a file.
const STANDARD_OUTPUT: [&str; 3] = ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"];

/// Refuses to write a file into standard output where something else goes already.
///
/// # Errors
/// A usage failure with `message` if `path` is standard output.
pub(crate) fn refuse_standard_output(path: &Path, message: &str) -> Result<(), Failure> {
    if STANDARD_OUTPUT.iter().any(|name| path == Path::new(name)) {
        return Err(Failure::new(Fault::Usage, message));
    }
    Ok(())
}

/// What is told where `--json` and OUTPUT would mix.
pub(crate) const JSON_AND_OUTPUT: &str = "--json and OUTPUT both go to standard output: leave one out";
