//! The command line: what it takes, what it says, which exit codes it ends with, and that no fault leaves half a file.

mod bounds;
mod convert;
mod faults;
mod files;
mod formats;
#[cfg(unix)]
mod interrupted;
mod parts;
#[cfg(unix)]
mod pipes;
mod preview;
mod program;
mod repair;
mod reports;
mod run;
mod surface;
mod transform;
