//! RISC-V: the processor counts the instructions it has finished.

use core::arch::asm;

use riscv::register::minstret;
use riscv_rt::entry;

/// The counter of instructions.
pub(crate) struct Counter;

#[entry]
fn start() -> ! {
    crate::run(Counter)
}

impl Counter {
    /// Instructions so far.
    pub(crate) fn ticks(&self) -> u32 {
        minstret::read() as u32
    }

    /// Instructions from one count to a later one.
    pub(crate) fn between(&self, first: u32, second: u32) -> u32 {
        second.wrapping_sub(first)
    }
}

/// Runs 2 `count` instructions.
pub(crate) fn spin(count: u32) {
    // SAFETY: the loop counts a register down and touches nothing else.
    unsafe { asm!("2:", "addi {0}, {0}, -1", "bnez {0}, 2b", inout(reg) count => _, options(nomem, nostack)) }
}
