//! Chores of the golden data, for `cargo xtask vectors`. Nothing here regenerates everything: files are added
//! one by one, and a file that exists changes only by `replace`, with a reason.

mod check;
mod edit;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use conformance::vectors::{Expect, Manifest, Vector, folder, outcome, sha256};

use crate::edit::Manuscript;

#[derive(Parser)]
#[command(name = "cargo xtask vectors", bin_name = "cargo xtask vectors", about = "Golden data of vectors/")]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Compare every file with its entry, its recipe and its expectation; writes nothing (the default)
    Check,
    /// Write the file of an entry that has none yet, and record its length and checksum
    Add {
        /// Identifiers of entries in vectors/MANIFEST.toml
        #[arg(required = true)]
        ids: Vec<String>,
    },
    /// Replace a file by what its recipe makes now; the input and what is expected of it stay
    Replace {
        /// Identifier of an entry in vectors/MANIFEST.toml
        id: String,
        /// Why the old bytes are wrong; recorded in the entry
        #[arg(long)]
        because: String,
        /// The version of the codestream did not change: nobody has the old bytes
        #[arg(long)]
        same_version: bool,
    },
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command.unwrap_or(Command::Check) {
        Command::Check => check::run(),
        Command::Add { ids } => ids.iter().try_for_each(|id| add(id)),
        Command::Replace { id, because, same_version } => replace(&id, &because, same_version),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn add(id: &str) -> Result<(), String> {
    let manifest = Manifest::read()?;
    let vector = manifest.vector(id)?;
    if path(vector).exists() {
        return Err(format!("vectors/{} exists; only replace changes it", vector.file));
    }
    let bytes = build(&manifest, vector)?;
    let checksum = sha256(&bytes);
    if vector.sha256.as_ref().is_some_and(|recorded| *recorded != checksum) {
        return Err(format!("{id}: the recipe no longer makes the bytes whose checksum is recorded"));
    }
    let mut manuscript = Manuscript::read()?;
    manuscript.set(id, "bytes", &bytes.len().to_string())?;
    manuscript.set(id, "sha256", &quoted(&checksum))?;
    write(vector, &bytes)?;
    manuscript.write()?;
    println!("added vectors/{}: {} bytes, sha256 {checksum}", vector.file, bytes.len());
    Ok(())
}

fn replace(id: &str, because: &str, same_version: bool) -> Result<(), String> {
    let manifest = Manifest::read()?;
    let vector = manifest.vector(id)?;
    let (old, new) = (vector.read()?, build(&manifest, vector)?);
    let Some(difference) = check::first_difference(&old, &new) else {
        return Err(format!("{id}: the recipe makes the bytes of the file; there is nothing to replace"));
    };
    println!("vectors/{}\n  old sha256 {}\n  new sha256 {}", vector.file, sha256(&old), sha256(&new));
    println!("  {difference}");
    if vector.since >= manifest.codestream && !same_version {
        return Err(format!(
            "{id} is of version {} of the codestream, and the encoder writes version {}: released bytes stay. \
             If nobody has them, say --same-version",
            vector.since, manifest.codestream
        ));
    }
    let mut manuscript = Manuscript::read()?;
    manuscript.set(id, "bytes", &new.len().to_string())?;
    manuscript.set(id, "sha256", &quoted(&sha256(&new)))?;
    manuscript.set(id, "since", &manifest.codestream.to_string())?;
    manuscript.set(id, "replaced", &quoted(because))?;
    write(vector, &new)?;
    manuscript.write()?;
    println!("replaced, because {because}");
    Ok(())
}

/// The bytes of a vector, if they are few enough and a decoder makes of them what the entry expects.
fn build(manifest: &Manifest, vector: &Vector) -> Result<Vec<u8>, String> {
    let bytes = manifest.build(vector)?;
    check::check_length(vector, &bytes)?;
    let found = outcome(&bytes);
    if found == vector.expect {
        return Ok(bytes);
    }
    let (Expect::Crc32(found) | Expect::Error(found), expected) = (found, &vector.expect);
    Err(format!("{}: decodes to {found}, not as expected: {expected:?}", vector.id))
}

fn path(vector: &Vector) -> PathBuf {
    folder().join(&vector.file)
}

fn write(vector: &Vector, bytes: &[u8]) -> Result<(), String> {
    let path = path(vector);
    let written =
        path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::write(&path, bytes));
    written.map_err(|error| format!("{}: {error}", path.display()))
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}
