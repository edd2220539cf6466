//! What wavelift takes and gives: bytes, time, memory. `cargo xtask bench` starts this program, and sets what it
//! prints, one JSON object a line, beside the rivals.
//!
//! Every run checks its answer. Times are CPU time on one thread, so that other work of the machine does not count,
//! and the least of several runs, because whatever disturbs one only adds to it.

mod coding;
mod lifting;
mod list;
mod memory;
mod stopwatch;
mod ways;

use std::error::Error;
use std::path::PathBuf;

use clap::{Parser, Subcommand};
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Given by cargo to every benchmark
    #[arg(long, hide = true)]
    bench: bool,
}

#[derive(Subcommand)]
enum Command {
    /// Lifting by each wavelet, beside a copy of the same memory; this is what runs without a command
    Lifting,
    /// Each volume of a list, coded in each way: bytes, seconds, peak memory
    Volumes { list: PathBuf },
    /// What a device has to lend the kernel for a brick
    Memory,
    /// The first volume of a list, coded so often in one way, for a program that counts instructions
    Repeat { list: PathBuf, codec: String, encode: u32, decode: u32 },
}

fn main() -> Result<(), Box<dyn Error>> {
    match Arguments::parse().command.unwrap_or(Command::Lifting) {
        Command::Lifting => lifting::measure(),
        Command::Volumes { list } => list::read(&list)?.iter().try_for_each(coding::measure),
        Command::Memory => memory::measure(),
        Command::Repeat { list, codec, encode, decode } => {
            let volumes = list::read(&list)?;
            coding::repeat(volumes.first().ok_or("no volume in the list")?, &codec, encode, decode)
        }
    }
}
