//! Runs firmware in QEMU, prints its logs, and compares what it sent with what the host makes.
//!
//! `runner BOARD FIRMWARE`; the exit code says whether all is well.

mod board;
mod brick;
mod log;
mod stream;
mod volume;

use std::path::Path;
use std::process::ExitCode;

use crate::log::Log;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [board, firmware] = arguments.as_slice() else {
        eprintln!("usage: runner {} FIRMWARE", board::names());
        return ExitCode::from(2);
    };
    match run(board, Path::new(firmware)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{board}: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(board: &str, firmware: &Path) -> Result<(), String> {
    let folder = tempfile::tempdir().map_err(|error| format!("no temporary folder: {error}"))?;
    let elf = std::fs::read(firmware).map_err(|error| format!("{}: {error}", firmware.display()))?;
    let outcome = board::run(board, firmware, folder.path())?;
    let log = Log::decode(&elf, &outcome.frames)?;
    log.lines.iter().for_each(|line| println!("{line}"));
    if !outcome.succeeded || log.lines.last().map(String::as_str) != Some("passed") {
        return Err("the firmware says that something failed, or did not come to its end".to_owned());
    }
    let bricks = brick::compare(&log)?;
    let streams = stream::compare(&log)?;
    let entries = volume::compare(folder.path())?;
    println!("host bricks={bricks} streams={streams} entries={entries}");
    Ok(())
}
