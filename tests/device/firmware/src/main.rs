//! What runs on every board: golden vectors both ways, a small volume sent to the host, and measures.
//!
//! Logs travel as defmt frames over semihosting; what is compared with the host's bytes travels in files. Board by
//! board only the start and the count of instructions differ.

#![no_std]
#![no_main]

#[cfg_attr(target_arch = "arm", path = "board/cortex_m.rs")]
#[cfg_attr(target_arch = "riscv32", path = "board/riscv.rs")]
mod board;
mod file;
mod golden;
mod measure;
#[cfg(feature = "slabs")]
mod measure_streams;
mod memory;
mod meter;
#[cfg(feature = "slabs")]
mod streams;
mod volume;

use defmt_semihosting as _;
use semihosting::process::{ExitCode, exit};

/// Everything, once the board has started.
fn run(counter: board::Counter) -> ! {
    let Some(memory) = memory::lend() else { exit(2) };
    let meter = meter::Meter::new(counter);
    let mut passed = golden::run(&mut memory.parts());
    passed &= measure::run(&meter, &mut memory.parts());
    #[cfg(feature = "slabs")]
    {
        passed &= measure_streams::run(&meter, &mut memory.parts());
    }
    passed &= volume::run(&mut memory.parts());
    if passed {
        defmt::info!("passed");
    } else {
        defmt::error!("failed");
    }
    let code = if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    code.exit_process()
}
