//! Instructions and stack that a piece of work takes.

use core::hint::black_box;

use crate::board::{Counter, spin};

/// What the stack is painted with.
const PAINT: u32 = 0xA5C3_5A3C;

/// Words of the stack that are painted: more than any work here takes.
const PAINTED: usize = if cfg!(feature = "roomy") { 4096 } else { 1280 };

/// Words next to the painter that its own calls may take.
const SPARED: usize = 32;

/// Times that the loop of known length runs when the counter is set right.
const SPINS: u32 = 1 << 20;

/// Counts instructions by a counter whose unit it has found out.
pub(crate) struct Meter {
    counter: Counter,
    /// Ticks of 2 [`SPINS`] instructions.
    ticks: u32,
}

/// What a piece of work took.
#[derive(Clone, Copy)]
pub(crate) struct Taken {
    pub(crate) instructions: u32,
    pub(crate) stack: u32,
}

impl Meter {
    pub(crate) fn new(counter: Counter) -> Self {
        let start = counter.ticks();
        spin(SPINS);
        let ticks = counter.between(start, counter.ticks());
        Self { counter, ticks }
    }

    /// Does `work`, and says what it took.
    #[inline(never)]
    pub(crate) fn measure<T>(&self, work: impl FnOnce() -> T) -> (T, Taken) {
        let mark = 0_u32;
        let here = black_box(&raw const mark).cast_mut();
        paint(here);
        let start = self.counter.ticks();
        let result = work();
        let ticks = self.counter.between(start, self.counter.ticks());
        let stack = high_water(here);
        let instructions = u64::from(ticks) * u64::from(2 * SPINS) / u64::from(self.ticks);
        (result, Taken { instructions: instructions as u32, stack })
    }
}

/// Paints the stack below `here`, but for what this function needs.
#[inline(never)]
fn paint(here: *mut u32) {
    for word in SPARED..PAINTED {
        let place = here.wrapping_sub(word);
        // SAFETY: the boards have this much stack, none of it in use that far below a living local.
        unsafe { place.write_volatile(PAINT) }
    }
}

/// Bytes of the stack below `here` that were written since it was painted.
#[inline(never)]
fn high_water(here: *mut u32) -> u32 {
    let is_painted = |word: &usize| {
        let place = here.wrapping_sub(*word);
        // SAFETY: as for painting.
        unsafe { place.read_volatile() == PAINT }
    };
    let clean = (SPARED..PAINTED).rev().take_while(is_painted).count();
    ((PAINTED - 1 - clean) * size_of::<u32>()) as u32
}
