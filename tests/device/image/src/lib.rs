//! What the images share.

#![no_std]

mod memory;

use core::panic::PanicInfo;

/// Nothing calls this: no image may hold a panic.
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {}
}
