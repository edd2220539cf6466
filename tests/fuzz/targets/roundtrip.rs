//! Any samples under any plan, there and back.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| fuzz::roundtrip::check(bytes));
