//! Cortex-M: SysTick counts, at the clock of the processor.

use core::arch::asm;

use cortex_m::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::entry;

/// Ticks before the counter begins again.
const WRAP: u32 = 1 << 24;

/// SysTick, running.
pub(crate) struct Counter;

#[entry]
fn start() -> ! {
    let Some(Peripherals { SYST: mut timer, .. }) = Peripherals::take() else {
        semihosting::process::exit(2)
    };
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(WRAP - 1);
    timer.clear_current();
    timer.enable_counter();
    crate::run(Counter)
}

impl Counter {
    /// Ticks so far, of which one stands for a fixed number of instructions.
    pub(crate) fn ticks(&self) -> u32 {
        WRAP - 1 - SYST::get_current()
    }

    /// Ticks from one count to a later one, less than a whole turn apart.
    pub(crate) fn between(&self, first: u32, second: u32) -> u32 {
        second.wrapping_sub(first) % WRAP
    }
}

/// Runs 2 `count` instructions.
pub(crate) fn spin(count: u32) {
    // SAFETY: the loop counts a register down and touches nothing else.
    unsafe { asm!("2:", "subs {0}, #1", "bne 2b", inout(reg) count => _, options(nomem, nostack)) }
}
