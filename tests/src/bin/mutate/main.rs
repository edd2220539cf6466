//! Damages golden streams, for `cargo xtask fuzz mutate`: as many as asked for, where the tests do a few.

use std::process::ExitCode;

use clap::Parser;
use conformance::mutation;

#[derive(Parser)]
#[command(name = "cargo xtask fuzz mutate", about = "Damage to golden streams")]
struct Arguments {
    /// Damaged streams
    #[arg(long, default_value_t = 1_000_000)]
    count: usize,
    /// The same seed, the same damage
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match mutation::run(arguments.seed, arguments.count) {
        Ok(tallies) => {
            println!("{tallies}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
