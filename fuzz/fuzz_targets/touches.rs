//! libFuzzer drives `fuzz::touches`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz::touches(bytes));
