//! Streams in any pieces, and any bytes as a stream.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| fuzz::step::check(bytes));
